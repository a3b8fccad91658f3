//! The active joint map of each motion. A view holds maps in joint numbers, each with a checksum of the joint names it was
//! made for, so that a link can hold it without the files, and a better proposal never changes an old link. Maps by name are
//! only text here: links and undo have to hold them, and their joints can't be resolved before the motion is there.

use gaitway_retarget::{JointMap, MapEntry};
use serde::{Deserialize, Serialize};

use super::ViewerState;
use crate::library::{Library, MotionId};

/// A joint map of a view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MotionMap {
    /// For one pair of skeletons, identified by a checksum.
    Numbers(NumberedMap),
    /// A map by joint names, as the JSON in the link: it waits for motions that it fits, and the editor then replaces it by
    /// numbers.
    Names(String),
    /// The URL of a map that has not been read yet.
    File(String),
}

/// A joint map for one model and one motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NumberedMap {
    /// See [`crate::library::names_checksum`].
    pub checksum: u32,
    /// In joint numbers of the two files.
    pub map: JointMap,
}

/// Returns a motion's map in the view, without the view's overrides.
pub(super) fn own_map<'a>(library: &Library, state: &'a ViewerState, motion: &MotionId) -> Option<&'a JointMap> {
    Some(&numbered_for(&state.character.retarget.map, library.names_checksum(motion)?)?.map)
}

/// Returns the active map of a motion: its map in the view, with the view's overrides. None if the view has no map for it.
pub fn active_map(library: &Library, state: &ViewerState, motion: &MotionId) -> Option<JointMap> {
    let mut map = own_map(library, state, motion)?.clone();
    if let Some(unmapped) = &state.character.retarget.unmapped {
        map.unmapped = unmapped.clone();
    }
    map.root = state.character.retarget.root.unwrap_or(map.root);
    map.feet = state.character.retarget.feet.unwrap_or(map.feet);
    map.contacts = state.character.retarget.contacts.unwrap_or(map.contacts);
    Some(map)
}

/// Returns the [`active_map`] of every motion, for [`Library::borrow_each`].
pub fn active_maps(library: &Library, state: &ViewerState) -> Vec<Option<JointMap>> {
    library.motions().iter().map(|motion| active_map(library, state, motion.id())).collect()
}

/// Returns the proposed map of a motion; None if there is nothing to propose.
pub fn proposed_map(library: &Library, motion: &MotionId) -> Option<JointMap> {
    let proposal = library.proposal(motion).filter(|proposal| !proposal.pairs.is_empty())?;
    let (model, motion) = (library.active()?, library.motion(motion)?);
    Some(proposal.to_map(&model.asset, &motion.asset))
}

/// Returns the map among `maps` that was made for joint names with this checksum.
pub fn numbered_for(maps: &[MotionMap], checksum: u32) -> Option<&NumberedMap> {
    maps.iter().find_map(|map| match map {
        MotionMap::Numbers(map) if map.checksum == checksum => Some(map),
        _ => None,
    })
}

/// Replaces the map of a motion; None removes it.
pub(super) fn set_map(state: &mut ViewerState, library: &Library, motion: &MotionId, map: Option<JointMap>) {
    let Some(checksum) = library.names_checksum(motion) else { return };
    let maps = &mut state.character.retarget.map;
    let at = maps.iter().position(|map| matches!(map, MotionMap::Numbers(map) if map.checksum == checksum));
    let map = map.map(|map| MotionMap::Numbers(NumberedMap { checksum, map }));
    match (at, map) {
        (Some(at), Some(map)) => maps[at] = map,
        (None, Some(map)) => maps.push(map),
        (Some(at), None) => drop(maps.remove(at)),
        (None, None) => {}
    }
}

/// Makes one joint follow another source, or none.
pub(super) fn set_source(map: &mut JointMap, target: usize, source: Option<usize>) {
    let entry = map.joints.entry(target);
    entry.and_modify(|entry| entry.source = source).or_insert(MapEntry::following(source));
}
