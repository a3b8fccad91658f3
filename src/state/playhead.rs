//! From a view state to a pose: the active clip, its time, and the sampled pose.

use glam::{Affine3A, Quat, Vec3};

use super::avatar::AvatarPose;
use super::clip_names::{look_up_clip, unknown_name};
use super::manual::pose_joints;
use super::pins::apply_pins;
use super::{ClipChoice, LayerSampler, UnknownName, UpAxis, ViewerState};
use crate::anim::{Pose, PropertyValues, SampleCursor, TimeRange, clip_time};
use crate::library::{Model, ModelClip};

/// Returns the active clip; `None` for the rest pose, a model without clips, or a clip that the model lacks.
pub fn active_clip<'a>(model: &'a Model, state: &ViewerState) -> Option<&'a ModelClip> {
    chosen_clip(model, &state.playhead.clip)
}

/// Returns the clip that the state names and the model lacks.
pub fn unknown_clip(model: &Model, state: &ViewerState) -> Option<UnknownName> {
    let ClipChoice::Clip(clip) = &state.playhead.clip else { return None };
    look_up_clip(model, clip).is_none().then(|| unknown_name(model, clip))
}

/// Returns the chosen clip.
pub(super) fn chosen_clip<'a>(model: &'a Model, choice: &ClipChoice) -> Option<&'a ModelClip> {
    match choice {
        ClipChoice::First => model.clips().first(),
        ClipChoice::RestPose => None,
        ClipChoice::Clip(clip) => look_up_clip(model, clip),
    }
}

/// Returns the length of the crossfade between two clips.
pub(super) fn crossfade_secs(from: Option<&ModelClip>, to: Option<&ModelClip>) -> f64 {
    [from, to].map(|clip| clip.map_or(0.0, ModelClip::crossfade_secs)).into_iter().fold(0.0, f64::max)
}

/// Returns the in and out points, clamped to the active clip.
pub fn play_range(clip: &ModelClip, state: &ViewerState) -> TimeRange {
    let duration_secs = clip.duration_secs();
    match state.playhead.range {
        Some(range) => TimeRange {
            start_secs: range.start_secs.clamp(0.0, duration_secs),
            end_secs: range.end_secs.clamp(0.0, duration_secs),
        },
        None => TimeRange { start_secs: 0.0, end_secs: duration_secs },
    }
}

/// Returns the time of the current pose in the active clip: the playhead, folded into the range by the loop mode.
pub fn clip_secs(clip: &ModelClip, state: &ViewerState) -> f64 {
    clip_time(state.playhead.time_secs, play_range(clip, state), state.playback.loop_mode)
}

/// A pose, with the buffers to sample the next one without allocating.
#[derive(Debug, Default)]
pub struct PoseSampler {
    /// The pose sampled last; empty before that.
    pub pose: Pose,
    /// What the clip animates besides joints, sampled together with the pose.
    pub properties: PropertyValues,
    cursor: SampleCursor,
    before: Pose,
    before_properties: PropertyValues,
    before_cursor: SampleCursor,
    layers: LayerSampler,
    avatar: AvatarPose,
}

impl PoseSampler {
    /// Samples the current pose: [`Self::sample_motion`], then [`Self::apply_avatar`] without a camera position.
    pub fn sample(&mut self, model: &Model, state: &ViewerState) {
        self.sample_motion(model, state);
        self.apply_avatar(model, state, None);
    }

    /// Samples the rest pose, layers below the clip, the clip, the crossfade from the previous clip, the layers over it,
    /// then manually posed joints. A crossfade doesn't blend properties but switches them halfway, and layers leave them
    /// alone. Allocates nothing once the buffers have grown.
    pub fn sample_motion(&mut self, model: &Model, state: &ViewerState) {
        let clip = active_clip(model, state);
        let time_secs = clip.map_or(0.0, |clip| clip_secs(clip, state));
        let into = (&mut self.pose, &mut self.properties);
        sample_clip(model, clip, time_secs, state.playhead.time_secs, &mut self.cursor, into);
        if let Some(fade) = &state.playhead.fade {
            let from = chosen_clip(model, &fade.clip);
            let length_secs = crossfade_secs(from, clip);
            let weight = if length_secs > 0.0 { (fade.elapsed_secs / length_secs).clamp(0.0, 1.0) } else { 1.0 };
            let elapsed_secs = fade.time_secs + fade.elapsed_secs;
            let range = TimeRange { start_secs: 0.0, end_secs: from.map_or(0.0, ModelClip::duration_secs) };
            let time_secs = clip_time(elapsed_secs, range, state.playback.loop_mode);
            let into = (&mut self.before, &mut self.before_properties);
            sample_clip(model, from, time_secs, elapsed_secs, &mut self.before_cursor, into);
            if weight < 0.5 {
                std::mem::swap(&mut self.properties, &mut self.before_properties);
            }
            // Smoothstep: eases in and out.
            self.pose.blend(&self.before, (weight * weight * (3.0 - 2.0 * weight)) as f32);
        }
        self.layers.apply(model, state, state.playhead.time_secs, &mut self.pose);
        pose_joints(model, state, &mut self.pose);
    }

    /// Applies pins and the avatar to the sampled motion, then morph weights set manually. `eye` is the camera's position in
    /// world space, without which nothing follows the camera. Allocates only when the spring simulation restarts.
    pub fn apply_avatar(&mut self, model: &Model, state: &ViewerState, eye: Option<Vec3>) {
        apply_pins(model, state, eye, None, &mut self.pose);
        self.avatar.apply(model, state, eye, &mut self.pose, &mut self.properties);
        for (&index, &weight) in &state.edits.morph {
            if let Some(slot) = self.pose.morph_weights.get_mut(index) {
                *slot = weight;
            }
        }
    }

    /// The weights of the avatar's expressions from the clip or set manually, before expressions override each other.
    pub fn expressions(&self) -> &[f32] {
        &self.avatar.weights
    }
}

/// Samples a clip over the rest pose, and its layers at `elapsed_secs`; without a clip, the rest pose.
pub(super) fn sample_pose(
    model: &Model,
    clip: Option<&ModelClip>,
    time_secs: f64,
    elapsed_secs: f64,
    cursor: &mut SampleCursor,
    pose: &mut Pose,
) {
    let skeleton = &model.asset.skeleton;
    match clip {
        Some(clip) => clip.over_layers().sample(skeleton, time_secs, elapsed_secs, cursor, pose),
        None => pose.copy_from(skeleton.rest()),
    }
}

/// Samples like [`sample_pose`], and the clip's animated properties.
fn sample_clip(
    model: &Model,
    clip: Option<&ModelClip>,
    time_secs: f64,
    elapsed_secs: f64,
    cursor: &mut SampleCursor,
    (pose, properties): (&mut Pose, &mut PropertyValues),
) {
    sample_pose(model, clip, time_secs, elapsed_secs, cursor, pose);
    properties.clear();
    if let Some(clip) = clip {
        clip.clip().sample_properties(time_secs as f32, cursor, properties);
    }
}

/// Returns the quarter turns that bring the file's up axis to +Y.
pub fn world_from_model(up: UpAxis) -> Affine3A {
    use std::f32::consts::{FRAC_PI_2, PI};
    Affine3A::from_quat(match up {
        UpAxis::Y => return Affine3A::IDENTITY,
        UpAxis::X => Quat::from_rotation_z(FRAC_PI_2),
        UpAxis::MinusX => Quat::from_rotation_z(-FRAC_PI_2),
        UpAxis::MinusY => Quat::from_rotation_z(PI),
        UpAxis::Z => Quat::from_rotation_x(-FRAC_PI_2),
        UpAxis::MinusZ => Quat::from_rotation_x(FRAC_PI_2),
    })
}
