//! Prepares joint maps for the state, which identifies joints by number only: maps by name are read here, once their
//! files are loaded.

use std::collections::BTreeMap;

use gaitway_character::asset::Asset;
use gaitway_retarget::{JointMap, JointMapFile, MapError};

use super::{Editor, Event, short_name};
use crate::library::{Library, Model, Motion};
use crate::state::{Command, MapEdit, MotionMap, NumberedMap, ViewerState, active_clip, numbered_for, proposed_map};

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

/// Reconciles the maps of a view with the loaded files. Returns one map per pair of skeletons (the view's where it fits, else
/// the proposal) and the maps that are still to be read, and says which maps are not used.
pub fn reconciled_maps(library: &Library, state: &ViewerState) -> (Vec<MotionMap>, Vec<MapProblem>) {
    let held = &state.character.retarget.map;
    let Some(model) = library.active().filter(|_| !library.motions().is_empty()) else {
        return (held.clone(), Vec::new());
    };
    let mut reconciled: Vec<MotionMap> = Vec::new();
    let mut used = vec![false; held.len()];
    let mut by_name = MapsByName::read(held);
    for motion in library.motions() {
        let Some(checksum) = library.names_checksum(motion.id()) else { continue };
        if numbered_for(&reconciled, checksum).is_some() {
            continue;
        }
        let by_numbers = || {
            held.iter().enumerate().find_map(|(at, map)| match map {
                MotionMap::Numbers(map) if map.checksum == checksum => Some((at, map.map.clone())),
                _ => None,
            })
        };
        let map = match by_name.fitting(model, motion).or_else(by_numbers) {
            Some((at, map)) => {
                used[at] = true;
                Some(map)
            }
            None => proposed_map(library, motion.id()),
        };
        reconciled.extend(map.map(|map| MotionMap::Numbers(NumberedMap { checksum, map })));
    }
    let mut problems = Vec::new();
    for (at, map) in held.iter().enumerate() {
        match map {
            MotionMap::File(_) => reconciled.push(map.clone()),
            MotionMap::Names(_) if !used[at] => problems.extend(by_name.misfits.remove(&at)),
            // A second map for the same names is redundant, not a problem.
            MotionMap::Numbers(numbers) if !used[at] && numbered_for(&reconciled, numbers.checksum).is_none() => {
                problems.push(MapProblem::OtherFiles);
            }
            _ => {}
        }
    }
    (reconciled, problems)
}

/// The maps by name of a view, by their place in its list.
struct MapsByName {
    maps: Vec<(usize, Result<JointMapFile, MapError>)>,
    /// The first problem of each map that doesn't fit a motion.
    misfits: BTreeMap<usize, MapProblem>,
}

impl MapsByName {
    fn read(maps: &[MotionMap]) -> Self {
        let by_name = maps.iter().enumerate().filter_map(|(at, map)| match map {
            MotionMap::Names(text) => Some((at, JointMapFile::from_json(text))),
            MotionMap::Numbers(_) | MotionMap::File(_) => None,
        });
        Self { maps: by_name.collect(), misfits: BTreeMap::new() }
    }

    /// Returns the first map that fits a motion, with its place in the list.
    fn fitting(&mut self, model: &Model, motion: &Motion) -> Option<(usize, JointMap)> {
        let mut found = None;
        for (at, map) in &self.maps {
            match map.as_ref().map_err(Clone::clone).and_then(|map| map.to_joint_map(&model.asset, &motion.asset)) {
                Ok(map) => found = found.or(Some((*at, map))),
                Err(problem) => {
                    let problem = MapProblem::NoFit { motion: motion.source.clone(), problem };
                    self.misfits.entry(*at).or_insert(problem);
                }
            }
        }
        found
    }
}

impl Editor {
    /// Applies a joint map that was opened alone to every motion it fits.
    pub(super) fn open_map(&mut self, map: &JointMapFile) -> Result<(), String> {
        let Some(model) = self.library.active() else { return Ok(()) };
        if self.library.motions().is_empty() {
            let problem = "this is a joint map, but no motion is loaded; open the motion first, or both together";
            return Err(problem.to_owned());
        }
        let playing = active_clip(model, &self.state).and_then(|clip| Some(clip.borrowed()?.motion.clone()));
        let (mut fitting, mut misfits) = (Vec::new(), Vec::new());
        for motion in self.library.motions() {
            let id = motion.id().clone();
            match map.to_joint_map(&model.asset, &motion.asset) {
                Ok(map) => fitting.push((id, short_name(&motion.source), map)),
                Err(problem) => misfits.push((id, MapProblem::NoFit { motion: motion.source.clone(), problem })),
            }
        }
        let of_playing = misfits.iter().find(|(id, _)| Some(id) == playing.as_ref());
        if let Some((_, problem)) = of_playing.or(misfits.first()).filter(|_| fitting.is_empty()) {
            return Err(self.map_problem(problem));
        }
        let about_playing = of_playing.map_or_else(String::new, |(_, problem)| {
            format!(" The motion that plays keeps its own. {}", self.map_problem(problem))
        });
        self.end_gesture();
        let steps = self.undo_steps();
        let mut names = Vec::new();
        for (motion, name, map) in fitting {
            self.apply(Command::EditMap { motion, edit: MapEdit::Load(Box::new(map)) });
            names.push(name);
        }
        self.end_gesture();
        let undoable = self.undo_steps() != steps;
        let text = format!("Applied the joint map and its options to {}.{about_playing}", names.join(", "));
        self.events.push(Event::Notice { text, undoable });
        Ok(())
    }

    /// Tells about a joint's new source.
    pub(super) fn tell_source(&mut self, command: &Command) {
        let Command::SetSource { motion, target, source } = command else { return };
        let name = |asset: &Asset, number: usize| {
            asset.skeleton.joint_of_source(number).map(|joint| asset.skeleton.name(joint).to_owned())
        };
        let (Some(model), Some(motion)) = (self.library.active(), self.library.motion(motion)) else { return };
        if let Some(target) = name(&model.asset, *target) {
            let source = source.and_then(|source| name(&motion.asset, source));
            self.events.push(Event::SourceSet { target, source });
        }
    }

    /// Returns the message about a map, with the name of its file if it has just been opened.
    pub(super) fn map_problem(&self, problem: &MapProblem) -> String {
        match (&self.opened_map, problem) {
            (Some(file), MapProblem::NoFit { motion, problem }) => {
                format!("{file}: doesn't fit {}: {problem}", short_name(motion))
            }
            _ => problem.to_string(),
        }
    }
}
