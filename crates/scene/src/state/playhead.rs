//! The active clip of a view, and its time.

use gaitway_character::anim::{TimeRange, clip_time};
use glam::{Affine3A, Quat};

use super::clip_names::{look_up_clip, unknown_name};
use super::{ClipChoice, UnknownName, UpAxis, ViewerState};
use crate::library::{Model, ModelClip};

/// Returns the active clip; `None` for the rest pose, a model without clips, or a clip that the model lacks.
pub fn active_clip<'a>(model: &'a Model, state: &ViewerState) -> Option<&'a ModelClip> {
    chosen_clip(model, &state.character.playhead.clip)
}

/// Returns the clip that the state names and the model lacks.
pub fn unknown_clip(model: &Model, state: &ViewerState) -> Option<UnknownName> {
    let ClipChoice::Clip(clip) = &state.character.playhead.clip else { return None };
    look_up_clip(model, clip).is_none().then(|| unknown_name(model, clip))
}

/// Returns the chosen clip.
pub(super) fn chosen_clip<'a>(model: &'a Model, choice: &ClipChoice) -> Option<&'a ModelClip> {
    match choice {
        ClipChoice::First => model.clips().first(),
        ClipChoice::FirstOfMotions => model.first_opened_clip().or_else(|| model.clips().first()),
        ClipChoice::RestPose => None,
        ClipChoice::Clip(clip) => look_up_clip(model, clip),
    }
}

/// Returns the in and out points, clamped to the active clip.
pub fn play_range(clip: &ModelClip, state: &ViewerState) -> TimeRange {
    let duration_secs = clip.duration_secs();
    match state.character.playhead.range {
        Some(range) => TimeRange {
            start_secs: range.start_secs.clamp(0.0, duration_secs),
            end_secs: range.end_secs.clamp(0.0, duration_secs),
        },
        None => TimeRange { start_secs: 0.0, end_secs: duration_secs },
    }
}

/// Returns the time of the current pose in the active clip: the playhead, folded into the range by the loop mode.
pub fn clip_secs(clip: &ModelClip, state: &ViewerState) -> f64 {
    clip_time(state.character.playhead.time_secs, play_range(clip, state), state.playback.loop_mode)
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
