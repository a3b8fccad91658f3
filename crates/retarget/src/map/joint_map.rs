//! The joint map in memory: which target joint follows which source joint, and how, by the joints' numbers in their
//! files.

use std::collections::BTreeMap;

use glam::Quat;
use serde::{Deserialize, Serialize};

use super::options::{Chains, Contacts, Feet, Keep, PathOrigin, RestChoices, RootOptions};
use super::unmapped::Unmapped;

/// A joint map for one model and one motion. Joints without an entry have no source.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct JointMap {
    /// By target joint.
    pub joints: BTreeMap<usize, MapEntry>,
    /// What joints without a source do, unless their entry says otherwise.
    pub unmapped: Unmapped,
    /// Which poses count as the rests of both skeletons.
    pub rest: RestChoices,
    /// What happens to the root motion.
    pub root: RootOptions,
    /// Translations of mapped joints other than the hips.
    pub translations: Keep,
    /// Scales of mapped joints.
    pub scales: Keep,
    /// Channels of the motion to ignore.
    pub muted_channels: Vec<MutedChannel>,
    /// Whether feet are planted.
    pub feet: Feet,
    /// Whether contacts of hands and knees are kept.
    pub contacts: Contacts,
    /// Whether chains of different numbers of joints share their bend, and twist joints and helpers follow.
    pub chains: Chains,
    /// Crossfade to and from the retargeted clips, 0 or more.
    pub crossfade_secs: f64,
}

/// What a map says about one target joint. `S` identifies the source: by number, or as a file writes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapEntry<S = usize> {
    /// None (`null` in a file): deliberately without a source.
    pub source: Option<S>,
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

impl<S> MapEntry<S> {
    /// Creates an entry that follows `source`, with default options.
    pub fn following(source: Option<S>) -> Self {
        Self { source, correction: Quat::IDENTITY, unmapped: None }
    }
}

/// A channel of the motion to ignore.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MutedChannel<S = usize> {
    /// The joint of the motion.
    pub source: S,
    /// By default all of the joint's channels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub property: Option<MutedProperty>,
}

/// The property of a muted channel. Morph weights cannot be muted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MutedProperty {
    /// The joint's translation.
    Translation,
    /// The joint's rotation.
    Rotation,
    /// The joint's scale.
    Scale,
}

impl JointMap {
    /// A map without joints, with the options that Gaitway proposes. Where files and links leave one out, [`Self::default`] holds,
    /// which never changes.
    pub fn with_proposed_options() -> Self {
        Self {
            root: RootOptions { origin: PathOrigin::Feet, ..RootOptions::default() },
            chains: Chains::Share,
            ..Self::default()
        }
    }

    /// The source of a target joint. None if the map does not mention the joint, `Some(None)` if it is deliberately without
    /// one.
    pub fn source_of(&self, target: usize) -> Option<Option<usize>> {
        self.joints.get(&target).map(|entry| entry.source)
    }
}
