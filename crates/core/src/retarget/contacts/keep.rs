//! Moves hands to where the source's touch, and arms out of other parts of the body: how far each wrist moves, smooth over time,
//! and the turns of shoulder and elbow that follow in closed form. Legs stay as they are, since feet stand where they stand.

use glam::{DQuat, DVec3};

use super::body::{Bodies, Frames};
use super::smooth::eased;
use super::touch::Touches;
use crate::anim::{Clip, JointIndex, Keys, Property};
use crate::asset::Slot;
use crate::retarget::feet::{Leg, LegTurns, dense_times, limit_turns, solve_leg, turned_locals};
use crate::retarget::keys::channel::NewChannel;
use crate::retarget::pose::{Scratch, WorldPose};
use crate::retarget::transfer::{Transfer, removed_travel, rotation_laws};

/// Touching and pushing out in turns, since each disturbs the other.
const ROUNDS: usize = 3;

/// Shares of the body's height: a wrist is never moved further than the first, and moves below the second are none.
const MAX_MOVE: f64 = 0.15;
const MIN_MOVE: f64 = 1e-4;

/// A point that is less deep than this share of the body's height stays.
const TOLERATED: f64 = 0.002;

/// A point that is deeper than that by this share is pushed out fully.
const CLEARLY_INSIDE: f64 = 0.003;

/// How far an upper or lower arm may be turned, and how fast.
const MAX_TURN_DEGREES: f64 = 50.0;
const MAX_TURN_DEGREES_PER_SEC: f64 = 250.0;

/// Joints of the arms, as in [`super::body::Region::arm`].
const ARMS: [[Slot; 3]; 2] = [
    [Slot::LeftUpperArm, Slot::LeftLowerArm, Slot::LeftHand],
    [Slot::RightUpperArm, Slot::RightLowerArm, Slot::RightHand],
];

/// One moment of the clip.
struct Moment {
    frames: Frames,
    touches: Touches,
    /// Turn and scale.
    target_from_source: (DQuat, f64),
}

/// What the points of one arm want its wrist to do: a weighted least-squares fit.
#[derive(Clone, Copy, Default)]
struct Wish {
    sum: DVec3,
    squares: f64,
    /// How much the most urgent point wants it.
    share: f64,
}

impl Wish {
    fn add(&mut self, by: DVec3, lever: f64, weight: f64, share: f64) {
        self.sum += weight * lever * by;
        self.squares += weight * lever * lever;
        self.share = self.share.max(share);
    }

    fn fit(self) -> (DVec3, f64) {
        if self.squares > 0.0 { (self.sum / self.squares, self.share) } else { (DVec3::ZERO, 0.0) }
    }
}

/// The clip at the sampled times, and how far each wrist moves.
struct Solver<'a> {
    bodies: &'a Bodies,
    times: &'a [f32],
    moments: Vec<Moment>,
    /// Whether an arm can be moved.
    movable: [bool; 2],
    moves: [Vec<DVec3>; 2],
}

impl Solver<'_> {
    fn moved_frames(&self, at: usize) -> Frames {
        let parts = self.moments[at].frames.iter().zip(&self.bodies.regions).zip(&self.bodies.levers);
        let moved = parts.map(|((&(position, turn), region), lever)| {
            (region.arm().map_or(position, |arm| position + *lever * self.moves[arm][at]), turn)
        });
        moved.collect()
    }

    fn point(&self, at: usize, index: usize) -> DVec3 {
        let point = &self.bodies.points[index];
        let move_of = |arm: usize| point.lever * self.moves[arm][at];
        let position = self.bodies.target.point(index, point.part, &self.moments[at].frames);
        position + point.region.arm().map_or(DVec3::ZERO, move_of)
    }

    /// Adds a wish of a part, which moves with its arm by `lever`, relative to another. Two arms share it.
    fn wish(
        &self,
        wishes: &mut [Wish; 2],
        [part, other]: [usize; 2],
        lever: f64,
        by: DVec3,
        [weight, share]: [f64; 2],
    ) {
        let movable = |part: usize| self.bodies.regions[part].arm().filter(|&arm| self.movable[arm]);
        let [own, partner] = [movable(part), movable(other)];
        let half = if own.is_some() && partner.is_some() { 0.5 } else { 1.0 };
        if let Some(arm) = own {
            wishes[arm].add(half * by, lever, weight, share);
        }
        if let Some(arm) = partner {
            wishes[arm].add(-half * by, self.bodies.levers[other], weight, share);
        }
    }

    /// What touches on the source should touch on the target.
    fn touch(&self, at: usize) -> [Wish; 2] {
        let moment = &self.moments[at];
        let frames = self.moved_frames(at);
        let mut wishes = [Wish::default(); 2];
        let point = |index| self.point(at, index);
        for (hand, part, weight, by) in self.bodies.misses(&moment.touches, point, &frames, moment.target_from_source) {
            self.wish(&mut wishes, [hand, part], 1.0, by, [weight, weight]);
        }
        wishes
    }

    /// What is inside other parts, and is not on the source, should come out.
    fn push_out(&self, at: usize) -> [Wish; 2] {
        let moment = &self.moments[at];
        let frames = self.moved_frames(at);
        let target = &self.bodies.target;
        let mut wishes = [Wish::default(); 2];
        for (index, others) in self.bodies.others.iter().enumerate() {
            let position = self.point(at, index);
            for &(part, at_rest) in others {
                let Some((distance, place)) = target.locate(part, &frames, position, 0.0) else { continue };
                let allowed = at_rest.max(moment.target_from_source.1 * moment.touches.depth(index, part));
                let excess = -distance - allowed - TOLERATED * self.bodies.heights[1];
                if excess > 0.0 {
                    let by = excess * target.outward(part, &frames, place);
                    let share = (excess / (CLEARLY_INSIDE * self.bodies.heights[1])).min(1.0);
                    let point = &self.bodies.points[index];
                    self.wish(&mut wishes, [point.part, part], point.lever, by, [excess, share]);
                }
            }
        }
        wishes
    }

    fn add(&mut self, wishes: impl Fn(&Self, usize) -> [Wish; 2]) {
        let wishes: Vec<[Wish; 2]> = (0..self.times.len()).map(|at| wishes(self, at)).collect();
        let limit = MAX_MOVE * self.bodies.heights[1];
        for arm in 0..2 {
            let wanted: Vec<(DVec3, f64)> = wishes.iter().map(|wishes| wishes[arm].fit()).collect();
            for (by, more) in self.moves[arm].iter_mut().zip(eased(self.times, &wanted)) {
                *by = (*by + more).clamp_length_max(limit);
            }
        }
    }
}

/// Returns all channels of the clip with its contacts kept, or `None` if there is nothing to do. `resampled` lists the joints whose
/// keys in `clip` are not the source's own.
pub fn kept_contacts(
    transfer: &Transfer,
    bodies: &Bodies,
    clip: &Clip,
    resampled: &[JointIndex],
) -> Option<Vec<NewChannel>> {
    let times = dense_times(transfer.tracks.clip);
    let mut scratch = Scratch::default();
    let poses: Vec<WorldPose> = times.iter().map(|&time| transfer.target_pose(clip, time, &mut scratch)).collect();
    let (laws, _) = rotation_laws(transfer);
    let yaw = removed_travel(transfer, &laws, &times).yaw;
    let scale = transfer.hips.map_or(1.0, |hips| hips.scale);
    let source: Vec<Frames> = times.iter().map(|&time| bodies.source.frames(&transfer.source_pose(time))).collect();
    let touches = bodies.touches(&times, &source);
    let moment = |((pose, &time), touches): ((&WorldPose, &f32), Touches)| Moment {
        frames: bodies.target.frames(pose),
        touches,
        target_from_source: (DQuat::from_rotation_y(yaw.as_ref().map_or(0.0, |yaw| yaw.at(time))), scale),
    };
    let moments = poses.iter().zip(&times).zip(touches).map(moment).collect();
    let rest = &transfer.alignment.target;
    let arms: [Option<Leg>; 2] = ARMS.map(|slots| {
        let [Some(shoulder), Some(elbow), Some(wrist)] = slots.map(|slot| transfer.pair(slot)) else { return None };
        Some(Leg::arm([shoulder.target, elbow.target, wrist.target], rest))
    });
    let movable = arms.map(|arm| arm.is_some());
    let moves = std::array::from_fn(|_| vec![DVec3::ZERO; times.len()]);
    let mut solver = Solver { bodies, times: &times, moments, movable, moves };
    for _ in 0..ROUNDS {
        solver.add(Solver::touch);
        solver.add(Solver::push_out);
    }
    solver.add(Solver::touch);
    let mut rotations: Vec<(JointIndex, Vec<DQuat>)> = Vec::new();
    for (arm, moves) in arms.iter().zip(&solver.moves) {
        if let Some(arm) = arm
            && moves.iter().any(|by| by.length() > MIN_MOVE * bodies.heights[1])
        {
            rotations.extend(arm_rotations(transfer, arm, &times, &poses, moves));
        }
    }
    if rotations.is_empty() {
        return None;
    }
    let is_replaced = |joint: JointIndex, property: Property| {
        property == Property::Rotation && rotations.iter().any(|(other, _)| *other == joint)
    };
    let mut channels = NewChannel::of_clip(clip, resampled, is_replaced);
    for (joint, keys) in &rotations {
        let keys = keys.iter().map(|key| key.as_quat()).collect();
        channels.push(NewChannel::resampled(*joint, times.clone(), Keys::Rotation(keys)));
    }
    Some(channels)
}

/// Local rotations of an arm's three joints at each time.
fn arm_rotations(
    transfer: &Transfer,
    arm: &Leg,
    times: &[f32],
    poses: &[WorldPose],
    moves: &[DVec3],
) -> Vec<(JointIndex, Vec<DQuat>)> {
    let [max_turn, max_rate] = [MAX_TURN_DEGREES, MAX_TURN_DEGREES_PER_SEC].map(f64::to_radians);
    let solved = poses.iter().zip(moves).map(|(pose, &by)| solve_leg(arm, pose, by, 0.0));
    let (mut upper, mut lower): (Vec<DQuat>, Vec<DQuat>) = solved.map(|turns| (turns.thigh, turns.shin)).unzip();
    limit_turns(times, &mut upper, max_turn, max_rate);
    limit_turns(times, &mut lower, max_turn, max_rate);
    let mut keys: [Vec<DQuat>; 3] = Default::default();
    for (at, pose) in poses.iter().enumerate() {
        let turns = LegTurns { thigh: upper[at], shin: lower[at] };
        let locals = turned_locals(arm, transfer.target_skeleton, pose, turns);
        keys.iter_mut().zip(locals).for_each(|(keys, rotation)| keys.push(rotation));
    }
    [arm.hip, arm.knee, arm.ankle].into_iter().zip(keys).collect()
}
