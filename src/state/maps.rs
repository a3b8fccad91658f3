//! Which joint map is in force for each motion. A view holds maps in joint numbers, each with a checksum of the names it
//! was made for, so that it can be written down without the files, and a better proposal never changes an old link.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::ViewerState;
use crate::asset::Asset;
use crate::library::{Library, Motion};
use crate::retarget::{JointMap, JointMapFile, MapEntry, MapError};

/// A joint map of a view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MotionMap {
    Numbers(NumberedMap),
    /// As a file has it, for whichever motions it fits: becomes [`MotionMap::Numbers`] as soon as those are there.
    Names(JointMapFile),
    /// The address of a map that has not been read yet.
    File(String),
}

/// A joint map for one model and one motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NumberedMap {
    /// See [`names_checksum`].
    pub checksum: u32,
    pub map: JointMap,
}

/// Why a map of a view is not used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MapProblem {
    #[error(
        "the link's joint map was made for other files (their joints have other names); an automatic one is used instead"
    )]
    OtherFiles,
    #[error("the joint map fits no motion that is open: {motion}: {problem}")]
    NoFit { motion: String, problem: MapError },
}

/// Tells two pairs of skeletons apart by the names of their joints, in the files' order (FNV-1a).
pub fn names_checksum(model: &Asset, motion: &Asset) -> u32 {
    let mut hash = 0x811c_9dc5_u32;
    let mut take = |byte: u8| hash = (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
    for skeleton in [&model.skeleton, &motion.skeleton] {
        for joint in (0..skeleton.len()).filter_map(|source| skeleton.joint_of_source(source)) {
            skeleton.name(joint).bytes().for_each(&mut take);
            take(0);
        }
        take(1);
    }
    hash
}

/// The map of a view that is meant for a motion of the library, with what the view sets besides on top. None: none is
/// meant for it.
pub fn map_in_force(library: &Library, state: &ViewerState, motion: usize) -> Option<JointMap> {
    let (model, motion) = (library.active()?, library.motions().get(motion)?);
    let mut map = numbered_for(&state.retarget.map, names_checksum(&model.asset, &motion.asset))?.map.clone();
    if let Some(unmapped) = &state.retarget.unmapped {
        map.unmapped = unmapped.clone();
    }
    map.root = state.retarget.root.unwrap_or(map.root);
    map.feet = state.retarget.feet.unwrap_or(map.feet);
    Some(map)
}

/// As [`map_in_force`], for every motion: what [`Library::borrow_each`] wants.
pub fn maps_in_force(library: &Library, state: &ViewerState) -> Vec<Option<JointMap>> {
    (0..library.motions().len()).map(|motion| map_in_force(library, state, motion)).collect()
}

/// The maps that a view should hold, one for each pair of skeletons: those that it holds as far as they fit, and
/// proposals for the rest. What is still to be read stays. And what did not fit.
pub fn settled_maps(library: &Library, state: &ViewerState) -> (Vec<MotionMap>, Vec<MapProblem>) {
    let Some(model) = library.active().filter(|_| !library.motions().is_empty()) else {
        return (state.retarget.map.clone(), Vec::new());
    };
    let mut settled: Vec<MotionMap> = Vec::new();
    let mut used = vec![false; state.retarget.map.len()];
    let mut misfits: BTreeMap<usize, MapProblem> = BTreeMap::new();
    for (index, motion) in library.motions().iter().enumerate() {
        let checksum = names_checksum(&model.asset, &motion.asset);
        if numbered_for(&settled, checksum).is_some() {
            continue;
        }
        let mut found = None;
        for (at, map) in state.retarget.map.iter().enumerate() {
            if let MotionMap::Names(map) = map {
                match map.to_joint_map(&model.asset, &motion.asset) {
                    Ok(map) => found = found.or(Some((at, map))),
                    Err(problem) => {
                        let problem = MapProblem::NoFit { motion: motion.source.clone(), problem };
                        misfits.entry(at).or_insert(problem);
                    }
                }
            }
        }
        let in_numbers = || {
            state.retarget.map.iter().enumerate().find_map(|(at, map)| match map {
                MotionMap::Numbers(map) if map.checksum == checksum => Some((at, map.map.clone())),
                _ => None,
            })
        };
        if let Some((at, map)) = found.or_else(in_numbers) {
            used[at] = true;
            settled.push(MotionMap::Numbers(NumberedMap { checksum, map }));
        } else if let Some(map) = proposed(library, index) {
            settled.push(MotionMap::Numbers(NumberedMap { checksum, map }));
        }
    }
    let mut problems = Vec::new();
    for (at, map) in state.retarget.map.iter().enumerate() {
        match map {
            MotionMap::File(_) => settled.push(map.clone()),
            MotionMap::Names(_) if !used[at] => problems.extend(misfits.remove(&at)),
            // Of two maps for the same names the second is not asked for.
            MotionMap::Numbers(numbers) if !used[at] && numbered_for(&settled, numbers.checksum).is_none() => {
                problems.push(MapProblem::OtherFiles);
            }
            _ => {}
        }
    }
    (settled, problems)
}

/// What is proposed for a motion, in numbers; none when nothing is.
pub fn proposed(library: &Library, motion: usize) -> Option<JointMap> {
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

/// Puts a map in the place of the one for a motion.
pub(super) fn set_map(state: &mut ViewerState, model: &Asset, motion: &Motion, map: Option<JointMap>) {
    let checksum = names_checksum(model, &motion.asset);
    let at =
        state.retarget.map.iter().position(|map| matches!(map, MotionMap::Numbers(map) if map.checksum == checksum));
    match (at, map) {
        (Some(at), Some(map)) => state.retarget.map[at] = MotionMap::Numbers(NumberedMap { checksum, map }),
        (None, Some(map)) => state.retarget.map.push(MotionMap::Numbers(NumberedMap { checksum, map })),
        (Some(at), None) => {
            state.retarget.map.remove(at);
        }
        (None, None) => {}
    }
}

/// Lets one joint follow another source, or none.
pub(super) fn set_source(map: &mut JointMap, target: usize, source: Option<usize>) {
    let entry = map.joints.entry(target);
    entry.and_modify(|entry| entry.source = source).or_insert(MapEntry::following(source));
}
