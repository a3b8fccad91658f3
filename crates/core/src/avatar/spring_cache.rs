//! Spring bones at a time of a clip: simulated in fixed steps from the clip's start, so that every way to a time gives the same
//! pose. States along the way are kept, which makes going back cheap.

use glam::{Affine3A, Quat};

use super::Springs;
use super::spring::Tail;
use crate::anim::{Pose, Skeleton, TimeRange};

/// Steps a second: what spring bones are usually tuned for, since their drag counts per step.
const RATE: f64 = 60.0;

/// Steps in which the tails come to rest in the first pose.
const SETTLE_STEPS: u32 = 60;

/// Steps before the start of a loop, from its end.
const MAX_LEAD_STEPS: u32 = 120;

/// At most this many steps lie between kept states, unless the clip is very long.
const MIN_INTERVAL: u32 = 30;
const MAX_KEPT: u32 = 512;

/// The motion that spring bones follow.
pub trait SpringMotion {
    /// Fills the pose at a time of the clip, and every joint's transform in world space.
    fn pose_at(&mut self, time_secs: f64, pose: &mut Pose, world: &mut Vec<Affine3A>);
}

/// The simulation of one model in one clip. Allocates only when it starts over.
#[derive(Debug, Default)]
pub struct SpringCache {
    range: TimeRange,
    /// Whether the clip repeats: then the tails at its start are those after its end.
    repeats: bool,
    /// Steps from the range's start to the state in `tails`; `None` before the first.
    step: Option<u32>,
    tails: Vec<Tail>,
    /// Local rotations of the spring joints at `step` and one step before.
    rotations: Vec<Quat>,
    rotations_before: Vec<Quat>,
    /// Steps between kept states.
    interval: u32,
    /// Each kept state: the tails of all joints and their rotations, after every `interval` steps from the start.
    kept_tails: Vec<Tail>,
    kept_rotations: Vec<Quat>,
    pose: Pose,
    world: Vec<Affine3A>,
    world_before: Vec<Affine3A>,
}

impl SpringCache {
    /// Starts over: another model, clip, range or pose.
    pub fn restart(&mut self, springs: &Springs, range: TimeRange, repeats: bool) {
        let count = springs.joints().len();
        self.range = range;
        self.repeats = repeats;
        self.step = None;
        self.tails.clear();
        self.tails.resize(count, Tail::default());
        for rotations in [&mut self.rotations, &mut self.rotations_before] {
            rotations.clear();
            rotations.resize(count, Quat::IDENTITY);
        }
        let steps = self.steps();
        self.interval = MIN_INTERVAL.max(steps / MAX_KEPT);
        let kept = (steps / self.interval + 2) as usize * count;
        self.kept_tails.clear();
        self.kept_tails.reserve(kept);
        self.kept_rotations.clear();
        self.kept_rotations.reserve(kept);
    }

    /// Turns the spring joints in `pose` as they are at a time in the range. `skeleton` and `springs` are those of the model,
    /// whose pose in the clip `motion` gives.
    pub fn apply(
        &mut self,
        skeleton: &Skeleton,
        springs: &Springs,
        time_secs: f64,
        motion: &mut dyn SpringMotion,
        pose: &mut Pose,
    ) {
        let steps = (time_secs - self.range.start_secs).max(0.0) * RATE;
        let to = (steps.ceil() as u32).min(self.steps());
        let factor = 1.0 - (f64::from(to) - steps).clamp(0.0, 1.0) as f32;
        self.seek(to, skeleton, springs, motion);
        for (index, spring) in springs.joints().iter().enumerate() {
            let (from, to) = (self.rotations_before[index], self.rotations[index]);
            pose.set_rotation(spring.joint, from.lerp(to, factor));
        }
    }

    /// Number of steps in the range.
    fn steps(&self) -> u32 {
        (self.range.length_secs() * RATE).ceil() as u32
    }

    fn seek(&mut self, to: u32, skeleton: &Skeleton, springs: &Springs, motion: &mut dyn SpringMotion) {
        let count = springs.joints().len();
        let kept = (self.kept_tails.len() / count.max(1)) as u32;
        if kept == 0 {
            self.begin(skeleton, springs, motion);
            self.keep();
            self.step = Some(0);
        }
        // The state before the wanted one is needed too, for the rotations between them.
        let last_kept = (to.saturating_sub(1) / self.interval).min(kept.max(1) - 1);
        let is_ahead = |step: u32| step > to || step + self.interval < last_kept * self.interval;
        if self.step.is_none_or(is_ahead) {
            let at = last_kept as usize * count;
            self.tails.copy_from_slice(&self.kept_tails[at..at + count]);
            self.rotations.copy_from_slice(&self.kept_rotations[at..at + count]);
            self.rotations_before.copy_from_slice(&self.rotations);
            self.step = Some(last_kept * self.interval);
        }
        while let Some(step) = self.step.filter(|&step| step < to) {
            let next = step + 1;
            let end_secs = self.range.end_secs;
            let time_secs = (self.range.start_secs + f64::from(next) / RATE).min(end_secs);
            self.advance(time_secs, skeleton, springs, motion);
            self.step = Some(next);
            if next.is_multiple_of(self.interval) && self.kept_tails.len() == (next / self.interval) as usize * count {
                self.keep();
            }
        }
    }

    fn keep(&mut self) {
        self.kept_tails.extend_from_slice(&self.tails);
        self.kept_rotations.extend_from_slice(&self.rotations);
    }

    /// The state at the start of the range. In a loop the tails arrive there from its end, carried along to where the model
    /// starts again, so that a walk that comes back to its start doesn't whip them.
    fn begin(&mut self, skeleton: &Skeleton, springs: &Springs, motion: &mut dyn SpringMotion) {
        let TimeRange { start_secs, end_secs } = self.range;
        let lead = if self.repeats { self.steps().min(MAX_LEAD_STEPS) } else { 0 };
        let lead_start = end_secs - f64::from(lead) / RATE;
        let first_secs = if lead > 0 { lead_start.max(start_secs) } else { start_secs };
        motion.pose_at(first_secs, &mut self.pose, &mut self.world);
        springs.reset(&self.world, &mut self.tails);
        for _ in 0..SETTLE_STEPS {
            self.advance(first_secs, skeleton, springs, motion);
        }
        for step in 1..=lead {
            let time_secs = (lead_start + f64::from(step) / RATE).max(start_secs);
            self.advance(time_secs, skeleton, springs, motion);
        }
        if lead > 0 {
            motion.pose_at(end_secs, &mut self.pose, &mut self.world_before);
            motion.pose_at(start_secs, &mut self.pose, &mut self.world);
            springs.carry(&self.world_before, &self.world, &mut self.tails);
        }
    }

    fn advance(&mut self, time_secs: f64, skeleton: &Skeleton, springs: &Springs, motion: &mut dyn SpringMotion) {
        motion.pose_at(time_secs, &mut self.pose, &mut self.world);
        self.rotations_before.copy_from_slice(&self.rotations);
        springs.step(skeleton, (1.0 / RATE) as f32, &self.pose, &mut self.world, &mut self.tails, &mut self.rotations);
    }
}
