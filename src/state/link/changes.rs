//! The keys of changed clips: `mirror=CLIP` and `change=CLIP:trim:0.5:1.5,reverse`, one each per clip, and `copy=NAME:CLIP`.
//! Mirroring comes first whatever else changes, so it needs no place in the list. Names are escaped as joint names are.

use super::values::{escaped_name, finite, unescaped_name};
use super::{Read, Written};
use crate::anim::TimeRange;
use crate::retarget::ClipChanges;
use crate::state::{ClipCopy, Edits, ViewerState};

pub(super) const MIRROR: &str = "a clip's name or index";
pub(super) const COPY: &str =
    "a new name and the clip that it is a copy of: Walk part 1:Walk; up to 100, each with its own name";
pub(super) const CHANGE: &str = "a clip and its changes: Walk:trim:0.5:1.5,reverse,speed:2,loop:0.2,offset:1:0,turn:90; the speed is from 0.1 to 10";
const TRIM: &str = "trim:START:END in seconds, the end after the start";

pub(super) fn read_mirror(state: &mut ViewerState, text: &str) -> Read {
    match clip_name(text) {
        Some(name) => {
            state.edits.clips.entry(name).or_default().mirror = true;
            Read::Done
        }
        None => Read::Bad(MIRROR),
    }
}

pub(super) fn write_mirror(state: &ViewerState) -> Written {
    let mirrored = state.edits.clips.iter().filter(|(_, changes)| changes.mirror);
    Written::List(mirrored.map(|(name, _)| escaped_name(name)).collect())
}

pub(super) fn reset_mirror(state: &mut ViewerState) {
    reset(state, |changes| changes.mirror = false);
}

pub(super) fn read_copy(state: &mut ViewerState, text: &str) -> Read {
    let names = text.split_once(':').and_then(|(name, of)| Some((clip_name(name)?, clip_name(of)?)));
    let copies = &mut state.edits.copies;
    match names {
        Some((name, of)) if copies.len() < Edits::MAX_COPIES && copies.iter().all(|copy| copy.name != name) => {
            copies.push(ClipCopy { name, of });
            Read::Done
        }
        _ => Read::Bad(COPY),
    }
}

pub(super) fn write_copy(state: &ViewerState) -> Written {
    let copies = state.edits.copies.iter();
    Written::List(copies.map(|ClipCopy { name, of }| format!("{}:{}", escaped_name(name), escaped_name(of))).collect())
}

pub(super) fn read_change(state: &mut ViewerState, text: &str) -> Read {
    match read(text) {
        Ok((name, changes)) => {
            let clips = &mut state.edits.clips;
            let mirror = clips.get(&name).is_some_and(|before| before.mirror);
            clips.insert(name, ClipChanges { mirror, ..changes });
            clips.retain(|_, changes| !changes.is_none());
            Read::Done
        }
        Err(expected) => Read::Bad(expected),
    }
}

pub(super) fn write_change(state: &ViewerState) -> Written {
    let texts = state.edits.clips.iter().filter_map(|(name, changes)| {
        let text = words(changes).join(",");
        (!text.is_empty()).then(|| format!("{}:{text}", escaped_name(name)))
    });
    Written::List(texts.collect())
}

pub(super) fn reset_change(state: &mut ViewerState) {
    reset(state, |changes| *changes = ClipChanges { mirror: changes.mirror, ..ClipChanges::default() });
}

fn reset(state: &mut ViewerState, one: fn(&mut ClipChanges)) {
    state.edits.clips.values_mut().for_each(one);
    state.edits.clips.retain(|_, changes| !changes.is_none());
}

/// Reads the name or index of a clip.
pub(super) fn clip_name(text: &str) -> Option<String> {
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
fn read(text: &str) -> Result<(String, ClipChanges), &'static str> {
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
    Ok((clip_name(name).ok_or(CHANGE)?, changes))
}
