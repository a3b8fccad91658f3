//! What joints are called: as the file says, or as a person does.

use std::borrow::Cow;

use super::{PoseSampler, ViewerState};
use crate::anim::{JointIndex, Skeleton};
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

/// The skeleton as it is written into a file: with the names given by hand, and in the pose of the moment if `posed`.
pub fn written_skeleton(model: &Model, state: &ViewerState, posed: bool) -> Skeleton {
    let names = state.edits.names.iter().map(|(&number, name)| (number, name.as_str()));
    let named = model.asset.skeleton.with_names(names);
    if !posed {
        return named;
    }
    let mut sampler = PoseSampler::default();
    sampler.sample(model, state);
    named.with_rest(&sampler.pose.locals)
}
