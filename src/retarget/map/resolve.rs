//! Resolves a joint map: looks its names up in two skeletons.

use std::collections::{BTreeMap, HashSet};

use glam::{DQuat, Quat};

use super::error::MapError;
use super::file::{ClipRef, JointMap, MutedChannel, MutedProperty, SourceRef, Unmapped};
use super::resolved::{Layer, Pair, ResolvedMap};
use crate::anim::{JointIndex, Property, Skeleton, find_clip};
use crate::asset::Asset;

/// Maximum number of similar names to suggest for one that is not found.
const MAX_SUGGESTIONS: usize = 3;

/// Minimum similarity of a suggested name, from 0 to 1.
const MIN_SIMILARITY: f64 = 0.6;

impl JointMap {
    /// Looks up every joint and clip of the map: targets and clips in `model`, sources in `motion`.
    ///
    /// # Errors
    /// If a name is missing or ambiguous, an option is out of range, or no joint has a source.
    pub fn resolve(&self, model: &Asset, motion: &Asset) -> Result<ResolvedMap, MapError> {
        if self.gaitway_map != 1 {
            return Err(MapError::Version { found: self.gaitway_map.to_string() });
        }
        if !(self.crossfade_secs >= 0.0 && self.crossfade_secs.is_finite()) {
            return Err(MapError::Crossfade { found: self.crossfade_secs });
        }
        let source_names = Names::new(&motion.skeleton);
        let joints = resolve_joints(self, model, &source_names)?;
        if joints.pairs.is_empty() {
            return Err(MapError::NothingMapped);
        }
        let default_layer = resolve_layer(model, &self.unmapped, "unmapped")?;
        let mut layers = Vec::new();
        for joint in model.skeleton.joints() {
            if joints.pairs.binary_search_by_key(&joint, |pair| pair.target).is_ok() {
                continue;
            }
            if let Some((clip, frozen)) = joints.layers[joint.get()].unwrap_or(default_layer) {
                layers.push(Layer { joint, clip, frozen });
            }
        }
        Ok(ResolvedMap {
            pairs: joints.pairs,
            layers,
            rest: self.rest,
            root: self.root,
            translations: self.translations,
            scales: self.scales,
            muted: resolve_muted(&self.muted_channels, &source_names)?,
            feet: self.feet,
            crossfade_secs: self.crossfade_secs,
        })
    }
}

/// A clip by its index, and whether it is frozen; None for the rest pose.
type LayerChoice = Option<(usize, bool)>;

/// What the map's entries say.
struct ResolvedJoints {
    /// Ascending by target.
    pairs: Vec<Pair>,
    /// By target joint; None where the map's default applies.
    layers: Vec<Option<LayerChoice>>,
}

fn resolve_joints(map: &JointMap, model: &Asset, source_names: &Names) -> Result<ResolvedJoints, MapError> {
    let target_names = Names::new(&model.skeleton);
    let mut name_of_target: Vec<Option<&str>> = vec![None; model.skeleton.len()];
    let mut pairs = Vec::new();
    let mut layers = vec![None; model.skeleton.len()];
    for (name, entry) in &map.joints {
        let path = format!("joints.{name}");
        let target = target_names.find_target(name, &path)?;
        if let Some(first) = name_of_target[target.get()].replace(name) {
            return Err(MapError::SameTarget { path, first: first.to_owned(), second: name.clone() });
        }
        let correction = normalize_correction(entry.correction, &path)?;
        if let Some(source) = &entry.source {
            let source = source_names.find_source(source, &format!("{path}.source"))?;
            pairs.push(Pair { target, source, correction });
        }
        layers[target.get()] = match &entry.unmapped {
            Some(unmapped) => Some(resolve_layer(model, unmapped, &format!("{path}.unmapped"))?),
            None => None,
        };
    }
    pairs.sort_by_key(|pair: &Pair| pair.target);
    Ok(ResolvedJoints { pairs, layers })
}

fn resolve_layer(model: &Asset, unmapped: &Unmapped, path: &str) -> Result<LayerChoice, MapError> {
    let Unmapped::Clip { clip, frozen } = unmapped else { return Ok(None) };
    let index = find_clip(model.clips.iter(), clip.query()).ok_or_else(|| MapError::NoClip {
        path: format!("{path}.clip"),
        clip: match clip {
            ClipRef::Index(index) => index.to_string(),
            ClipRef::Name(name) => format!("“{name}”"),
        },
        clips: model.clips.iter().map(|clip| clip.name().to_owned()).collect(),
    })?;
    Ok(Some((index, *frozen)))
}

/// Channels in the order of the map, without duplicates.
fn resolve_muted(channels: &[MutedChannel], names: &Names) -> Result<Vec<(JointIndex, Property)>, MapError> {
    let (mut muted, mut seen) = (Vec::new(), HashSet::new());
    for (index, channel) in channels.iter().enumerate() {
        let joint = names.find_source(&channel.source, &format!("muted_channels[{index}].source"))?;
        let properties: &[Property] = match channel.property {
            Some(MutedProperty::Translation) => &[Property::Translation],
            Some(MutedProperty::Rotation) => &[Property::Rotation],
            Some(MutedProperty::Scale) => &[Property::Scale],
            None => &[Property::Translation, Property::Rotation, Property::Scale],
        };
        muted.extend(properties.iter().map(|&property| (joint, property)).filter(|&channel| seen.insert(channel)));
    }
    Ok(muted)
}

/// A quaternion that is nearly zero or not finite is not a rotation.
fn normalize_correction(correction: Quat, path: &str) -> Result<Quat, MapError> {
    let double = correction.as_dquat();
    let length = double.length();
    if !length.is_finite() || length < 1e-6 {
        return Err(MapError::Correction { path: format!("{path}.correction"), found: correction.to_array() });
    }
    Ok(DQuat::from_xyzw(double.x / length, double.y / length, double.z / length, double.w / length).as_quat())
}

/// The joints of a skeleton by name.
struct Names<'a> {
    skeleton: &'a Skeleton,
    joints: BTreeMap<&'a str, Vec<JointIndex>>,
}

impl<'a> Names<'a> {
    fn new(skeleton: &'a Skeleton) -> Self {
        let mut joints: BTreeMap<&str, Vec<JointIndex>> = BTreeMap::new();
        for joint in skeleton.joints() {
            joints.entry(skeleton.name(joint)).or_default().push(joint);
        }
        Self { skeleton, joints }
    }

    fn named(&self, name: &str) -> &[JointIndex] {
        self.joints.get(name).map(Vec::as_slice).unwrap_or_default()
    }

    /// Finds a name, or `#NODE`. A joint that is really called `#3` wins over node 3.
    fn find_target(&self, name: &str, path: &str) -> Result<JointIndex, MapError> {
        let (path, name) = (path.to_owned(), name.to_owned());
        match (self.named(&name), name.strip_prefix('#')) {
            ([joint], _) => Ok(*joint),
            ([], Some(number)) => {
                let found = number.parse().ok().and_then(|number| self.skeleton.joint_of_source(number));
                let number = number.to_owned();
                found.ok_or(MapError::TargetOutOfRange { path, number, count: self.skeleton.len() })
            }
            ([], None) => Err(MapError::NoTarget { path, nearest: self.nearest(&name), name }),
            (same, _) => Err(MapError::AmbiguousTarget { path, name, numbers: self.numbers(same) }),
        }
    }

    fn find_source(&self, source: &SourceRef, path: &str) -> Result<JointIndex, MapError> {
        let path = path.to_owned();
        match source {
            SourceRef::Number(number) => {
                let found = self.skeleton.joint_of_source(*number);
                found.ok_or(MapError::SourceOutOfRange { path, number: *number, count: self.skeleton.len() })
            }
            SourceRef::Name(name) => match self.named(name) {
                [joint] => Ok(*joint),
                [] => Err(MapError::NoSource { path, nearest: self.nearest(name), name: name.clone() }),
                same => Err(MapError::AmbiguousSource { path, name: name.clone(), numbers: self.numbers(same) }),
            },
        }
    }

    /// The most similar names, best first; empty if none is similar enough.
    fn nearest(&self, name: &str) -> Vec<String> {
        let wanted = name.to_lowercase();
        let mut scored: Vec<(f64, &str)> = self
            .joints
            .keys()
            .filter(|other| !other.is_empty())
            .map(|&other| (strsim::jaro_winkler(&wanted, &other.to_lowercase()), other))
            .filter(|(score, _)| *score >= MIN_SIMILARITY)
            .collect();
        scored.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(b.1)));
        scored.into_iter().take(MAX_SUGGESTIONS).map(|(_, other)| other.to_owned()).collect()
    }

    /// The joints' numbers in the file.
    fn numbers(&self, joints: &[JointIndex]) -> Vec<usize> {
        let mut numbers: Vec<usize> = joints.iter().map(|&joint| self.skeleton.source_index(joint)).collect();
        numbers.sort_unstable();
        numbers
    }
}
