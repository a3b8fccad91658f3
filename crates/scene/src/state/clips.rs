//! Edits of clips: their changes and names, and copies with changes of their own.

use gaitway_character::anim::{TimeRange, clip_time};
use gaitway_retarget::ClipChanges;

use super::apply::{one_line, set_clip};
use super::clip_names::look_up_clip;
use super::playhead::active_clip;
use super::{ClipChoice, Playhead, ViewerState};
use crate::library::{ClipCopy, ClipEdits, ClipId, Library, Model, ModelClip};

/// Drops edits and layers of clips whose motion was removed.
pub fn drop_orphaned_edits(state: &mut ViewerState, library: &Library) {
    let is_there = |clip: &ClipId| clip.motion().is_none_or(|motion| library.motion(motion).is_some());
    state.character.edits.clips.retain(is_there);
    let copies = &state.character.edits.clips.copies;
    state.character.edits.layers.retain(|over| match &over.clip {
        ClipId::Copy(id) => copies.iter().any(|copy| copy.id == *id),
        clip => is_there(clip),
    });
}

/// An edit of a clip. Numbers out of range are clamped.
#[derive(Debug, Clone, PartialEq)]
pub enum ClipEdit {
    /// Replaces its changes.
    Change(Box<ClipChanges>),
    /// Adds a copy that has these changes, whatever those of the clip, and plays it; ignored if there are
    /// [`ClipEdits::MAX_COPIES`]. A copy of a copy is one of the original.
    Copy(Box<ClipChanges>),
    /// Removes it, if it is a copy. If it is active, the original plays.
    RemoveCopy,
    /// Renames it, with a number if another clip or the rest pose has the name; an empty name restores the file's. Control
    /// characters are removed, and everything after [`MAX_NAME_CHARS`](super::MAX_NAME_CHARS).
    Rename(String),
}

/// Applies an edit. Clips that the model lacks are ignored.
pub(super) fn edit_clip(state: &mut ViewerState, model: Option<&Model>, clip: &ClipId, edit: ClipEdit) {
    let Some((model, clip)) = model.and_then(|model| Some((model, look_up_clip(model, clip)?))) else { return };
    match edit {
        ClipEdit::Change(changes) => set_changes(state, model, clip, changes.clamped()),
        ClipEdit::Copy(changes) => copy_clip(state, model, clip, changes.clamped()),
        ClipEdit::RemoveCopy => remove_copy(state, model, clip),
        ClipEdit::Rename(name) => rename(state, model, clip, &one_line(&name)),
    }
}

fn set_changes(state: &mut ViewerState, model: &Model, clip: &ModelClip, changes: ClipChanges) {
    if is_active(model, state, clip) {
        let before = state.character.edits.clips.changes_of(clip.id());
        follow_changes(state, clip, &before, &changes);
    }
    state.character.edits.clips.set_changes(clip.id().clone(), changes);
}

fn copy_clip(state: &mut ViewerState, model: &Model, clip: &ModelClip, changes: ClipChanges) {
    let Some(original) = model.clip(clip.original_id()) else { return };
    let edits = &mut state.character.edits.clips;
    if edits.copies.len() == ClipEdits::MAX_COPIES {
        return;
    }
    let is_free = |name: &String| {
        model.clips().titles().all(|title| title != name) && edits.names.values().all(|taken| taken != name)
    };
    let Some(name) = (1..).map(|part: u32| format!("{} part {part}", original.title())).find(is_free) else { return };
    let copy = edits.new_copy_id();
    edits.copies.push(ClipCopy { id: copy, of: original.id().clone() });
    edits.names.insert(ClipId::Copy(copy), name);
    edits.set_changes(ClipId::Copy(copy), changes);
    set_clip(state, Some(model), ClipChoice::Clip(ClipId::Copy(copy)));
}

/// Removes a copy and the layers that play it.
fn remove_copy(state: &mut ViewerState, model: &Model, copy: &ModelClip) {
    if !copy.is_copy() {
        return;
    }
    if is_active(model, state, copy) {
        set_clip(state, Some(model), ClipChoice::Clip(copy.original_id().clone()));
    }
    state.character.edits.layers.retain(|over| over.clip != *copy.id());
    state.character.edits.clips.remove_copy(copy.id());
}

fn rename(state: &mut ViewerState, model: &Model, clip: &ModelClip, name: &str) {
    let names = &mut state.character.edits.clips.names;
    let restores = name.is_empty() || (clip.is_renamed() && name == clip.unchanged().name());
    match (restores, clip.is_copy()) {
        // Copies have no other name.
        (true, true) => {}
        (true, false) => drop(names.remove(clip.id())),
        (false, _) if name == clip.title() => {}
        (false, _) => drop(names.insert(clip.id().clone(), model.clips().free_title(clip.id(), name))),
    }
}

/// Brings the edits of a view that replaces another one into their ranges.
pub(super) fn check(edits: &mut ClipEdits) {
    edits.copies.truncate(ClipEdits::MAX_COPIES);
    let copies: Vec<_> = edits.copies.iter().map(|copy| copy.id).collect();
    let is_there = |clip: &ClipId| !matches!(clip, ClipId::Copy(copy) if !copies.contains(copy));
    // Other keys of the link call copies by their names, so those stay as they are.
    for (_, name) in edits.names.iter_mut().filter(|(clip, _)| !matches!(clip, ClipId::Copy(_))) {
        *name = one_line(name);
    }
    edits.names.retain(|clip, name| !name.is_empty() && is_there(clip));
    let changes = std::mem::take(&mut edits.changes).into_iter();
    let changes = changes.map(|(clip, changes)| (clip, changes.clamped()));
    edits.changes = changes.filter(|(clip, changes)| !changes.is_none() && is_there(clip)).collect();
}

fn is_active(model: &Model, state: &ViewerState, clip: &ModelClip) -> bool {
    active_clip(model, state).is_some_and(|active| active.id() == clip.id())
}

/// Keeps the pose and the range of the active clip, whose times stretch and turn round. A trimmed clip starts over.
fn follow_changes(state: &mut ViewerState, clip: &ModelClip, before: &ClipChanges, changes: &ClipChanges) {
    let mode = state.playback.loop_mode;
    let Playhead { range, time_secs, .. } = &mut state.character.playhead;
    if changes.trim != before.trim {
        (*range, *time_secs) = (None, 0.0);
        return;
    }
    let duration_secs = f64::from(clip.unchanged().duration_secs());
    let whole = TimeRange { start_secs: 0.0, end_secs: duration_secs };
    let kept = before.trim.map_or(whole, |trim| TimeRange { end_secs: trim.end_secs.min(duration_secs), ..trim });
    let end_secs = kept.length_secs() / before.speed;
    let turns = changes.reverse != before.reverse;
    if turns {
        // A looping clip runs on beyond its range.
        *time_secs = clip_time(*time_secs, range.unwrap_or(TimeRange { start_secs: 0.0, end_secs }), mode);
    }
    let stretch = before.speed / changes.speed;
    let follow = |secs: f64| stretch * if turns { end_secs - secs } else { secs };
    *time_secs = follow(*time_secs);
    *range = range.map(|TimeRange { start_secs, end_secs }| {
        let [from, to] = if turns { [end_secs, start_secs] } else { [start_secs, end_secs] };
        TimeRange { start_secs: follow(from), end_secs: follow(to) }
    });
}

/// Copies what undo covers from another state. Pose and range follow the changes of the active clip, and a range that a trim
/// dropped returns.
pub(super) fn restore_edits(state: &mut ViewerState, model: Option<&Model>, from: &ViewerState) {
    let active = model.and_then(|model| Some((model, active_clip(model, state)?)));
    let changed = |state: &ViewerState| active.map(|(_, clip)| state.character.edits.clips.changes_of(clip.id()));
    let before = changed(state);
    let was_copy = is_copy_active(state);
    // A copy that was removed while it played.
    let returns = is_copy_active(from) && !is_copy_of(state, &from.character.playhead.clip);
    state.restore_undoable(from);
    if returns || (was_copy && !is_copy_active(state)) {
        state.character.playhead.clone_from(&from.character.playhead);
        return;
    }
    if let (Some((model, clip)), Some(before), Some(changes)) = (active, before, changed(state)) {
        follow_changes(state, clip, &before, &changes);
        if changes.trim != before.trim && is_active(model, from, clip) {
            // Both belong to the clip as it is again.
            let Playhead { range, time_secs, .. } = from.character.playhead;
            (state.character.playhead.range, state.character.playhead.time_secs) = (range, time_secs);
        }
    }
}

fn is_copy_active(state: &ViewerState) -> bool {
    is_copy_of(state, &state.character.playhead.clip)
}

/// Whether the view has this copy of a clip.
fn is_copy_of(state: &ViewerState, choice: &ClipChoice) -> bool {
    let ClipChoice::Clip(ClipId::Copy(copy)) = choice else { return false };
    state.character.edits.clips.copies.iter().any(|known| known.id == *copy)
}
