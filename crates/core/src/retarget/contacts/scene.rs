//! A clip of the target and its source at the same times: what corrections of contacts look at.

use glam::DQuat;

use super::body::{Bodies, BodyMotion};
use super::ground::Ground;
use super::touch::Touches;
use crate::anim::Clip;
use crate::retarget::pose::{Scratch, WorldPose};
use crate::retarget::times::dense_times;
use crate::retarget::transfer::{RemovedTravel, Transfer, removed_travel, rotation_laws};

/// Source and target over time.
pub struct Scene<'a> {
    pub transfer: &'a Transfer<'a>,
    pub bodies: &'a Bodies,
    pub times: Vec<f32>,
    pub source: BodyMotion,
    /// What the source touches.
    pub touches: Vec<Touches>,
    /// What the options take away from the source's path.
    pub removed: RemovedTravel,
    pub poses: Vec<WorldPose>,
    pub target: BodyMotion,
    /// `None` without feet.
    pub ground: Option<Ground>,
}

impl<'a> Scene<'a> {
    pub fn new(transfer: &'a Transfer<'a>, bodies: &'a Bodies, clip: &Clip) -> Self {
        let times = dense_times(transfer.tracks.clip);
        let source = bodies.source_motion(transfer, &times);
        let touches = bodies.touches(&times, &source.frames);
        let removed = removed_travel(transfer, &rotation_laws(transfer).0, &times);
        let (poses, target) = (Vec::new(), BodyMotion::default());
        Self { transfer, bodies, times, source, touches, removed, poses, target, ground: None }.playing(clip)
    }

    /// Turn and scale at one of the times.
    pub fn target_from_source(&self, at: usize) -> (DQuat, f64) {
        (self.removed.turn(self.times[at]), self.transfer.scale())
    }

    /// The same with another clip of the target.
    pub fn playing(mut self, clip: &Clip) -> Self {
        let mut scratch = Scratch::default();
        let pose = |&time: &f32| self.transfer.target_pose(clip, time, &mut scratch);
        self.poses = self.times.iter().map(pose).collect();
        self.target = BodyMotion::default();
        self.poses.iter().for_each(|pose| self.target.push(&self.bodies.target, pose));
        let motions = [&self.source, &self.target];
        self.ground = Ground::new(self.transfer, self.bodies, &self.times, motions, self.transfer.scale());
        self
    }
}
