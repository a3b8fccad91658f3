//! The layers over the clip.

use gaitway_character::anim::{JointMask, Pose};
use gaitway_retarget::{Baking, ClipLayer, LayerBuffers, LayerMask, StackedLayer, baking};
use serde::{Deserialize, Serialize};

use super::Take;
use crate::library::{ClipId, Model, ModelClip, ModelId};

/// A clip over the one that plays.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LayeredClip {
    /// Which clip.
    pub clip: ClipId,
    /// How it changes the pose below it.
    pub layer: ClipLayer,
}

/// Applies layers. Keeps what they need between frames.
#[derive(Debug, Default)]
pub(super) struct LayerSampler {
    states: Vec<LayerState>,
}

/// What one layer needs.
#[derive(Debug, Default)]
struct LayerState {
    mask: JointMask,
    /// What `mask` was made from: the model, its number of joints, and the choice.
    made_from: Option<(ModelId, usize, LayerMask)>,
    buffers: LayerBuffers,
}

impl LayerSampler {
    /// Changes the pose that the clip has after `elapsed_secs`. Allocates only when a layer's mask, the number of layers or the
    /// model changes.
    pub fn apply(&mut self, take: &Take<'_>, elapsed_secs: f64, pose: &mut Pose) {
        if self.states.len() < take.layers.len() {
            self.states.resize_with(take.layers.len(), LayerState::default);
        }
        for (LayeredClip { clip, layer }, state) in take.layers.iter().zip(&mut self.states) {
            let Some(source) = take.model.clip(clip).map(ModelClip::over_layers) else { continue };
            state.refresh(take.model, &layer.mask);
            let skeleton = &take.model.asset.skeleton;
            layer.apply(skeleton, source, &state.mask, elapsed_secs, &mut state.buffers, pose);
        }
    }
}

impl LayerState {
    fn refresh(&mut self, model: &Model, mask: &LayerMask) {
        let skeleton = &model.asset.skeleton;
        let is_same = |(id, joints, made_from): &(ModelId, usize, LayerMask)| {
            (*id, *joints) == (model.id, skeleton.len()) && made_from == mask
        };
        if !self.made_from.as_ref().is_some_and(is_same) {
            self.mask = JointMask::new(skeleton, &mask.included(&model.body()));
            self.made_from = Some((model.id, skeleton.len(), mask.clone()));
        }
    }
}

impl<'a> Take<'a> {
    /// The layers that change the pose, for baking.
    pub(super) fn stacked(&self) -> Vec<StackedLayer<'a>> {
        let model = self.model;
        let layers = self.layers.iter().filter(|over| over.layer.weight > 0.0);
        let stacked = layers.filter_map(|LayeredClip { clip, layer }| {
            let (source, included) = (model.clip(clip)?.over_layers(), layer.mask.included(&model.body()));
            included.contains(&true).then_some(StackedLayer { layer, source, included })
        });
        stacked.collect()
    }

    /// How the clip and its layers become one clip; of a single loop for the rest pose. `over` are [`Self::stacked`].
    pub(super) fn baking(&self, over: &[StackedLayer<'_>], loops: Option<usize>) -> Baking {
        let Some(clip) = self.clip else { return Baking { loops: 1, seamless: true } };
        let periods = over.iter().filter_map(|over| over.layer.period_secs(over.source.clip));
        baking(clip.clip, clip.below, &periods.collect::<Vec<_>>(), loops)
    }
}
