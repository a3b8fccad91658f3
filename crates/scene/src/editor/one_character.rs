//! Files of one character that are opened together, each with clips of its own, as Mixamo writes them “with skin”: one is the
//! character, the others are its motions. Users who meant several models get them by [`Editor::read_otherwise`].

use std::collections::BTreeSet;

use gaitway_character::anim::Clip;
use gaitway_character::asset::Asset;
use gaitway_character::mesh::{Geometry, Mesh};
use gaitway_character::sort::collect_set;

use super::{Editor, OpenedModel, short_name};
use crate::library::{Model, Motion};
use crate::state::{ClipChoice, Command};

/// Splits files opened together into models and clips: if they are all `active`, with clips that it lacks, none is a model.
pub(super) fn split(models: Vec<OpenedModel>, active: Option<&Model>) -> (Vec<OpenedModel>, Vec<OpenedModel>) {
    if models.len() < 2 {
        return (models, Vec::new());
    }
    let is_of_active = |active: &&Model| models.iter().all(|opened| adds_clips(&active.asset, &opened.model.asset));
    if active.filter(is_of_active).is_some() {
        return (Vec::new(), models);
    }
    // A file without clips can only be meant as the character.
    let character = models.iter().position(|opened| opened.model.asset.clips.is_empty()).unwrap_or(0);
    let asset = models[character].model.asset.clone();
    models.into_iter().partition(|opened| !adds_clips(&asset, &opened.model.asset))
}

impl Editor {
    /// Shows the files that were taken as clips of the character in the list of models instead, and removes those clips.
    pub(super) fn open_as_models(&mut self, models: Vec<OpenedModel>) {
        let Some(active) = self.library.active().map(|model| model.id).filter(|_| !models.is_empty()) else { return };
        let names: Vec<String> = models.iter().map(|opened| short_name(&opened.model.source)).collect();
        let before = self.snapshot();
        let is_other = |motion: &&Motion| !models.iter().any(|opened| opened.model.origin == motion.origin);
        let others = self.library.motions().iter().filter(is_other).cloned().collect();
        self.keep_motions(others);
        for opened in models {
            self.add(opened);
        }
        self.library.show(active);
        self.remember(before);
        self.evict();
        if self.is_clip_unknown() {
            self.apply(Command::SetClip(ClipChoice::First));
        }
        let are = if names.len() == 1 { "is" } else { "are" };
        self.notify_undoable(format!("{} {are} in the model list.", names.join(", ")));
    }
}

/// The files as motions.
pub(super) fn motions(models: &[OpenedModel]) -> Vec<Motion> {
    models.iter().map(|OpenedModel { model, files }| Motion::of_model(model, files.clone())).collect()
}

/// Whether a file has clips that this character's file lacks, and is the same character otherwise. For a character without clips,
/// the same skin joints are enough: its clips are often downloaded with another body.
fn adds_clips(character: &Asset, file: &Asset) -> bool {
    let lacks = |clip: &Clip| !character.clips.iter().any(|known| is_same_clip(known, clip));
    let (joints, of_file) = (skin_joints(character), skin_joints(file));
    !joints.is_empty()
        && joints == of_file
        && !file.clips.is_empty()
        && file.clips.iter().all(lacks)
        && (character.clips.is_empty() || looks_like(character, file))
}

fn skin_joints(asset: &Asset) -> BTreeSet<&str> {
    let joints = asset.skins.iter().flat_map(|skin| skin.joints());
    collect_set(joints.map(|&joint| asset.skeleton.name(joint)))
}

/// By their keys: different takes often have one name.
fn is_same_clip(one: &Clip, other: &Clip) -> bool {
    one.timelines() == other.timelines()
        && one.channels().len() == other.channels().len()
        && one.channels().iter().zip(other.channels()).all(|(channel, same)| channel.keys == same.keys)
}

/// Whether both have the same surfaces: another version of a character is a model of its own, and so is one in another colour.
fn looks_like(one: &Asset, other: &Asset) -> bool {
    let are_same_parts = |(part, same): (&Geometry, &Geometry)| {
        part.positions.len() == same.positions.len() && part.indices == same.indices && part.uvs == same.uvs
    };
    let are_same_meshes = |(mesh, same): (&Mesh, &Mesh)| {
        mesh.primitives.len() == same.primitives.len()
            && mesh.primitives.iter().zip(&same.primitives).all(are_same_parts)
    };
    one.materials == other.materials
        && one.images.len() == other.images.len()
        && one.images.iter().zip(&other.images).all(|(image, same)| image.bytes == same.bytes)
        && one.meshes.len() == other.meshes.len()
        && one.meshes.iter().zip(&other.meshes).all(are_same_meshes)
}
