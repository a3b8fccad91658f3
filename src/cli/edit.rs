//! Options that edit the clip that is written, shared by `retarget` and `convert`.

use clap::Args;

use super::change::ChangeOptions;
use super::failure::Outcome;
use super::layer::LayerOptions;
use super::pin::PinOptions;
use crate::anim::Clip;
use crate::asset::Asset;
use crate::retarget::{ChangedClip, Recognized, Symmetry};

#[derive(Debug, Args)]
pub(super) struct EditOptions {
    #[command(flatten)]
    pub changes: ChangeOptions,
    #[command(flatten)]
    layers: LayerOptions,
    #[command(flatten)]
    pins: PinOptions,
}

impl EditOptions {
    /// Returns whether the clip stays as it is.
    pub(super) fn is_none(&self) -> bool {
        self.changes.changes().is_none() && self.layers.layers.is_empty() && self.pins.is_empty()
    }

    /// Returns the clip with its changes, layers and pins; `recognized` is only called for those that need it. `is_looped` says that
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
        Ok(ChangedClip { clip, seam })
    }
}
