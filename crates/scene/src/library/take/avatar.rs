//! What an avatar adds to the pose of a clip: gaze, expressions, node constraints and spring bones, in this order.
//!
//! Gaze needs the camera, so it is resolved after the motion is sampled. Expressions become morph weights and properties: later
//! stages don't handle expressions.

use gaitway_character::anim::{LoopMode, Pose, PropertyTarget, PropertyValues, SampleCursor, model_from_joint};
use gaitway_character::avatar::{LookAt, SpringCache, SpringMotion, apply_expressions, resolve_weights};
use glam::{Affine3A, Vec3};
use serde::{Deserialize, Serialize};

use super::Take;
use super::fingerprint::Fingerprint;
use super::layers::LayerSampler;

/// The target of an avatar's gaze.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LookTarget {
    /// As the clip animates it.
    #[default]
    Off,
    /// The camera.
    Camera,
    /// A point in world space.
    Point(Vec3),
}

/// Buffers of [`AvatarPose::apply`], reused between frames.
#[derive(Debug, Default)]
pub(super) struct AvatarPose {
    /// Requested weights, one per expression: the clip's, or those set manually.
    pub weights: Vec<f32>,
    /// The same after gaze and overrides.
    resolved_weights: Vec<f32>,
    springs: SpringCache,
    /// What the springs were simulated for.
    simulated: Option<Fingerprint>,
    cursor: SampleCursor,
    layers: LayerSampler,
}

impl AvatarPose {
    /// Applies the avatar to the pose that the take has after `elapsed_secs`. `eye` is the camera's position in world space, if
    /// known.
    pub fn apply(
        &mut self,
        take: &Take<'_>,
        elapsed_secs: f64,
        eye: Option<Vec3>,
        pose: &mut Pose,
        properties: &mut PropertyValues,
    ) {
        let (skeleton, avatar) = (&take.model.asset.skeleton, &take.model.asset.avatar);
        self.request_weights(take, properties);
        self.resolved_weights.clone_from(&self.weights);
        if let Some(look_at) = &avatar.look_at
            && let Some(direction) = gaze_direction(look_at, take, eye, pose, properties)
        {
            look_at.apply(direction, skeleton, pose, &mut self.resolved_weights);
        }
        resolve_weights(&avatar.expressions, &mut self.resolved_weights);
        apply_expressions(&avatar.expressions, &self.resolved_weights, pose, properties);
        for constraint in &avatar.constraints {
            constraint.apply(skeleton, pose);
        }
        if take.springs && !avatar.springs.joints().is_empty() {
            self.apply_springs(take, elapsed_secs, pose);
        }
    }

    /// Takes the clip's weights, or those set manually.
    fn request_weights(&mut self, take: &Take<'_>, properties: &PropertyValues) {
        self.weights.clear();
        self.weights.resize(take.model.asset.avatar.expressions.len(), 0.0);
        for (target, value) in properties.iter() {
            if let PropertyTarget::Expression(index) = target
                && let Some(weight) = self.weights.get_mut(index)
            {
                *weight = value.x.clamp(0.0, 1.0);
            }
        }
        for (index, weight) in take.held.expressions(take.model) {
            self.weights[index] = weight;
        }
    }

    fn apply_springs(&mut self, take: &Take<'_>, elapsed_secs: f64, pose: &mut Pose) {
        let (skeleton, springs) = (&take.model.asset.skeleton, &take.model.asset.avatar.springs);
        // Morph weights and expressions move no joints.
        let moving = Take { held: take.held.joints(), ..*take };
        if !self.simulated.as_ref().is_some_and(|simulated| simulated.matches(&moving)) {
            self.springs.restart(springs, take.range, take.loop_mode == LoopMode::Loop);
            self.simulated = Some(Fingerprint::of(&moving));
        }
        let (cursor, layers) = (&mut self.cursor, &mut self.layers);
        let mut motion = SteadyMotion { take, cursor, layers };
        self.springs.apply(skeleton, springs, take.clip_secs(elapsed_secs), &mut motion, pose);
    }
}

/// Returns the yaw and pitch of the eyes, see [`LookAt::direction`]; `None` leaves them as the clip poses them.
fn gaze_direction(
    look_at: &LookAt,
    take: &Take<'_>,
    eye: Option<Vec3>,
    pose: &Pose,
    properties: &PropertyValues,
) -> Option<[f32; 2]> {
    let model_from_world = take.world_from_model.inverse();
    let skeleton = &take.model.asset.skeleton;
    let towards = |point| look_at.direction(model_from_world.transform_point3(point), skeleton, pose);
    match take.look_at {
        LookTarget::Off => properties.get(PropertyTarget::LookAt).map(|angles| [angles.x, angles.y]),
        LookTarget::Camera => eye.and_then(towards),
        LookTarget::Point(point) => towards(point),
    }
}

/// The take without a crossfade and without gazes at the camera: it depends on the time in the clip alone.
struct SteadyMotion<'a> {
    take: &'a Take<'a>,
    cursor: &'a mut SampleCursor,
    layers: &'a mut LayerSampler,
}

impl SpringMotion for SteadyMotion<'_> {
    /// Samples the layers below and over the clip as in its first loop.
    fn pose_at(&mut self, time_secs: f64, pose: &mut Pose, world: &mut Vec<Affine3A>) {
        let take = self.take;
        take.sample_clip(time_secs, time_secs, self.cursor, pose);
        self.layers.apply(take, time_secs, pose);
        take.held.pose_joints(take.model, pose);
        if !take.pins.is_empty() {
            take.pinning(None).apply(time_secs, pose);
        }
        let skeleton = &take.model.asset.skeleton;
        for constraint in &take.model.asset.avatar.constraints {
            constraint.apply(skeleton, pose);
        }
        model_from_joint(skeleton, pose, take.world_from_model, world);
    }
}
