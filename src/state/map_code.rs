//! The compact form of a joint map in a link: `1.CHECKSUM.PAIRS`, or `1.CHECKSUM.PAIRS.REST`. The checksum is eight hex
//! digits; a pair is `TARGET-SOURCE` in joint numbers (nothing after the hyphen: deliberately no source), pairs are joined
//! by commas; the rest is everything else that the map says, as JSON in base64url.

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use glam::Quat;
use serde_json::Value;

use super::maps::{NumberedMap, number_of};
use crate::retarget::{JointMap, MapEntry, SourceRef};

/// What every code of this form begins with.
pub(super) const MARK: &str = "1.";

pub(super) fn encode(numbered: &NumberedMap) -> String {
    let mut rest = numbered.map.clone();
    let mut pairs: Vec<(usize, Option<usize>)> = Vec::new();
    rest.joints.retain(|key, entry| match plain_pair(key, entry) {
        Some(pair) => {
            pairs.push(pair);
            false
        }
        None => true,
    });
    pairs.sort_unstable();
    let pairs = pairs.iter().map(|(target, source)| match source {
        Some(source) => format!("{target}-{source}"),
        None => format!("{target}-"),
    });
    let mut code = format!("{MARK}{:08x}.{}", numbered.checksum, pairs.collect::<Vec<_>>().join(","));
    if rest != JointMap::default() {
        code.push('.');
        code.push_str(&URL_SAFE_NO_PAD.encode(without_defaults(&rest).to_string()));
    }
    code
}

/// Members that say what holds anyway are left out, but for the version, without which it is no map.
fn without_defaults(map: &JointMap) -> Value {
    // A map is plain data: it can always be written.
    let written = |map: &JointMap| serde_json::to_value(map).unwrap_or_default();
    let (mut form, default) = (written(map), written(&JointMap::default()));
    if let (Some(form), Some(default)) = (form.as_object_mut(), default.as_object()) {
        form.retain(|key, value| key == "gaitway_map" || default.get(key) != Some(value));
        form.get_mut("joints").into_iter().for_each(shorten);
    }
    form
}

/// Corrections are single precision: as doubles they would have twice the digits, which say nothing.
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

/// None when it is no such code.
pub(super) fn decode(code: &str) -> Option<NumberedMap> {
    let mut parts = code.strip_prefix(MARK)?.split('.');
    let (checksum, pairs, rest) = (parts.next()?, parts.next()?, parts.next());
    if parts.next().is_some() || checksum.len() != 8 || checksum.starts_with('+') {
        return None;
    }
    let checksum = u32::from_str_radix(checksum, 16).ok()?;
    let mut map: JointMap = match rest {
        Some(rest) => {
            let json = String::from_utf8(URL_SAFE_NO_PAD.decode(rest).ok()?).ok()?;
            JointMap::from_json(&json).ok()?
        }
        None => JointMap::default(),
    };
    for pair in pairs.split(',').filter(|pair| !pair.is_empty()) {
        let (target, source) = pair.split_once('-')?;
        let target: usize = target.parse().ok()?;
        let source = if source.is_empty() { None } else { Some(SourceRef::Number(source.parse().ok()?)) };
        let entry = MapEntry { source, correction: Quat::IDENTITY, unmapped: None };
        if map.joints.insert(format!("#{target}"), entry).is_some() {
            return None;
        }
    }
    Some(NumberedMap { checksum, map })
}

/// A joint of which the map says nothing but its source.
fn plain_pair(key: &str, entry: &MapEntry) -> Option<(usize, Option<usize>)> {
    let target = number_of(key).filter(|target| format!("#{target}") == key)?;
    if entry.unmapped.is_some() || entry.correction != Quat::IDENTITY {
        return None;
    }
    match entry.source {
        None => Some((target, None)),
        Some(SourceRef::Number(source)) => Some((target, Some(source))),
        Some(SourceRef::Name(_)) => None,
    }
}
