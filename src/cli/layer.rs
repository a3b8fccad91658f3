//! `--layer`: clips over the one that is shown or written.

use clap::Args;
use gaitway_character::asset::Asset;
use gaitway_retarget::ClipLayer;
use gaitway_scene::library::{ClipId, LayeredClip, Model};
use gaitway_scene::state::{read_layer, unknown_layers};

use super::failure::{Failure, Outcome};
use super::retarget::clip_named;

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
    /// Returns the layers with their clips found among the model's.
    pub(super) fn layers(
        &self,
        model: &Model,
        warnings: &mut Vec<(&'static str, String)>,
    ) -> Outcome<Vec<LayeredClip>> {
        check_joints(&self.layers, &model.asset)?;
        let found = |LayeredClip { clip, layer }: &LayeredClip| {
            let name = clip.to_string();
            let index = clip_named(&model.asset, &name).map_err(|unknown| Failure::from(unknown).at("--layer"))?;
            if !layer.mask.included(&model.body()).contains(&true) {
                let message = format!("--layer: the file has none of the body parts that “{name}” is masked by");
                warnings.push(("empty-mask", message));
            }
            Ok(LayeredClip { clip: ClipId::Own(index), layer: layer.clone() })
        };
        self.layers.iter().map(found).collect()
    }
}
