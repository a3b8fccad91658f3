//! Edits of a motion's joint map, besides choosing a source.

use gaitway_character::asset::Asset;
use gaitway_retarget::{
    JointMap, Keep, MapEntry, MutedChannel, MutedProperty, Proposal, RestChoices, Unmapped, opposite_joints,
};
use glam::Quat;

use super::{ViewerState, maps};
use crate::library::{Library, MotionId};

/// An edit of a joint map. Joints are identified by their numbers in their own files.
#[derive(Debug, Clone, PartialEq)]
pub enum MapEdit {
    /// Replaces the whole map and clears the view's overrides, so that everything in the map takes effect.
    Load(Box<JointMap>),
    /// Removes all entries.
    Clear,
    /// Joints that follow the left side follow the right, and vice versa.
    SwapSides,
    /// Sets a joint's rotation offset, in its own space.
    Correction {
        /// Joint of the model.
        target: usize,
        /// Normalized when applied; ignored if close to zero or not finite.
        correction: Quat,
    },
    /// What a joint does without a source; None for the map's default.
    Unmapped {
        /// Joint of the model.
        target: usize,
        /// For this joint alone.
        unmapped: Option<Unmapped>,
    },
    /// Mutes or unmutes one channel of the motion.
    Mute {
        /// Joint of the motion.
        source: usize,
        /// The channel.
        property: MutedProperty,
        /// Whether to ignore the channel.
        muted: bool,
    },
    /// Unmutes all channels.
    UnmuteAll,
    /// Sets which poses count as the skeletons' rest.
    Rest(RestChoices),
    /// Sets whether translations of joints other than the hips are carried over.
    Translations(Keep),
    /// Sets whether scales of joints other than the hips are carried over.
    Scales(Keep),
    /// Length of the crossfade to and from the borrowed clips.
    CrossfadeSecs(f64),
}

const MAX_CROSSFADE_SECS: f64 = 10.0;

const PROPERTIES: [MutedProperty; 3] = [MutedProperty::Translation, MutedProperty::Rotation, MutedProperty::Scale];

/// Applies an edit. Joint numbers and values that are out of range change nothing.
pub(super) fn edit_map(state: &mut ViewerState, library: &Library, motion: &MotionId, edit: MapEdit) {
    let (Some(model), Some(about)) = (library.active(), library.motion(motion)) else { return };
    let mut map = maps::own_map(library, state, motion).cloned().unwrap_or_default();
    let has_target = |target: usize| model.asset.skeleton.joint_of_source(target).is_some();
    match edit {
        MapEdit::Load(new) => {
            map = *new;
            (state.character.retarget.unmapped, state.character.retarget.root) = (None, None);
            state.character.retarget.set_feet(None);
            state.character.retarget.contacts = None;
        }
        MapEdit::Clear => map.joints.clear(),
        MapEdit::SwapSides => {
            if let Some(proposal) = library.proposal(motion) {
                swap_sides(&mut map, &model.asset, &about.asset, proposal);
            }
        }
        MapEdit::Correction { target, correction } => {
            if has_target(target) && correction.is_finite() && correction.length_squared() > 1e-6 {
                entry(&mut map, target).correction = correction.normalize();
            }
        }
        MapEdit::Unmapped { target, unmapped } => {
            if has_target(target) {
                entry(&mut map, target).unmapped = unmapped;
            }
        }
        MapEdit::Mute { source, property, muted } => {
            if about.asset.skeleton.joint_of_source(source).is_some() {
                mute(&mut map, source, property, muted);
            }
        }
        MapEdit::UnmuteAll => map.muted_channels.clear(),
        MapEdit::Rest(rest) => map.rest = rest,
        MapEdit::Translations(keep) => map.translations = keep,
        MapEdit::Scales(keep) => map.scales = keep,
        MapEdit::CrossfadeSecs(secs) => {
            if secs.is_finite() {
                map.crossfade_secs = secs.clamp(0.0, MAX_CROSSFADE_SECS);
            }
        }
    }
    maps::set_map(state, library, motion, Some(map));
}

fn entry(map: &mut JointMap, target: usize) -> &mut MapEntry {
    map.joints.entry(target).or_insert(MapEntry::following(None))
}

/// Returns which channels of a source joint a map mutes, in the order translation, rotation, scale.
pub fn muted_properties(map: &JointMap, source: usize) -> [bool; 3] {
    let about = map.muted_channels.iter().filter(|channel| channel.source == source);
    let mut muted = [false; 3];
    for channel in about {
        for (muted, property) in muted.iter_mut().zip(PROPERTIES) {
            *muted |= channel.property.is_none_or(|other| other == property);
        }
    }
    muted
}

fn mute(map: &mut JointMap, source: usize, property: MutedProperty, muted: bool) {
    let mut now = muted_properties(map, source);
    for (now, other) in now.iter_mut().zip(PROPERTIES) {
        *now = if other == property { muted } else { *now };
    }
    map.muted_channels.retain(|channel| channel.source != source);
    if now == [true; 3] {
        map.muted_channels.push(MutedChannel { source, property: None });
    } else {
        let muted = PROPERTIES.into_iter().zip(now).filter(|(_, muted)| *muted);
        let channel = |(property, _)| MutedChannel { source, property: Some(property) };
        map.muted_channels.extend(muted.map(channel));
    }
}

/// Replaces every source by its counterpart on the other side; if the motion's sides are unknown, swaps the sources of
/// opposite targets instead.
fn swap_sides(map: &mut JointMap, model: &Asset, motion: &Asset, proposal: &Proposal) {
    let opposite = opposite_joints(&motion.skeleton, &proposal.motion);
    let mut swapped = false;
    for entry in map.joints.values_mut() {
        let Some(number) = &mut entry.source else { continue };
        let joint = motion.skeleton.joint_of_source(*number);
        if let Some(other) = joint.and_then(|joint| opposite[joint.get()]) {
            *number = motion.skeleton.source_index(other);
            swapped = true;
        }
    }
    if swapped {
        return;
    }
    let opposite = opposite_joints(&model.skeleton, &proposal.model);
    let old = map.joints.clone();
    for joint in model.skeleton.joints() {
        let Some(other) = opposite[joint.get()] else { continue };
        let other = old.get(&model.skeleton.source_index(other)).and_then(|entry| entry.source);
        let target = model.skeleton.source_index(joint);
        if other.is_some() || old.contains_key(&target) {
            entry(map, target).source = other;
        }
    }
}
