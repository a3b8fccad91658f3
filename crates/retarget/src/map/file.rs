//! The file form of a joint map (`{"gaitway_map": 1, …}`), with joints by name. It exists only where files are read and
//! written; [`JointMapFile::to_joint_map`] looks its names up in two skeletons.

use std::collections::BTreeMap;

use gaitway_character::sort::sort_by;
use gaitway_json_text::{offset_of, path_at, place};
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::value::RawValue;

use super::error::MapError;
use super::joint_map::{MapEntry, MutedChannel};
use super::options::{Chains, Contacts, Feet, Keep, RestChoices, RootOptions};
use super::unmapped::Unmapped;

/// A joint map as written in a file. Joints that it does not name have no source.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointMapFile {
    /// Version of the format: 1.
    pub gaitway_map: u32,
    /// By target joint: its name, or `#NODE` if it has none or shares it.
    #[serde(default, deserialize_with = "unique_entries")]
    pub joints: BTreeMap<String, MapEntry<SourceRef>>,
    /// What joints without a source do, unless their entry says otherwise.
    #[serde(default)]
    pub unmapped: Unmapped,
    /// Which poses count as the rests of both skeletons.
    #[serde(default)]
    pub rest: RestChoices,
    /// What happens to the root motion.
    #[serde(default)]
    pub root: RootOptions,
    /// Translations of mapped joints other than the hips.
    #[serde(default)]
    pub translations: Keep,
    /// Scales of mapped joints.
    #[serde(default)]
    pub scales: Keep,
    /// Channels of the motion to ignore.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub muted_channels: Vec<MutedChannel<SourceRef>>,
    /// Whether feet are planted.
    #[serde(default)]
    pub feet: Feet,
    /// Whether contacts of hands and knees are kept.
    #[serde(default, skip_serializing_if = "Contacts::is_off")]
    pub contacts: Contacts,
    /// Whether chains of different numbers of joints share their bend, and twist joints and helpers follow.
    #[serde(default, skip_serializing_if = "Chains::is_off")]
    pub chains: Chains,
    /// Crossfade to and from the retargeted clips, 0 or more.
    #[serde(default)]
    pub crossfade_secs: f64,
}

/// A source joint by its number in its own file, or by its name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected a joint's name, its number (0, 1, …) or null")]
pub enum SourceRef {
    /// A glTF node index or a BVH joint number.
    Number(usize),
    /// A joint name, which only one joint may have.
    Name(String),
}

/// Rejects a joint that appears twice, which would silently lose one of its entries.
fn unique_entries<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<BTreeMap<String, MapEntry<SourceRef>>, D::Error> {
    struct Entries;

    impl<'de> Visitor<'de> for Entries {
        type Value = BTreeMap<String, MapEntry<SourceRef>>;

        fn expecting(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
            formatter.write_str("an object of target joints and what they follow")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut entries = BTreeMap::new();
            while let Some((name, entry)) = map.next_entry::<String, MapEntry<SourceRef>>()? {
                if entries.contains_key(&name) {
                    return Err(A::Error::custom(format!("“{name}” appears twice; keep one of the two")));
                }
                // Out of range for f32 it would be infinite, which cannot be written back.
                if !entry.correction.is_finite() {
                    return Err(A::Error::custom(format!("a number in the correction of “{name}” is too large")));
                }
                entries.insert(name, entry);
            }
            Ok(entries)
        }
    }

    deserializer.deserialize_map(Entries)
}

impl JointMapFile {
    /// Reads a map's JSON.
    ///
    /// # Errors
    /// If it is not a map of version 1. Unknown members are errors: a misspelt one would have no effect.
    pub fn from_json(text: &str) -> Result<Self, MapError> {
        let text = text.trim_start_matches('\u{feff}');
        // Check the version first: other versions have other rules.
        let version = serde_json::from_str(text).map(|form: serde_json::Value| form.get("gaitway_map").cloned());
        match version {
            Ok(Some(version)) if version == 1 => {}
            Ok(Some(version)) => return Err(MapError::Version { found: version.to_string() }),
            Ok(None) => return Err(MapError::NotAMap),
            Err(error) => return Err(MapError::NotJson { message: error.to_string() }),
        }
        let blanked = without_explanations(text);
        let text = blanked.as_deref().unwrap_or(text);
        serde_json::from_str(text).map_err(|error| {
            let message = error.to_string();
            let end = offset_of(text, error.line(), error.column()).min(text.len());
            // The parser has read one byte more than a number, but all of a list or an object that is too short.
            let is_whole = ["missing field", "invalid length"].iter().any(|start| message.starts_with(start));
            let is_past = !is_whole && matches!(text.as_bytes()[..end].last(), Some(b'}' | b']'));
            let path = place(&path_at(text, end - usize::from(is_past)));
            // The text is valid JSON, so what the parser missed is the name of an option.
            let option = "expected a name in quotation marks (see docs/joint-maps.md) at line ";
            MapError::Json { path, message: message.replacen("expected value at line ", option, 1) }
        })
    }

    /// Writes the map as JSON with a final newline. Reading it gives the same map again.
    ///
    /// # Errors
    /// Never in practice: a map is plain data.
    pub fn to_json(&self) -> Result<String, MapError> {
        let text = serde_json::to_string_pretty(self);
        text.map(|text| text + "\n").map_err(|error| MapError::NotJson { message: error.to_string() })
    }
}

/// The members of an object by name, with their JSON.
type Members<'a> = BTreeMap<String, &'a RawValue>;

/// Blanks what `gaitway map --json` adds to a map, so that its output can be used as one and errors keep their line and column.
/// That output is recognised by its "unused_sources"; None for any other text, which is read strictly.
fn without_explanations(text: &str) -> Option<String> {
    let map: Members = serde_json::from_str(text).ok()?;
    map.get("unused_sources")?;
    let mut blanked = text.to_owned().into_bytes();
    blank_members(&mut blanked, text, text, &["unused_sources", "unmapped_targets", "warnings"]);
    let joints: Members =
        map.get("joints").and_then(|joints| serde_json::from_str(joints.get()).ok()).unwrap_or_default();
    for entry in joints.values() {
        blank_members(&mut blanked, text, entry.get(), &["slot", "reason", "confidence"]);
    }
    String::from_utf8(blanked).ok()
}

/// Overwrites members of `object`, a part of `text`, with spaces in `blanked`, a copy of `text`.
fn blank_members(blanked: &mut [u8], text: &str, object: &str, names: &[&str]) {
    let start_of = |part: &str| part.as_ptr() as usize - text.as_ptr() as usize;
    let members: Members = serde_json::from_str(object).unwrap_or_default();
    let mut members: Vec<(usize, usize, bool)> = members
        .iter()
        .map(|(name, value)| (start_of(value.get()), value.get().len(), names.contains(&name.as_str())))
        .collect();
    sort_by(&mut members, Ord::cmp);
    let mut before = start_of(object) + object.find('{').map_or(0, |brace| brace + 1);
    let mut is_first = true;
    for (start, length, is_unwanted) in members {
        let blank = |byte: &mut u8| *byte = if *byte == b'\n' { b'\n' } else { b' ' };
        if is_unwanted {
            blanked[before..start + length].iter_mut().for_each(blank);
        } else if std::mem::take(&mut is_first) {
            // The comma after a blanked member.
            blanked[before..start].iter_mut().take_while(|byte| **byte != b'"').for_each(blank);
        }
        before = start + length;
    }
}

impl Default for JointMapFile {
    fn default() -> Self {
        Self {
            gaitway_map: 1,
            joints: BTreeMap::new(),
            unmapped: Unmapped::Rest,
            rest: RestChoices::default(),
            root: RootOptions::default(),
            translations: Keep::Auto,
            scales: Keep::Auto,
            muted_channels: Vec::new(),
            feet: Feet::Off,
            contacts: Contacts::Off,
            chains: Chains::Off,
            crossfade_secs: 0.0,
        }
    }
}
