//! The active joint map of each motion. A view holds maps in joint numbers, each with a checksum of the joint names it was
//! made for, so that a link can hold it without the files, and a better proposal never changes an old link.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::ViewerState;
use crate::library::{Library, Model, Motion};
use crate::retarget::{JointMap, JointMapFile, MapEntry, MapError};

/// A joint map of a view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MotionMap {
    /// For one pair of skeletons, identified by a checksum.
    Numbers(NumberedMap),
    /// The file form, for every motion it fits; becomes [`MotionMap::Numbers`] once those are loaded.
    Names(JointMapFile),
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

/// Why a map of a view is not used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MapProblem {
    /// A map by numbers whose checksum fits no pair of loaded skeletons.
    #[error(
        "the link's joint map was made for other files (their joints have other names); an automatic one is used instead"
    )]
    OtherFiles,
    /// A map by names that fits none of the motions.
    #[error("the joint map doesn't fit {motion}: {problem}")]
    NoFit {
        /// [Source](crate::library::Motion::source) of the first motion it was tried with.
        motion: String,
        /// Why it doesn't fit that motion.
        problem: MapError,
    },
}

/// Returns a motion's map in the view, without the view's overrides.
pub(super) fn own_map<'a>(library: &Library, state: &'a ViewerState, motion: usize) -> Option<&'a JointMap> {
    Some(&numbered_for(&state.retarget.map, library.names_checksum(motion)?)?.map)
}

/// Returns the active map of a motion: its map in the view, with the view's overrides. None if the view has no map for it.
pub fn active_map(library: &Library, state: &ViewerState, motion: usize) -> Option<JointMap> {
    let mut map = own_map(library, state, motion)?.clone();
    if let Some(unmapped) = &state.retarget.unmapped {
        map.unmapped = unmapped.clone();
    }
    map.root = state.retarget.root.unwrap_or(map.root);
    map.feet = state.retarget.feet.unwrap_or(map.feet);
    Some(map)
}

/// Returns the [`active_map`] of every motion, for [`Library::borrow_each`].
pub fn active_maps(library: &Library, state: &ViewerState) -> Vec<Option<JointMap>> {
    (0..library.motions().len()).map(|motion| active_map(library, state, motion)).collect()
}

/// Reconciles the maps of a view with the loaded files. Returns one map per pair of skeletons (the view's where it fits, else
/// the proposal) and the maps that are still to be read, and says which maps are not used.
pub fn reconciled_maps(library: &Library, state: &ViewerState) -> (Vec<MotionMap>, Vec<MapProblem>) {
    let held = &state.retarget.map;
    let Some(model) = library.active().filter(|_| !library.motions().is_empty()) else {
        return (held.clone(), Vec::new());
    };
    let mut reconciled: Vec<MotionMap> = Vec::new();
    let mut used = vec![false; held.len()];
    let mut misfits: BTreeMap<usize, MapProblem> = BTreeMap::new();
    for (index, motion) in library.motions().iter().enumerate() {
        let Some(checksum) = library.names_checksum(index) else { continue };
        if numbered_for(&reconciled, checksum).is_some() {
            continue;
        }
        let by_names = fitting_map(held, model, motion, &mut misfits);
        let by_numbers = || {
            held.iter().enumerate().find_map(|(at, map)| match map {
                MotionMap::Numbers(map) if map.checksum == checksum => Some((at, map.map.clone())),
                _ => None,
            })
        };
        let map = match by_names.or_else(by_numbers) {
            Some((at, map)) => {
                used[at] = true;
                Some(map)
            }
            None => proposed(library, index),
        };
        reconciled.extend(map.map(|map| MotionMap::Numbers(NumberedMap { checksum, map })));
    }
    let mut problems = Vec::new();
    for (at, map) in held.iter().enumerate() {
        match map {
            MotionMap::File(_) => reconciled.push(map.clone()),
            MotionMap::Names(_) if !used[at] => problems.extend(misfits.remove(&at)),
            // A second map for the same names is redundant, not a problem.
            MotionMap::Numbers(numbers) if !used[at] && numbered_for(&reconciled, numbers.checksum).is_none() => {
                problems.push(MapProblem::OtherFiles);
            }
            _ => {}
        }
    }
    (reconciled, problems)
}

/// Returns the first map by names that fits a motion, with its place in the list. Each map that does not fit gets its first
/// problem into `misfits`.
fn fitting_map(
    maps: &[MotionMap],
    model: &Model,
    motion: &Motion,
    misfits: &mut BTreeMap<usize, MapProblem>,
) -> Option<(usize, JointMap)> {
    let mut found = None;
    for (at, map) in maps.iter().enumerate() {
        let MotionMap::Names(map) = map else { continue };
        match map.to_joint_map(&model.asset, &motion.asset) {
            Ok(map) => found = found.or(Some((at, map))),
            Err(problem) => {
                let problem = MapProblem::NoFit { motion: motion.source.clone(), problem };
                misfits.entry(at).or_insert(problem);
            }
        }
    }
    found
}

/// Returns the proposed map of a motion; None if there is nothing to propose.
pub(super) fn proposed(library: &Library, motion: usize) -> Option<JointMap> {
    let proposal = library.proposal(motion).filter(|proposal| !proposal.pairs.is_empty())?;
    let (model, motion) = (library.active()?, library.motions().get(motion)?);
    Some(proposal.to_map(&model.asset, &motion.asset))
}

fn numbered_for(maps: &[MotionMap], checksum: u32) -> Option<&NumberedMap> {
    maps.iter().find_map(|map| match map {
        MotionMap::Numbers(map) if map.checksum == checksum => Some(map),
        _ => None,
    })
}

/// Replaces the map of a motion; None removes it.
pub(super) fn set_map(state: &mut ViewerState, library: &Library, motion: usize, map: Option<JointMap>) {
    let Some(checksum) = library.names_checksum(motion) else { return };
    let maps = &mut state.retarget.map;
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
