//! The key of pins: `pin=JOINT:GOAL`, one for each. A goal is `at:X,Y,Z`, `joint:OTHER,X,Y,Z`, `look:X,Y,Z` or `look:camera`,
//! and `@START,END,BLEND` after it says when, in seconds.

use gaitway_retarget::{Pin, PinGoal, PinTimes};
use glam::Vec3;

use super::values::finite;
use super::{Read, Written};
use crate::state::ViewerState;

pub(super) const EXPECTED: &str =
    "a joint and where it goes: 9:at:0.2,1.1,0.3@1,2,0.25, 9:joint:4,0,0,0, 6:look:0,1,5 or 6:look:camera";

pub(super) fn read(state: &mut ViewerState, text: &str) -> Read {
    let read = |text: &str| {
        let (joint, goal) = text.split_once(':')?;
        Some((joint.trim().parse().ok()?, read_pin(goal, |other| other.trim().parse().ok())?))
    };
    match read(text) {
        Some((joint, pin)) => {
            state.character.edits.pins.insert(joint, pin);
            Read::Done
        }
        None => Read::Bad(EXPECTED),
    }
}

pub(super) fn write(state: &ViewerState) -> Written {
    Written::List(state.character.edits.pins.iter().map(|(joint, pin)| format!("{joint}:{}", pin_text(pin))).collect())
}

pub(super) fn reset(state: &mut ViewerState) {
    state.character.edits.pins.clear();
}

fn pin_text(pin: &Pin) -> String {
    let mut text = match pin.goal {
        PinGoal::Point(at) => format!("at:{},{},{}", at.x, at.y, at.z),
        PinGoal::Joint(other, at) => format!("joint:{other},{},{},{}", at.x, at.y, at.z),
        PinGoal::Look(at) => format!("look:{},{},{}", at.x, at.y, at.z),
        PinGoal::Camera => "look:camera".to_owned(),
    };
    if let Some(PinTimes { start_secs, end_secs, blend_secs }) = pin.times {
        text += &format!("@{start_secs},{end_secs},{blend_secs}");
    }
    text
}

/// Reads a goal and its times. `joint` finds the joint that another is held at; without an offset it is held at its origin.
pub fn read_pin(text: &str, joint: impl FnOnce(&str) -> Option<usize>) -> Option<Pin> {
    let (goal, times) = text.rsplit_once('@').map_or((text, None), |(goal, times)| (goal, Some(times)));
    let goal = match goal.split_once(':')? {
        ("at", at) => PinGoal::Point(point(at)?),
        ("look", "camera") => PinGoal::Camera,
        ("look", at) => PinGoal::Look(point(at)?),
        ("joint", other) => {
            let offset =
                other.rmatch_indices(',').nth(2).and_then(|(comma, _)| Some((comma, point(&other[comma + 1..])?)));
            let (other, at) = offset.map_or((other, Vec3::ZERO), |(comma, at)| (&other[..comma], at));
            PinGoal::Joint(joint(other)?, at)
        }
        _ => return None,
    };
    let Some(times) = times else { return Some(Pin { goal, times: None }) };
    let &[start_secs, end_secs, blend_secs] = &times.split(',').map(finite).collect::<Option<Vec<f64>>>()?[..] else {
        return None;
    };
    Some(Pin { goal, times: Some(PinTimes { start_secs, end_secs, blend_secs }) })
}

fn point(text: &str) -> Option<Vec3> {
    let numbers = text.split(',').map(finite).collect::<Option<Vec<f32>>>()?;
    <[f32; 3]>::try_from(numbers).ok().map(Vec3::from_array)
}
