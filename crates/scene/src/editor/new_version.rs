//! A file opened again after it was changed: its new version takes the place of the old one, and the view is kept as far as it
//! applies. Users who meant two models get them by [`Editor::read_otherwise`].

use std::collections::BTreeSet;

use gaitway_character::asset::Asset;
use gaitway_character::sort::collect_set;

use super::open::Snapshot;
use super::transact::Change;
use super::{Editor, short_name};
use crate::library::{ClipId, Model, ModelId};
use crate::state::{ClipChoice, Edits, Selection};

impl Editor {
    /// Closes the model that was active if the opened one is a new version of its file, and returns it.
    pub(super) fn close_older_version(&mut self, before: Option<&Snapshot>, opened: ModelId) -> Option<ModelId> {
        let (older, opened) = (self.library.get(before?.loaded.model)?, self.library.get(opened)?);
        let older = is_version_of(opened, older).then_some(older.id)?;
        self.library.close(older);
        Some(older)
    }

    /// Drops what the view says of joints and clips that are not where they were. Returns a sentence about it.
    pub(super) fn fit_view_to_version(&mut self, older: ModelId) -> Option<&'static str> {
        let (older, active) = (&self.library.get(older)?.asset, &self.library.active()?.asset);
        let character = &mut self.state.character;
        let before = character.edits.clone();
        if !has_same_joints(older, active) {
            let Edits { expressions, clips, layers, variant, up, .. } = std::mem::take(&mut character.edits);
            character.edits = Edits { expressions, clips, layers, variant, up, ..Edits::default() };
            self.state.selection = Selection::default();
        }
        let names = |asset: &Asset| asset.clips.iter().map(|clip| clip.name().to_owned()).collect::<Vec<_>>();
        let (known, now) = (names(older), names(active));
        if known != now {
            character.edits.clips.retain(|clip| !matches!(clip, ClipId::Own(_)));
            character.edits.layers.retain(|layer| !matches!(layer.clip, ClipId::Own(_)));
            if let ClipChoice::Clip(ClipId::Own(index)) = character.playhead.clip {
                let place = known.get(index).and_then(|name| now.iter().position(|other| other == name));
                character.playhead.clip = place.map_or(ClipChoice::First, |index| ClipChoice::Clip(ClipId::Own(index)));
            }
        }
        (before != character.edits)
            .then_some("What was set for joints or clips that it lacks is dropped; undo brings it back.")
    }

    /// Lists the older version of the active file again.
    pub(super) fn list_older_version(&mut self, older: ModelId) {
        let Some(active) = self.library.active().map(|model| model.id) else { return };
        self.history.closed(self.library.listed());
        if self.library.show(older) {
            let name = self.library.get(older).map(|model| short_name(&model.source)).unwrap_or_default();
            self.library.show(active);
            self.transact(Change::View, |_| ());
            self.notify_undoable(format!("Both versions of {name} are in the model list."));
        }
    }
}

/// By name, and by most of their joints: many files are called “scene.gltf”.
fn is_version_of(opened: &Model, known: &Model) -> bool {
    let is_same_file = opened.id != known.id && opened.is_own && known.is_own && opened.source == known.source;
    is_same_file && {
        let (one, other) = (joint_names(&opened.asset), joint_names(&known.asset));
        2 * one.intersection(&other).count() > one.len().max(other.len())
    }
}

fn joint_names(asset: &Asset) -> BTreeSet<&str> {
    collect_set(asset.skeleton.joints().map(|joint| asset.skeleton.name(joint)))
}

fn has_same_joints(one: &Asset, other: &Asset) -> bool {
    let (one, other) = (&one.skeleton, &other.skeleton);
    one.len() == other.len()
        && one.joints().zip(other.joints()).all(|(joint, same)| {
            one.name(joint) == other.name(same)
                && one.parent(joint) == other.parent(same)
                && one.source_index(joint) == other.source_index(same)
        })
}
