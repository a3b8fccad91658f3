//! Pins in a view: what they need from it, how they are set, and clips with the pins baked in.

use glam::Vec3;

use super::ViewerState;
use super::playhead::{active_clip, clip_secs, world_from_model};
use crate::anim::{Clip, Pose};
use crate::library::Model;
use crate::retarget::{Pin, PinGoal, Pinning};

/// Returns the pins of a view. `eye` is the camera's position in world space, if known.
pub fn pinning<'a>(model: &'a Model, state: &'a ViewerState, eye: Option<Vec3>) -> Pinning<'a> {
    Pinning {
        asset: &model.asset,
        body: model.recognition(),
        pins: &state.edits.pins,
        world_from_model: world_from_model(state.edits.up),
        eye,
    }
}

/// Applies the pins of a view to a pose. `time_secs` is that of the active clip; `None` is the playhead's.
pub(super) fn apply_pins(
    model: &Model,
    state: &ViewerState,
    eye: Option<Vec3>,
    time_secs: Option<f64>,
    pose: &mut Pose,
) {
    if !state.edits.pins.is_empty() {
        let playhead_secs = || active_clip(model, state).map_or(0.0, |clip| clip_secs(clip, state));
        pinning(model, state, eye).apply(time_secs.unwrap_or_else(playhead_secs), pose);
    }
}

/// Whether a joint looks at the camera.
pub fn looks_at_camera(state: &ViewerState) -> bool {
    state.edits.pins.values().any(|pin| pin.goal == PinGoal::Camera)
}

/// Returns a clip, or a longer one made of it, with the pins of the view; `None` if there are none. `eye` as for [`pinning`].
pub fn pinned_clip(
    model: &Model,
    state: &ViewerState,
    clip: &Clip,
    period_secs: f64,
    eye: Option<Vec3>,
) -> Option<Clip> {
    (!state.edits.pins.is_empty()).then(|| pinning(model, state, eye).bake(clip, period_secs))
}

/// Ignores joints that the model can't pin this way.
pub(super) fn set_pin(state: &mut ViewerState, model: Option<&Model>, joint: usize, pin: Option<Pin>) {
    let Some(pin) = pin else {
        state.edits.pins.remove(&joint);
        return;
    };
    let is_allowed = model.is_none_or(|model| pinning(model, state, None).allows(joint, pin.goal));
    if let Some(pin) = pin.checked().filter(|_| is_allowed) {
        state.edits.pins.insert(joint, pin);
    }
}
