//! Looks the names of a joint map up in two skeletons.

use std::collections::{BTreeMap, HashSet};

use glam::Quat;

use super::file::{ClipRef, JointMap, MutedProperty, SourceRef, Unmapped};
use super::resolved::{Layer, Pair, ResolvedMap};
use crate::anim::{JointIndex, Property, Skeleton};
use crate::asset::Asset;

/// Why a joint map does not fit a model and a motion. `path` is the place in the map's JSON.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MapError {
    #[error("not JSON: {message}")]
    NoJson { message: String },
    #[error("not a joint map: it has no “gaitway_map”")]
    NoMap,
    #[error("gaitway_map is {found}; this program reads version 1")]
    Version { found: String },
    #[error("{path}: {message}")]
    Json { path: String, message: String },
    #[error("{path}: the model has no joint “{name}”{}", nearest_text(.nearest))]
    NoTarget { path: String, name: String, nearest: Vec<String> },
    #[error("{path}: the motion has no joint “{name}”{}", nearest_text(.nearest))]
    NoSource { path: String, name: String, nearest: Vec<String> },
    #[error("{path}: the model has no node {number}: it has {count}, numbered from 0")]
    TargetOutOfRange { path: String, number: String, count: usize },
    #[error("{path}: the motion has no channel {number}: it has {count} joints, 0 to {}", .count.saturating_sub(1))]
    SourceOutOfRange { path: String, number: usize, count: usize },
    #[error("{path}: {} joints of the model are called “{name}”: write one of {}", .numbers.len(), numbers_text(.numbers, "#"))]
    AmbiguousTarget { path: String, name: String, numbers: Vec<usize> },
    #[error("{path}: {} joints of the motion are called “{name}”: write one of their numbers, {}", .numbers.len(), numbers_text(.numbers, ""))]
    AmbiguousSource { path: String, name: String, numbers: Vec<usize> },
    #[error("{path}: “{first}” and “{second}” are the same joint of the model; keep one of them")]
    SameTarget { path: String, first: String, second: String },
    #[error("{path}: the model has no clip {clip}; it has {}", clips_text(.clips))]
    NoClip { path: String, clip: String, clips: Vec<String> },
    #[error("{path}: [{}, {}, {}, {}] is no rotation; it must be finite and not all zero", .found[0], .found[1], .found[2], .found[3])]
    Correction { path: String, found: [f32; 4] },
    #[error("crossfade_secs is {found}; it must be 0 or more")]
    Crossfade { found: f64 },
    #[error("no joint of the model follows the motion: the map names no source")]
    NothingMapped,
    #[error(
        "the model and the motion have no joint in common: neither names nor body parts agree. Write a map by hand, as docs/joint-maps.md says"
    )]
    NothingInCommon,
}

fn nearest_text(nearest: &[String]) -> String {
    if nearest.is_empty() { String::new() } else { format!("; nearest: {}", nearest.join(", ")) }
}

fn numbers_text(numbers: &[usize], mark: &str) -> String {
    numbers.iter().map(|number| format!("{mark}{number}")).collect::<Vec<_>>().join(", ")
}

fn clips_text(clips: &[String]) -> String {
    if clips.is_empty() {
        return "none".to_owned();
    }
    let named = clips.iter().enumerate().map(|(index, name)| format!("{index} “{name}”"));
    named.collect::<Vec<_>>().join(", ")
}

impl JointMap {
    /// Finds every joint and clip that the map names: targets and clips in `model`, sources in `motion`.
    pub fn resolve(&self, model: &Asset, motion: &Asset) -> Result<ResolvedMap, MapError> {
        if self.gaitway_map != 1 {
            return Err(MapError::Version { found: self.gaitway_map.to_string() });
        }
        if !(self.crossfade_secs >= 0.0 && self.crossfade_secs.is_finite()) {
            return Err(MapError::Crossfade { found: self.crossfade_secs });
        }
        let (target_names, source_names) = (Names::new(&model.skeleton), Names::new(&motion.skeleton));
        let mut targets: Vec<Option<&str>> = vec![None; model.skeleton.len()];
        let mut pairs = Vec::new();
        let mut own = vec![None; model.skeleton.len()];
        for (name, entry) in &self.joints {
            let path = format!("joints.{name}");
            let target = target_names.find_target(name, &path)?;
            if let Some(first) = targets[target.get()].replace(name) {
                return Err(MapError::SameTarget { path, first: first.to_owned(), second: name.clone() });
            }
            let correction = unit(entry.correction, &path)?;
            if let Some(source) = &entry.source {
                let source = source_names.find_source(source, &format!("{path}.source"))?;
                pairs.push(Pair { target, source, correction });
            }
            own[target.get()] = match &entry.unmapped {
                Some(unmapped) => Some(find_layer(model, unmapped, &format!("{path}.unmapped"))?),
                None => None,
            };
        }
        if pairs.is_empty() {
            return Err(MapError::NothingMapped);
        }
        pairs.sort_by_key(|pair: &Pair| pair.target);
        let common = find_layer(model, &self.unmapped, "unmapped")?;
        let mut layers = Vec::new();
        for joint in model.skeleton.joints() {
            if pairs.binary_search_by_key(&joint, |pair| pair.target).is_ok() {
                continue;
            }
            if let Some((clip, frozen)) = own[joint.get()].unwrap_or(common) {
                layers.push(Layer { joint, clip, frozen });
            }
        }
        let (mut muted, mut seen) = (Vec::new(), HashSet::new());
        for (index, channel) in self.muted_channels.iter().enumerate() {
            let joint = source_names.find_source(&channel.source, &format!("muted_channels[{index}].source"))?;
            let properties: &[Property] = match channel.property {
                Some(MutedProperty::Translation) => &[Property::Translation],
                Some(MutedProperty::Rotation) => &[Property::Rotation],
                Some(MutedProperty::Scale) => &[Property::Scale],
                None => &[Property::Translation, Property::Rotation, Property::Scale],
            };
            for &property in properties {
                if seen.insert((joint, property)) {
                    muted.push((joint, property));
                }
            }
        }
        Ok(ResolvedMap {
            pairs,
            layers,
            rest: self.rest,
            root: self.root,
            translations: self.translations,
            scales: self.scales,
            muted,
            feet: self.feet,
            crossfade_secs: self.crossfade_secs,
        })
    }
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

    fn called(&self, name: &str) -> &[JointIndex] {
        self.joints.get(name).map(Vec::as_slice).unwrap_or_default()
    }

    /// A name, or `#NODE`. A joint that is really called `#3` is found by that name first.
    fn find_target(&self, name: &str, path: &str) -> Result<JointIndex, MapError> {
        let (path, name) = (path.to_owned(), name.to_owned());
        match (self.called(&name), name.strip_prefix('#')) {
            ([joint], _) => Ok(*joint),
            ([], Some(number)) => {
                let found = number.parse().ok().and_then(|number| self.skeleton.joint_of_source(number));
                let number = number.to_owned();
                found.ok_or(MapError::TargetOutOfRange { path, number, count: self.skeleton.len() })
            }
            ([], None) => Err(MapError::NoTarget { path, nearest: self.nearest(&name), name }),
            (same, _) => {
                let numbers = numbers_of(self.skeleton, same);
                Err(MapError::AmbiguousTarget { path, name, numbers })
            }
        }
    }

    fn find_source(&self, source: &SourceRef, path: &str) -> Result<JointIndex, MapError> {
        let path = path.to_owned();
        match source {
            SourceRef::Number(number) => {
                let found = self.skeleton.joint_of_source(*number);
                found.ok_or(MapError::SourceOutOfRange { path, number: *number, count: self.skeleton.len() })
            }
            SourceRef::Name(name) => match self.called(name) {
                [joint] => Ok(*joint),
                [] => Err(MapError::NoSource { path, nearest: self.nearest(name), name: name.clone() }),
                same => {
                    let numbers = numbers_of(self.skeleton, same);
                    Err(MapError::AmbiguousSource { path, name: name.clone(), numbers })
                }
            },
        }
    }

    /// The names most alike, best first; none when nothing is alike.
    fn nearest(&self, name: &str) -> Vec<String> {
        let wanted = name.to_lowercase();
        let mut scored: Vec<(f64, &str)> = self
            .joints
            .keys()
            .filter(|other| !other.is_empty())
            .map(|&other| (strsim::jaro_winkler(&wanted, &other.to_lowercase()), other))
            .filter(|(score, _)| *score >= ALIKE)
            .collect();
        scored.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(b.1)));
        scored.into_iter().take(OFFERED).map(|(_, other)| other.to_owned()).collect()
    }
}

fn numbers_of(skeleton: &Skeleton, joints: &[JointIndex]) -> Vec<usize> {
    let mut numbers: Vec<usize> = joints.iter().map(|&joint| skeleton.source_index(joint)).collect();
    numbers.sort_unstable();
    numbers
}

/// The clip and whether it is frozen; none for rest.
fn find_layer(model: &Asset, unmapped: &Unmapped, path: &str) -> Result<Option<(usize, bool)>, MapError> {
    let Unmapped::Clip { clip, frozen } = unmapped else { return Ok(None) };
    let found = match clip {
        ClipRef::Index(index) => (*index < model.clips.len()).then_some(*index),
        ClipRef::Name(name) => model.clips.iter().position(|clip| clip.name() == name),
    };
    let index = found.ok_or_else(|| MapError::NoClip {
        path: format!("{path}.clip"),
        clip: match clip {
            ClipRef::Index(index) => index.to_string(),
            ClipRef::Name(name) => format!("“{name}”"),
        },
        clips: model.clips.iter().map(|clip| clip.name().to_owned()).collect(),
    })?;
    Ok(Some((index, *frozen)))
}

/// As long as 1. Nearly zero or not finite says nothing of a rotation.
fn unit(correction: Quat, path: &str) -> Result<Quat, MapError> {
    let length = correction.as_dquat().length();
    if !length.is_finite() || length < 1e-6 {
        return Err(MapError::Correction { path: format!("{path}.correction"), found: correction.to_array() });
    }
    let double = correction.as_dquat();
    Ok(glam::DQuat::from_xyzw(double.x / length, double.y / length, double.z / length, double.w / length).as_quat())
}

/// How many names are offered for one that is not there.
const OFFERED: usize = 3;

/// So much alike (0 nothing, 1 the same) a name must be to be offered.
const ALIKE: f64 = 0.6;
