//! Which clips the model's file already contains as they play.

use crate::library::{Model, ModelClip};
use crate::state::{ViewerState, active_clip, take_of};

/// Returns the active clip unless the model's file already contains it as it plays.
pub fn derived_clip<'a>(model: &'a Model, state: &ViewerState) -> Option<&'a ModelClip> {
    active_clip(model, state).filter(|clip| is_derived(model, state, clip))
}

/// Whether a clip as it plays is not in the model's file, or under another name.
pub(super) fn is_derived(model: &Model, state: &ViewerState, clip: &ModelClip) -> bool {
    clip.is_renamed() || !is_in_file(model, state, clip)
}

/// Whether a clip as it plays is in the model's file, perhaps under another name: it is not retargeted, changed, below layers or
/// what is set manually, nor pinned.
pub(super) fn is_in_file(model: &Model, state: &ViewerState, clip: &ModelClip) -> bool {
    clip.is_in_file() && !take_of(model, Some(clip), state).is_more_than_clip()
}
