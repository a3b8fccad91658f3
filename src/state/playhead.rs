//! From a view state to a pose: the active clip, its time, and the sampled pose.

use glam::{Affine3A, Quat, Vec3};

use super::avatar::AvatarPose;
use super::manual::pose_joints;
use super::pins::apply_pins;
use super::{ClipChoice, LayerSampler, NameKind, UnknownName, UpAxis, ViewerState};
use crate::anim::{ClipQuery, Pose, PropertyValues, SampleCursor, TimeRange, clip_time, find_clip};
use crate::library::Model;
use crate::retarget::ClipOverLayers;

/// Returns the index of the active clip; `None` for the rest pose, a model without clips, or an unknown name.
pub fn active_clip(model: &Model, state: &ViewerState) -> Option<usize> {
    clip_of(model, &state.playhead.clip)
}

/// Returns the clip that the state names and the model lacks.
pub fn unknown_clip(model: &Model, state: &ViewerState) -> Option<UnknownName> {
    let ClipChoice::Named(name) = &state.playhead.clip else { return None };
    let unknown = || UnknownName { kind: NameKind::Clip, name: name.clone(), names: model.clip_titles().to_vec() };
    active_clip(model, state).is_none().then(unknown)
}

/// Returns the index of the chosen clip.
pub(super) fn clip_of(model: &Model, choice: &ClipChoice) -> Option<usize> {
    match choice {
        ClipChoice::First => (model.clip_count() > 0).then_some(0),
        ClipChoice::RestPose => None,
        ClipChoice::Named(name) => clip_called(model, name),
    }
}

/// Finds a clip by its name, its index in decimal, or its display title.
pub fn clip_called(model: &Model, name: &str) -> Option<usize> {
    if name.is_empty() {
        return None;
    }
    // Titles never look like an index unless a clip has that very name.
    let by_title = || model.clip_titles().iter().position(|title| title == name);
    find_clip(model.clips(), ClipQuery::NameOrIndex(name)).or_else(by_title)
}

/// Returns how a state refers to a clip: by name if that is unambiguous, otherwise by index, or by title if another clip is called
/// like the index.
pub fn name_of_clip(model: &Model, clip: usize) -> String {
    let (name, index) = (model.clip(clip).map_or("", |clip| clip.name()), clip.to_string());
    let is_unique = model.clips().filter(|other| other.name() == name).count() == 1;
    let refers = |name: &str| clip_called(model, name) == Some(clip);
    match model.clip_titles().get(clip) {
        _ if is_unique && refers(name) => name.to_owned(),
        Some(title) if !refers(&index) => title.clone(),
        _ => index,
    }
}

/// Returns the choice of a clip, as [`name_of_clip`] calls it.
pub fn choice_of_clip(model: &Model, clip: usize) -> ClipChoice {
    ClipChoice::Named(name_of_clip(model, clip))
}

/// Returns the in and out points, clamped to the clip.
pub fn play_range(model: &Model, clip: usize, state: &ViewerState) -> TimeRange {
    let duration_secs = model.clip(clip).map_or(0.0, |clip| f64::from(clip.duration_secs()));
    match state.playhead.range {
        Some(range) => TimeRange {
            start_secs: range.start_secs.clamp(0.0, duration_secs),
            end_secs: range.end_secs.clamp(0.0, duration_secs),
        },
        None => TimeRange { start_secs: 0.0, end_secs: duration_secs },
    }
}

/// Returns the clip time of the current pose: the playhead, folded into the range by the loop mode.
pub fn clip_secs(model: &Model, clip: usize, state: &ViewerState) -> f64 {
    clip_time(state.playhead.time_secs, play_range(model, clip, state), state.playback.loop_mode)
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
        let time_secs = clip.map_or(0.0, |clip| clip_secs(model, clip, state));
        let into = (&mut self.pose, &mut self.properties);
        sample_clip(model, clip, time_secs, state.playhead.time_secs, &mut self.cursor, into);
        if let Some(fade) = &state.playhead.fade {
            let from = clip_of(model, &fade.clip);
            let length_secs = model.crossfade_secs(from, clip);
            let weight = if length_secs > 0.0 { (fade.elapsed_secs / length_secs).clamp(0.0, 1.0) } else { 1.0 };
            let elapsed_secs = fade.time_secs + fade.elapsed_secs;
            let duration_secs =
                from.and_then(|from| model.clip(from)).map_or(0.0, |clip| f64::from(clip.duration_secs()));
            let range = TimeRange { start_secs: 0.0, end_secs: duration_secs };
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
    clip: Option<usize>,
    time_secs: f64,
    elapsed_secs: f64,
    cursor: &mut SampleCursor,
    pose: &mut Pose,
) {
    let skeleton = &model.asset.skeleton;
    match clip.and_then(|index| Some((index, model.clip(index)?))) {
        Some((index, clip)) => {
            let source = ClipOverLayers { clip, below: model.layers(index) };
            source.sample(skeleton, time_secs, elapsed_secs, cursor, pose);
        }
        None => pose.copy_from(skeleton.rest()),
    }
}

/// Samples like [`sample_pose`], and the clip's animated properties.
fn sample_clip(
    model: &Model,
    clip: Option<usize>,
    time_secs: f64,
    elapsed_secs: f64,
    cursor: &mut SampleCursor,
    (pose, properties): (&mut Pose, &mut PropertyValues),
) {
    sample_pose(model, clip, time_secs, elapsed_secs, cursor, pose);
    properties.clear();
    if let Some(clip) = clip.and_then(|clip| model.clip(clip)) {
        clip.sample_properties(time_secs as f32, cursor, properties);
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
