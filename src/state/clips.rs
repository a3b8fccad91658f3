//! Edits of clips: their changes, and copies with changes of their own.

use std::collections::{BTreeMap, BTreeSet};

use super::apply::set_clip;
use super::layers::clip_of_layer;
use super::playhead::{active_clip, choice_of_clip, clip_called, name_of_clip};
use super::{ClipChoice, ClipCopy, Edits, Playhead, ViewerState};
use crate::anim::{Clip, TimeRange, clip_time};
use crate::library::Model;
use crate::retarget::ClipChanges;

/// Returns the copies of the model's clips, each with its name and the index of its original; those of clips that the model lacks
/// are skipped.
pub fn clip_copies(model: &Model, state: &ViewerState) -> Vec<(String, usize)> {
    let original = |name: &str| clip_called(model, name).filter(|&clip| !model.is_copy(clip));
    state.edits.copies.iter().filter_map(|copy| Some((copy.name.clone(), original(&copy.of)?))).collect()
}

/// Returns the changes of the model's clips by index; names that the model lacks are skipped.
pub fn clip_changes(model: &Model, state: &ViewerState) -> BTreeMap<usize, ClipChanges> {
    let clips = state.edits.clips.iter();
    clips.filter_map(|(name, changes)| Some((clip_called(model, name)?, changes.clone()))).collect()
}

/// Returns the changes of one clip.
pub fn changes_of(model: &Model, state: &ViewerState, clip: usize) -> ClipChanges {
    let mut clips = state.edits.clips.iter().rev();
    clips
        .find(|(name, _)| clip_called(model, name) == Some(clip))
        .map(|(_, changes)| changes.clone())
        .unwrap_or_default()
}

/// Replaces the changes of a clip.
pub(super) fn set_changes(state: &mut ViewerState, model: Option<&Model>, clip: usize, changes: ClipChanges) {
    let Some(model) = model.filter(|model| clip < model.clip_count()) else { return };
    let name = name_of_clip(model, clip);
    let changes = changes.clamped();
    let before = changes_of(model, state, clip);
    // A link may name the clip by its index.
    state.edits.clips.retain(|name, _| clip_called(model, name) != Some(clip));
    if active_clip(model, state) == Some(clip) {
        follow_changes(state, model.unchanged_clip(clip), &before, &changes);
    }
    insert_changes(state, name, changes);
}

/// Adds a copy of a clip, unless there are [`Edits::MAX_COPIES`], and plays it.
pub(super) fn copy_clip(state: &mut ViewerState, model: Option<&Model>, clip: usize, changes: ClipChanges) {
    let Some(model) = model.filter(|model| clip < model.clip_count()) else { return };
    let original = model.original(clip);
    if state.edits.copies.len() == Edits::MAX_COPIES {
        return;
    }
    let titles = model.clip_titles();
    let is_free = |name: &String| !titles.contains(name) && !state.edits.has_copy(name);
    let Some(name) = (1..).map(|part: u32| format!("{} part {part}", titles[original])).find(is_free) else { return };
    state.edits.copies.push(ClipCopy { name: name.clone(), of: name_of_clip(model, original) });
    insert_changes(state, name.clone(), changes.clamped());
    set_clip(state, Some(model), ClipChoice::Named(name));
}

/// Removes a copy and the layers that play it; the original plays in its place.
pub(super) fn remove_copy(state: &mut ViewerState, model: Option<&Model>, clip: usize) {
    let Some(model) = model.filter(|model| model.is_copy(clip)) else { return };
    let Some(name) = model.unchanged_clip(clip).map(Clip::name) else { return };
    if active_clip(model, state) == Some(clip) {
        set_clip(state, Some(model), choice_of_clip(model, model.original(clip)));
    }
    state.edits.layers.retain(|layer| clip_of_layer(model, layer) != Some(clip));
    state.edits.copies.retain(|copy| copy.name != name);
    state.edits.clips.retain(|changed, _| clip_called(model, changed) != Some(clip));
}

/// Returns the names by which edits refer to clips.
pub fn edited_clips(edits: &Edits) -> BTreeSet<&str> {
    let originals = edits.copies.iter().map(|copy| &copy.of);
    let layers = edits.layers.iter().map(|layer| &layer.clip);
    edits.clips.keys().chain(originals).chain(layers).map(String::as_str).collect()
}

/// Makes edits refer to clips by new names, as far as `renamed` has them; `None` drops the edits of a clip, with its copies.
pub fn rename_clips(edits: &mut Edits, mut renamed: BTreeMap<String, Option<String>>) {
    for copy in &edits.copies {
        if renamed.get(&copy.of) == Some(&None) {
            renamed.insert(copy.name.clone(), None);
        }
    }
    let new_name = |name: &str| renamed.get(name).map_or_else(|| Some(name.to_owned()), Clone::clone);
    let rename = |name: &mut String| new_name(name).map(|new| *name = new).is_some();
    edits.copies.retain_mut(|copy| rename(&mut copy.of));
    edits.layers.retain_mut(|layer| rename(&mut layer.clip));
    let clips = std::mem::take(&mut edits.clips).into_iter();
    edits.clips = clips.filter_map(|(name, changes)| Some((new_name(&name)?, changes))).collect();
}

/// Keeps the pose and the range of the active clip, whose times stretch and turn round. A trimmed clip starts over.
fn follow_changes(state: &mut ViewerState, unchanged: Option<&Clip>, before: &ClipChanges, changes: &ClipChanges) {
    let mode = state.playback.loop_mode;
    let Playhead { range, time_secs, .. } = &mut state.playhead;
    if changes.trim != before.trim {
        (*range, *time_secs) = (None, 0.0);
        return;
    }
    let duration_secs = unchanged.map_or(0.0, |clip| f64::from(clip.duration_secs()));
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
    let changed = |state: &ViewerState| active.map(|(model, clip)| changes_of(model, state, clip));
    let before = changed(state);
    let was_copy = is_copy_active(state);
    // A copy that was removed while it played.
    let returns = is_copy_active(from) && !has_copy_of(state, &from.playhead.clip);
    state.restore_undoable(from);
    if returns || (was_copy && !is_copy_active(state)) {
        state.playhead.clone_from(&from.playhead);
        return;
    }
    if let (Some((model, clip)), Some(before), Some(changes)) = (active, before, changed(state)) {
        follow_changes(state, model.unchanged_clip(clip), &before, &changes);
        if changes.trim != before.trim && active_clip(model, from) == Some(clip) {
            state.playhead.range = from.playhead.range;
        }
    }
}

fn is_copy_active(state: &ViewerState) -> bool {
    has_copy_of(state, &state.playhead.clip)
}

fn has_copy_of(state: &ViewerState, clip: &ClipChoice) -> bool {
    matches!(clip, ClipChoice::Named(name) if state.edits.has_copy(name))
}

/// Sets the changes of a name, whether the model has such a clip or not.
pub(super) fn insert_changes(state: &mut ViewerState, name: String, changes: ClipChanges) {
    if changes.is_none() {
        state.edits.clips.remove(&name);
    } else {
        state.edits.clips.insert(name, changes);
    }
}
