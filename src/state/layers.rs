//! The layers over the active clip: finding their clips and joints, and applying them to a pose.

use super::clip_names::{look_up_clip, unknown_name};
use super::{LayeredClip, UnknownName, ViewerState};
use crate::anim::{JointMask, Pose};
use crate::library::{Model, ModelClip, ModelId};
use crate::retarget::{LayerBuffers, LayerMask, StackedLayer};

/// Applies the layers of a view. Keeps what they need between frames.
#[derive(Debug, Default)]
pub struct LayerSampler {
    held: Vec<Held>,
}

/// What one layer needs.
#[derive(Debug, Default)]
struct Held {
    mask: JointMask,
    /// What `mask` was made from: the model, its number of joints, and the choice.
    made_from: Option<(ModelId, usize, LayerMask)>,
    buffers: LayerBuffers,
}

impl LayerSampler {
    /// Changes the pose that the active clip has after `elapsed_secs`. Layers whose clip the model lacks are skipped.
    /// Allocates only when a layer's mask, the number of layers or the model changes.
    pub fn apply(&mut self, model: &Model, state: &ViewerState, elapsed_secs: f64, pose: &mut Pose) {
        let layers = &state.edits.layers;
        if self.held.len() < layers.len() {
            self.held.resize_with(layers.len(), Held::default);
        }
        for (LayeredClip { clip, layer }, held) in layers.iter().zip(&mut self.held) {
            let Some(source) = look_up_clip(model, clip).map(ModelClip::over_layers) else { continue };
            held.refresh(model, &layer.mask);
            let skeleton = &model.asset.skeleton;
            layer.apply(skeleton, source, &held.mask, elapsed_secs, &mut held.buffers, pose);
        }
    }
}

impl Held {
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

/// Whether any layer changes the pose.
pub fn has_layers(model: &Model, state: &ViewerState) -> bool {
    state.edits.layers.iter().any(|over| over.layer.weight > 0.0 && look_up_clip(model, &over.clip).is_some())
}

/// Returns the layers that change the pose, for baking. Those whose clip the model lacks are skipped.
pub fn stacked_layers<'a>(model: &'a Model, state: &'a ViewerState) -> Vec<StackedLayer<'a>> {
    let layers = state.edits.layers.iter().filter(|over| over.layer.weight > 0.0);
    let stacked = layers.filter_map(|LayeredClip { clip, layer }| {
        let (source, included) = (look_up_clip(model, clip)?.over_layers(), layer.mask.included(&model.body()));
        included.contains(&true).then_some(StackedLayer { layer, source, included })
    });
    stacked.collect()
}

/// Returns the clips of layers that the model lacks.
pub fn unknown_layers(model: &Model, layers: &[LayeredClip]) -> impl Iterator<Item = UnknownName> {
    let unknown = layers.iter().filter(|over| look_up_clip(model, &over.clip).is_none());
    unknown.map(|over| unknown_name(model, &over.clip))
}
