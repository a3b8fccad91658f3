//! A joint map whose names have been found in two skeletons: what the engine works with.

use glam::Quat;

use super::{Feet, Keep, RestChoices, RootOptions};
use crate::anim::{JointIndex, Property};

#[derive(Debug, Clone, Default, PartialEq)]
pub struct ResolvedMap {
    /// By target joint, ascending; a target stands here once.
    pub pairs: Vec<Pair>,
    /// What joints without a source do, where that is not to rest: ascending by joint, own clips of the model.
    pub layers: Vec<Layer>,
    pub rest: RestChoices,
    pub root: RootOptions,
    pub translations: Keep,
    pub scales: Keep,
    /// Channels of the motion that are left out.
    pub muted: Vec<(JointIndex, Property)>,
    pub feet: Feet,
    pub crossfade_secs: f64,
}

/// One target joint and the source joint it follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    pub target: JointIndex,
    pub source: JointIndex,
    /// Unit rotation, applied first, in the joint's own space.
    pub correction: Quat,
}

/// A joint that plays one of the model's own clips meanwhile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layer {
    pub joint: JointIndex,
    /// Index into [`crate::asset::Asset::clips`] of the model.
    pub clip: usize,
    /// The clip's first key for all time.
    pub frozen: bool,
}

impl ResolvedMap {
    /// Index of the pair with this target.
    pub fn pair_index(&self, target: JointIndex) -> Option<usize> {
        self.pairs.iter().position(|pair| pair.target == target)
    }

    pub fn source_of(&self, target: JointIndex) -> Option<JointIndex> {
        self.pairs.iter().find(|pair| pair.target == target).map(|pair| pair.source)
    }
}
