//! A take as one ordinary clip, for files.

use std::borrow::Cow;

use gaitway_character::anim::{Clip, ClipBuilder};
use gaitway_retarget::{Baking, ClipOverLayers, bake_layers, bake_stack};
use glam::Vec3;

use super::Take;

/// A clip with everything that is laid over it.
#[derive(Debug)]
pub struct BakedTake<'a> {
    /// The clip: the take's own where nothing is laid over it.
    pub clip: Cow<'a, Clip>,
    /// How loops and layers were brought to end together; `None` for one loop without layers.
    pub baking: Option<Baking>,
    /// Whether joints are held in it.
    pub is_posed: bool,
}

impl<'a> Take<'a> {
    /// Bakes the whole clip, with what plays below it, layers, held values and pins, but not the avatar, whose file has its own
    /// gaze, constraints and springs. `loops` is how many loops of the clip to write; without it, as few as let the layers end with
    /// it. The rest pose is a clip without keys.
    /// `eye` is the camera's position in world space, which pinned gazes at the camera keep.
    pub fn bake(&self, loops: Option<usize>, eye: Option<Vec3>) -> BakedTake<'a> {
        let (skeleton, over) = (&self.model.asset.skeleton, self.stacked());
        let clip = match self.clip {
            Some(ClipOverLayers { clip, .. }) => Cow::Borrowed(clip),
            None => Cow::Owned(ClipBuilder::new("", skeleton).build()),
        };
        let below = self.clip.map_or(&[][..], |over| over.below);
        let period_secs = f64::from(clip.duration_secs());
        let mut baked = BakedTake { clip, baking: None, is_posed: false };
        if !below.is_empty() || !over.is_empty() || loops.is_some_and(|loops| loops > 1) {
            let baking = self.baking(&over, loops);
            let layered = bake_layers(&self.model.asset, &baked.clip, below, &baking);
            baked.clip = Cow::Owned(if over.is_empty() { layered } else { bake_stack(skeleton, &layered, &over) });
            baked.baking = Some(baking);
        }
        if let Some(held) = self.held.hold(self.model, &baked.clip) {
            baked.clip = Cow::Owned(held);
            baked.is_posed = !self.held.rotations.is_empty();
        }
        if !self.pins.is_empty() {
            // Pins repeat with the clip, not with its layers.
            baked.clip = Cow::Owned(self.pinning(eye).bake(&baked.clip, period_secs));
        }
        baked
    }
}
