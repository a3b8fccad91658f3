//! A joint map whose names have been looked up in two skeletons: the form that retargeting reads.

use gaitway_character::anim::{JointIndex, Property};
use glam::Quat;

use super::options::{Chains, Contacts, Feet, Keep, RestChoices, RootOptions};

/// A joint map in joint indices, checked against both skeletons.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ResolvedMap {
    /// Ascending by target; each target appears once.
    pub pairs: Vec<Pair>,
    /// Joints that are deliberately without a source, ascending.
    pub without_source: Vec<JointIndex>,
    /// Joints without a source that play one of the model's own clips, ascending. Others rest.
    pub layers: Vec<Layer>,
    /// Which poses count as the rests of both skeletons.
    pub rest: RestChoices,
    /// What happens to the root motion.
    pub root: RootOptions,
    /// Translations of mapped joints other than the hips.
    pub translations: Keep,
    /// Scales of mapped joints.
    pub scales: Keep,
    /// Ignored channels of the motion.
    pub muted: Vec<(JointIndex, Property)>,
    /// Whether feet are planted.
    pub feet: Feet,
    /// Whether contacts of hands and knees are kept.
    pub contacts: Contacts,
    /// Whether chains of different numbers of joints share their bend, and twist joints and helpers follow.
    pub chains: Chains,
    /// Crossfade to and from the retargeted clips, 0 or more.
    pub crossfade_secs: f64,
}

/// A target joint and the source joint that it follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// Joint of the model.
    pub target: JointIndex,
    /// Joint of the motion.
    pub source: JointIndex,
    /// Rotation offset in the target joint's own space, a unit quaternion.
    pub correction: Quat,
}

/// A joint that plays one of the model's own clips.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layer {
    /// Joint of the model.
    pub joint: JointIndex,
    /// Index into [`gaitway_character::asset::AssetParts::clips`] of the model.
    pub clip: usize,
    /// Holds the clip's first key.
    pub frozen: bool,
}

impl ResolvedMap {
    /// Index of the pair with this target.
    pub fn pair_index(&self, target: JointIndex) -> Option<usize> {
        self.pairs.binary_search_by_key(&target, |pair| pair.target).ok()
    }

    /// Returns the source of a target joint; `None` if it has none.
    pub fn source_of(&self, target: JointIndex) -> Option<JointIndex> {
        self.pair_index(target).map(|pair| self.pairs[pair].source)
    }
}
