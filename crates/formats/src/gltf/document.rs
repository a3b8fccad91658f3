//! The JSON of a glTF file in the types of the `gltf` crate.
//!
//! Those types are stricter than the specification in a few places (an animation channel need not target a node) and stricter
//! than a viewer needs to be in many. So the text is deserialized directly first, which works for nearly every file. If that
//! fails, it is parsed as a plain value, [`loosen`]ed, written as text and deserialized once more; if that fails as well, what
//! a model can do without is [left out](leave_out).
//!
//! They also keep only 32 bits of an index, so a text with a longer integer takes the second path as well, which rejects
//! such an index. [`strict`] rejects what they would accept beyond glTF while they read.

use std::borrow::Cow;
use std::cell::OnceCell;
use std::collections::BTreeMap;

use gaitway_character::asset::{Warning, Warnings};
use gaitway_json_text::{self as json_text, Step, offset_of, path_at, place};
use gltf::json::validation::USize64;
use gltf::json::{Index, Root};
use serde_json::Value;
use serde_json::value::RawValue;

use super::container::Container;
use super::loosen::{NONE, leave_out, loosen, text};
use super::strict;
use crate::LoadError;
use crate::limits::{MAX_JSON_OBJECTS, MAX_JSON_VALUES};

/// The parsed JSON of a file. No index in it has been checked.
pub struct Document<'a> {
    pub root: Root,
    /// Places of the elements that could not be read and were replaced by empty ones, each with the reason.
    unreadable: BTreeMap<String, String>,
    text: Cow<'a, str>,
    /// The text as a plain value, parsed when a message has to quote it.
    value: OnceCell<Value>,
}

impl<'a> Document<'a> {
    pub fn read(file: &str, container: &Container<'a>) -> Result<Self, LoadError> {
        let text = as_text(container.json);
        let (root, unreadable) = match strict::from_str::<Root>(&text, MAX_JSON_OBJECTS) {
            Ok(root) if !has_long_integer(text.as_bytes()) => {
                check_version(file, Some(&root.asset.version), root.asset.min_version.as_deref())?;
                (root, BTreeMap::new())
            }
            Err(strict::Error::TooManyObjects) => return Err(too_many(file, MAX_JSON_OBJECTS, "objects")),
            _ => read_loosened(file, &text, container.is_glb)?,
        };
        Ok(Self { root, unreadable, text, value: OnceCell::new() })
    }

    /// Reports the elements that were left out.
    pub fn warn(&self, warnings: &mut Warnings) {
        for (place, problem) in &self.unreadable {
            let problem = format!("it cannot be read and is left out: {problem}");
            warnings.push(Warning::Other { code: "left-out", place: place.clone(), problem });
        }
    }

    /// Whether the element at `place`, such as `cameras[0]`, is an empty one instead of the file's, which was reported.
    pub fn is_left_out(&self, place: &str) -> bool {
        self.unreadable.contains_key(place)
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
        let parse = || serde_json::from_str(Some(&*self.text).filter(|text| fits_in_memory(text))?).ok();
        let value = self.value.get_or_init(|| parse().unwrap_or_default());
        let pointer = place.replace("].", "/").replace(['.', '['], "/").replace(']', "");
        value.pointer(&format!("/{pointer}"))
    }
}

/// Names not encoded in UTF-8 get replacement characters. Checking the whole text once is faster than each string.
pub fn as_text(json: &[u8]) -> Cow<'_, str> {
    str::from_utf8(json).map_or_else(|_| String::from_utf8_lossy(json), Cow::Borrowed)
}

/// Converts a byte count or offset. A value too large for this machine becomes one beyond the end of any buffer.
pub fn size(bytes: USize64) -> usize {
    usize::try_from(bytes.0).unwrap_or(usize::MAX)
}

/// Returns an index, unless it is the placeholder for a missing one.
pub fn present<T>(index: Index<T>) -> Option<usize> {
    Some(index.value()).filter(|&index| index != NONE as usize)
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

fn too_many(file: &str, max: usize, what: &str) -> LoadError {
    let (expected, found) = (format!("at most {max} {what} in all"), "more".to_owned());
    LoadError::Invalid { file: file.to_owned(), place: "JSON".to_owned(), expected, found }
}

/// Whether a text can be held as a tree of values.
pub fn fits_in_memory(text: &str) -> bool {
    text.bytes().filter(|byte| matches!(byte, b',' | b'[' | b'{')).count() <= MAX_JSON_VALUES
}

/// Reads a text that the crate's types reject, or whose integers they may truncate.
fn read_loosened(file: &str, text: &str, is_glb: bool) -> Result<(Root, BTreeMap<String, String>), LoadError> {
    if !fits_in_memory(text) {
        return Err(too_many(file, MAX_JSON_VALUES, "values"));
    }
    let mut value: Value = serde_json::from_str(text).map_err(|problem| json_error(file, text, is_glb, &problem))?;
    // Other versions have a different structure, so the version is checked first.
    let asset = |key: &str| value.pointer(&format!("/asset/{key}")).filter(|value| !value.is_null()).map(self::text);
    check_version(file, asset("version").as_deref(), asset("minVersion").as_deref())?;
    loosen(&mut value);
    // Back to text: deserializing the value itself would compile the crate's many types into the program a second time.
    let mut loosened = value.to_string();
    let mut unreadable = BTreeMap::new();
    let mut root = strict::from_str(&loosened, MAX_JSON_OBJECTS);
    if root.is_err() {
        unreadable = leave_out(&mut value);
        loosened = value.to_string();
        root = strict::from_str(&loosened, MAX_JSON_OBJECTS);
    }
    root.map(|root| (root, unreadable)).map_err(|problem| {
        let problem = match problem {
            strict::Error::TooManyObjects => return too_many(file, MAX_JSON_OBJECTS, "objects"),
            strict::Error::Json(problem) => problem,
        };
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

fn check_version(file: &str, version: Option<&str>, min_version: Option<&str>) -> Result<(), LoadError> {
    let unsupported = |found: String| LoadError::UnsupportedVersion { file: file.to_owned(), found };
    match version {
        // glTF 1.0 allowed an asset without a version.
        None => return Err(unsupported("without a version (asset.version is missing)".to_owned())),
        Some(version) if !version.starts_with("2.") => return Err(unsupported(version.to_owned())),
        Some(_) => {}
    }
    match min_version {
        Some(version) if version != "2.0" => Err(unsupported(format!("{version} at least (asset.minVersion)"))),
        _ => Ok(()),
    }
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
            // Scans to the end, so that a long run of digits is read only once.
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
