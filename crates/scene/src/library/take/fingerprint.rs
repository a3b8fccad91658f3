//! What a take consists of, to see whether another one plays the same.

use std::collections::BTreeMap;

use gaitway_character::anim::{Clip, JointIndex, LoopMode, TimeRange};
use gaitway_retarget::Pin;
use glam::Affine3A;

use super::{LayeredClip, Take};
use crate::library::{ModelClip, ModelId};

/// Everything that decides what a take shows of the body at any time, but for gazes. Clips are compared by their keys.
#[derive(Debug)]
pub(super) struct Fingerprint {
    model: ModelId,
    clip: Option<Clip>,
    root: Option<JointIndex>,
    range: TimeRange,
    loop_mode: LoopMode,
    layers: Vec<(LayeredClip, Option<Clip>)>,
    rotations: BTreeMap<usize, [f32; 3]>,
    morph_weights: BTreeMap<usize, f32>,
    expressions: BTreeMap<String, f32>,
    pins: BTreeMap<usize, Pin>,
    world_from_model: Affine3A,
}

impl Fingerprint {
    /// Takes the fingerprint.
    pub fn of(take: &Take<'_>) -> Self {
        let keys = |clip: &ModelClip| clip.clip().clone();
        let layers = take.layers.iter().map(|over| (over.clone(), take.model.clip(&over.clip).map(keys)));
        Self {
            model: take.model.id,
            clip: take.clip.map(|over| over.clip.clone()),
            root: take.root,
            range: take.range,
            loop_mode: take.loop_mode,
            layers: layers.collect(),
            rotations: take.held.rotations.clone(),
            morph_weights: take.held.morph_weights.clone(),
            expressions: take.held.expressions.clone(),
            pins: take.pins.clone(),
            world_from_model: take.world_from_model,
        }
    }

    /// Whether [`Self::of`] would return the same, without allocating.
    pub fn matches(&self, take: &Take<'_>) -> bool {
        let is_same_layer = |(known, clip): &(LayeredClip, Option<Clip>), over: &LayeredClip| {
            known == over && Clip::are_same(clip.as_ref(), take.model.clip(&over.clip).map(ModelClip::clip))
        };
        (self.model, self.root, self.range, self.loop_mode) == (take.model.id, take.root, take.range, take.loop_mode)
            && self.world_from_model == take.world_from_model
            && Clip::are_same(self.clip.as_ref(), take.clip.map(|over| over.clip))
            && self.layers.len() == take.layers.len()
            && self.layers.iter().zip(take.layers).all(|(known, over)| is_same_layer(known, over))
            && self.rotations == *take.held.rotations
            && self.morph_weights == *take.held.morph_weights
            && self.expressions == *take.held.expressions
            && self.pins == *take.pins
    }
}
