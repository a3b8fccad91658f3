//! Spring bones at a time of a clip: simulated in fixed steps from the clip's start, so that every way to a time gives
//! the same pose. States along the way are kept, which makes going back cheap.

use glam::{Affine3A, Quat};

use super::Springs;
use super::spring::Tail;
use crate::anim::{Pose, Skeleton, TimeRange};

/// Steps a second: what spring bones are usually tuned for, since their drag counts per step.
const RATE: f64 = 60.0;

/// Steps in which the tails come to rest in the first pose.
const SETTLE_STEPS: u32 = 60;

/// Steps before the start of a loop, from its end, and before the start of a later section.
const MAX_LEAD_STEPS: u32 = 120;

/// Steps in a section. Each is simulated on its own, so that no jump takes longer than one of them.
const SECTION_STEPS: u32 = 600;

/// Steps between kept states.
const INTERVAL: u32 = 30;

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
    /// The section that was simulated last.
    section: Option<u32>,
    /// Steps from the range's start to the state in `tails`.
    step: u32,
    tails: Vec<Tail>,
    /// Local rotations of the spring joints at `step` and one step before.
    rotations: Vec<Quat>,
    rotations_before: Vec<Quat>,
    /// The tails of all joints and their rotations, after every [`INTERVAL`] steps from the section's start.
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
        (self.range, self.repeats, self.section) = (range, repeats, None);
        self.tails.clear();
        self.tails.resize(count, Tail::default());
        for rotations in [&mut self.rotations, &mut self.rotations_before] {
            rotations.clear();
            rotations.resize(count, Quat::IDENTITY);
        }
        let kept = (self.steps().min(SECTION_STEPS) / INTERVAL + 1) as usize * count;
        self.kept_tails.clear();
        self.kept_tails.reserve(kept);
        self.kept_rotations.clear();
        self.kept_rotations.reserve(kept);
    }

    /// Turns the spring joints in `pose` as they are at a time in the range. `skeleton` and `springs` are those of the
    /// model, whose pose in the clip `motion` gives.
    pub fn apply(
        &mut self,
        skeleton: &Skeleton,
        springs: &Springs,
        time_secs: f64,
        motion: &mut dyn SpringMotion,
        pose: &mut Pose,
    ) {
        if springs.joints().is_empty() {
            return;
        }
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
        // The step before the wanted one is in the same section: the image shows rotations between the two.
        let section = to.saturating_sub(1) / SECTION_STEPS;
        let first = section * SECTION_STEPS;
        if self.section != Some(section) {
            self.begin(section, skeleton, springs, motion);
            (self.section, self.step) = (Some(section), first);
            self.kept_tails.clear();
            self.kept_rotations.clear();
            self.keep();
        }
        let last_kept = self.kept_tails.len() / count - 1;
        let nearest = ((to.saturating_sub(1) - first) / INTERVAL).min(last_kept as u32);
        if self.step > to || self.step < first + nearest * INTERVAL {
            let at = nearest as usize * count;
            self.tails.copy_from_slice(&self.kept_tails[at..at + count]);
            self.rotations.copy_from_slice(&self.kept_rotations[at..at + count]);
            self.step = first + nearest * INTERVAL;
        }
        while self.step < to {
            self.step += 1;
            let time_secs = self.range.start_secs + f64::from(self.step) / RATE;
            self.advance(time_secs.min(self.range.end_secs), skeleton, springs, motion);
            let kept = self.kept_tails.len() / count;
            if self.step == first + kept as u32 * INTERVAL {
                self.keep();
            }
        }
    }

    fn keep(&mut self) {
        self.kept_tails.extend_from_slice(&self.tails);
        self.kept_rotations.extend_from_slice(&self.rotations);
    }

    /// The state at the start of a section. In a loop, the tails arrive at the first one from the end, carried along to
    /// where the model starts again, so that a walk doesn't whip them when it jumps back.
    fn begin(&mut self, section: u32, skeleton: &Skeleton, springs: &Springs, motion: &mut dyn SpringMotion) {
        let TimeRange { start_secs, end_secs } = self.range;
        let (lead, lead_end_secs) = match section {
            0 if self.repeats => (self.steps().min(MAX_LEAD_STEPS), end_secs),
            0 => (0, start_secs),
            _ => (MAX_LEAD_STEPS, start_secs + f64::from(section * SECTION_STEPS) / RATE),
        };
        let before = |steps: u32| (lead_end_secs - f64::from(steps) / RATE).max(start_secs);
        motion.pose_at(before(lead), &mut self.pose, &mut self.world);
        springs.reset(&self.world, &mut self.tails);
        for _ in 0..SETTLE_STEPS {
            self.advance(before(lead), skeleton, springs, motion);
        }
        for step in (0..lead).rev() {
            self.advance(before(step), skeleton, springs, motion);
        }
        if section == 0 && lead > 0 {
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
