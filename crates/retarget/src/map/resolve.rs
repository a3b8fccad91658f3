//! Resolves a joint map: turns its joint numbers and clips into indices of a model and a motion.

use std::collections::HashSet;

use gaitway_character::anim::{JointIndex, Property, Skeleton, find_clip};
use gaitway_character::asset::Asset;
use gaitway_character::sort::{sort_by, sort_by_key};
use glam::{DQuat, Quat};

use super::error::MapError;
use super::expressions::has_expressions_alone;
use super::joint_map::{JointMap, MutedChannel, MutedProperty};
use super::resolved::{Layer, Pair, ResolvedMap};
use super::unmapped::{ClipRef, Unmapped};

impl JointMap {
    /// Looks up every joint and clip of the map: targets and clips in `model`, sources in `motion`.
    ///
    /// # Errors
    /// If a number, clip or option is out of range, or no joint has a source although the motion moves some.
    pub fn resolve(&self, model: &Asset, motion: &Asset) -> Result<ResolvedMap, MapError> {
        check_crossfade(self.crossfade_secs)?;
        let joints = resolve_joints(self, model, motion)?;
        if joints.pairs.is_empty() && !has_expressions_alone(motion) {
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
            without_source: joints.without_source,
            layers,
            rest: self.rest,
            root: self.root,
            translations: self.translations,
            scales: self.scales,
            muted: resolve_muted(&self.muted_channels, &motion.skeleton)?,
            feet: self.feet,
            contacts: self.contacts,
            chains: self.chains,
            crossfade_secs: self.crossfade_secs,
        })
    }
}

/// A clip by its index, and whether it is frozen; None for the rest pose.
type LayerChoice = Option<(usize, bool)>;

/// The map's entries, resolved.
struct ResolvedJoints {
    /// Ascending by target.
    pairs: Vec<Pair>,
    /// Ascending.
    without_source: Vec<JointIndex>,
    /// By target joint; None where the map's default applies.
    layers: Vec<Option<LayerChoice>>,
}

fn resolve_joints(map: &JointMap, model: &Asset, motion: &Asset) -> Result<ResolvedJoints, MapError> {
    let (mut pairs, mut without_source) = (Vec::new(), Vec::new());
    let mut layers = vec![None; model.skeleton.len()];
    for (&number, entry) in &map.joints {
        let path = format!("joints.#{number}");
        let target = model.skeleton.joint_of_source(number).ok_or_else(|| MapError::TargetOutOfRange {
            path: path.clone(),
            number: number.to_string(),
            count: model.skeleton.len(),
        })?;
        let correction = normalize_correction(entry.correction, &path)?;
        if let Some(source) = entry.source {
            let source = source_joint(&motion.skeleton, source, &format!("{path}.source"))?;
            pairs.push(Pair { target, source, correction });
        } else {
            without_source.push(target);
        }
        layers[target.get()] = match &entry.unmapped {
            Some(unmapped) => Some(resolve_layer(model, unmapped, &format!("{path}.unmapped"))?),
            None => None,
        };
    }
    sort_by_key(&mut pairs, |pair: &Pair| pair.target);
    sort_by(&mut without_source, Ord::cmp);
    Ok(ResolvedJoints { pairs, without_source, layers })
}

/// The joint of the motion with this number in its file.
pub(super) fn source_joint(motion: &Skeleton, number: usize, path: &str) -> Result<JointIndex, MapError> {
    motion.joint_of_source(number).ok_or_else(|| MapError::SourceOutOfRange {
        path: path.to_owned(),
        number,
        count: motion.len(),
    })
}

pub(super) fn check_crossfade(secs: f64) -> Result<(), MapError> {
    if secs >= 0.0 && secs.is_finite() { Ok(()) } else { Err(MapError::Crossfade { found: secs }) }
}

pub(super) fn resolve_layer(model: &Asset, unmapped: &Unmapped, path: &str) -> Result<LayerChoice, MapError> {
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
fn resolve_muted(channels: &[MutedChannel], motion: &Skeleton) -> Result<Vec<(JointIndex, Property)>, MapError> {
    let (mut muted, mut seen) = (Vec::new(), HashSet::new());
    for (index, channel) in channels.iter().enumerate() {
        let joint = source_joint(motion, channel.source, &format!("muted_channels[{index}].source"))?;
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
pub(super) fn normalize_correction(correction: Quat, path: &str) -> Result<Quat, MapError> {
    let double = correction.as_dquat();
    let length = double.length();
    if !length.is_finite() || length < 1e-6 {
        return Err(MapError::Correction { path: format!("{path}.correction"), found: correction.to_array() });
    }
    Ok(DQuat::from_xyzw(double.x / length, double.y / length, double.z / length, double.w / length).as_quat())
}
