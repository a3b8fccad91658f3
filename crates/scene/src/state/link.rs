//! The text form of a view state: `key=value` pairs joined by `&` after the `#`, and the same keys as a JSON object. Old
//! links keep working: [`Version`] fixes the defaults, and unknown keys are preserved when the link is written again. A key is one
//! row of [`KEYS`].

mod changes;
mod layers;
mod pins;
mod values;

use percent_encoding::{AsciiSet, CONTROLS, percent_decode_str, utf8_percent_encode};
use serde_json::{Map, Value, json};

pub use gaitway_session::{Link, MEMBER_SEPARATOR, is_to_bring, with_current_member};

pub use self::pins::read_pin;
use self::values::*;
use super::clip_names::with_link_names;
use super::{CharacterView, ClipChoice, UnknownName, ViewerState};
use crate::library::{LayeredClip, Library};

/// A part of a link, or of an object from a script, that is not understood or that can't be shown. All other parts still apply.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LinkError {
    /// A key's value is unusable and was skipped.
    #[error("{key}={value}: expected {expected}")]
    BadValue {
        /// The key.
        key: String,
        /// Its value, decoded.
        value: String,
        /// What the key takes, in words.
        expected: &'static str,
    },
    /// A key that this version does not know, preserved in [`super::PageOptions::unknown`].
    #[error("{key}: unknown key, kept in the link")]
    UnknownKey {
        /// The key, decoded.
        key: String,
    },
    /// A word of `show` that this version does not know, preserved in [`super::PageOptions::unknown`].
    #[error("show={value}: unknown word, kept in the link")]
    UnknownShow {
        /// The word.
        value: String,
    },
    /// A number or an index is out of range.
    #[error("{key}={value}: expected {expected}; {instead}")]
    OutOfRange {
        /// The key.
        key: &'static str,
        /// Its value, or those of its values that are out of range.
        value: String,
        /// What the key takes, in words.
        expected: &'static str,
        /// What is used instead.
        instead: String,
    },
    /// The model has no clip, variant or the like of this name.
    #[error("{key}: {unknown}; {instead}")]
    UnknownName {
        /// The key.
        key: &'static str,
        /// The name, and those that exist.
        unknown: UnknownName,
        /// What is used instead.
        instead: &'static str,
    },
    /// Nothing of the model is where the camera looks, as when the link was made for another file.
    #[error("camera: it looks past this model; fit everything in view (F) to see it")]
    LooksPast,
}

impl LinkError {
    /// Returns the key that it is about.
    pub fn key(&self) -> &str {
        match self {
            Self::BadValue { key, .. } | Self::UnknownKey { key } => key,
            Self::UnknownShow { .. } => "show",
            Self::LooksPast => "camera",
            Self::OutOfRange { key, .. } | Self::UnknownName { key, .. } => key,
        }
    }
}

/// What a link leaves out means what its key `v` says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Version {
    /// Without `clip`, the model's first clip plays, its own before those of motions. Links without `v` are of this version.
    One,
    /// Without `clip`, the first clip of the motions plays, if there are any.
    Two,
}

impl Version {
    const KEY: &str = "v";
    const EXPECTED: &str = "1 or 2";
    /// The one that is written.
    const CURRENT: u32 = 2;

    /// Reads the value of its key. One that is unknown is reported and read as the current one: a newer link is most like that.
    fn read(value: &str, errors: &mut Vec<LinkError>) -> Self {
        match value {
            "1" => return Self::One,
            "2" => {}
            _ => errors.push(bad_value(Self::KEY, value, Self::EXPECTED)),
        }
        Self::Two
    }

    /// Chooses the clip of a view whose link names none.
    fn complete(self, state: &mut ViewerState) {
        let CharacterView { sources, playhead, .. } = &mut state.character;
        if matches!(playhead.clip, ClipChoice::First | ClipChoice::FirstOfMotions) {
            let is_of_motions = self == Self::Two && !sources.motion.is_empty();
            playhead.clip = if is_of_motions { ClipChoice::FirstOfMotions } else { ClipChoice::First };
        }
    }
}

/// How one key of the link is read and written: a row of [`KEYS`].
struct Key {
    name: &'static str,
    /// May appear several times in a link; an array in JSON.
    repeatable: bool,
    /// What its values are, in words.
    expected: &'static str,
    read: fn(&mut ViewerState, &str) -> Read,
    write: fn(&ViewerState) -> Written,
    /// Resets the field to its default.
    reset: fn(&mut ViewerState),
}

/// The value of a key, as text for the link and as JSON for scripts.
#[derive(PartialEq)]
enum Written {
    /// Not in the link; null in JSON.
    Unset,
    Flag(bool),
    Number(String, Value),
    Text(String),
    List(Vec<String>),
}

impl Written {
    fn texts(self) -> Vec<String> {
        match self {
            Self::Unset => Vec::new(),
            Self::Flag(flag) => vec![flag_text(flag).to_owned()],
            Self::Number(text, _) | Self::Text(text) => vec![text],
            Self::List(texts) => texts,
        }
    }

    fn json(self) -> Value {
        match self {
            Self::Unset => Value::Null,
            Self::Flag(flag) => Value::Bool(flag),
            Self::Number(_, number) => number,
            Self::Text(text) => Value::String(text),
            Self::List(texts) => json!(texts),
        }
    }
}

/// A key with one value. `$read` returns the field's value, or `None` if the text is not what `$expected` says.
macro_rules! key {
    ($name:literal, $group:ident $(.$field:ident)*, $read:expr, $write:expr, $expected:literal) => {
        Key {
            name: $name,
            repeatable: false,
            expected: $expected,
            read: |state, text| match $read(text) {
                Some(value) => {
                    state.$group$(.$field)* = value;
                    Read::Done
                }
                None => Read::Bad($expected),
            },
            write: |state| $write(&state.$group$(.$field)*),
            reset: |state| state.$group$(.$field)* = ViewerState::default().$group$(.$field)*,
        }
    };
}

/// A key whose values are the words of a table.
macro_rules! word {
    ($name:literal, $group:ident $(.$field:ident)*, $words:ident, $expected:literal) => {
        key!($name, $group$(.$field)*, |text| from_word(&$words, text), |value| write_word(&$words, value), $expected)
    };
}

/// A key with any number of values.
macro_rules! list {
    ($name:literal, $group:ident $(.$field:ident)*, $read:expr, $write:expr, $expected:expr) => {
        Key {
            name: $name,
            repeatable: true,
            expected: $expected,
            read: |state, text| match $read(text) {
                Some(value) => {
                    state.$group$(.$field)*.push(value);
                    Read::Done
                }
                None => Read::Bad($expected),
            },
            write: |state| Written::List(state.$group$(.$field)*.iter().map($write).collect()),
            reset: |state| state.$group$(.$field)*.clear(),
        }
    };
}

/// All keys, in the order they are written.
const KEYS: &[Key] = &[
    list!("model", character.sources.model, read_source, String::clone, "a URL, sample:NAME or a file name"),
    list!("motion", character.sources.motion, read_source, String::clone, "a URL, sample:NAME or a file name"),
    list!(
        "map",
        character.retarget.map,
        read_map,
        map_text,
        "a URL, the compact form of a copied link, or a joint map as JSON"
    ),
    key!(
        "unmapped",
        character.retarget.unmapped,
        read_some(read_unmapped),
        write_some(unmapped_text),
        "rest, clip:CLIP or first-key:CLIP"
    ),
    key!(
        "root",
        character.retarget.root,
        read_some(read_root),
        write_some(root_text),
        "horizontal:, vertical: or yaw: with keep, in-place or freeze, extract, and origin: with rest or feet"
    ),
    key!("feet", character.retarget.feet, read_some(read_feet), write_some(feet_text), "off or plant"),
    key!("contacts", character.retarget.contacts, read_some(read_contacts), write_some(contacts_text), "off or keep"),
    key!("scene", character.sources.scene, read_index, write_index, "a scene's index"),
    key!("clip", character.playhead.clip, read_clip, write_clip, "a clip's name or index"),
    key!("t", character.playhead.time_secs, finite, write_number, "seconds from 0 on"),
    key!(
        "fade",
        character.playhead.fade,
        read_unless_empty(read_fade),
        write_some(fade_text),
        "two times in seconds and a clip: 0.1,1.5,Walk"
    ),
    key!("play", playback.playing, flag, write_flag, "0 or 1"),
    Key {
        name: "mirror",
        repeatable: true,
        expected: changes::MIRROR,
        read: changes::read_mirror,
        write: changes::write_mirror,
        reset: changes::reset_mirror,
    },
    Key {
        name: "copy",
        repeatable: true,
        expected: changes::COPY,
        read: changes::read_copy,
        write: changes::write_copy,
        reset: changes::reset_copy,
    },
    Key {
        name: "rename",
        repeatable: true,
        expected: changes::RENAME,
        read: changes::read_rename,
        write: changes::write_rename,
        reset: changes::reset_rename,
    },
    Key {
        name: "change",
        repeatable: true,
        expected: changes::CHANGE,
        read: changes::read_change,
        write: changes::write_change,
        reset: changes::reset_change,
    },
    list!("layers", character.edits.layers, layers::read, layers::text, layers::EXPECTED),
    key!("speed", playback.speed, finite, write_number, "a factor from 0.1 to 4"),
    word!("loop", playback.loop_mode, LOOP_MODES, "once, loop or ping-pong"),
    key!(
        "range",
        character.playhead.range,
        read_unless_empty(read_range),
        write_some(range_text),
        "two times in seconds from 0 on: 0.5,1.5"
    ),
    word!("skinning", display.skinning, SKINNING_MODES, "linear, rigid or dual-quaternion"),
    key!(
        "morph",
        character.edits.morph,
        read_morph,
        write_morph,
        "pairs of index and weight from -10 to 10: 0:0.5,3:1"
    ),
    key!(
        "expression",
        character.edits.expressions,
        read_expressions,
        write_expressions,
        "pairs of name and weight from 0 to 1: happy:0.5,blink:1"
    ),
    key!("look", display.look_at, read_look, write_look, "camera, x,y,z in metres, or off"),
    key!("springs", display.springs, flag, write_flag, "0 or 1"),
    key!(
        "pose",
        character.edits.pose,
        read_pose,
        write_pose,
        "joints with three angles in degrees: 4:30:0:-15,7:0:90:0"
    ),
    Key {
        name: "pin",
        repeatable: true,
        expected: pins::EXPECTED,
        read: pins::read,
        write: pins::write,
        reset: pins::reset,
    },
    key!("names", character.edits.names, read_names, write_names, "joints with their names: 4:Left%20knee,7:Hand"),
    word!(
        "channel",
        display.channel,
        CHANNELS,
        "shaded, base-color, normal, tangent, roughness, metallic, occlusion, emissive, uv, vertex-color, influences or \
         wireframe"
    ),
    Key { name: "show", repeatable: false, expected: "", read: read_show, write: write_show, reset: reset_show },
    key!("joint", selection.joint, read_index, write_index, "a joint's index in the file"),
    key!(
        "vertex",
        selection.vertex,
        read_unless_empty(read_vertex),
        write_some(vertex_text),
        "INSTANCE:PRIMITIVE:VERTEX, counting from 0"
    ),
    key!(
        "camera",
        camera,
        read_camera,
        write_camera,
        "yaw,pitch,distance,x,y,z in degrees and metres, gltf:INDEX or auto"
    ),
    key!("fov", camera_options.fov_degrees, finite, write_number, "degrees from 5 to 120"),
    key!("follow", camera_options.follow, flag, write_flag, "0 or 1"),
    key!("turntable", camera_options.turntable, finite, write_number, "degrees per second from -360 to 360"),
    key!(
        "variant",
        character.edits.variant,
        read_unless_empty(read_text),
        write_some(String::clone),
        "the name of a material variant"
    ),
    key!(
        "hidden",
        character.edits.hidden,
        read_hidden,
        write_hidden,
        "node indices, and materials as m and their index: 4,7,m2"
    ),
    word!("up", character.edits.up, UP_AXES, "x, y, z, -x, -y or -z"),
    key!("exposure", display.exposure, finite, write_number, "stops from -10 to 10"),
    word!("tonemap", display.tone_map, TONE_MAPS, "neutral, aces, agx or none"),
    key!("environment", display.environment_degrees, finite, write_number, "degrees"),
    key!("light", lighting.environment, read_light, write_light, "studio, white, soft, hard, outdoor or an .hdr image"),
    key!(
        "key",
        lighting.key,
        read_unless_empty(read_key_light),
        write_some(key_light_text),
        "STRENGTH,YAW,PITCH: 0 to 10, and the angles in degrees"
    ),
    key!(
        "background",
        display.background,
        read_background,
        write_background,
        "studio, transparent, environment, blurred or rrggbb"
    ),
    key!("embed", page.embed, read_embed, write_embed, "0, 1, transport or viewport"),
];

fn key(name: &str) -> Option<&'static Key> {
    KEYS.iter().find(|key| key.name == name)
}

/// Links stay readable: `/`, `:`, `,` and the like need no escaping in a fragment.
const ESCAPED: &AsciiSet =
    &CONTROLS.add(b' ').add(b'"').add(b'#').add(b'%').add(b'&').add(b'+').add(b'<').add(b'=').add(b'>').add(b'`');

/// Returns the part after `#`, with only what differs from the default. The library has the clips that the view refers to.
pub fn to_link(state: &ViewerState, library: &Library) -> String {
    let (state, default) = (&with_link_names(state, library), ViewerState::default());
    let mut text = format!("{}={}", Version::KEY, Version::CURRENT);
    let mut push = |key: &str, value: &str| {
        text.push('&');
        text.extend(utf8_percent_encode(key, ESCAPED));
        text.push('=');
        text.extend(utf8_percent_encode(value, ESCAPED));
    };
    for key in KEYS {
        let value = (key.write)(state);
        if value != (key.write)(&default) {
            value.texts().iter().for_each(|text| push(key.name, text));
        }
    }
    for (key, values) in &state.page.unknown {
        if key != "show" {
            values.iter().for_each(|value| push(key, value));
        }
    }
    text
}

/// Adds where a view isn't what is `used` of it, and `why`.
pub(super) fn differences(view: &ViewerState, used: &ViewerState, why: &str, errors: &mut Vec<LinkError>) {
    for key in KEYS {
        let [asked, used] = [view, used].map(|state| (key.write)(state).texts());
        let only = |of: &[String], others: &[String]| {
            of.iter().filter(|text| !others.contains(text)).cloned().collect::<Vec<_>>().join(", ")
        };
        let (value, used) = (only(&asked, &used), only(&used, &asked));
        let instead = if used.is_empty() { format!("{why}it is left out") } else { format!("{why}{used} is used") };
        if !value.is_empty() {
            let value = shortened(&value);
            errors.push(LinkError::OutOfRange { key: key.name, value, expected: key.expected, instead });
        }
    }
}

/// Reads a value of the key `layers`, as the command line has it.
///
/// # Errors
/// What was expected.
pub fn read_layer(text: &str) -> Result<LayeredClip, &'static str> {
    layers::read(text).ok_or(layers::EXPECTED)
}

/// Reads the part after `#`, with or without a leading `#`. Bad values are reported and skipped; unknown keys are kept.
pub fn from_link(fragment: &str) -> (ViewerState, Vec<LinkError>) {
    let mut state = ViewerState::default();
    let mut errors = Vec::new();
    let mut version = Version::One;
    for pair in fragment.trim_start_matches('#').split('&').filter(|pair| !pair.is_empty()) {
        let (key, value) = pair.split_once('=').unwrap_or((pair, ""));
        let decode = |text: &str| percent_decode_str(text).decode_utf8_lossy().into_owned();
        match (decode(key), decode(value)) {
            (key, value) if key == Version::KEY => version = Version::read(&value, &mut errors),
            (key, value) => set_value(&mut state, &key, &value, &mut errors),
        }
    }
    version.complete(&mut state);
    (state, errors)
}

/// Returns all keys of the link as JSON: flags are booleans, numbers are numbers, unset keys are null.
pub fn to_object(state: &ViewerState, library: &Library) -> Value {
    let state = &with_link_names(state, library);
    let mut object = Map::new();
    object.insert(Version::KEY.to_owned(), json!(Version::CURRENT));
    for key in KEYS {
        object.insert(key.name.to_owned(), (key.write)(state).json());
    }
    for (key, values) in state.page.unknown.iter().filter(|(key, _)| *key != "show") {
        let value = if let [value] = &values[..] { json!(value) } else { json!(values) };
        object.insert(key.clone(), value);
    }
    Value::Object(object)
}

/// Returns a state with some keys of the link replaced; null resets a key to its default, which is that of the current version
/// unless the object names another. Bad values are reported and skipped. The library has the clips that `base` refers to; the
/// returned state calls them as links do.
pub fn from_object(base: &ViewerState, library: &Library, partial: &Value) -> (ViewerState, Vec<LinkError>) {
    let mut state = with_link_names(base, library);
    let mut errors = Vec::new();
    let Value::Object(partial) = partial else {
        let expected = "an object with keys of the link";
        errors.push(LinkError::BadValue { key: "state".to_owned(), value: partial.to_string(), expected });
        return (state, errors);
    };
    let mut version = Version::Two;
    for (name, value) in partial {
        if name == Version::KEY {
            if !value.is_null() {
                version = Version::read(&plain_text(value), &mut errors);
            }
            continue;
        }
        let known = key(name);
        let repeatable = known.is_none_or(|key| key.repeatable);
        let texts = match value {
            Value::Array(values) if repeatable => values.iter().map(plain_text).collect(),
            Value::Array(values) => vec![values.iter().map(plain_text).collect::<Vec<_>>().join(",")],
            Value::Null => Vec::new(),
            value => vec![plain_text(value)],
        };
        if (repeatable || texts.is_empty())
            && let Some(key) = known
        {
            (key.reset)(&mut state);
        }
        if known.is_none() {
            state.page.unknown.remove(name);
        }
        for text in texts {
            set_value(&mut state, name, &text, &mut errors);
        }
    }
    version.complete(&mut state);
    (state, errors)
}

fn plain_text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Bool(flag) => flag_text(*flag).to_owned(),
        value => value.to_string(),
    }
}

fn set_value(state: &mut ViewerState, key: &str, value: &str, errors: &mut Vec<LinkError>) {
    let read = match self::key(key) {
        Some(key) => (key.read)(state, value),
        None => Read::Unknown,
    };
    let expected = match read {
        Read::Done => return,
        Read::Bad(expected) => expected,
        Read::Unknown => {
            errors.push(LinkError::UnknownKey { key: key.to_owned() });
            state.page.unknown.entry(key.to_owned()).or_default().push(value.to_owned());
            return;
        }
        Read::UnknownShow(words) => {
            errors.extend(words.iter().map(|word| LinkError::UnknownShow { value: word.clone() }));
            state.page.unknown.insert("show".to_owned(), words);
            return;
        }
    };
    errors.push(bad_value(key, value, expected));
}

fn bad_value(key: &str, value: &str, expected: &'static str) -> LinkError {
    LinkError::BadValue { key: key.to_owned(), value: shortened(value), expected }
}

/// Returns a value as an error shows it: a long one would hide the other errors.
fn shortened(value: &str) -> String {
    const MAX_CHARS: usize = 60;
    match value.char_indices().nth(MAX_CHARS) {
        Some((end, _)) => format!("{}…", &value[..end]),
        None => value.to_owned(),
    }
}

enum Read {
    Done,
    /// Holds what was expected.
    Bad(&'static str),
    Unknown,
    /// Unknown words of `show`; the others are set.
    UnknownShow(Vec<String>),
}
