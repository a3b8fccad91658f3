//! Options that edit the clip that is written, shared by `retarget` and `convert`.

use clap::Args;

use super::change::ChangeOptions;
use super::failure::Outcome;
use super::layer::LayerOptions;
use super::pin::PinOptions;
use crate::anim::Clip;
use crate::asset::Asset;
use crate::retarget::{ChangedClip, Recognized, Symmetry};
use crate::state::one_line;

#[derive(Debug, Args)]
pub(super) struct EditOptions {
    /// The name of the written clip [default: its own, that of its file if it has none, or “NAME (changed)” beside the original].
    #[arg(long, value_name = "NAME", value_parser = read_name)]
    pub name: Option<String>,
    #[command(flatten)]
    pub changes: ChangeOptions,
    #[command(flatten)]
    layers: LayerOptions,
    #[command(flatten)]
    pins: PinOptions,
}

fn read_name(text: &str) -> Result<String, String> {
    let name = one_line(text);
    if name.is_empty() { Err("expected a name that is not empty".to_owned()) } else { Ok(name) }
}

impl EditOptions {
    /// Returns whether the clip stays as it is.
    pub(super) fn is_none(&self) -> bool {
        self.name.is_none() && self.changes.changes().is_none() && self.layers.layers.is_empty() && self.pins.is_empty()
    }

    /// Returns the clip with its changes, layers, pins and name; `recognized` is only called for those that need it. `is_looped` says that
    /// the number of loops was given: none are added then to let the layers end together.
    pub(super) fn bake(
        &self,
        asset: &Asset,
        clip: Clip,
        recognized: &dyn Fn() -> Recognized,
        is_looped: bool,
        warnings: &mut Vec<(&'static str, String)>,
    ) -> Outcome<ChangedClip> {
        let symmetry = || Symmetry::of(asset, &recognized());
        let ChangedClip { clip, seam } = self.changes.change(asset, clip, symmetry, warnings)?;
        // Layers may add loops; the times of pins are in the first one.
        let period_secs = f64::from(clip.duration_secs());
        let clip = self.layers.bake(asset, clip, recognized, is_looped, warnings)?;
        let clip = self.pins.bake(asset, recognized, clip, period_secs)?;
        let clip = match &self.name {
            Some(name) => clip.with_name(name.clone()),
            None => clip,
        };
        Ok(ChangedClip { clip, seam })
    }
}
