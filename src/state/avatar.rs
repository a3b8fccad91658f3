//! What an avatar adds to the pose of a clip: gaze, expressions, node constraints and spring bones, in this order.
//!
//! Gaze needs the camera, so `frame::evaluate` resolves it after the clip is sampled. Expressions become morph weights and
//! properties: later stages don't handle expressions.

use std::collections::BTreeMap;

use glam::{Affine3A, Vec3};
use serde::{Deserialize, Serialize};

use super::clip_names::look_up_clip;
use super::manual::pose_joints;
use super::pins::apply_pins;
use super::playhead::{active_clip, clip_secs, play_range, sample_pose, world_from_model};
use super::{Edits, LayerSampler, UpAxis, ViewerState};
use crate::anim::{
    Clip, LoopMode, Pose, PropertyTarget, PropertyValues, SampleCursor, Skeleton, TimeRange, model_from_joint,
};
use crate::avatar::{Avatar, LookAt, SpringCache, SpringMotion, apply_expressions, resolve_weights};
use crate::library::{Model, ModelClip, ModelId};
use crate::retarget::{ClipLayer, Pin};

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
    springs_key: Option<SpringsKey>,
    cursor: SampleCursor,
    layers: LayerSampler,
}

/// Everything that a simulation of the springs depends on.
#[derive(Debug)]
struct SpringsKey {
    model: ModelId,
    clip: Option<Clip>,
    range: TimeRange,
    repeats: bool,
    up: UpAxis,
    joints: BTreeMap<usize, [f32; 3]>,
    layers: Vec<(ClipLayer, Option<Clip>)>,
    pins: BTreeMap<usize, Pin>,
}

impl AvatarPose {
    /// Applies the avatar of `model` to the pose of its clip. `eye` is the camera's position in world space, if known.
    pub fn apply(
        &mut self,
        model: &Model,
        state: &ViewerState,
        eye: Option<Vec3>,
        pose: &mut Pose,
        properties: &mut PropertyValues,
    ) {
        let (skeleton, avatar) = (&model.asset.skeleton, &model.asset.avatar);
        self.request_weights(avatar, state, properties);
        self.resolved_weights.clone_from(&self.weights);
        if let Some(look_at) = &avatar.look_at
            && let Some(direction) = gaze_direction(look_at, skeleton, state, eye, pose, properties)
        {
            look_at.apply(direction, skeleton, pose, &mut self.resolved_weights);
        }
        resolve_weights(&avatar.expressions, &mut self.resolved_weights);
        apply_expressions(&avatar.expressions, &self.resolved_weights, pose, properties);
        for constraint in &avatar.constraints {
            constraint.apply(skeleton, pose);
        }
        if state.display.springs && !avatar.springs.joints().is_empty() {
            self.apply_springs(model, state, pose);
        }
    }

    /// Takes the clip's weights, or those set manually.
    fn request_weights(&mut self, avatar: &Avatar, state: &ViewerState, properties: &PropertyValues) {
        self.weights.clear();
        self.weights.resize(avatar.expressions.len(), 0.0);
        for (target, value) in properties.iter() {
            if let PropertyTarget::Expression(index) = target
                && let Some(weight) = self.weights.get_mut(index)
            {
                *weight = value.x.clamp(0.0, 1.0);
            }
        }
        for (name, &weight) in &state.edits.expressions {
            if let Some(index) = avatar.expression(name) {
                self.weights[index] = weight;
            }
        }
    }

    fn apply_springs(&mut self, model: &Model, state: &ViewerState, pose: &mut Pose) {
        let (skeleton, springs) = (&model.asset.skeleton, &model.asset.avatar.springs);
        let clip = active_clip(model, state);
        let range = clip.map_or(TimeRange::default(), |clip| play_range(clip, state));
        let repeats = state.playback.loop_mode == LoopMode::Loop;
        if !self.springs_key.as_ref().is_some_and(|key| key.matches(model, state, clip, range, repeats)) {
            self.springs.restart(springs, range, repeats);
            self.springs_key = Some(SpringsKey::new(model, state, clip, range, repeats));
        }
        let time_secs = clip.map_or(0.0, |clip| clip_secs(clip, state));
        let (cursor, layers) = (&mut self.cursor, &mut self.layers);
        let mut motion = ClipMotion { model, state, clip, cursor, layers };
        self.springs.apply(skeleton, springs, time_secs, &mut motion, pose);
    }
}

/// Returns the yaw and pitch of the eyes, see [`LookAt::direction`]; `None` leaves them as the clip poses them.
fn gaze_direction(
    look_at: &LookAt,
    skeleton: &Skeleton,
    state: &ViewerState,
    eye: Option<Vec3>,
    pose: &Pose,
    properties: &PropertyValues,
) -> Option<[f32; 2]> {
    let model_from_world = world_from_model(state.edits.up).inverse();
    let towards = |point| look_at.direction(model_from_world.transform_point3(point), skeleton, pose);
    match state.display.look_at {
        LookTarget::Off => properties.get(PropertyTarget::LookAt).map(|angles| [angles.x, angles.y]),
        LookTarget::Camera => eye.and_then(towards),
        LookTarget::Point(point) => towards(point),
    }
}

impl SpringsKey {
    fn new(model: &Model, state: &ViewerState, clip: Option<&ModelClip>, range: TimeRange, repeats: bool) -> Self {
        let Edits { pose, pins, up, layers, .. } = &state.edits;
        let keys = |clip: &ModelClip| clip.clip().clone();
        let layers = layers.iter().map(|over| (over.layer.clone(), look_up_clip(model, &over.clip).map(keys)));
        Self {
            model: model.id,
            clip: clip.map(keys),
            range,
            repeats,
            up: *up,
            joints: pose.clone(),
            layers: layers.collect(),
            pins: pins.clone(),
        }
    }

    /// Whether [`Self::new`] would return the same, without allocating.
    fn matches(
        &self,
        model: &Model,
        state: &ViewerState,
        clip: Option<&ModelClip>,
        range: TimeRange,
        repeats: bool,
    ) -> bool {
        let is_same =
            |known: &Option<Clip>, clip: Option<&ModelClip>| Clip::are_same(known.as_ref(), clip.map(ModelClip::clip));
        let Edits { pose, pins, up, layers, .. } = &state.edits;
        (self.model, self.range, self.repeats, self.up) == (model.id, range, repeats, *up)
            && is_same(&self.clip, clip)
            && self.joints == *pose
            && self.layers.len() == layers.len()
            && self
                .layers
                .iter()
                .zip(layers)
                .all(|((layer, clip), over)| *layer == over.layer && is_same(clip, look_up_clip(model, &over.clip)))
            && self.pins == *pins
    }
}

/// The active clip with layers, manually posed and pinned joints and constraints, without a crossfade and gazes at the camera.
struct ClipMotion<'a> {
    model: &'a Model,
    state: &'a ViewerState,
    clip: Option<&'a ModelClip>,
    cursor: &'a mut SampleCursor,
    layers: &'a mut LayerSampler,
}

impl SpringMotion for ClipMotion<'_> {
    /// Samples the layers below and over the clip as in its first loop.
    fn pose_at(&mut self, time_secs: f64, pose: &mut Pose, world: &mut Vec<Affine3A>) {
        let skeleton = &self.model.asset.skeleton;
        sample_pose(self.model, self.clip, time_secs, time_secs, self.cursor, pose);
        self.layers.apply(self.model, self.state, time_secs, pose);
        pose_joints(self.model, self.state, pose);
        apply_pins(self.model, self.state, None, Some(time_secs), pose);
        for constraint in &self.model.asset.avatar.constraints {
            constraint.apply(skeleton, pose);
        }
        model_from_joint(skeleton, pose, world_from_model(self.state.edits.up), world);
    }
}
