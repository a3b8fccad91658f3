//! The JSON of a glTF file in the types of the `gltf` crate.
//!
//! Those types are stricter than the specification in a few places (an animation channel need not target a node) and stricter
//! than a viewer needs to be in many. So the text is deserialized directly first, which works for nearly every file. If that
//! fails, it is parsed as a plain value, [`loosen`]ed, written as text and deserialized once more.

use std::borrow::Cow;
use std::cell::OnceCell;
use std::collections::BTreeMap;

use gltf::json::validation::USize64;
use gltf::json::{Index, Root, scene};
use serde_json::value::RawValue;
use serde_json::{Map, Value};

use super::container::Container;
use crate::formats::LoadError;
use crate::json_text;

/// The `target.node` of an animation channel that has none: an extension defines what it animates.
const NO_NODE: u32 = u32::MAX;

/// Members that hold an index or a code. The crate silently truncates these to 32 bits.
const NARROW_MEMBERS: [&str; 23] = [
    "buffer",
    "bufferView",
    "camera",
    "children",
    "componentType",
    "index",
    "indices",
    "input",
    "inverseBindMatrices",
    "joints",
    "light",
    "material",
    "mesh",
    "mode",
    "node",
    "nodes",
    "output",
    "sampler",
    "scene",
    "skeleton",
    "skin",
    "source",
    "targets",
];

/// Extensions that the crate has types for. The contents of all others are left alone.
const TYPED_EXTENSIONS: [&str; 4] =
    ["KHR_lights_punctual", "KHR_materials_emissive_strength", "KHR_materials_unlit", "KHR_texture_transform"];

/// The parsed JSON of a file. No index in it has been checked.
pub struct Document<'a> {
    pub root: Root,
    text: Cow<'a, str>,
    /// The text as a plain value, parsed once a message has to quote it.
    value: OnceCell<Value>,
}

impl<'a> Document<'a> {
    pub fn read(file: &str, container: &Container<'a>) -> Result<Self, LoadError> {
        let text = as_text(container.json);
        let root = match serde_json::from_str::<Root>(&text) {
            Ok(root) if !has_long_integer(text.as_bytes()) => {
                check_version(file, Some(&root.asset.version), root.asset.min_version.as_deref())?;
                root
            }
            _ => read_loosened(file, &text, container.is_glb)?,
        };
        Ok(Self { root, text, value: OnceCell::new() })
    }

    /// Returns the value at `place`, such as `meshes[0].primitives[1].mode`, as text, for messages: the crate does not keep the
    /// codes that it does not know.
    pub fn text_at(&self, place: &str) -> String {
        self.value_at(place).map_or_else(String::new, text)
    }

    /// Like [`Self::text_at`], with quotation marks around a string.
    pub fn quoted_at(&self, place: &str) -> String {
        let text = self.text_at(place);
        if self.value_at(place).is_some_and(Value::is_string) { format!("“{text}”") } else { text }
    }

    fn value_at(&self, place: &str) -> Option<&Value> {
        let value = self.value.get_or_init(|| serde_json::from_str(&self.text).unwrap_or_default());
        let pointer = place.replace("].", "/").replace(['.', '['], "/").replace(']', "");
        value.pointer(&format!("/{pointer}"))
    }
}

/// Names in another encoding than UTF-8 get replacement characters. Checking the whole text once is faster than each string.
pub fn as_text(json: &[u8]) -> Cow<'_, str> {
    str::from_utf8(json).map_or_else(|_| String::from_utf8_lossy(json), Cow::Borrowed)
}

/// Converts a byte count or offset. A value that is too large for this machine becomes one that is beyond any buffer.
pub fn size(bytes: USize64) -> usize {
    usize::try_from(bytes.0).unwrap_or(usize::MAX)
}

/// Returns the node that an animation channel targets, if any.
pub fn target_node(node: Index<scene::Node>) -> Option<usize> {
    Some(node.value()).filter(|&node| node != NO_NODE as usize)
}

/// Wraps an error of the JSON parser about a text that is not JSON.
pub fn json_error(file: &str, text: &str, is_glb: bool, problem: &serde_json::Error) -> LoadError {
    let message = problem.to_string();
    let (said, position) = json_text::split_position(&message);
    // A GLB's text is usually one long line, and no editor shows it.
    let path = is_glb.then(|| place(&path_at(text, offset_of(text, problem.line(), problem.column()))));
    let place = path.filter(|path| !path.is_empty()).or(position).unwrap_or_default();
    LoadError::Json { file: file.to_owned(), place, problem: json_text::plain(said) }
}

/// The byte at a line and column, both from 1.
fn offset_of(text: &str, line: usize, column: usize) -> usize {
    let before: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    before + column
}

/// Reads a text that the crate's types reject, or whose integers they may truncate.
fn read_loosened(file: &str, text: &str, is_glb: bool) -> Result<Root, LoadError> {
    let mut value: Value = serde_json::from_str(text).map_err(|problem| json_error(file, text, is_glb, &problem))?;
    // Other versions have another structure, so the version comes first.
    let asset = |key: &str| value.pointer(&format!("/asset/{key}")).filter(|value| !value.is_null()).map(self::text);
    check_version(file, asset("version").as_deref(), asset("minVersion").as_deref())?;
    loosen(&mut value);
    // As text again: deserializing the value itself would put the crate's many types into the program a second time.
    let loosened = value.to_string();
    serde_json::from_str(&loosened).map_err(|problem| {
        let path = path_at(&loosened, problem.column());
        let (line, column) = position(text, &path);
        let position = if is_glb { String::new() } else { format!(" (line {line}, column {column})") };
        let message = problem.to_string();
        let said = json_text::split_position(&message).0;
        let (expected, found) =
            json_text::expected_and_found(said).unwrap_or_else(|| ("valid glTF".to_owned(), json_text::plain(said)));
        LoadError::Invalid { file: file.to_owned(), place: place(&path) + &position, expected, found }
    })
}

/// A step from a JSON value to one inside it.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Step {
    Member(String),
    Element(usize),
}

/// The path to the value that a parser was reading when it stopped after `end` bytes.
fn path_at(text: &str, end: usize) -> Vec<Step> {
    let mut path = Vec::new();
    let mut at = 0;
    while at < end.min(text.len()) {
        let rest = &text[at..];
        let mut length = 1;
        match (rest.as_bytes()[0], path.last_mut()) {
            // Stopped at its beginning: what it is was the problem, not what is in it.
            (b'{' | b'[', _) if at + 1 >= end => {}
            (b'{', _) => path.push(Step::Member(String::new())),
            (b'[', _) => path.push(Step::Element(0)),
            (b'}' | b']', _) => drop(path.pop()),
            (b',', Some(Step::Member(key))) => key.clear(),
            (b',', Some(Step::Element(index))) => *index += 1,
            (b'"', last) => {
                length = string_length(rest);
                let string = &rest[..length];
                if let (Some(Step::Member(key)), true) = (last, rest[length..].trim_start().starts_with(':')) {
                    *key = serde_json::from_str(string).unwrap_or_default();
                }
            }
            _ => {}
        }
        at += length.max(rest.chars().next().map_or(1, char::len_utf8));
    }
    path
}

/// Bytes of the string that the text begins with, with its quotation marks.
fn string_length(text: &str) -> usize {
    let mut escaped = false;
    for (at, letter) in text.char_indices().skip(1) {
        match letter {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// A path as messages have it: `meshes[0].primitives[1].mode`.
fn place(path: &[Step]) -> String {
    let mut place = String::new();
    for step in path {
        match step {
            Step::Member(key) if key.is_empty() => {}
            Step::Member(key) if place.is_empty() => place.push_str(key),
            Step::Member(key) => place.extend([".", key]),
            Step::Element(index) => place.push_str(&format!("[{index}]")),
        }
    }
    place
}

fn check_version(file: &str, version: Option<&str>, min_version: Option<&str>) -> Result<(), LoadError> {
    let unsupported = |found: String| LoadError::UnsupportedVersion { file: file.to_owned(), found };
    match version {
        // glTF 1.0 allowed an asset without a version.
        None => return Err(unsupported("of no stated version (asset.version is missing)".to_owned())),
        Some(version) if !version.starts_with("2.") => return Err(unsupported(version.to_owned())),
        Some(_) => {}
    }
    match min_version {
        Some(version) if version != "2.0" => Err(unsupported(format!("{version} at least (asset.minVersion)"))),
        _ => Ok(()),
    }
}

fn text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// Whether the text has an integer of ten digits or more, which may not fit into 32 bits. Inspects every tenth byte.
fn has_long_integer(text: &[u8]) -> bool {
    const DIGITS: usize = 10;
    let is_digit = |at: usize| text.get(at).is_some_and(u8::is_ascii_digit);
    let mut at = DIGITS - 1;
    while at < text.len() {
        // Ten digits around this one reach at least five to one side.
        if is_digit(at) && (is_digit(at + DIGITS / 2) || is_digit(at - DIGITS / 2)) {
            let mut start = at;
            while start > 0 && is_digit(start - 1) {
                start -= 1;
            }
            // To the end, so that a long run of digits is read once.
            while is_digit(at) {
                at += 1;
            }
            // Not part of a fraction or a name.
            let is_integer = start.checked_sub(1).is_none_or(|before| b":,[ \t\r\n".contains(&text[before]))
                && text.get(at).is_none_or(|after| b",]} \t\r\n".contains(after));
            if is_integer && at - start >= DIGITS {
                return true;
            }
        }
        at += DIGITS;
    }
    false
}

/// Line and column, from 1, of the value at `path`, or of the innermost value around it that exists.
fn position(text: &str, path: &[Step]) -> (usize, usize) {
    let Ok(mut value) = serde_json::from_str::<&RawValue>(text) else { return (1, 1) };
    for step in path {
        let inner = match step {
            Step::Element(index) => {
                serde_json::from_str::<Vec<&RawValue>>(value.get()).ok().and_then(|list| list.get(*index).copied())
            }
            Step::Member(key) => serde_json::from_str::<BTreeMap<String, &RawValue>>(value.get())
                .ok()
                .and_then(|members| members.get(key).copied()),
        };
        let Some(inner) = inner else { break };
        value = inner;
    }
    let before = &text[..value.get().as_ptr() as usize - text.as_ptr() as usize];
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (1 + before.matches('\n').count(), 1 + before.len() - line_start)
}

/// Removes or completes members that the crate's types reject and the reader can do without.
fn loosen(root: &mut Value) {
    clean(root, None);
    let asset = root.get_mut("asset").and_then(Value::as_object_mut);
    if let Some(asset) = asset {
        for key in ["version", "minVersion"] {
            if let Some(version) = asset.get_mut(key) {
                *version = Value::from(text(version));
            }
        }
        remove_unless(asset, "copyright", Value::is_string);
    }
    objects(root, "bufferViews").for_each(|view| remove_unless(view, "target", Value::is_u64));
    objects(root, "images").for_each(|image| remove_unless(image, "mimeType", Value::is_string));
    objects(root, "scenes").for_each(|scene| set_default(scene, "nodes", empty_list()));
    objects(root, "skins").for_each(|skin| set_default(skin, "joints", empty_list()));
    for camera in objects(root, "cameras") {
        // The reader goes by the members of a camera.
        remove_unless(camera, "type", Value::is_string);
        set_default(camera, "type", Value::from("perspective"));
    }
    for mesh in objects(root, "meshes") {
        set_default(mesh, "primitives", empty_list());
        objects_of(mesh, "primitives").for_each(loosen_attributes);
    }
    for animation in objects(root, "animations") {
        set_default(animation, "channels", empty_list());
        set_default(animation, "samplers", empty_list());
        let channels = objects_of(animation, "channels");
        for target in channels.filter_map(|channel| channel.get_mut("target")?.as_object_mut()) {
            set_default(target, "node", Value::from(NO_NODE));
        }
    }
    if let Some(lights) = root.pointer_mut("/extensions/KHR_lights_punctual").and_then(Value::as_object_mut) {
        set_default(lights, "lights", empty_list());
    }
}

/// Applies the rules for all objects: removes null members, names that are not strings and extensions that are not objects.
/// Turns integers that the crate would truncate into floats, which it rejects. `key`: the member that holds the value.
fn clean(value: &mut Value, key: Option<&str>) {
    match value {
        Value::Array(list) => list.iter_mut().for_each(|value| clean(value, key)),
        Value::Number(number) => {
            if key.is_some_and(|key| NARROW_MEMBERS.contains(&key))
                && let Some(wide) = number.as_u64().filter(|&number| number >= u64::from(u32::MAX))
            {
                *value = Value::from(wide as f64);
            }
        }
        Value::Object(members) => {
            members.retain(|_, value| !value.is_null());
            remove_unless(members, "name", Value::is_string);
            remove_unless(members, "extensions", Value::is_object);
            let indices_inside = key.filter(|&key| matches!(key, "attributes" | "targets")).map(|_| "index");
            for (key, value) in members {
                match key.as_str() {
                    "extras" => {}
                    "extensions" => clean_extensions(value),
                    key => clean(value, indices_inside.or(Some(key))),
                }
            }
        }
        _ => {}
    }
}

fn clean_extensions(extensions: &mut Value) {
    let Some(extensions) = extensions.as_object_mut() else { return };
    for name in TYPED_EXTENSIONS {
        if let Some(extension) = extensions.get_mut(name) {
            clean(extension, None);
        }
    }
    // Its presence is all that matters.
    if let Some(unlit) = extensions.get_mut("KHR_materials_unlit").filter(|unlit| !unlit.is_object()) {
        *unlit = Value::Object(Map::new());
    }
}

/// Returns a copy without null members.
pub fn without_nulls(value: &Value) -> Value {
    let mut value = value.clone();
    clean(&mut value, None);
    value
}

/// Removes attributes that are never read and are not indices.
fn loosen_attributes(primitive: &mut Map<String, Value>) {
    set_default(primitive, "attributes", Value::Object(Map::new()));
    let is_read = |semantic: &str| {
        matches!(semantic, "POSITION" | "NORMAL" | "TANGENT" | "TEXCOORD_0" | "TEXCOORD_1" | "COLOR_0")
            || semantic.starts_with("JOINTS_")
            || semantic.starts_with("WEIGHTS_")
    };
    if let Some(attributes) = primitive.get_mut("attributes").and_then(Value::as_object_mut) {
        attributes.retain(|semantic, index| index.is_u64() || is_read(semantic));
    }
}

fn empty_list() -> Value {
    Value::Array(Vec::new())
}

/// The objects in the list `key`.
fn objects<'v>(value: &'v mut Value, key: &str) -> impl Iterator<Item = &'v mut Map<String, Value>> + use<'v> {
    value.get_mut(key).and_then(Value::as_array_mut).into_iter().flatten().filter_map(Value::as_object_mut)
}

fn objects_of<'v>(
    members: &'v mut Map<String, Value>,
    key: &str,
) -> impl Iterator<Item = &'v mut Map<String, Value>> + use<'v> {
    members.get_mut(key).and_then(Value::as_array_mut).into_iter().flatten().filter_map(Value::as_object_mut)
}

fn set_default(members: &mut Map<String, Value>, key: &str, value: Value) {
    members.entry(key).or_insert(value);
}

fn remove_unless(members: &mut Map<String, Value>, key: &str, is_kept: fn(&Value) -> bool) {
    if members.get(key).is_some_and(|value| !is_kept(value)) {
        // Keeps the order of the others.
        members.shift_remove(key);
    }
}
