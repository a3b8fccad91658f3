//! Options that edit the clip that is written, shared by `retarget` and `convert`.

use clap::Args;
use gaitway_character::anim::Clip;
use gaitway_retarget::{ChangedClip, ClipOverLayers, Symmetry};
use gaitway_scene::library::{BakedTake, Model, Take};
use gaitway_scene::state::one_line;

use super::change::ChangeOptions;
use super::failure::Outcome;
use super::layer::LayerOptions;
use super::pin::PinOptions;

#[derive(Debug, Args)]
pub(super) struct EditOptions {
    /// The name of the written clip [default: its own, that of its file if it has none, or “NAME (changed)” beside the original].
    /// `convert` to .glb replaces the name of a clip that is otherwise unchanged.
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
        self.name.is_none() && self.is_name_only()
    }

    /// Returns whether the clip stays as it is except for its name.
    pub(super) fn is_name_only(&self) -> bool {
        self.changes.changes().is_none() && self.layers.layers.is_empty() && self.pins.is_empty()
    }

    /// Returns the clip with its changes, layers, pins and name. `is_looped` says that the number of loops was given: none are added
    /// then to let the layers end together.
    pub(super) fn bake(
        &self,
        model: &Model,
        clip: Clip,
        is_looped: bool,
        warnings: &mut Vec<(&'static str, String)>,
    ) -> Outcome<ChangedClip> {
        let symmetry = || Symmetry::of(&model.asset, model.recognition());
        let ChangedClip { clip, seam } = self.changes.change(&model.asset, clip, symmetry, warnings)?;
        let (layers, pins) = (self.layers.layers(model, warnings)?, self.pins.pins_of_clip(model)?);
        let played = ClipOverLayers { clip: &clip, below: &[] };
        let take = Take { layers: &layers, pins: &pins, ..Take::of_clip(model, Some(played)) };
        let clip = baked(&take, is_looped.then_some(1), "", warnings);
        let clip = match &self.name {
            Some(name) => clip.with_name(name.clone()),
            None => clip,
        };
        Ok(ChangedClip { clip, seam })
    }
}

/// Bakes a take, with a warning about a seam and `advice` after it.
pub(super) fn baked(
    take: &Take<'_>,
    loops: Option<usize>,
    advice: &str,
    warnings: &mut Vec<(&'static str, String)>,
) -> Clip {
    let BakedTake { clip, baking, .. } = take.bake(loops, None);
    let seam = baking.and_then(|baking| baking.seam());
    warnings.extend(seam.map(|why| ("loop-seam", format!("the loop has a seam: {why}{advice}"))));
    clip.into_owned()
}
