//! The text of a joint map in a link. A map by name is its file's JSON. A map by numbers is compact: `2.CHECKSUM.PAIRS`, or
//! `2.CHECKSUM.PAIRS.REST`. The checksum is eight hex digits; a pair is `TARGET-SOURCE` in joint numbers (nothing after the
//! hyphen: deliberately no source), pairs are joined by commas; the rest is everything else in the map, as JSON in base64url. A
//! code that begins with 1 is of a map whose path's origin is the rest; older versions knew no other.

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use gaitway_retarget::{JointMap, JointMapFile, MapEntry, PathOrigin, RootOptions};
use serde_json::Value;

use super::maps::{MotionMap, NumberedMap};

/// What a code of this form begins with, by the origin of the map's path.
const fn mark(origin: PathOrigin) -> &'static str {
    match origin {
        PathOrigin::Rest => "1.",
        PathOrigin::Feet => "2.",
    }
}

/// Whether a text is meant as a code. Otherwise it is a URL, in older links also if it begins with 2.
pub(super) fn is_code(text: &str) -> bool {
    let is_checksum = |text: &str| text.len() == 8 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
    let has_checksum = |rest: &str| rest.split_once('.').is_some_and(|(checksum, _)| is_checksum(checksum));
    text.starts_with(mark(PathOrigin::Rest)) || text.strip_prefix(mark(PathOrigin::Feet)).is_some_and(has_checksum)
}

/// What a code leaves out.
fn defaults(origin: PathOrigin) -> JointMap {
    JointMap { root: RootOptions { origin, ..RootOptions::default() }, ..JointMap::default() }
}

impl MotionMap {
    /// Returns a map that was read from a file, as a link holds it.
    pub fn of_file(map: &JointMapFile) -> Self {
        // A map is plain data, so this cannot fail.
        Self::Names(serde_json::to_string(map).unwrap_or_default())
    }
}

pub(super) fn encode(numbered: &NumberedMap) -> String {
    let mut rest = numbered.map.clone();
    let mut pairs = Vec::new();
    rest.joints.retain(|&target, entry| {
        let is_plain = *entry == MapEntry::following(entry.source);
        if is_plain {
            pairs.push(match entry.source {
                Some(source) => format!("{target}-{source}"),
                None => format!("{target}-"),
            });
        }
        !is_plain
    });
    let origin = rest.root.origin;
    let mut code = format!("{}{:08x}.{}", mark(origin), numbered.checksum, pairs.join(","));
    if rest != defaults(origin) {
        code.push('.');
        code.push_str(&URL_SAFE_NO_PAD.encode(without_defaults(&rest).to_string()));
    }
    code
}

/// The map's file form without members at their defaults, except the version, without which it is not a map.
fn without_defaults(map: &JointMap) -> Value {
    // A map is plain data: serializing cannot fail.
    let form = |map: &JointMap| serde_json::to_value(map.to_numbered_file()).unwrap_or_default();
    let (mut form, default) = (form(map), form(&defaults(map.root.origin)));
    if let (Some(form), Some(default)) = (form.as_object_mut(), default.as_object()) {
        form.retain(|key, value| key == "gaitway_map" || default.get(key) != Some(value));
        form.get_mut("joints").into_iter().for_each(shorten);
    }
    form
}

/// Writes numbers with the digits of single precision, which corrections have; a double would have twice as many.
fn shorten(value: &mut Value) {
    match value {
        Value::Object(members) => members.values_mut().for_each(shorten),
        Value::Array(items) => items.iter_mut().for_each(shorten),
        Value::Number(number) if number.is_f64() => {
            let shortest = number.as_f64().and_then(|number| (number as f32).to_string().parse().ok());
            if let Some(shortest) = shortest.and_then(serde_json::Number::from_f64) {
                *number = shortest;
            }
        }
        _ => {}
    }
}

/// Returns None for any other text.
pub(super) fn decode(code: &str) -> Option<NumberedMap> {
    let marked = |origin| Some((code.strip_prefix(mark(origin))?, origin));
    let (code, origin) = marked(PathOrigin::Rest).or_else(|| marked(PathOrigin::Feet))?;
    let mut parts = code.split('.');
    let (checksum, pairs, rest) = (parts.next()?, parts.next()?, parts.next());
    if parts.next().is_some() || checksum.len() != 8 || checksum.starts_with('+') {
        return None;
    }
    let checksum = u32::from_str_radix(checksum, 16).ok()?;
    let mut map = match rest {
        Some(rest) => {
            let json = String::from_utf8(URL_SAFE_NO_PAD.decode(rest).ok()?).ok()?;
            JointMapFile::from_json(&json).ok()?.as_numbers()?
        }
        None => JointMap::default(),
    };
    map.root.origin = origin;
    for pair in pairs.split(',').filter(|pair| !pair.is_empty()) {
        let (target, source) = pair.split_once('-')?;
        let target: usize = target.parse().ok()?;
        let source = if source.is_empty() { None } else { Some(source.parse().ok()?) };
        if map.joints.insert(target, MapEntry::following(source)).is_some() {
            return None;
        }
    }
    Some(NumberedMap { checksum, map })
}
