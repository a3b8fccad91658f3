//! Spring bones at a time of a clip, simulated in fixed steps from the clip's start, so that the pose at a time doesn't
//! depend on how playback got there. Checkpoints along the way make seeking cheap.

use glam::{Affine3A, Quat};

use super::Springs;
use super::spring::Tail;
use crate::anim::{Pose, Skeleton, TimeRange};

/// Steps per second. Drag acts per step, and spring bones are usually tuned for this rate.
const RATE: f64 = 60.0;

/// Steps for the tails to settle in the first pose.
const SETTLE_STEPS: u32 = 60;

/// Maximum number of warm-up steps before a section: from the end of a loop, or from the section before.
const MAX_WARM_UP_STEPS: u32 = 120;

/// Steps in a section. Sections are simulated independently, which bounds the cost of seeking.
const SECTION_STEPS: u32 = 600;

/// Steps between checkpoints.
const CHECKPOINT_STEPS: u32 = 30;

/// The motion that spring bones follow.
pub trait SpringMotion {
    /// Writes the pose at a time of the clip, and every joint's transform in world space.
    fn pose_at(&mut self, time_secs: f64, pose: &mut Pose, world: &mut Vec<Affine3A>);
}

/// The simulation of one model in one clip. Allocates only when it restarts.
#[derive(Debug, Default)]
pub struct SpringCache {
    range: TimeRange,
    /// Whether the clip loops. The tails then start where the end of the loop leaves them.
    repeats: bool,
    /// The section that was simulated last.
    section: Option<u32>,
    /// Steps from the range's start to the state in `tails`.
    step: u32,
    tails: Vec<Tail>,
    /// Local rotations of the spring joints at `step`.
    rotations: Vec<Quat>,
    /// Local rotations of the spring joints one step earlier.
    previous_rotations: Vec<Quat>,
    /// The tails of all joints at every checkpoint of the section, which starts with one.
    checkpoint_tails: Vec<Tail>,
    /// The rotations of all joints at every checkpoint.
    checkpoint_rotations: Vec<Quat>,
    pose: Pose,
    world: Vec<Affine3A>,
    end_world: Vec<Affine3A>,
}

impl SpringCache {
    /// Discards the simulation because the model, the clip, its range or the pose has changed.
    pub fn restart(&mut self, springs: &Springs, range: TimeRange, repeats: bool) {
        let count = springs.joints().len();
        (self.range, self.repeats, self.section) = (range, repeats, None);
        self.tails.clear();
        self.tails.resize(count, Tail::default());
        for rotations in [&mut self.rotations, &mut self.previous_rotations] {
            rotations.clear();
            rotations.resize(count, Quat::IDENTITY);
        }
        let capacity = (self.step_count().min(SECTION_STEPS) / CHECKPOINT_STEPS + 1) as usize * count;
        self.clear_checkpoints();
        self.checkpoint_tails.reserve(capacity);
        self.checkpoint_rotations.reserve(capacity);
    }

    /// Rotates the spring joints in `pose` as simulated at a time in the range. `motion` supplies the poses of the clip
    /// for the model that `skeleton` and `springs` belong to.
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
        let target = (steps.ceil() as u32).min(self.step_count());
        let factor = 1.0 - (f64::from(target) - steps).clamp(0.0, 1.0) as f32;
        self.seek(target, skeleton, springs, motion);
        for (index, spring) in springs.joints().iter().enumerate() {
            let (from, to) = (self.previous_rotations[index], self.rotations[index]);
            pose.set_rotation(spring.joint, from.lerp(to, factor));
        }
    }

    /// Returns the number of steps in the range.
    fn step_count(&self) -> u32 {
        (self.range.length_secs() * RATE).ceil() as u32
    }

    /// Simulates up to the target step and the one before it, between which the pose is interpolated.
    fn seek(&mut self, target: u32, skeleton: &Skeleton, springs: &Springs, motion: &mut dyn SpringMotion) {
        let previous = target.saturating_sub(1);
        let section = previous / SECTION_STEPS;
        let first = section * SECTION_STEPS;
        if self.section != Some(section) {
            self.begin_section(section, skeleton, springs, motion);
        }
        let count = springs.joints().len();
        let last_checkpoint = (self.checkpoint_tails.len() / count - 1) as u32;
        let checkpoint = ((previous - first) / CHECKPOINT_STEPS).min(last_checkpoint);
        let checkpoint_step = first + checkpoint * CHECKPOINT_STEPS;
        if self.step > target || self.step < checkpoint_step {
            let start = checkpoint as usize * count;
            self.tails.copy_from_slice(&self.checkpoint_tails[start..start + count]);
            self.rotations.copy_from_slice(&self.checkpoint_rotations[start..start + count]);
            self.step = checkpoint_step;
        }
        while self.step < target {
            self.step += 1;
            let time_secs = self.range.start_secs + f64::from(self.step) / RATE;
            self.advance(time_secs.min(self.range.end_secs), skeleton, springs, motion);
            let next_checkpoint = (self.checkpoint_tails.len() / count) as u32;
            if self.step == first + next_checkpoint * CHECKPOINT_STEPS {
                self.add_checkpoint();
            }
        }
    }

    fn add_checkpoint(&mut self) {
        self.checkpoint_tails.extend_from_slice(&self.tails);
        self.checkpoint_rotations.extend_from_slice(&self.rotations);
    }

    fn clear_checkpoints(&mut self) {
        self.checkpoint_tails.clear();
        self.checkpoint_rotations.clear();
    }

    /// Simulates the state at the start of a section. In a loop, the first section continues from the end of the clip;
    /// the tails jump back to the start together with the model, so that the jump doesn't whip them.
    fn begin_section(&mut self, section: u32, skeleton: &Skeleton, springs: &Springs, motion: &mut dyn SpringMotion) {
        let TimeRange { start_secs, end_secs } = self.range;
        let first = section * SECTION_STEPS;
        let (warm_up, warm_up_end_secs) = match section {
            0 if self.repeats => (self.step_count().min(MAX_WARM_UP_STEPS), end_secs),
            0 => (0, start_secs),
            _ => (MAX_WARM_UP_STEPS, start_secs + f64::from(first) / RATE),
        };
        let time_before_end = |steps: u32| (warm_up_end_secs - f64::from(steps) / RATE).max(start_secs);
        motion.pose_at(time_before_end(warm_up), &mut self.pose, &mut self.world);
        springs.reset(&self.world, &mut self.tails);
        for _ in 0..SETTLE_STEPS {
            self.advance(time_before_end(warm_up), skeleton, springs, motion);
        }
        for step in (0..warm_up).rev() {
            self.advance(time_before_end(step), skeleton, springs, motion);
        }
        if section == 0 && warm_up > 0 {
            motion.pose_at(end_secs, &mut self.pose, &mut self.end_world);
            motion.pose_at(start_secs, &mut self.pose, &mut self.world);
            springs.teleport(&self.end_world, &self.world, &mut self.tails);
        }
        (self.section, self.step) = (Some(section), first);
        self.clear_checkpoints();
        self.add_checkpoint();
    }

    fn advance(&mut self, time_secs: f64, skeleton: &Skeleton, springs: &Springs, motion: &mut dyn SpringMotion) {
        motion.pose_at(time_secs, &mut self.pose, &mut self.world);
        self.previous_rotations.copy_from_slice(&self.rotations);
        springs.step(skeleton, (1.0 / RATE) as f32, &self.pose, &mut self.world, &mut self.tails, &mut self.rotations);
    }
}
