//! Moves hands to where the source's touch, and limbs out of other parts of the body: how far the end of each limb moves, smooth
//! over time, and the turns of its joints that follow in closed form.

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

/// Shares of the body's height: the end of a limb is never moved further than the first, and moves below the second are none.
const MAX_MOVE: f64 = 0.15;
const MIN_MOVE: f64 = 1e-4;

/// A point that is deeper than this share of the body's height is pushed out fully.
const CLEARLY_INSIDE: f64 = 0.003;

/// How far an upper or lower limb may be turned, and how fast.
const MAX_TURN_DEGREES: f64 = 50.0;
const MAX_TURN_DEGREES_PER_SEC: f64 = 250.0;

/// Joints of the limbs, as in [`super::body::Region::LIMBS`].
const LIMBS: [[Slot; 3]; 4] = [
    [Slot::LeftUpperArm, Slot::LeftLowerArm, Slot::LeftHand],
    [Slot::RightUpperArm, Slot::RightLowerArm, Slot::RightHand],
    [Slot::LeftUpperLeg, Slot::LeftLowerLeg, Slot::LeftFoot],
    [Slot::RightUpperLeg, Slot::RightLowerLeg, Slot::RightFoot],
];

/// One moment of the clip.
struct Moment {
    frames: Frames,
    touches: Touches,
    /// Turn and scale.
    target_from_source: (DQuat, f64),
}

/// What the points of one limb want its end to do: a weighted least-squares fit.
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

/// The clip at the sampled times, and how far the end of each limb moves.
struct Solver<'a> {
    bodies: &'a Bodies,
    times: &'a [f32],
    moments: Vec<Moment>,
    /// Whether a limb can be moved.
    movable: [bool; 4],
    moves: [Vec<DVec3>; 4],
}

impl Solver<'_> {
    fn moved_frames(&self, at: usize) -> Frames {
        let parts = self.moments[at].frames.iter().zip(&self.bodies.regions).zip(&self.bodies.levers);
        let moved = parts.map(|((&(position, turn), region), lever)| {
            (region.limb().map_or(position, |limb| position + *lever * self.moves[limb][at]), turn)
        });
        moved.collect()
    }

    fn point(&self, at: usize, index: usize) -> DVec3 {
        let point = &self.bodies.points[index];
        let move_of = |limb: usize| point.lever * self.moves[limb][at];
        let position = self.bodies.target.point(index, point.part, &self.moments[at].frames);
        position + point.region.limb().map_or(DVec3::ZERO, move_of)
    }

    /// Adds a wish of a point relative to a part. Two arms, or two legs, share it.
    fn wish(&self, wishes: &mut [Wish; 4], (index, part): (usize, usize), by: DVec3, weight: f64, share: f64) {
        let point = &self.bodies.points[index];
        let other = self.bodies.regions[part];
        let own = point.region.limb().filter(|&limb| self.movable[limb]);
        let partner = other.limb().filter(|&limb| self.movable[limb] && other.is_leg() == point.region.is_leg());
        let half = if own.is_some() && partner.is_some() { 0.5 } else { 1.0 };
        if let Some(limb) = own {
            wishes[limb].add(half * by, point.lever, weight, share);
        }
        if let Some(limb) = partner {
            wishes[limb].add(-half * by, self.bodies.levers[part], weight, share);
        }
    }

    /// What touches on the source should touch on the target.
    fn touch(&self, at: usize) -> [Wish; 4] {
        let moment = &self.moments[at];
        let frames = self.moved_frames(at);
        let mut wishes = [Wish::default(); 4];
        let of_arms = moment.touches.touches.iter().filter(|touch| !self.bodies.points[touch.point].region.is_leg());
        for touch in of_arms {
            let by = self.bodies.miss(touch, self.point(at, touch.point), &frames, moment.target_from_source);
            self.wish(&mut wishes, (touch.point, touch.part), by, touch.weight, touch.weight);
        }
        wishes
    }

    /// What is inside other parts, and is not on the source, should come out.
    fn push_out(&self, at: usize) -> [Wish; 4] {
        let moment = &self.moments[at];
        let frames = self.moved_frames(at);
        let target = &self.bodies.target;
        let mut wishes = [Wish::default(); 4];
        for (index, others) in self.bodies.others.iter().enumerate() {
            let position = self.point(at, index);
            for &(part, at_rest) in others {
                let Some((distance, place)) = target.locate(part, &frames, position, 0.0) else { continue };
                let allowed = at_rest.max(moment.target_from_source.1 * moment.touches.depth(index, part));
                let excess = -distance - allowed;
                if excess > 0.0 {
                    let by = excess * target.outward(part, &frames, place);
                    let share = (excess / (CLEARLY_INSIDE * self.bodies.heights[1])).min(1.0);
                    self.wish(&mut wishes, (index, part), by, excess, share);
                }
            }
        }
        wishes
    }

    fn add(&mut self, wishes: impl Fn(&Self, usize) -> [Wish; 4]) {
        let wishes: Vec<[Wish; 4]> = (0..self.times.len()).map(|at| wishes(self, at)).collect();
        let limit = MAX_MOVE * self.bodies.heights[1];
        for limb in 0..4 {
            let wanted: Vec<(DVec3, f64)> = wishes.iter().map(|wishes| wishes[limb].fit()).collect();
            for (by, more) in self.moves[limb].iter_mut().zip(eased(self.times, &wanted)) {
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
    let limbs: [Option<Leg>; 4] = std::array::from_fn(|limb| {
        let [Some(top), Some(middle), Some(end)] = LIMBS[limb].map(|slot| transfer.pair(slot)) else { return None };
        let joints = [top.target, middle.target, end.target];
        Some(if limb < 2 {
            Leg::arm(joints, rest)
        } else {
            Leg::new([joints[0], joints[1], joints[2], joints[2]], rest)
        })
    });
    let movable = limbs.map(|limb| limb.is_some());
    let moves = std::array::from_fn(|_| vec![DVec3::ZERO; times.len()]);
    let mut solver = Solver { bodies, times: &times, moments, movable, moves };
    for _ in 0..ROUNDS {
        if std::env::var("GW_NOTOUCH").is_err() { solver.add(Solver::touch); }
        if std::env::var("GW_NOPUSH").is_err() { solver.add(Solver::push_out); }
    }
    let mut rotations: Vec<(JointIndex, Vec<DQuat>)> = Vec::new();
    for (leg, moves) in limbs.iter().zip(&solver.moves) {
        if let Some(leg) = leg
            && moves.iter().any(|by| by.length() > MIN_MOVE * bodies.heights[1])
        {
            rotations.extend(limb_rotations(transfer, leg, &times, &poses, moves));
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

/// Local rotations of a limb's three joints at each time.
fn limb_rotations(
    transfer: &Transfer,
    leg: &Leg,
    times: &[f32],
    poses: &[WorldPose],
    moves: &[DVec3],
) -> Vec<(JointIndex, Vec<DQuat>)> {
    let [max_turn, max_rate] = [MAX_TURN_DEGREES, MAX_TURN_DEGREES_PER_SEC].map(f64::to_radians);
    let solved = poses.iter().zip(moves).map(|(pose, &by)| solve_leg(leg, pose, by, 0.0));
    let (mut upper, mut lower): (Vec<DQuat>, Vec<DQuat>) = solved.map(|turns| (turns.thigh, turns.shin)).unzip();
    limit_turns(times, &mut upper, max_turn, max_rate);
    limit_turns(times, &mut lower, max_turn, max_rate);
    let mut keys: [Vec<DQuat>; 3] = Default::default();
    for (at, pose) in poses.iter().enumerate() {
        let turns = LegTurns { thigh: upper[at], shin: lower[at] };
        let locals = turned_locals(leg, transfer.target_skeleton, pose, turns);
        keys.iter_mut().zip(locals).for_each(|(keys, rotation)| keys.push(rotation));
    }
    [leg.hip, leg.knee, leg.ankle].into_iter().zip(keys).collect()
}
