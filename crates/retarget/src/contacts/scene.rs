//! A clip of the target and its source at the same times: what corrections and figures of contacts look at.

use gaitway_character::anim::Clip;
use glam::DQuat;

use super::bodies::Bodies;
use super::body::BodyMotion;
use super::ground::Ground;
use super::touch::Touches;
use crate::pose::{Scratch, WorldPose};
use crate::times::corrected_times;
use crate::transfer::{RemovedTravel, Transfer, removed_travel};

/// The source over time, and what it touches.
pub struct SourceScene {
    pub times: Vec<f32>,
    pub motion: BodyMotion,
    pub touches: Vec<Touches>,
    /// What the options take away from its path.
    pub removed: RemovedTravel,
    /// Of the target.
    pub scale: f64,
}

impl SourceScene {
    pub fn new(transfer: &Transfer, bodies: &Bodies, times: Vec<f32>) -> Self {
        let motion = bodies.source_motion(transfer, &times);
        let touches = bodies.touches(&times, &motion.frames);
        let removed = removed_travel(transfer, &times);
        Self { times, motion, touches, removed, scale: transfer.scale() }
    }

    /// Turn and scale at one of the times.
    pub fn target_from_source(&self, at: usize) -> (DQuat, f64) {
        (self.removed.turn(self.times[at]), self.scale)
    }

    /// Returns the ground that source and target stand on; `None` without feet.
    pub fn ground(&self, transfer: &Transfer, bodies: &Bodies, target: &BodyMotion) -> Option<Ground> {
        Ground::new(transfer, bodies, &self.times, [&self.motion, target], self.scale)
    }
}

/// Source and target over time.
pub struct Scene<'a> {
    pub transfer: &'a Transfer<'a>,
    pub bodies: &'a Bodies,
    pub source: SourceScene,
    pub poses: Vec<WorldPose>,
    pub target: BodyMotion,
    /// `None` without feet.
    pub ground: Option<Ground>,
}

impl<'a> Scene<'a> {
    /// Returns `None` if the clip is too long.
    pub fn new(transfer: &'a Transfer<'a>, bodies: &'a Bodies, clip: &Clip) -> Option<Self> {
        let times = corrected_times(transfer.tracks.clip, transfer.target_skeleton.len())?;
        let source = SourceScene::new(transfer, bodies, times);
        let (poses, target) = (Vec::new(), BodyMotion::default());
        Some(Self { transfer, bodies, source, poses, target, ground: None }.playing(clip))
    }

    /// The same with another clip of the target.
    pub fn playing(mut self, clip: &Clip) -> Self {
        let mut scratch = Scratch::default();
        let pose = |&time: &f32| self.transfer.target_pose(clip, time, &mut scratch);
        self.poses = self.source.times.iter().map(pose).collect();
        self.target = BodyMotion::default();
        self.poses.iter().for_each(|pose| self.target.push(&self.bodies.target, pose));
        self.ground = self.source.ground(self.transfer, self.bodies, &self.target);
        self
    }
}
