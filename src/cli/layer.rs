//! `--layer`: clips over the one that is shown or written.

use clap::Args;

use super::failure::{Failure, Outcome};
use super::retarget::clip_named;
use crate::anim::Clip;
use crate::asset::Asset;
use crate::library::Model;
use crate::retarget::{Body, ClipLayer, ClipOverLayers, Recognized, StackedLayer, bake_layers, bake_stack, baking};
use crate::state::{LayeredClip, read_layer, unknown_layers};

/// Returns the warning about a loop with a seam, with its code.
pub(super) fn loop_seam(why: &str) -> (&'static str, String) {
    ("loop-seam", format!("the loop has a seam: {why}"))
}

/// Clips over the one that is shown or written.
#[derive(Debug, Default, Args)]
pub(super) struct LayerOptions {
    /// A clip over this one: its name or index and settings, as in a link's key `layers`. Repeatable, the lowest first
    /// [settings: weight:W, speed:S, start:SECS, additive, additive:rest, mask:PART:JOINT].
    #[arg(long = "layer", value_name = "CLIP[:SETTING,…]", value_parser = read)]
    pub layers: Vec<LayeredClip>,
}

fn read(text: &str) -> Result<LayeredClip, String> {
    let layer = read_layer(text).map_err(|expected| format!("expected {expected}"))?;
    if layer.layer.clone().clamped() == layer.layer {
        return Ok(layer);
    }
    let (speed, start) = (ClipLayer::MAX_SPEED, ClipLayer::MAX_START_SECS);
    Err(format!("expected a weight from 0 to 1, a speed from 0 to {speed} and a start from -{start} to {start}"))
}

/// Fails if the model lacks a clip or a joint that a layer names.
pub(super) fn check(layers: &[LayeredClip], model: &Model) -> Outcome {
    if let Some(unknown) = unknown_layers(model, layers).next() {
        return Err(Failure::from(unknown).at("--layer").in_file(&model.source));
    }
    check_joints(layers, &model.asset).map_err(|failure| failure.in_file(&model.source))
}

fn check_joints(layers: &[LayeredClip], asset: &Asset) -> Outcome {
    let count = asset.skeleton.len();
    let mut joints = layers.iter().flat_map(|over| &over.layer.mask.joints);
    match joints.find(|&&joint| joint >= count) {
        Some(joint) => {
            let expected = format!("a mask of joints from 0 to {}", count.saturating_sub(1));
            Err(Failure::expected(expected, joint.to_string()).at("--layer"))
        }
        None => Ok(()),
    }
}

impl LayerOptions {
    /// Bakes layers of the asset's own clips into a clip. Without layers, `recognized` isn't called. Loops are added until all
    /// layers end together, unless `is_looped` says that their number was given.
    pub(super) fn bake(
        &self,
        asset: &Asset,
        clip: Clip,
        recognized: impl FnOnce() -> Recognized,
        is_looped: bool,
        warnings: &mut Vec<(&'static str, String)>,
    ) -> Outcome<Clip> {
        if self.layers.is_empty() {
            return Ok(clip);
        }
        check_joints(&self.layers, asset)?;
        let slots = recognized().humanoid();
        let mut stack = Vec::new();
        for LayeredClip { clip, layer } in &self.layers {
            let name = clip.to_string();
            let index = clip_named(asset, &name).map_err(|unknown| Failure::from(unknown).at("--layer"))?;
            let included = layer.mask.included(&Body { asset, slots: &slots });
            if !included.contains(&true) {
                let message = format!("--layer: the file has none of the body parts that “{name}” is masked by");
                warnings.push(("empty-mask", message));
            }
            let source = ClipOverLayers { clip: &asset.clips[index], below: &[] };
            stack.push(StackedLayer { layer, source, included });
        }
        let periods: Vec<f64> =
            stack.iter().filter_map(|stacked| stacked.layer.period_secs(stacked.source.clip)).collect();
        let baking = baking(&clip, &[], &periods, is_looped.then_some(1));
        warnings.extend(baking.seam().map(|why| loop_seam(&why)));
        let clip = if baking.loops > 1 { bake_layers(asset, &clip, &[], &baking) } else { clip };
        Ok(bake_stack(&asset.skeleton, &clip, &stack))
    }
}
