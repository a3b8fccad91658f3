//! What links, scripts and the command line call clips. A view that was just read has these names; they are replaced by identities
//! once the files are there.

use std::collections::BTreeMap;

use gaitway_character::anim::{ClipQuery, find_clip};
use gaitway_character::sort::collect_map;

use super::playhead::chosen_clip;
use super::{ClipChoice, NameKind, UnknownName, ViewerState};
use crate::library::{ClipEdits, ClipId, LayeredClip, Library, Model, ModelClip, clip_file_name};

/// Finds a clip by its name, its index in decimal, or its display title.
fn clip_called<'a>(model: &'a Model, name: &str) -> Option<&'a ModelClip> {
    if name.is_empty() {
        return None;
    }
    // Titles never look like an index unless a clip has that very name.
    let by_title = || model.clips().iter().find(|clip| clip.title() == name);
    let index = find_clip(model.clips().iter().map(ModelClip::unchanged), ClipQuery::NameOrIndex(name));
    index.and_then(|index| model.clips().iter().nth(index)).or_else(by_title)
}

/// Finds a clip by its identity, or by what a link calls it: [`resolve_clips`] replaces that by the identity.
pub fn look_up_clip<'a>(model: &'a Model, clip: &ClipId) -> Option<&'a ModelClip> {
    clip.name().map_or_else(|| model.clip(clip), |name| clip_called(model, name))
}

/// Returns what a view that asks for an unknown clip should have asked for.
pub(super) fn unknown_name(model: &Model, clip: &ClipId) -> UnknownName {
    let name = clip.name().map_or_else(|| clip.to_string(), str::to_owned);
    let names = model.clips().iter().map(|clip| name_in_link(model, clip)).collect();
    UnknownName { kind: NameKind::Clip, name, names }
}

/// Returns what people can call a clip in a link: its name if that is unambiguous, otherwise its title, or its index if it is
/// renamed.
fn name_in_link(model: &Model, clip: &ModelClip) -> String {
    let refers = |name: &str| clip_called(model, name).is_some_and(|found| found.id() == clip.id());
    let name = clip.unchanged().name();
    let title = if clip.is_renamed() { None } else { Some(clip.title()) };
    let found = [name].into_iter().chain(title).find(|name| refers(name));
    let index = || model.clips().iter().position(|other| other.id() == clip.id()).unwrap_or_default();
    found.map_or_else(|| index().to_string(), str::to_owned)
}

/// Returns the clips of layers that the model lacks.
pub fn unknown_layers(model: &Model, layers: &[LayeredClip]) -> impl Iterator<Item = UnknownName> {
    let unknown = layers.iter().filter(|over| look_up_clip(model, &over.clip).is_none());
    unknown.map(|over| unknown_name(model, &over.clip))
}

/// Returns what a link calls a clip of the active model: its name if that is unambiguous, otherwise its index, or its title if
/// another clip is called like the index. A clip whose motion lends none, since its map has no pairs, is called as in its file.
/// `None` if no text would mean the clip.
fn link_clip_name(library: &Library, edits: &ClipEdits, id: &ClipId) -> Option<String> {
    let Some(model) = library.active().filter(|_| id.name().is_none()) else { return id.name().map(str::to_owned) };
    let Some(at) = model.clips().iter().position(|clip| clip.id() == id) else {
        let name = match id {
            ClipId::Own(_) | ClipId::Called(_) => None,
            ClipId::Copy(_) => edits.names.get(id).cloned(),
            ClipId::Borrowed(motion, clip) => {
                library.motion(motion).and_then(|motion| clip_file_name(&motion.source, *clip, &motion.asset))
            }
        };
        return name.filter(|name| clip_called(model, name).is_none());
    };
    let names = || model.clips().iter().map(|clip| clip.unchanged().name());
    let clip = model.clips().get(id)?;
    let (name, index) = (clip.unchanged().name(), at.to_string());
    let refers = |name: &str| clip_called(model, name).is_some_and(|found| found.id() == id);
    Some(if names().filter(|other| *other == name).count() == 1 && refers(name) {
        name.to_owned()
    } else if refers(&index) {
        index
    } else {
        clip.title().to_owned()
    })
}

/// Returns what a link says for the first clip of the active model: nothing where a link that names no clip plays it, too. An index
/// stands for it until the model is there.
fn first_in_link(view: &ViewerState, library: &Library) -> ClipChoice {
    if view.character.sources.motion.is_empty() {
        return ClipChoice::First;
    }
    let Some(model) = library.active().filter(|model| !model.clips().is_empty()) else {
        return ClipChoice::called("0");
    };
    let choices = [ClipChoice::First, ClipChoice::FirstOfMotions];
    let [first, of_motions] = choices.map(|choice| chosen_clip(model, &choice).map(ModelClip::id));
    let name = first
        .filter(|_| first != of_motions)
        .and_then(|first| link_clip_name(library, &view.character.edits.clips, first));
    name.map_or(ClipChoice::First, |name| ClipChoice::called(&name))
}

/// Returns a view that refers to clips as links do.
pub(super) fn with_link_names(view: &ViewerState, library: &Library) -> ViewerState {
    let mut state = view.clone();
    let called =
        |id: &ClipId| link_clip_name(library, &view.character.edits.clips, id).map(|name| ClipId::called(&name));
    // A clip whose map has no pairs shows the rest pose until the map has some again.
    let plays =
        |clip: &ClipId| clip.name().is_some() || library.active().is_some_and(|model| model.clip(clip).is_some());
    let choice = |choice: &ClipChoice| match choice {
        ClipChoice::First => first_in_link(view, library),
        ClipChoice::Clip(clip) => called(clip).filter(|_| plays(clip)).map_or(ClipChoice::RestPose, ClipChoice::Clip),
        other => other.clone(),
    };
    state.character.playhead.clip = choice(&state.character.playhead.clip);
    if let Some(fade) = &mut state.character.playhead.fade {
        fade.clip = choice(&fade.clip);
    }
    state.character.edits.layers.retain_mut(|over| called(&over.clip).map(|name| over.clip = name).is_some());
    let clips = &mut state.character.edits.clips;
    clips.copies.retain_mut(|copy| called(&copy.of).map(|name| copy.of = name).is_some());
    let changes = std::mem::take(&mut clips.changes).into_iter();
    clips.changes = collect_map(changes.filter_map(|(clip, changes)| Some((called(&clip)?, changes))));
    // The key `copy` has those of copies.
    let names = std::mem::take(&mut clips.names).into_iter();
    let name = |(clip, name)| Some((if let ClipId::Copy(_) = clip { clip } else { called(&clip)? }, name));
    clips.names = collect_map(names.filter_map(name));
    state
}

/// Finds the clips of a view that are still only called by a name, and makes the active model's clips those that the view edits.
/// What the model lacks keeps its name, since its file may be still to come. Returns whether the model's clips have changed.
pub fn resolve_clips(state: &mut ViewerState, library: &mut Library) -> bool {
    let Some(model) = library.active() else { return false };
    for copy in &mut state.character.edits.clips.copies {
        let found = copy.of.name().and_then(|name| clip_called(model, name));
        if let Some(original) = found.filter(|clip| !clip.is_copy()) {
            copy.of = original.id().clone();
        }
    }
    // Names come before what is called by them.
    resolve_keys(&mut state.character.edits.clips.names, model);
    let mut is_changed = library.edit_clips(&state.character.edits.clips);
    if let Some(model) = library.active() {
        resolve_references(state, model);
    }
    is_changed |= library.edit_clips(&state.character.edits.clips);
    is_changed
}

/// Finds the clips that a view refers to, once the model has its copies.
fn resolve_references(state: &mut ViewerState, model: &Model) {
    let resolve = |clip: &mut ClipId| {
        if clip.name().is_some() {
            *clip = resolved(model, clip.clone());
        }
    };
    let fade = state.character.playhead.fade.as_mut().map(|fade| &mut fade.clip);
    for choice in [Some(&mut state.character.playhead.clip), fade].into_iter().flatten() {
        if let ClipChoice::Clip(clip) = choice {
            resolve(clip);
        }
    }
    state.character.edits.layers.iter_mut().for_each(|over| resolve(&mut over.clip));
    resolve_keys(&mut state.character.edits.clips.changes, model);
}

/// Finds a clip that is still only called by a name.
pub(super) fn resolved(model: &Model, clip: ClipId) -> ClipId {
    let found = clip.name().and_then(|name| clip_called(model, name));
    found.map_or(clip, |found| found.id().clone())
}

fn resolve_keys<T>(map: &mut BTreeMap<ClipId, T>, model: &Model) {
    if map.keys().any(|clip| clip.name().is_some()) {
        *map = collect_map(std::mem::take(map).into_iter().map(|(clip, value)| (resolved(model, clip), value)));
    }
}
