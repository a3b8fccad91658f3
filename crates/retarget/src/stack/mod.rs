//! A stack of clips over the one that plays: each with a weight, a speed and a start, as an override or an addition, on all
//! joints or on some. The arithmetic is in `anim`; here are the settings, the time of a layer, and baking the stack into a
//! clip.
//!
//! Layers are applied to poses, after a crossfade. Only exports need a clip of the sum.

mod bake;
mod mask;

use gaitway_character::anim::{Clip, JointMask, Pose, SampleCursor, Skeleton};
use serde::{Deserialize, Serialize};

use super::math::clamped;
use super::transfer::LayerClip;

pub use bake::{StackedLayer, bake_stack};
pub use mask::{BodyPart, LayerMask};

/// How a clip over the one that plays changes it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ClipLayer {
    /// From 0, no effect, to 1.
    pub weight: f64,
    /// Factor on the speed, up to [`Self::MAX_SPEED`]; 0 holds the first frame.
    pub speed: f64,
    /// Where on the timeline the clip begins, up to [`Self::MAX_START_SECS`] either way. It repeats in both directions.
    pub start_secs: f64,
    /// How it changes the pose below it.
    pub mode: LayerMode,
    /// The joints that it changes.
    pub mask: LayerMask,
}

/// How a layer changes the pose below it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LayerMode {
    /// Blends over it.
    #[default]
    Override,
    /// Adds the clip's difference from its first frame.
    Additive,
    /// Adds the clip's difference from the rest pose.
    AdditiveToRest,
}

impl LayerMode {
    /// All modes in display order.
    pub const ALL: [Self; 3] = [Self::Override, Self::Additive, Self::AdditiveToRest];
}

impl Default for ClipLayer {
    fn default() -> Self {
        Self { weight: 1.0, speed: 1.0, start_secs: 0.0, mode: LayerMode::Override, mask: LayerMask::default() }
    }
}

/// A clip, and the layers that its joint map puts below it.
#[derive(Debug, Clone, Copy)]
pub struct ClipOverLayers<'a> {
    /// The clip.
    pub clip: &'a Clip,
    /// What joints without a source play.
    pub below: &'a [LayerClip],
}

impl ClipOverLayers<'_> {
    /// Samples the clip at `time_secs` over the rest pose, and the layers below it after `elapsed_secs`.
    pub fn sample(
        &self,
        skeleton: &Skeleton,
        time_secs: f64,
        elapsed_secs: f64,
        cursor: &mut SampleCursor,
        pose: &mut Pose,
    ) {
        pose.copy_from(skeleton.rest());
        for layer in self.below {
            layer.sample(skeleton, elapsed_secs, cursor, pose);
        }
        self.clip.sample(skeleton, time_secs as f32, cursor, pose);
    }
}

/// What sampling a layer needs, reused between frames.
#[derive(Debug, Clone, Default)]
pub struct LayerBuffers {
    pose: Pose,
    reference: Pose,
    cursor: SampleCursor,
    reference_cursor: SampleCursor,
}

impl ClipLayer {
    /// Largest factor on the speed.
    pub const MAX_SPEED: f64 = 10.0;
    /// Farthest that the start lies from that of the timeline.
    pub const MAX_START_SECS: f64 = 3600.0;

    /// Clamps numbers to their ranges, and replaces those that aren't finite with the default.
    pub fn clamped(mut self) -> Self {
        self.weight = clamped(self.weight, 1.0, 0.0, 1.0);
        self.speed = clamped(self.speed, 1.0, 0.0, Self::MAX_SPEED);
        self.start_secs = clamped(self.start_secs, 0.0, -Self::MAX_START_SECS, Self::MAX_START_SECS);
        self
    }

    /// Seconds that the layer has run when the clip below it has for `elapsed_secs`.
    fn run_secs(&self, elapsed_secs: f64) -> f64 {
        let secs = (elapsed_secs - self.start_secs) * self.speed;
        if secs.is_finite() { secs } else { 0.0 }
    }

    /// Time after which the layer repeats, in seconds of the timeline. `None` if it doesn't move.
    pub fn period_secs(&self, clip: &Clip) -> Option<f64> {
        let period_secs = f64::from(clip.duration_secs()) / self.speed;
        (self.weight > 0.0 && period_secs > 0.0 && period_secs.is_finite()).then_some(period_secs)
    }

    /// Changes `pose`, which the clips below have after `elapsed_secs`. `mask` has the joints of [`Self::mask`]. Allocates
    /// nothing once the buffers have grown.
    pub fn apply(
        &self,
        skeleton: &Skeleton,
        source: ClipOverLayers<'_>,
        mask: &JointMask,
        elapsed_secs: f64,
        buffers: &mut LayerBuffers,
        pose: &mut Pose,
    ) {
        if self.weight <= 0.0 {
            return;
        }
        let LayerBuffers { pose: layer, reference, cursor, reference_cursor } = buffers;
        let run_secs = self.run_secs(elapsed_secs);
        let duration_secs = f64::from(source.clip.duration_secs());
        let time_secs = if duration_secs > 0.0 { run_secs.rem_euclid(duration_secs) } else { 0.0 };
        source.sample(skeleton, time_secs, run_secs, cursor, layer);
        let weight = self.weight as f32;
        let reference = match self.mode {
            LayerMode::Override => {
                pose.override_with(layer, weight, mask);
                return;
            }
            LayerMode::Additive => {
                source.sample(skeleton, 0.0, 0.0, reference_cursor, reference);
                reference
            }
            LayerMode::AdditiveToRest => skeleton.rest(),
        };
        pose.add_layer(layer, reference, weight, mask);
    }
}
