//! Changes clips: mirrors, trims, reverses, retimes, loops, moves and turns them. The original is untouched. The result has
//! its keys; trimming and blending a seam add some, and so does what must be held: the values of a reversed clip that starts late or
//! has steps, and the joint that moves the body of a clip of an arm. Apart from that, holds parts of a clip still.
//!
//! The changes are a struct and not a list: they are applied in the order of its fields, and each can be edited later.

mod hold;
mod mirror;
mod path;
mod seam;
pub(crate) mod time;
pub(crate) mod track;

use gaitway_character::anim::{Clip, TimeRange};
use gaitway_character::asset::Asset;
use serde::{Deserialize, Serialize};

use super::math::clamped;
pub use hold::{HeldValues, hold_values};
pub use mirror::Symmetry;
pub use seam::Seam;
use track::Tracks;

/// Changes to a clip, applied in the order of the fields.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ClipChanges {
    /// Swaps left and right, across the plane between them.
    pub mirror: bool,
    /// The part to keep, in seconds of the original clip.
    pub trim: Option<TimeRange>,
    /// Plays backwards.
    pub reverse: bool,
    /// Factor on the speed, [`Self::MIN_SPEED`] to [`Self::MAX_SPEED`].
    pub speed: f64,
    /// Makes the end meet the start, blended over this time in seconds at either side of the seam, up to
    /// [`Self::MAX_LOOP_SECS`].
    pub loop_secs: Option<f64>,
    /// Moves the character over the ground: metres along X and Z, each up to [`Self::MAX_OFFSET_METRES`] either way.
    pub offset: [f64; 2],
    /// Turns the character and its path about the vertical through its start, counter-clockwise seen from above, by up to
    /// [`Self::MAX_TURN_DEGREES`] either way.
    pub turn_degrees: f64,
}

impl Default for ClipChanges {
    fn default() -> Self {
        Self::NONE
    }
}

impl ClipChanges {
    /// Leaves the clip as it is.
    pub const NONE: Self = Self {
        mirror: false,
        trim: None,
        reverse: false,
        speed: 1.0,
        loop_secs: None,
        offset: [0.0; 2],
        turn_degrees: 0.0,
    };
    /// Smallest factor on the speed.
    pub const MIN_SPEED: f64 = 0.1;
    /// Largest factor on the speed.
    pub const MAX_SPEED: f64 = 10.0;
    /// Longest time that a seam is blended over at either side.
    pub const MAX_LOOP_SECS: f64 = 10.0;
    /// Farthest that a character is moved along an axis.
    pub const MAX_OFFSET_METRES: f64 = 1000.0;
    /// Largest angle that a path is turned by.
    pub const MAX_TURN_DEGREES: f64 = 360.0;

    /// Whether the clip stays as it is.
    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    /// Clamps numbers to their ranges, and replaces those that aren't finite with the default. Drops a trim that keeps nothing.
    pub fn clamped(mut self) -> Self {
        let symmetric = |value, max: f64| clamped(value, 0.0, -max, max);
        self.speed = clamped(self.speed, Self::NONE.speed, Self::MIN_SPEED, Self::MAX_SPEED);
        self.loop_secs = self.loop_secs.map(|secs| clamped(secs, 0.0, 0.0, Self::MAX_LOOP_SECS));
        self.offset = self.offset.map(|metres| symmetric(metres, Self::MAX_OFFSET_METRES));
        self.turn_degrees = symmetric(self.turn_degrees, Self::MAX_TURN_DEGREES);
        let is_part = |start: f64, end: f64| start.is_finite() && end.is_finite() && start.max(0.0) < end;
        self.trim = self.trim.filter(|range| is_part(range.start_secs, range.end_secs));
        self
    }
}

/// A changed clip.
#[derive(Debug, Clone)]
pub struct ChangedClip {
    /// Has the name of the original.
    pub clip: Clip,
    /// The seam before it was blended, if the changes make a loop.
    pub seam: Option<Seam>,
}

/// Changes a clip of an asset. `symmetry` is only called to mirror.
pub fn change_clip(
    asset: &Asset,
    clip: &Clip,
    changes: &ClipChanges,
    symmetry: impl FnOnce() -> Symmetry,
) -> ChangedClip {
    let changes = changes.clone().clamped();
    let skeleton = &asset.skeleton;
    let mut tracks = Tracks::of(clip);
    if changes.mirror {
        mirror::mirror(&mut tracks, asset, &symmetry());
    }
    if let Some(range) = changes.trim {
        time::trim(&mut tracks, range.start_secs as f32, range.end_secs as f32);
    }
    if changes.reverse {
        time::reverse(&mut tracks);
    }
    if changes.speed != 1.0 {
        time::set_speed(&mut tracks, changes.speed);
    }
    let seam = changes.loop_secs.map(|secs| seam::blend(&mut tracks, skeleton, secs as f32));
    if changes.offset != [0.0; 2] || changes.turn_degrees != 0.0 {
        path::place(&mut tracks, asset, changes.offset, changes.turn_degrees.to_radians());
    }
    ChangedClip { clip: tracks.build(clip.name(), skeleton), seam }
}
