//! What plays: a clip of a model with everything that is laid over it, as one value. Pictures, springs, the camera's framing and
//! files are made from it and from nothing else, so that all of them show the same.
//!
//! The order: the rest pose, what plays below the clip, the clip, a crossfade from the one before, layers, joints that are held,
//! pins, the avatar (gaze, expressions, constraints, springs), then morph weights that are held.

mod avatar;
mod baked;
mod bounds;
mod fingerprint;
mod held;
mod layers;
mod sampler;

pub use avatar::LookTarget;
pub use baked::BakedTake;
pub use held::{Held, manual_degrees, manual_rotation};
pub use layers::LayeredClip;
pub use sampler::{Moment, Outgoing, TakeSampler};

pub(super) use bounds::BoundsCache;

use std::collections::BTreeMap;

use gaitway_character::anim::{JointIndex, LoopMode, TimeRange, clip_time};
use gaitway_retarget::{ClipOverLayers, Pin, PinGoal, Pinning};
use glam::{Affine3A, Vec3};

use super::{Model, ModelClip};

/// What plays. Borrowed from a model and from whatever holds the settings, so that making one costs nothing.
#[derive(Debug, Clone, Copy)]
pub struct Take<'a> {
    /// Whose clip it is.
    pub model: &'a Model,
    /// The clip over what its joint map puts below it; `None` is the rest pose.
    pub clip: Option<ClipOverLayers<'a>>,
    /// The joint that carries the body's travel in the clip.
    pub root: Option<JointIndex>,
    /// The part of the clip that plays, in its own seconds.
    pub range: TimeRange,
    /// What happens at the end of the range.
    pub loop_mode: LoopMode,
    /// Clips over the clip, the lowest first. Those that the model lacks are skipped.
    pub layers: &'a [LayeredClip],
    /// What is set manually.
    pub held: Held<'a>,
    /// Pinned joints, by index in the file.
    pub pins: &'a BTreeMap<usize, Pin>,
    /// The target of an avatar's gaze.
    pub look_at: LookTarget,
    /// Whether an avatar's spring bones are simulated.
    pub springs: bool,
    /// Turns the file's up axis up.
    pub world_from_model: Affine3A,
}

static NO_PINS: BTreeMap<usize, Pin> = BTreeMap::new();

impl<'a> Take<'a> {
    /// A whole clip in a loop, or the rest pose, with nothing over it.
    pub fn new(model: &'a Model, clip: Option<&'a ModelClip>) -> Self {
        let take = Self::of_clip(model, clip.map(ModelClip::over_layers));
        Self { root: clip.and_then(ModelClip::root), ..take }
    }

    /// The same for a clip that the model doesn't list.
    pub fn of_clip(model: &'a Model, clip: Option<ClipOverLayers<'a>>) -> Self {
        Self {
            model,
            clip,
            root: None,
            range: whole(clip),
            loop_mode: LoopMode::Loop,
            layers: &[],
            held: Held::NOTHING,
            pins: &NO_PINS,
            look_at: LookTarget::Off,
            springs: false,
            world_from_model: Affine3A::IDENTITY,
        }
    }

    /// The same with the whole clip, in a loop.
    pub fn whole(&self) -> Self {
        Self { range: whole(self.clip), loop_mode: LoopMode::Loop, ..*self }
    }

    /// Returns the time in the clip when it has played for `elapsed_secs`, which runs on beyond the range; 0 for the rest pose.
    pub fn clip_secs(&self, elapsed_secs: f64) -> f64 {
        self.clip.map_or(0.0, |_| clip_time(elapsed_secs, self.range, self.loop_mode))
    }

    /// Whether a joint is pinned to look at the camera.
    pub fn has_gaze_at_camera(&self) -> bool {
        self.pins.values().any(|pin| pin.goal == PinGoal::Camera)
    }

    /// Whether anything is laid over the clip that a file with the clip alone lacks: layers, held values or pins.
    pub fn is_more_than_clip(&self) -> bool {
        self.has_layers() || self.held.is_any(self.model) || !self.pins.is_empty()
    }

    /// Whether any layer changes the pose.
    fn has_layers(&self) -> bool {
        self.layers.iter().any(|over| over.layer.weight > 0.0 && self.model.clip(&over.clip).is_some())
    }

    /// The pins with what they need. `eye` is the camera's position in world space, if known.
    pub fn pinning(&self, eye: Option<Vec3>) -> Pinning<'a> {
        Pinning {
            asset: &self.model.asset,
            body: self.model.recognition(),
            pins: self.pins,
            world_from_model: self.world_from_model,
            eye,
        }
    }
}

/// The whole clip as a range; an instant for the rest pose.
fn whole(clip: Option<ClipOverLayers<'_>>) -> TimeRange {
    let duration_secs = clip.map_or(0.0, |over| f64::from(over.clip.duration_secs()));
    TimeRange { start_secs: 0.0, end_secs: duration_secs }
}
