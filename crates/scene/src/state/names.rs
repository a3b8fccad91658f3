//! Joint names: the file's, or the user's custom ones.

use std::borrow::Cow;

use gaitway_character::anim::{JointIndex, Pose, Skeleton};
use gaitway_character::asset::Asset;

use super::ViewerState;
use crate::library::Model;

/// Returns a joint's display name: the custom one in `state`, the file's, or its number. `state` is that of the active model;
/// `None` for other files.
pub fn title<'a>(state: Option<&'a ViewerState>, asset: &'a Asset, joint: JointIndex) -> Cow<'a, str> {
    let number = asset.skeleton.source_index(joint);
    let custom = state.and_then(|state| state.character.edits.names.get(&number));
    match (custom, asset.skeleton.name(joint)) {
        (Some(name), _) => Cow::Borrowed(name),
        (None, "") => Cow::Owned(format!("Node {number}")),
        (None, name) => Cow::Borrowed(name),
    }
}

/// Returns the skeleton to write into a file: with the user's custom names and, if `pose` is set, with that as its
/// rest pose.
pub fn written_skeleton(model: &Model, state: &ViewerState, pose: Option<&Pose>) -> Skeleton {
    let names = state.character.edits.names.iter().map(|(&number, name)| (number, name.as_str()));
    let named = model.asset.skeleton.with_names(names);
    match pose {
        Some(pose) => named.with_rest(pose),
        None => named,
    }
}
