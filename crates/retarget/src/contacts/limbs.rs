//! Moves hands to where the source's touch, arms out of other parts of the body and the ground, and legs out of each other: how far
//! each wrist and ankle moves, smooth over time, and the turns of the limb's bones that follow in closed form. The trunk and feet that
//! stand stay as `knees` and `trunk` leave them.

use gaitway_character::anim::{Clip, JointIndex};
use glam::{DQuat, DVec3};

use super::bodies::Bodies;
use super::body::{Frames, place_of};
use super::ground::{Ground, Sunken};
use super::limb::{ARMS, LIMBS, Limb};
use super::scene::{Scene, SourceScene};
use super::smooth::eased;
use super::wish::Wish;
use super::{MAX_MOVE, MAX_TURN_DEGREES, MAX_TURN_DEGREES_PER_SEC, MIN_MOVE};
use crate::feet::ranges;
use crate::keys::channel::NewChannel;
use crate::limit::limit_turns;
use crate::math::{HORIZONTAL, smooth};
use crate::pose::WorldPose;
use crate::two_bones::limb_rotations;

/// Touching and pushing out in turns, since each disturbs the other, and then both at once.
const ROUNDS: usize = 2;
const COMPROMISES: usize = 2;

/// Weight of a point that is as deep inside as the body is high, against that of a contact.
const PUSH_WEIGHT: f64 = 10.0;

/// A point that is less deep than this share of the body's height stays.
const TOLERATED: f64 = 0.002;

/// A point that is deeper than that by this share is pushed out fully.
const CLEARLY_INSIDE: f64 = 0.003;

/// A foot stays where it is until the first of these times after it has stood, and is free from the second on; the same before it
/// stands. Other times are sampled when slide is measured: the first is more than a frame.
const LANDING_SECS: [f64; 2] = [0.05, 0.2];

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
    source: SourceScene,
    /// The clip without corrections.
    poses: Vec<WorldPose>,
    /// The parts of the target at each time, with the limbs moved so far.
    frames: Vec<Frames>,
    limbs: [Option<Limb>; LIMBS],
    /// How freely each ankle moves at each time: from 0, where the leg stands or kneels, to 1.
    freedom: [Vec<f64>; LIMBS - ARMS],
    /// `None` without feet.
    ground: Option<Ground>,
    /// How far each wrist has to move over the ground to stay in place while it rests there, at each time.
    holds: [Vec<DVec3>; ARMS],
    /// How far the end of each limb moves, at each time.
    moves: [Vec<DVec3>; LIMBS],
}

type Wishes = [Wish; LIMBS];

/// Returns all channels of the clip with its hands where they touch and its limbs out of the body, or `None` if there is nothing to do.
/// `resampled` lists the joints whose keys in `clip` are not the source's own.
pub fn kept_limbs(scene: Scene, clip: &Clip, resampled: &[JointIndex]) -> Option<Vec<NewChannel>> {
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
    for (index, limb) in solver.limbs.iter().enumerate() {
        let turns = solver.turns(index);
        let Some(limb) = limb.filter(|_| turns.iter().flatten().any(|&turn| turn != DQuat::IDENTITY)) else { continue };
        let turns = turns.each_ref().map(Vec::as_slice);
        rotations.extend(limb_rotations(skeleton, limb.joints(), &solver.poses, turns));
    }
    (!rotations.is_empty()).then(|| NewChannel::corrected(clip, resampled, &solver.source.times, None, rotations))
}

impl<'a> Solver<'a> {
    fn new(scene: Scene<'a>) -> Self {
        let Scene { transfer, bodies, source, poses, target, ground } = scene;
        let times = &source.times;
        let limbs = Limb::mapped(transfer, bodies);
        let freedom = [0, 1].map(|side| match &ground {
            Some(ground) => freedom(times, &ground.standing(bodies, side)),
            None => vec![0.0; times.len()],
        });
        let moves = std::array::from_fn(|_| vec![DVec3::ZERO; times.len()]);
        let mut holds = [(); ARMS].map(|()| vec![DVec3::ZERO; times.len()]);
        for (part, touching) in bodies.ground_parts.iter().zip(ground.iter().flat_map(|ground| &ground.touching)) {
            let Some(arm) = bodies.regions[part.part].arm().filter(|&arm| limbs[arm].is_some()) else { continue };
            // How far the wrist is from where the source's is: constant if it goes over the ground like that.
            let offset = |at: usize| {
                let (turn, scale) = source.target_from_source(at);
                let wrist = bodies.target.joints[part.part];
                let wrist = source.removed.restored(transfer, &poses[at], wrist, at, turn.conjugate());
                (wrist - scale * source.motion.frames[at][part.part].0) * HORIZONTAL
            };
            for contact in ranges(touching) {
                let offsets: Vec<DVec3> = contact.clone().map(offset).collect();
                let mean = offsets.iter().sum::<DVec3>() / offsets.len() as f64;
                for (at, offset) in contact.zip(offsets) {
                    holds[arm][at] = source.target_from_source(at).0 * (mean - offset);
                }
            }
        }
        Self { bodies, source, poses, frames: target.frames, limbs, freedom, ground, holds, moves }
    }

    /// What touches on the source should touch on the target.
    fn touch(&self, at: usize) -> Wishes {
        let frames = &self.frames[at];
        let mut wishes = [Wish::default(); LIMBS];
        for miss in self.bodies.misses(&self.source.touches[at], frames, self.source.target_from_source(at)) {
            let pair = &self.bodies.pairs[miss.pair];
            self.wish(&mut wishes, at, (pair.limb, 1.0), Some(pair.other), miss.by, [miss.weight; 2]);
        }
        for (part, by) in self.ground.iter().flat_map(|ground| ground.misses(self.bodies, at, frames)) {
            if let Some(arm) = self.bodies.regions[part].arm() {
                let over = (self.holds[arm][at] - self.moves[arm][at]) * HORIZONTAL;
                self.wish(&mut wishes, at, (part, 1.0), None, over + by * DVec3::Y, [1.0; 2]);
            }
        }
        wishes
    }

    /// What is inside other parts, and is not on the source, should come out.
    fn push_out(&self, at: usize) -> Wishes {
        let mut wishes = [Wish::default(); LIMBS];
        for Overlap { limb, other, point, excess, outward } in self.overlaps(at) {
            let share = (excess / (CLEARLY_INSIDE * self.bodies.target.height)).min(1.0);
            let lever = self.bodies.lever(limb, place_of(point).share);
            self.wish(&mut wishes, at, (limb, lever), other, excess * outward, [excess, share]);
        }
        wishes
    }

    /// Both at once, where they contradict each other.
    fn compromise(&self, at: usize) -> Wishes {
        let (mut wishes, pushes) = (self.touch(at), self.push_out(at));
        let weight = PUSH_WEIGHT / self.bodies.target.height;
        for (wish, push) in wishes.iter_mut().zip(pushes) {
            wish.join(push, weight);
        }
        wishes
    }

    fn overlaps(&self, at: usize) -> Vec<Overlap> {
        let target = &self.bodies.target;
        let frames = &self.frames[at];
        let touches = &self.source.touches[at];
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
            let of_source = self.source.scale * touches.depth(meeting.pair, meeting.point);
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

    /// Adds a wish of a part, which moves with the end of its limb by `lever`, relative to another part or the ground. Two arms or two
    /// legs share it; arms give way to legs.
    fn wish(
        &self,
        wishes: &mut Wishes,
        at: usize,
        (part, lever): (usize, f64),
        other: Option<usize>,
        by: DVec3,
        [weight, share]: [f64; 2],
    ) {
        let is_of_leg = self.bodies.regions[part].is_leg();
        // Feet stay as high as they are.
        let by = if is_of_leg { by * HORIZONTAL } else { by };
        let movable = |part: usize, lever: f64| {
            let region = self.bodies.regions[part];
            let limb = region.limb().filter(|&limb| self.limbs[limb].is_some() && region.is_leg() == is_of_leg)?;
            Some((limb, lever, self.freedom(limb, at)))
        };
        let partner = other.and_then(|part| movable(part, self.bodies.lever(part, 0.5)));
        let limbs = [movable(part, lever), partner];
        let total: f64 = limbs.iter().flatten().map(|(.., freedom)| freedom).sum();
        for (moved, by) in limbs.into_iter().zip([by, -by]) {
            if let Some((limb, lever, freedom)) = moved.filter(|_| total > 0.0) {
                wishes[limb].add(freedom / total * by, lever, weight, share);
            }
        }
    }

    fn freedom(&self, limb: usize, at: usize) -> f64 {
        limb.checked_sub(ARMS).map_or(1.0, |leg| self.freedom[leg][at])
    }

    /// Moves the ends of the limbs further, smoothly over time.
    fn add(&mut self, wishes: fn(&Self, usize) -> Wishes) {
        let wishes: Vec<Wishes> = (0..self.frames.len()).map(|at| wishes(self, at)).collect();
        let limit = MAX_MOVE * self.bodies.target.height;
        for limb in 0..LIMBS {
            let wanted: Vec<(DVec3, f64)> = wishes.iter().map(|wishes| wishes[limb].fit()).collect();
            for (at, more) in eased(&self.source.times, &wanted).into_iter().enumerate() {
                let freedom = self.freedom(limb, at);
                let by = &mut self.moves[limb][at];
                *by = (*by + freedom * more).clamp_length_max(limit);
            }
        }
        for at in 0..self.frames.len() {
            let turns = std::array::from_fn(|limb| self.reach(limb, at));
            self.frames[at] = self.turned_frames(at, turns);
        }
    }

    fn reach(&self, limb: usize, at: usize) -> [DQuat; 2] {
        let by = self.moves[limb][at];
        let is_moved = by.length() > MIN_MOVE * self.bodies.target.height;
        let limb = self.limbs[limb].filter(|_| is_moved);
        limb.map_or([DQuat::IDENTITY; 2], |limb| limb.reach(&self.poses[at], by))
    }

    /// The target's parts with its limbs turned.
    fn turned_frames(&self, at: usize, turns: [[DQuat; 2]; LIMBS]) -> Frames {
        let target = &self.bodies.target;
        let pose = &self.poses[at];
        let mut frames = target.frames(pose);
        for (limb, [upper, lower]) in self.limbs.iter().zip(turns) {
            let Some(joints) = limb.as_ref().map(Limb::joints) else { continue };
            let [root, middle, end] = joints.map(|joint| pose.position(joint));
            let moved_middle = root + upper * (middle - root);
            let moved_end = moved_middle + lower * (end - middle);
            let moved = [(root, upper), (moved_middle, lower), (moved_end, DQuat::IDENTITY)];
            for (joint, (position, turn)) in joints.iter().zip(moved) {
                if let Some(part) = target.joints.iter().position(|other| other == joint) {
                    frames[part] = (position, turn * frames[part].1);
                }
            }
        }
        frames
    }

    /// How a limb turns at each time.
    fn turns(&self, limb: usize) -> [Vec<DQuat>; 2] {
        let [max_turn, max_rate] = [MAX_TURN_DEGREES, MAX_TURN_DEGREES_PER_SEC].map(f64::to_radians);
        let mut turns = [Vec::new(), Vec::new()];
        for at in 0..self.frames.len() {
            let [upper, lower] = self.reach(limb, at);
            turns[0].push(upper);
            turns[1].push(lower);
        }
        for turns in &mut turns {
            limit_turns(&self.source.times, turns, max_turn, max_rate);
        }
        turns
    }
}

/// How freely an ankle moves at each time, given where its leg stands.
fn freedom(times: &[f32], standing: &[bool]) -> Vec<f64> {
    let [near, far] = LANDING_SECS;
    let mut freedom = vec![1.0_f64; times.len()];
    for contact in ranges(standing) {
        let [from, to] = [times[contact.start], times[contact.end - 1]];
        for (freedom, &time) in freedom.iter_mut().zip(times) {
            let away = f64::from((from - time).max(time - to).max(0.0));
            *freedom = freedom.min(smooth((away - near) / (far - near)));
        }
    }
    freedom
}
