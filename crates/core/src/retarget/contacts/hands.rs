//! Moves hands to where the source's touch, and arms out of other parts of the body and the ground: how far each wrist moves, smooth
//! over time, and the turns of upper arm and forearm that follow in closed form. Legs and trunk stay as `knees` leaves them.

use glam::{DQuat, DVec3};

use super::arm::Arm;
use super::body::{Bodies, Frames, place_of};
use super::ground::{Ground, Sunken};
use super::scene::Scene;
use super::smooth::eased;
use super::touch::Touches;
use super::{MAX_MOVE, MAX_TURN_DEGREES, MAX_TURN_DEGREES_PER_SEC, MIN_MOVE};
use crate::anim::{Clip, JointIndex};
use crate::retarget::feet::ranges;
use crate::retarget::keys::channel::NewChannel;
use crate::retarget::limit::limit_turns;
use crate::retarget::math::HORIZONTAL;
use crate::retarget::pose::WorldPose;
use crate::retarget::transfer::{removed_travel, rotation_laws};
use crate::retarget::two_bones::limb_rotations;

/// Touching and pushing out in turns, since each disturbs the other, and then both at once.
const ROUNDS: usize = 2;
const COMPROMISES: usize = 2;

/// Weight of a point that is as deep inside as the body is high, against that of a contact.
const PUSH_WEIGHT: f64 = 10.0;

/// A point that is less deep than this share of the body's height stays.
const TOLERATED: f64 = 0.002;

/// A point that is deeper than that by this share is pushed out fully.
const CLEARLY_INSIDE: f64 = 0.003;

/// One moment of the clip.
struct Moment {
    /// With the arms moved so far.
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

/// A point of a limb that is deeper inside another part, or in the ground, than it may be.
struct Overlap {
    limb: usize,
    other: Option<usize>,
    point: usize,
    excess: f64,
    outward: DVec3,
}

struct Solver<'a> {
    bodies: &'a Bodies,
    times: Vec<f32>,
    /// The clip without corrections.
    poses: Vec<WorldPose>,
    moments: Vec<Moment>,
    arms: [Option<Arm>; 2],
    /// `None` without feet.
    ground: Option<Ground>,
    /// How far each wrist has to move over the ground to stay in place while it rests there, at each time.
    holds: [Vec<DVec3>; 2],
    /// How far each wrist moves, at each time.
    moves: [Vec<DVec3>; 2],
}

/// Returns all channels of the clip with its hands where they touch, or `None` if there is nothing to do. `resampled` lists the joints
/// whose keys in `clip` are not the source's own.
pub fn kept_hands(scene: Scene, clip: &Clip, resampled: &[JointIndex]) -> Option<Vec<NewChannel>> {
    let skeleton = scene.transfer.target_skeleton;
    let mut solver = Solver::new(scene);
    for _ in 0..ROUNDS {
        solver.add(Solver::touch);
        solver.add(Solver::push_out);
    }
    for _ in 0..COMPROMISES {
        solver.add(Solver::compromise);
    }
    let mut rotations: Vec<(JointIndex, Vec<DQuat>)> = Vec::new();
    for (index, arm) in solver.arms.iter().enumerate() {
        let turns = solver.turns(index);
        let Some(arm) = arm.filter(|_| turns.iter().flatten().any(|&turn| turn != DQuat::IDENTITY)) else { continue };
        let turns = turns.each_ref().map(Vec::as_slice);
        rotations.extend(limb_rotations(skeleton, arm.joints, &solver.poses, turns));
    }
    (!rotations.is_empty()).then(|| NewChannel::corrected(clip, resampled, &solver.times, None, rotations))
}

impl<'a> Solver<'a> {
    fn new(scene: Scene<'a>) -> Self {
        let scale = scene.transfer.scale();
        let Scene { transfer, bodies, times, source, poses, target, ground } = scene;
        let (laws, _) = rotation_laws(transfer);
        let removed = removed_travel(transfer, &laws, &times);
        let mut moments = Vec::with_capacity(times.len());
        for ((&time, frames), touches) in times.iter().zip(target.frames).zip(bodies.touches(&times, &source.frames)) {
            moments.push(Moment { frames, touches, target_from_source: (removed.turn(time), scale) });
        }
        let arms = bodies.arms.map(|joints| Some(Arm::new(joints?, &transfer.alignment.target)));
        let [moves, mut holds] = [(); 2].map(|()| std::array::from_fn(|_| vec![DVec3::ZERO; times.len()]));
        for (part, touching) in bodies.ground_parts.iter().zip(ground.iter().flat_map(|ground| &ground.touching)) {
            let Some(arm) = bodies.regions[part.part].arm().filter(|&arm| arms[arm].is_some()) else { continue };
            // How far the wrist is from where the source's is: constant if it goes over the ground like that.
            let offset = |at: usize| {
                let turn_back = moments[at].target_from_source.0.conjugate();
                let wrist = bodies.target.joints[part.part];
                let wrist = removed.restored(transfer, &poses[at], wrist, at, turn_back);
                (wrist - scale * source.frames[at][part.part].0) * HORIZONTAL
            };
            for contact in ranges(touching) {
                let offsets: Vec<DVec3> = contact.clone().map(offset).collect();
                let mean = offsets.iter().sum::<DVec3>() / offsets.len() as f64;
                for (at, offset) in contact.zip(offsets) {
                    holds[arm][at] = moments[at].target_from_source.0 * (mean - offset);
                }
            }
        }
        Self { bodies, times, poses, moments, arms, ground, holds, moves }
    }

    /// What touches on the source should touch on the target.
    fn touch(&self, at: usize) -> [Wish; 2] {
        let moment = &self.moments[at];
        let mut wishes = [Wish::default(); 2];
        for miss in self.bodies.misses(&moment.touches, &moment.frames, moment.target_from_source) {
            let pair = &self.bodies.pairs[miss.pair];
            self.wish(&mut wishes, pair.limb, Some(pair.other), 1.0, miss.by, [miss.weight; 2]);
        }
        for (part, by) in self.ground.iter().flat_map(|ground| ground.misses(self.bodies, at, &moment.frames)) {
            if let Some(arm) = self.bodies.regions[part].arm() {
                let over = (self.holds[arm][at] - self.moves[arm][at]) * HORIZONTAL;
                self.wish(&mut wishes, part, None, 1.0, over + by * DVec3::Y, [1.0; 2]);
            }
        }
        wishes
    }

    /// What is inside other parts, and is not on the source, should come out.
    fn push_out(&self, at: usize) -> [Wish; 2] {
        let mut wishes = [Wish::default(); 2];
        for Overlap { limb, other, point, excess, outward } in self.overlaps(at) {
            let share = (excess / (CLEARLY_INSIDE * self.bodies.target.height)).min(1.0);
            let lever = self.bodies.lever(limb, place_of(point).share);
            self.wish(&mut wishes, limb, other, lever, excess * outward, [excess, share]);
        }
        wishes
    }

    /// Both at once, where they contradict each other.
    fn compromise(&self, at: usize) -> [Wish; 2] {
        let (mut wishes, pushes) = (self.touch(at), self.push_out(at));
        let weight = PUSH_WEIGHT / self.bodies.target.height;
        for (wish, push) in wishes.iter_mut().zip(pushes) {
            wish.sum += weight * push.sum;
            wish.squares += weight * push.squares;
            wish.share = wish.share.max(push.share);
        }
        wishes
    }

    fn overlaps(&self, at: usize) -> Vec<Overlap> {
        let target = &self.bodies.target;
        let moment = &self.moments[at];
        let frames = &moment.frames;
        let tolerated = TOLERATED * target.height;
        let sunken = self.ground.iter().flat_map(|ground| ground.sunken(self.bodies, at, frames, tolerated));
        let mut overlaps: Vec<Overlap> = sunken
            .map(|Sunken { part, point, depth }| Overlap {
                limb: part,
                other: None,
                point,
                excess: depth,
                outward: DVec3::Y,
            })
            .collect();
        for meeting in self.bodies.meetings(target, frames, 0.0) {
            let pair = &self.bodies.pairs[meeting.pair];
            let of_source = moment.target_from_source.1 * moment.touches.depth(meeting.pair, meeting.point);
            let allowed = pair.at_rest[meeting.point].max(of_source) + tolerated;
            let excess = -meeting.distance - allowed;
            if excess > 0.0 {
                let outward = target.outward(pair.other, meeting.place, frames);
                let (limb, other) = (pair.limb, Some(pair.other));
                overlaps.push(Overlap { limb, other, point: meeting.point, excess, outward });
            }
        }
        overlaps
    }

    /// Adds a wish of a limb's part, which moves with its wrist by `lever`, relative to another part or the ground. Two arms share
    /// it.
    fn wish(
        &self,
        wishes: &mut [Wish; 2],
        limb: usize,
        other: Option<usize>,
        lever: f64,
        by: DVec3,
        [weight, share]: [f64; 2],
    ) {
        let movable = |part: usize| self.bodies.regions[part].arm().filter(|&arm| self.arms[arm].is_some());
        let own = movable(limb).map(|arm| (arm, lever));
        let partner = other.and_then(|part| Some((movable(part)?, self.bodies.lever(part, 0.5))));
        let by = if own.is_some() && partner.is_some() { 0.5 * by } else { by };
        for (moved, by) in [(own, by), (partner, -by)] {
            if let Some((arm, lever)) = moved {
                wishes[arm].sum += weight * lever * by;
                wishes[arm].squares += weight * lever * lever;
                wishes[arm].share = share.max(wishes[arm].share);
            }
        }
    }

    /// Moves the wrists further, smoothly over time.
    fn add(&mut self, wishes: fn(&Self, usize) -> [Wish; 2]) {
        let wishes: Vec<[Wish; 2]> = (0..self.times.len()).map(|at| wishes(self, at)).collect();
        let limit = MAX_MOVE * self.bodies.target.height;
        for arm in 0..2 {
            let fit = |wish: Wish| {
                if wish.squares > 0.0 { (wish.sum / wish.squares, wish.share) } else { (DVec3::ZERO, 0.0) }
            };
            let wanted: Vec<(DVec3, f64)> = wishes.iter().map(|wishes| fit(wishes[arm])).collect();
            for (by, more) in self.moves[arm].iter_mut().zip(eased(&self.times, &wanted)) {
                *by = (*by + more).clamp_length_max(limit);
            }
        }
        for at in 0..self.times.len() {
            let turns = [0, 1].map(|arm| self.reach(arm, at));
            self.moments[at].frames = self.turned_frames(at, turns);
        }
    }

    fn reach(&self, arm: usize, at: usize) -> [DQuat; 2] {
        let by = self.moves[arm][at];
        let is_moved = by.length() > MIN_MOVE * self.bodies.target.height;
        let arm = self.arms[arm].filter(|_| is_moved);
        arm.map_or([DQuat::IDENTITY; 2], |arm| arm.reach(&self.poses[at], by))
    }

    /// The target's parts with its arms turned.
    fn turned_frames(&self, at: usize, turns: [[DQuat; 2]; 2]) -> Frames {
        let target = &self.bodies.target;
        let pose = &self.poses[at];
        let mut frames = target.frames(pose);
        for (arm, [upper, lower]) in self.arms.iter().zip(turns) {
            let Some(arm) = arm else { continue };
            let [shoulder, elbow, wrist] = arm.joints.map(|joint| pose.position(joint));
            let moved_elbow = shoulder + upper * (elbow - shoulder);
            let moved_wrist = moved_elbow + lower * (wrist - elbow);
            let moved = [(shoulder, upper), (moved_elbow, lower), (moved_wrist, DQuat::IDENTITY)];
            for (joint, (position, turn)) in arm.joints.iter().zip(moved) {
                if let Some(part) = target.joints.iter().position(|other| other == joint) {
                    frames[part] = (position, turn * frames[part].1);
                }
            }
        }
        frames
    }

    /// How an arm turns at each time.
    fn turns(&self, arm: usize) -> [Vec<DQuat>; 2] {
        let [max_turn, max_rate] = [MAX_TURN_DEGREES, MAX_TURN_DEGREES_PER_SEC].map(f64::to_radians);
        let mut turns = [Vec::new(), Vec::new()];
        for at in 0..self.times.len() {
            let [upper, lower] = self.reach(arm, at);
            turns[0].push(upper);
            turns[1].push(lower);
        }
        for turns in &mut turns {
            limit_turns(&self.times, turns, max_turn, max_rate);
        }
        turns
    }
}
