//! The joint map: which target joint follows which source joint, and how, in the form that files have it
//! (`{"gaitway_map": 1, …}`). Names are looked up when it is resolved against two skeletons.

use std::collections::BTreeMap;

use glam::Quat;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::resolve::MapError;

/// A whole map, as written. Joints that are not named in it have no source.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointMap {
    /// 1: the version of this form.
    pub gaitway_map: u32,
    /// By target joint: its name, or `#NODE` where it has none or shares it.
    #[serde(default, deserialize_with = "once_each")]
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
    /// Turns the joint further, in its own space: x y z w.
    #[serde(default, skip_serializing_if = "is_identity")]
    pub correction: Quat,
    /// What the joint does when it has no source; absent: what the map says for all.
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

/// What joints without a source do: the word `"rest"`, or one of the model's own clips.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "UnmappedForm", into = "UnmappedForm")]
pub enum Unmapped {
    #[default]
    Rest,
    Clip {
        clip: ClipRef,
        /// The clip's first key for all time.
        frozen: bool,
    },
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected \"rest\" or {\"clip\": NAME or INDEX}, with \"hold\": \"first-key\" if it is to stand still"
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

/// A joint that stands in the file twice would silently lose one of its entries.
fn once_each<'de, D: Deserializer<'de>>(deserializer: D) -> Result<BTreeMap<String, MapEntry>, D::Error> {
    struct Entries;

    impl<'de> Visitor<'de> for Entries {
        type Value = BTreeMap<String, MapEntry>;

        fn expecting(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
            formatter.write_str("an object: target joints and what they follow")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut entries = BTreeMap::new();
            while let Some((name, entry)) = map.next_entry::<String, MapEntry>()? {
                if entries.contains_key(&name) {
                    return Err(A::Error::custom(format!("“{name}” stands here twice; keep one of the two")));
                }
                entries.insert(name, entry);
            }
            Ok(entries)
        }
    }

    deserializer.deserialize_map(Entries)
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RestChoices {
    pub model: RestChoice,
    pub motion: RestChoice,
}

/// Which pose counts as a skeleton's rest.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RestChoice {
    #[default]
    Auto,
    /// The nodes' own transforms.
    Node,
    /// Where the mesh was bound, for joints that a skin covers.
    Bind,
    /// The first key of the clip.
    FirstFrame,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RootOptions {
    pub horizontal: RootPart,
    pub vertical: RootPart,
    pub yaw: RootPart,
    /// Moves what is kept of the travel to the model's root joint.
    pub extract: bool,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RootPart {
    #[default]
    Keep,
    /// Without travel (the line from the first to the last key); the sway stays.
    InPlace,
    /// The first key's value for all time.
    Freeze,
}

/// What becomes of translations or scales of joints other than the hips.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Keep {
    /// Kept when the two skeletons are the same.
    #[default]
    Auto,
    Keep,
    Drop,
}

/// A channel of the motion that is left out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MutedChannel {
    pub source: SourceRef,
    /// Absent: all of the joint's channels.
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

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Feet {
    #[default]
    Off,
    /// Feet stay where they touch the ground.
    Plant,
}

impl JointMap {
    /// Reads the form that files have. Members that are not known are errors: a misspelt one would do nothing.
    pub fn from_json(text: &str) -> Result<Self, MapError> {
        let text = text.trim_start_matches('\u{feff}');
        // The version first: what another one may have in it is not to be judged by this one's rules.
        let version = serde_json::from_str(text).map(|form: serde_json::Value| form.get("gaitway_map").cloned());
        match version {
            Ok(Some(version)) if version == 1 => {}
            Ok(Some(version)) => return Err(MapError::Version { found: version.to_string() }),
            Ok(None) => return Err(MapError::NoMap),
            Err(error) => return Err(MapError::NoJson { message: error.to_string() }),
        }
        let explained = without_explanations(text);
        let text = explained.as_deref().unwrap_or(text);
        serde_path_to_error::deserialize(&mut serde_json::Deserializer::from_str(text)).map_err(|error| {
            let path = error.path().to_string();
            MapError::Json { path, message: error.into_inner().to_string() }
        })
    }

    /// The form that files have, with a final newline. Reading it gives the same map again.
    pub fn to_json(&self) -> Result<String, MapError> {
        let text = serde_json::to_string_pretty(self);
        text.map(|text| text + "\n").map_err(|error| MapError::NoJson { message: error.to_string() })
    }
}

/// `gaitway map --json` says more than a map has, and its "unused_sources" tell; what it says can be used as a map all the
/// same. None for other text, which is read to the letter.
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
