//! The text of a joint map in a link. A map by name is its file's JSON. A map by numbers is compact: `3.CHECKSUM.PAIRS`, or
//! `3.CHECKSUM.PAIRS.REST`. The checksum is eight hex digits; a pair is `TARGET-SOURCE` in joint numbers (nothing after the
//! hyphen: deliberately no source), pairs are joined by commas; the rest is everything else in the map, as JSON in base64url. The
//! number at the beginning says which options the rest leaves out: with 3 those that Gaitway proposes, with 2 those that it proposed
//! before chains were shared, with 1 a file's defaults.

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use gaitway_retarget::{Chains, JointMap, JointMapFile, MapEntry, PathOrigin, RootOptions};
use serde_json::Value;

use super::maps::{MotionMap, NumberedMap};

/// What a code begins with, and the options that it leaves out.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Form {
    mark: &'static str,
    origin: PathOrigin,
    chains: Chains,
}

const FORMS: [Form; 3] = [
    Form { mark: "3.", origin: PathOrigin::Feet, chains: Chains::Share },
    Form { mark: "2.", origin: PathOrigin::Feet, chains: Chains::Off },
    Form { mark: "1.", origin: PathOrigin::Rest, chains: Chains::Off },
];

impl Form {
    /// Returns the first form that fits a map. The origin of its path must be the form's; other options can be written.
    fn of(map: &JointMap) -> Self {
        let [.., last] = FORMS;
        let fits = |form: &&Self| form.origin == map.root.origin && (form.chains == map.chains || form.chains.is_off());
        FORMS.iter().find(fits).copied().unwrap_or(last)
    }

    /// A map without joints and with only these options.
    fn defaults(self) -> JointMap {
        let root = RootOptions { origin: self.origin, ..RootOptions::default() };
        JointMap { root, chains: self.chains, ..JointMap::default() }
    }

    /// Returns the code without its mark, if it has this one.
    fn strip(self, code: &str) -> Option<&str> {
        code.strip_prefix(self.mark)
    }
}

/// Whether a text is meant as a code. Otherwise it is a URL, in older links also if it begins with another number than 1.
pub(super) fn is_code(text: &str) -> bool {
    let is_checksum = |text: &str| text.len() == 8 && text.bytes().all(|byte| byte.is_ascii_hexdigit());
    let has_checksum = |rest: &str| rest.split_once('.').is_some_and(|(checksum, _)| is_checksum(checksum));
    FORMS.iter().any(|form| form.strip(text).is_some_and(|rest| form.origin == PathOrigin::Rest || has_checksum(rest)))
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
    let form = Form::of(&rest);
    let mut code = format!("{}{:08x}.{}", form.mark, numbered.checksum, pairs.join(","));
    if rest != form.defaults() {
        code.push('.');
        code.push_str(&URL_SAFE_NO_PAD.encode(without_defaults(&rest, form).to_string()));
    }
    code
}

/// The map's file form without members at their defaults, except the version, without which it is not a map.
fn without_defaults(map: &JointMap, form: Form) -> Value {
    // A map is plain data: serializing cannot fail.
    let to_value = |map: &JointMap| serde_json::to_value(map.to_numbered_file()).unwrap_or_default();
    let (mut value, default) = (to_value(map), to_value(&form.defaults()));
    if let (Some(members), Some(default)) = (value.as_object_mut(), default.as_object()) {
        members.retain(|key, value| key == "gaitway_map" || default.get(key) != Some(value));
        members.get_mut("joints").into_iter().for_each(shorten);
    }
    value
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
    let (form, code) = FORMS.into_iter().find_map(|form| Some((form, form.strip(code)?)))?;
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
    map.root.origin = form.origin;
    if !form.chains.is_off() {
        map.chains = form.chains;
    }
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
