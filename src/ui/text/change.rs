//! Changes to the current clip.

use crate::retarget::Seam;

/// Heading.
pub const CHANGE_CLIP: &str = "Edit clip";
/// Switch: left and right are swapped.
pub const MIRROR: &str = "Mirror";
/// Switch: the clip is reversed.
pub const BACKWARDS: &str = "Reverse";
/// Button that keeps the part between the in and out points.
pub const TRIM_TO_RANGE: &str = "Trim to range";
/// Why that button is disabled.
pub const NEEDS_RANGE: &str = "Set a range on the timeline first (keys I and O).";
/// Why that button is disabled.
pub const TRIM_FIRST: &str = "To trim, turn off Reverse and reset the clip speed.";
/// Button that brings back the whole clip.
pub const UNDO_TRIM: &str = "Restore the whole clip";
/// Switch: the end is made to meet the start.
pub const MAKE_LOOP: &str = "Make loopable";
/// Slider: the time that the seam is blended over.
pub const BLEND: &str = "Blend";
/// Slider: factor on the speed of the clip itself.
pub const BAKED_SPEED: &str = "Clip speed";
/// Slider: the angle that the path is turned by.
pub const TURN_PATH: &str = "Turn path";
/// Slider: the offset along X.
pub const MOVE_X: &str = "Move along X";
/// Slider: the offset along Z.
pub const MOVE_Z: &str = "Move along Z";
/// Button that removes all changes.
pub const RESET_CHANGES: &str = "Reset clip";

/// Returns how far apart the ends of the clip were.
pub fn seam(seam: Seam) -> String {
    format!("The ends were {seam}.")
}
