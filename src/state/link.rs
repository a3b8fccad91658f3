//! The text form of a view state: `key=value` joined by `&` after the `#`, and the same keys as a JSON object. Old links
//! keep working: `v=1` fixes the defaults below, keys this version does not know are kept and written back.

mod files;
mod values;

use percent_encoding::{AsciiSet, CONTROLS, percent_decode_str, utf8_percent_encode};
use serde_json::{Map, Value, json};

pub use self::files::{
    LinkRole, LinkedFile, MEMBER_SEPARATOR, embedded_link, link_with_files, link_without_missing, linked_files,
    most_similar_link, public_link, shown_files,
};
use self::values::*;
use super::{Background, ClipChoice, ViewerState};

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LinkError {
    #[error("{key}={value}: expected {expected}")]
    BadValue { key: String, value: String, expected: &'static str },
    #[error("{key}: this version does not know it; it is kept in the link")]
    UnknownKey { key: String },
    #[error("show={value}: this version does not know it; it is kept in the link")]
    UnknownShow { value: String },
}

/// Keys of the link in the order they are written.
const KEYS: [&str; 30] = [
    "model",
    "motion",
    "map",
    "unmapped",
    "root",
    "feet",
    "scene",
    "clip",
    "t",
    "fade",
    "play",
    "speed",
    "loop",
    "range",
    "skinning",
    "morph",
    "pose",
    "names",
    "show",
    "joint",
    "vertex",
    "camera",
    "fov",
    "follow",
    "turntable",
    "up",
    "exposure",
    "environment",
    "background",
    "embed",
];

/// Keys that may stand in a link several times.
const REPEATABLE: [&str; 3] = ["model", "motion", "map"];

/// Kept readable: `/`, `:`, `,` and the like need no escape in a fragment.
const ESCAPED: &AsciiSet =
    &CONTROLS.add(b' ').add(b'"').add(b'#').add(b'%').add(b'&').add(b'+').add(b'<').add(b'=').add(b'>').add(b'`');

/// What stands between names, and what escapes.
const IN_NAMES: &AsciiSet = &CONTROLS.add(b'%').add(b',').add(b':');

/// The part after `#`; only what differs from the default is written.
pub fn to_link(state: &ViewerState) -> String {
    let default = ViewerState::default();
    let mut text = "v=1".to_owned();
    let mut push = |key: &str, value: &str| {
        text.push('&');
        text.extend(utf8_percent_encode(key, ESCAPED));
        text.push('=');
        text.extend(utf8_percent_encode(value, ESCAPED));
    };
    for key in KEYS {
        if let Some(values) = values_of(state, key) {
            values.iter().for_each(|value| push(key, value));
        } else if key == "clip" && state.clip == ClipChoice::First {
            // Absent means the first; empty means the rest pose.
        } else {
            let value = value_of(state, key);
            if value != value_of(&default, key) || key == "clip" {
                push(key, &value);
            }
        }
    }
    for (key, values) in &state.unknown {
        if key != "show" {
            values.split('\n').for_each(|value| push(key, value));
        }
    }
    text
}

/// Reads a link's part after `#` (a leading `#` is fine). Bad values are reported and skipped, unknown keys kept.
pub fn from_link(fragment: &str) -> (ViewerState, Vec<LinkError>) {
    let mut state = ViewerState::default();
    let mut errors = Vec::new();
    for pair in fragment.trim_start_matches('#').split('&').filter(|pair| !pair.is_empty()) {
        let (key, value) = pair.split_once('=').unwrap_or((pair, ""));
        let decode = |text: &str| percent_decode_str(text).decode_utf8_lossy().into_owned();
        set_value(&mut state, &decode(key), &decode(value), &mut errors);
    }
    (state, errors)
}

/// All keys of the link with their values, as plain JSON: flags are booleans, numbers numbers, what is not set null.
pub fn to_object(state: &ViewerState) -> Value {
    let mut object = Map::new();
    object.insert("v".to_owned(), json!(1));
    for key in KEYS {
        let text = value_of(state, key);
        let value = match key {
            _ if values_of(state, key).is_some() => json!(values_of(state, key)),
            "unmapped" if state.unmapped.is_none() => Value::Null,
            "root" if state.root.is_none() => Value::Null,
            "feet" if state.feet.is_none() => Value::Null,
            "clip" if state.clip == ClipChoice::First => Value::Null,
            "play" | "follow" | "embed" => json!(text == "1"),
            "t" => json!(state.time_secs),
            "speed" => json!(state.speed),
            "fov" => json!(state.fov_degrees),
            "turntable" => json!(state.turntable),
            "exposure" => json!(state.exposure),
            "environment" => json!(state.environment_degrees),
            "scene" => json!(state.scene),
            "joint" => json!(state.joint),
            "vertex" if state.vertex.is_none() => Value::Null,
            "range" if state.range.is_none() => Value::Null,
            "fade" if state.fade.is_none() => Value::Null,
            _ => Value::String(text),
        };
        object.insert(key.to_owned(), value);
    }
    for (key, values) in state.unknown.iter().filter(|(key, _)| *key != "show") {
        let mut values: Vec<&str> = values.split('\n').collect();
        let value = if values.len() == 1 { json!(values.remove(0)) } else { json!(values) };
        object.insert(key.clone(), value);
    }
    Value::Object(object)
}

/// A state with some keys of the link set anew; null sets a key back to its default. Bad values are reported and skipped.
pub fn from_object(base: &ViewerState, partial: &Value) -> (ViewerState, Vec<LinkError>) {
    let mut state = base.clone();
    let mut errors = Vec::new();
    let Value::Object(partial) = partial else {
        let expected = "an object with keys of the link";
        errors.push(LinkError::BadValue { key: "state".to_owned(), value: partial.to_string(), expected });
        return (state, errors);
    };
    for (key, value) in partial {
        let repeatable = REPEATABLE.contains(&key.as_str()) || !(KEYS.contains(&key.as_str()) || key == "v");
        let texts = match value {
            Value::Array(values) if repeatable => values.iter().map(plain_text).collect(),
            Value::Array(values) => vec![values.iter().map(plain_text).collect::<Vec<_>>().join(",")],
            Value::Null => Vec::new(),
            value => vec![plain_text(value)],
        };
        if repeatable {
            reset(&mut state, key);
            state.unknown.remove(key);
        }
        if texts.is_empty() {
            reset(&mut state, key);
        }
        for text in texts {
            set_value(&mut state, key, &text, &mut errors);
        }
    }
    (state, errors)
}

fn plain_text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Bool(flag) => flag_text(*flag).to_owned(),
        value => value.to_string(),
    }
}

/// Back to the default of one key.
fn reset(state: &mut ViewerState, key: &str) {
    match key {
        "clip" => state.clip = ClipChoice::First,
        "scene" => state.scene = None,
        "joint" => state.joint = None,
        "vertex" => state.vertex = None,
        "range" => state.range = None,
        "fade" => state.fade = None,
        "model" => state.model.clear(),
        "motion" => state.motion.clear(),
        "map" => state.map.clear(),
        "unmapped" => state.unmapped = None,
        "root" => state.root = None,
        "feet" => state.feet = None,
        key if KEYS.contains(&key) => set_value(state, key, &value_of(&ViewerState::default(), key), &mut Vec::new()),
        _ => {}
    }
}

/// The values of a key that may have several; none for any other key.
fn values_of(state: &ViewerState, key: &str) -> Option<Vec<String>> {
    match key {
        "model" => Some(state.model.clone()),
        "motion" => Some(state.motion.clone()),
        "map" => Some(state.map.iter().map(map_text).collect()),
        _ => None,
    }
}

fn value_of(state: &ViewerState, key: &str) -> String {
    let number = |value: Option<usize>| value.map_or(String::new(), |value| value.to_string());
    match key {
        "scene" => number(state.scene),
        "unmapped" => state.unmapped.as_ref().map_or(String::new(), unmapped_text),
        "root" => state.root.as_ref().map_or(String::new(), root_text),
        "feet" => state.feet.map_or(String::new(), |feet| word_of(&FEET, &feet)),
        "clip" => match &state.clip {
            ClipChoice::Named(name) => name.clone(),
            ClipChoice::First | ClipChoice::RestPose => String::new(),
        },
        "t" => state.time_secs.to_string(),
        "fade" => state.fade.as_ref().map_or(String::new(), fade_text),
        "play" => flag_text(state.playing).to_owned(),
        "speed" => state.speed.to_string(),
        "loop" => word_of(&LOOP_MODES, &state.loop_mode),
        "range" => state.range.map_or(String::new(), |range| format!("{},{}", range.start_secs, range.end_secs)),
        "skinning" => word_of(&SKINNING_MODES, &state.skinning),
        "morph" => joined(state.morph.iter().map(|(index, weight)| format!("{index}:{weight}"))),
        "pose" => joined(state.pose.iter().map(|(joint, [x, y, z])| format!("{joint}:{x}:{y}:{z}"))),
        "names" => {
            joined(state.names.iter().map(|(joint, name)| format!("{joint}:{}", utf8_percent_encode(name, IN_NAMES))))
        }
        "show" => show_text(state),
        "joint" => number(state.joint),
        "vertex" => state
            .vertex
            .map_or(String::new(), |choice| format!("{}:{}:{}", choice.instance, choice.primitive, choice.vertex)),
        "camera" => camera_text(&state.camera),
        "fov" => state.fov_degrees.to_string(),
        "follow" => flag_text(state.follow).to_owned(),
        "turntable" => state.turntable.to_string(),
        "up" => word_of(&UP_AXES, &state.up),
        "exposure" => state.exposure.to_string(),
        "environment" => state.environment_degrees.to_string(),
        "background" => match state.background {
            Background::Studio => "studio".to_owned(),
            Background::Transparent => "transparent".to_owned(),
            Background::Color([red, green, blue]) => format!("{red:02x}{green:02x}{blue:02x}"),
        },
        "embed" => flag_text(state.embed).to_owned(),
        _ => String::new(),
    }
}

fn set_value(state: &mut ViewerState, key: &str, value: &str, errors: &mut Vec<LinkError>) {
    let expected = match read_value(state, key, value) {
        Read::Done => return,
        Read::Bad(expected) => expected,
        Read::Unknown => {
            errors.push(LinkError::UnknownKey { key: key.to_owned() });
            let kept = state.unknown.entry(key.to_owned());
            kept.and_modify(|kept| *kept = format!("{kept}\n{value}")).or_insert_with(|| value.to_owned());
            return;
        }
        Read::UnknownShow(words) => {
            errors.extend(words.iter().map(|word| LinkError::UnknownShow { value: word.clone() }));
            state.unknown.insert("show".to_owned(), words.join(","));
            return;
        }
    };
    errors.push(LinkError::BadValue { key: key.to_owned(), value: value.to_owned(), expected });
}

enum Read {
    Done,
    /// What was expected.
    Bad(&'static str),
    Unknown,
    /// Words of `show` that are not known; the others are set.
    UnknownShow(Vec<String>),
}

fn read_value(state: &mut ViewerState, key: &str, value: &str) -> Read {
    match key {
        "v" => return if value == "1" { Read::Done } else { Read::Bad("1, the only version there is") },
        "model" => state.model.push(with_current_member(value)),
        "motion" => state.motion.push(value.to_owned()),
        "map" => match read_map(value) {
            Some(map) => state.map.push(map),
            None => return Read::Bad("an address, what a copied link has here, or a joint map in JSON"),
        },
        "unmapped" => {
            let unmapped = read_unmapped(value).map(Some);
            return put(&mut state.unmapped, unmapped, "rest, clip:CLIP or first-key:CLIP");
        }
        "root" => {
            let expected = "horizontal:, vertical: or yaw: with keep, in-place or freeze, and extract";
            return put(&mut state.root, read_root(value).map(Some), expected);
        }
        "feet" => return put(&mut state.feet, from_word(&FEET, value).map(Some), "off or plant"),
        "clip" if value.is_empty() => state.clip = ClipChoice::RestPose,
        "clip" => state.clip = ClipChoice::Named(value.to_owned()),
        "scene" => return put(&mut state.scene, optional(value), "a scene's index"),
        "joint" => return put(&mut state.joint, optional(value), "a joint's number in the file"),
        "vertex" if value.is_empty() => state.vertex = None,
        "vertex" => return put(&mut state.vertex, read_vertex(value).map(Some), "INSTANCE:PIECE:VERTEX, from 0"),
        "t" => return put(&mut state.time_secs, finite(value), "seconds"),
        "fade" if value.is_empty() => state.fade = None,
        "fade" => return put(&mut state.fade, read_fade(value), "two times in seconds and a clip: 0.1,1.5,Walk"),
        "play" => return put(&mut state.playing, flag(value), "0 or 1"),
        "speed" => return put(&mut state.speed, finite(value), "a factor such as 0.5"),
        "loop" => return put(&mut state.loop_mode, from_word(&LOOP_MODES, value), "once, loop or ping-pong"),
        "range" if value.is_empty() => state.range = None,
        "range" => return put(&mut state.range, read_range(value), "two times in seconds: 0.5,1.5"),
        "skinning" => {
            let mode = from_word(&SKINNING_MODES, value);
            return put(&mut state.skinning, mode, "linear, rigid or dual-quaternion");
        }
        "morph" => return put(&mut state.morph, read_morph(value), "pairs of index and weight: 0:0.5,3:1"),
        "pose" => {
            let expected = "joints with three angles in degrees: 4:30:0:-15,7:0:90:0";
            return put(&mut state.pose, read_pose(value), expected);
        }
        "names" => return put(&mut state.names, read_names(value), "joints with their names: 4:Left%20knee,7:Hand"),
        "show" => return read_show(state, value),
        "camera" => {
            let expected = "yaw,pitch,distance,x,y,z in degrees and metres, gltf:INDEX or auto";
            return put(&mut state.camera, read_camera(value), expected);
        }
        "fov" => return put(&mut state.fov_degrees, finite(value), "degrees"),
        "follow" => return put(&mut state.follow, flag(value), "0 or 1"),
        "turntable" => return put(&mut state.turntable, finite(value), "degrees per second"),
        "up" => return put(&mut state.up, from_word(&UP_AXES, value), "x, y, z, -x, -y or -z"),
        "exposure" => return put(&mut state.exposure, finite(value), "stops"),
        "environment" => return put(&mut state.environment_degrees, finite(value), "degrees"),
        "background" => {
            return put(&mut state.background, read_background(value), "studio, transparent or rrggbb");
        }
        "embed" => return put(&mut state.embed, flag(value), "0 or 1"),
        _ => return Read::Unknown,
    }
    Read::Done
}

fn put<T>(slot: &mut T, value: Option<T>, expected: &'static str) -> Read {
    match value {
        Some(value) => {
            *slot = value;
            Read::Done
        }
        None => Read::Bad(expected),
    }
}
