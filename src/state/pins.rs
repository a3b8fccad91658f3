//! How pins are set.

use super::{ViewerState, active_take};
use crate::library::Model;
use crate::retarget::Pin;

/// Ignores joints that the model can't pin this way.
pub(super) fn set_pin(state: &mut ViewerState, model: Option<&Model>, joint: usize, pin: Option<Pin>) {
    let Some(pin) = pin else {
        state.character.edits.pins.remove(&joint);
        return;
    };
    let is_allowed = model.is_none_or(|model| active_take(model, state).pinning(None).allows(joint, pin.goal));
    if let Some(pin) = pin.checked().filter(|_| is_allowed) {
        state.character.edits.pins.insert(joint, pin);
    }
}
