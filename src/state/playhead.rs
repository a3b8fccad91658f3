//! Which clip is meant, and at which time of it: the step from a view state to a pose.

use glam::{Affine3A, Quat};

use super::{ClipChoice, UpAxis, ViewerState};
use crate::anim::{Pose, SampleCursor, TimeRange, clip_time};
use crate::library::Model;

/// The clip that plays, by index; none for the rest pose, for a model without clips, or when no clip is called that.
pub fn active_clip(model: &Model, state: &ViewerState) -> Option<usize> {
    match &state.clip {
        ClipChoice::First => (model.clip_count() > 0).then_some(0),
        ClipChoice::RestPose => None,
        ClipChoice::Named(name) => clip_called(model, name),
    }
}

/// A clip by its name, by the title it is shown under, or by its index in decimal.
fn clip_called(model: &Model, name: &str) -> Option<usize> {
    let by_name = model.clips().position(|clip| !name.is_empty() && clip.name() == name);
    let by_title = || model.clip_titles().iter().position(|title| title == name);
    let by_index = || name.parse::<usize>().ok().filter(|&index| index < model.clip_count());
    by_name.or_else(by_title).or_else(by_index)
}

/// How a state names a clip: by name when that is enough, else by index.
pub fn choice_of_clip(model: &Model, clip: usize) -> ClipChoice {
    let name = model.clip(clip).map_or("", |clip| clip.name());
    let found = clip_called(model, name);
    let unique = model.clips().filter(|other| other.name() == name).count() == 1;
    ClipChoice::Named(if unique && found == Some(clip) { name.to_owned() } else { clip.to_string() })
}

/// In and out points within a clip, in seconds.
pub fn play_range(model: &Model, clip: usize, state: &ViewerState) -> TimeRange {
    let duration_secs = model.clip(clip).map_or(0.0, |clip| f64::from(clip.duration_secs()));
    match state.range {
        Some(range) => TimeRange {
            start_secs: range.start_secs.clamp(0.0, duration_secs),
            end_secs: range.end_secs.clamp(0.0, duration_secs),
        },
        None => TimeRange { start_secs: 0.0, end_secs: duration_secs },
    }
}

/// The time of the clip that is shown: the playhead, folded into the range by the loop mode.
pub fn clip_secs(model: &Model, clip: usize, state: &ViewerState) -> f64 {
    clip_time(state.time_secs, play_range(model, clip, state), state.loop_mode)
}

/// The pose that is shown: rest, then what plays below the clip, then the clip, then the morph weights set by hand. Allocates nothing once `pose` and
/// `cursor` have grown.
pub fn sample_pose(model: &Model, state: &ViewerState, cursor: &mut SampleCursor, pose: &mut Pose) {
    let skeleton = &model.asset.skeleton;
    pose.copy_from(skeleton.rest());
    if let Some(index) = active_clip(model, state)
        && let Some(clip) = model.clip(index)
    {
        for layer in model.layers(index) {
            layer.sample(skeleton, state.time_secs, cursor, pose);
        }
        clip.sample(skeleton, clip_secs(model, index, state) as f32, cursor, pose);
    }
    for (&index, &weight) in &state.morph {
        if let Some(slot) = pose.morph_weights.get_mut(index) {
            *slot = weight;
        }
    }
}

/// Turns the file's up axis to +Y by quarter turns.
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
