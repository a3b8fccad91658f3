//! Joint names: the file's, or those given by the user.

use std::borrow::Cow;

use super::ViewerState;
use crate::anim::{JointIndex, Pose, Skeleton};
use crate::asset::Asset;
use crate::library::Model;

/// A name to show; nodes without one get their number. `state`: of the model that is shown; none for other files.
pub fn title<'a>(state: Option<&'a ViewerState>, asset: &'a Asset, joint: JointIndex) -> Cow<'a, str> {
    let number = asset.skeleton.source_index(joint);
    let by_hand = state.and_then(|state| state.edits.names.get(&number));
    match (by_hand, asset.skeleton.name(joint)) {
        (Some(name), _) => Cow::Borrowed(name),
        (None, "") => Cow::Owned(format!("Node {number}")),
        (None, name) => Cow::Borrowed(name),
    }
}

/// Returns the skeleton to write into a file: with the names given by the user and, if `pose` is set, with that as its
/// rest pose.
pub fn written_skeleton(model: &Model, state: &ViewerState, pose: Option<&Pose>) -> Skeleton {
    let names = state.edits.names.iter().map(|(&number, name)| (number, name.as_str()));
    let named = model.asset.skeleton.with_names(names);
    match pose {
        Some(pose) => named.with_rest(&pose.locals),
        None => named,
    }
}
