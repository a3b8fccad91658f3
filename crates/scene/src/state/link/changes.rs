//! The keys of edited clips: `mirror=CLIP`, `change=CLIP:trim:0.5:1.5,reverse` and `rename=CLIP:NAME`, one each per clip, and
//! `copy=NAME:CLIP`. Mirroring comes first whatever else changes, so it needs no place in the list. Names are escaped as joint
//! names are.

use gaitway_character::anim::TimeRange;
use gaitway_retarget::ClipChanges;

use super::values::{escaped_name, finite, unescaped_name};
use super::{Read, Written};
use crate::library::{ClipCopy, ClipEdits, ClipId};
use crate::state::ViewerState;

pub(super) const MIRROR: &str = "a clip's name or index";
pub(super) const COPY: &str =
    "a new name and the clip that it is a copy of: Walk part 1:Walk; up to 100, each with its own name";
pub(super) const RENAME: &str = "a clip and its new name: Walk:Stroll; up to 80 characters";
pub(super) const CHANGE: &str = "a clip and its changes: Walk:trim:0.5:1.5,reverse,speed:2,loop:0.2,offset:1:0,turn:90; the speed is from 0.1 to 10";
const TRIM: &str = "trim:START:END in seconds, the end after the start";

pub(super) fn read_mirror(state: &mut ViewerState, text: &str) -> Read {
    match read_clip(text) {
        Some(clip) => {
            state.character.edits.clips.changes.entry(clip).or_default().mirror = true;
            Read::Done
        }
        None => Read::Bad(MIRROR),
    }
}

pub(super) fn write_mirror(state: &ViewerState) -> Written {
    let mirrored = state.character.edits.clips.changes.iter().filter(|(_, changes)| changes.mirror);
    Written::List(mirrored.map(|(clip, _)| clip_text(clip)).collect())
}

pub(super) fn reset_mirror(state: &mut ViewerState) {
    reset(state, |changes| changes.mirror = false);
}

pub(super) fn read_copy(state: &mut ViewerState, text: &str) -> Read {
    let names = text.split_once(':').and_then(|(name, of)| Some((clip_name(name)?, read_clip(of)?)));
    let edits = &mut state.character.edits.clips;
    match names {
        Some((name, of))
            if edits.copies.len() < ClipEdits::MAX_COPIES && !copy_names(edits).any(|taken| *taken == name) =>
        {
            let id = edits.new_copy_id();
            edits.copies.push(ClipCopy { id, of });
            edits.names.insert(ClipId::Copy(id), name);
            Read::Done
        }
        _ => Read::Bad(COPY),
    }
}

fn copy_names(edits: &ClipEdits) -> impl Iterator<Item = &String> {
    edits.copies.iter().filter_map(|copy| edits.names.get(&ClipId::Copy(copy.id)))
}

pub(super) fn write_copy(state: &ViewerState) -> Written {
    let ClipEdits { copies, names, .. } = &state.character.edits.clips;
    let text = |copy: &ClipCopy| {
        let name = names.get(&ClipId::Copy(copy.id))?;
        Some(format!("{}:{}", escaped_name(name), clip_text(&copy.of)))
    };
    Written::List(copies.iter().filter_map(text).collect())
}

pub(super) fn reset_copy(state: &mut ViewerState) {
    let edits = &mut state.character.edits.clips;
    edits.copies.clear();
    edits.names.retain(|clip, _| !matches!(clip, ClipId::Copy(_)));
}

pub(super) fn read_rename(state: &mut ViewerState, text: &str) -> Read {
    match text.split_once(':').and_then(|(clip, name)| Some((read_clip(clip)?, clip_name(name)?))) {
        Some((clip, name)) => {
            state.character.edits.clips.names.insert(clip, name);
            Read::Done
        }
        None => Read::Bad(RENAME),
    }
}

pub(super) fn write_rename(state: &ViewerState) -> Written {
    let renamed = state.character.edits.clips.names.iter().filter(|(clip, _)| !matches!(clip, ClipId::Copy(_)));
    Written::List(renamed.map(|(clip, name)| format!("{}:{}", clip_text(clip), escaped_name(name))).collect())
}

pub(super) fn reset_rename(state: &mut ViewerState) {
    state.character.edits.clips.names.retain(|clip, _| matches!(clip, ClipId::Copy(_)));
}

pub(super) fn read_change(state: &mut ViewerState, text: &str) -> Read {
    match read(text) {
        Ok((clip, changes)) => {
            let clips = &mut state.character.edits.clips;
            let mirror = clips.changes_of(&clip).mirror;
            clips.set_changes(clip, ClipChanges { mirror, ..changes });
            Read::Done
        }
        Err(expected) => Read::Bad(expected),
    }
}

pub(super) fn write_change(state: &ViewerState) -> Written {
    let texts = state.character.edits.clips.changes.iter().filter_map(|(clip, changes)| {
        let text = words(changes).join(",");
        (!text.is_empty()).then(|| format!("{}:{text}", clip_text(clip)))
    });
    Written::List(texts.collect())
}

pub(super) fn reset_change(state: &mut ViewerState) {
    reset(state, |changes| *changes = ClipChanges { mirror: changes.mirror, ..ClipChanges::default() });
}

fn reset(state: &mut ViewerState, one: fn(&mut ClipChanges)) {
    let changes = &mut state.character.edits.clips.changes;
    changes.values_mut().for_each(one);
    changes.retain(|_, changes| !changes.is_none());
}

/// Writes what a link calls a clip.
pub(super) fn clip_text(clip: &ClipId) -> String {
    escaped_name(&clip.to_string())
}

/// Reads what a link calls a clip.
pub(super) fn read_clip(text: &str) -> Option<ClipId> {
    clip_name(text).map(|name| ClipId::called(&name))
}

/// Reads a name, which isn't empty.
fn clip_name(text: &str) -> Option<String> {
    unescaped_name(text).filter(|name| !name.is_empty())
}

fn words(changes: &ClipChanges) -> Vec<String> {
    let mut words = Vec::new();
    if let Some(TimeRange { start_secs, end_secs }) = changes.trim {
        words.push(format!("trim:{start_secs}:{end_secs}"));
    }
    if changes.reverse {
        words.push("reverse".to_owned());
    }
    if changes.speed != 1.0 {
        words.push(format!("speed:{}", changes.speed));
    }
    if let Some(secs) = changes.loop_secs {
        words.push(format!("loop:{secs}"));
    }
    if changes.offset != [0.0; 2] {
        let [x, z] = changes.offset;
        words.push(format!("offset:{x}:{z}"));
    }
    if changes.turn_degrees != 0.0 {
        words.push(format!("turn:{}", changes.turn_degrees));
    }
    words
}

/// The error is what was expected.
fn read(text: &str) -> Result<(ClipId, ClipChanges), &'static str> {
    let (name, words) = text.split_once(':').ok_or(CHANGE)?;
    let mut changes = ClipChanges::default();
    for word in words.split(',') {
        let mut parts = word.split(':').map(str::trim);
        let kind = parts.next().unwrap_or_default();
        let numbers = parts.map(finite).collect::<Option<Vec<f64>>>().ok_or(CHANGE)?;
        match (kind, &numbers[..]) {
            ("trim", &[start_secs, end_secs]) => {
                changes.trim = Some(TimeRange { start_secs, end_secs });
                // Nothing would be left of the clip.
                if changes.clone().clamped().trim.is_none() {
                    return Err(TRIM);
                }
            }
            ("reverse", []) => changes.reverse = true,
            ("speed", &[speed]) => changes.speed = speed,
            ("loop", &[secs]) => changes.loop_secs = Some(secs),
            ("offset", &[x, z]) => changes.offset = [x, z],
            ("turn", &[degrees]) => changes.turn_degrees = degrees,
            _ => return Err(CHANGE),
        }
    }
    Ok((read_clip(name).ok_or(CHANGE)?, changes))
}
