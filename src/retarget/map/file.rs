//! The joint map as it is written in files (`{"gaitway_map": 1, …}`): which target joint follows which source joint, and
//! how. Its names are looked up in two skeletons by `resolve`.

use std::collections::BTreeMap;

use glam::Quat;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::error::MapError;
use super::options::{Feet, Keep, RestChoices, RootOptions};
use crate::anim::ClipQuery;

/// A whole map, as written. Joints that it does not name have no source.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointMap {
    /// Version of the format: 1.
    pub gaitway_map: u32,
    /// By target joint: its name, or `#NODE` if it has none or shares it.
    #[serde(default, deserialize_with = "unique_entries")]
    pub joints: BTreeMap<String, MapEntry>,
    #[serde(default)]
    pub unmapped: Unmapped,
    #[serde(default)]
    pub rest: RestChoices,
    #[serde(default)]
    pub root: RootOptions,
    #[serde(default)]
    pub translations: Keep,
    #[serde(default)]
    pub scales: Keep,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub muted_channels: Vec<MutedChannel>,
    #[serde(default)]
    pub feet: Feet,
    #[serde(default)]
    pub crossfade_secs: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapEntry {
    /// None (`null`): deliberately without a source.
    pub source: Option<SourceRef>,
    /// Rotation offset in the joint's own space, as x y z w.
    #[serde(default, skip_serializing_if = "is_identity")]
    pub correction: Quat,
    /// What the joint does without a source; by default what the map says for all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unmapped: Option<Unmapped>,
}

fn is_identity(rotation: &Quat) -> bool {
    *rotation == Quat::IDENTITY
}

/// A source joint by its number in its own file, or by its name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected a joint's name, its number (0, 1, …) or null")]
pub enum SourceRef {
    Number(usize),
    Name(String),
}

/// A clip of the model by its index or by its name.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected a clip's name or its index (0, 1, …)")]
pub enum ClipRef {
    Index(usize),
    Name(String),
}

impl ClipRef {
    pub fn query(&self) -> ClipQuery<'_> {
        match self {
            Self::Index(index) => ClipQuery::Index(*index),
            Self::Name(name) => ClipQuery::Name(name),
        }
    }
}

/// What joints without a source do: the word `"rest"`, or one of the model's own clips.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "UnmappedForm", into = "UnmappedForm")]
pub enum Unmapped {
    #[default]
    Rest,
    Clip {
        clip: ClipRef,
        /// Holds the clip's first key.
        frozen: bool,
    },
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected \"rest\" or {\"clip\": NAME or INDEX}, with \"hold\": \"first-key\" to freeze it"
)]
enum UnmappedForm {
    Word(String),
    Clip(ClipForm),
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ClipForm {
    clip: ClipRef,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    hold: Option<String>,
}

impl TryFrom<UnmappedForm> for Unmapped {
    type Error = String;

    fn try_from(form: UnmappedForm) -> Result<Self, String> {
        match form {
            UnmappedForm::Word(word) if word == "rest" => Ok(Self::Rest),
            UnmappedForm::Word(word) => Err(format!("expected \"rest\" or {{\"clip\": …}}, found “{word}”")),
            UnmappedForm::Clip(ClipForm { clip, hold }) => match hold.as_deref() {
                None => Ok(Self::Clip { clip, frozen: false }),
                Some("first-key") => Ok(Self::Clip { clip, frozen: true }),
                Some(other) => Err(format!("expected \"hold\": \"first-key\", found “{other}”")),
            },
        }
    }
}

impl From<Unmapped> for UnmappedForm {
    fn from(unmapped: Unmapped) -> Self {
        match unmapped {
            Unmapped::Rest => Self::Word("rest".to_owned()),
            Unmapped::Clip { clip, frozen } => {
                Self::Clip(ClipForm { clip, hold: frozen.then(|| "first-key".to_owned()) })
            }
        }
    }
}

/// Refuses a joint that appears twice, which would silently lose one of its entries.
fn unique_entries<'de, D: Deserializer<'de>>(deserializer: D) -> Result<BTreeMap<String, MapEntry>, D::Error> {
    struct Entries;

    impl<'de> Visitor<'de> for Entries {
        type Value = BTreeMap<String, MapEntry>;

        fn expecting(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
            formatter.write_str("an object of target joints and what they follow")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut entries = BTreeMap::new();
            while let Some((name, entry)) = map.next_entry::<String, MapEntry>()? {
                if entries.contains_key(&name) {
                    return Err(A::Error::custom(format!("“{name}” appears twice; keep one of the two")));
                }
                entries.insert(name, entry);
            }
            Ok(entries)
        }
    }

    deserializer.deserialize_map(Entries)
}

/// A channel of the motion to ignore.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MutedChannel {
    pub source: SourceRef,
    /// By default all of the joint's channels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub property: Option<MutedProperty>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MutedProperty {
    Translation,
    Rotation,
    Scale,
}

impl JointMap {
    /// Reads a map's JSON.
    ///
    /// # Errors
    /// If it is not a map of version 1. Unknown members are errors: a misspelt one would have no effect.
    pub fn from_json(text: &str) -> Result<Self, MapError> {
        let text = text.trim_start_matches('\u{feff}');
        // The version comes first: another one has other rules.
        let version = serde_json::from_str(text).map(|form: serde_json::Value| form.get("gaitway_map").cloned());
        match version {
            Ok(Some(version)) if version == 1 => {}
            Ok(Some(version)) => return Err(MapError::Version { found: version.to_string() }),
            Ok(None) => return Err(MapError::NotAMap),
            Err(error) => return Err(MapError::NotJson { message: error.to_string() }),
        }
        let stripped = without_explanations(text);
        let text = stripped.as_deref().unwrap_or(text);
        serde_path_to_error::deserialize(&mut serde_json::Deserializer::from_str(text)).map_err(|error| {
            let path = error.path().to_string();
            MapError::Json { path, message: error.into_inner().to_string() }
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

/// Removes what `gaitway map --json` adds to a map, so that its output can be used as one. That output is recognised by its
/// "unused_sources"; None for any other text, which is read strictly.
fn without_explanations(text: &str) -> Option<String> {
    let mut form: serde_json::Value = serde_json::from_str(text).ok()?;
    let map = form.as_object_mut()?;
    map.remove("unused_sources")?;
    map.remove("unmapped_targets");
    map.remove("warnings");
    let entries = map.get_mut("joints").and_then(serde_json::Value::as_object_mut);
    for entry in entries.into_iter().flat_map(|joints| joints.values_mut()).filter_map(|entry| entry.as_object_mut()) {
        for explanation in ["slot", "reason", "confidence"] {
            entry.remove(explanation);
        }
    }
    Some(form.to_string())
}

impl Default for JointMap {
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
            crossfade_secs: 0.0,
        }
    }
}
