//! Texts about pins.

use crate::retarget::PinTimes;

/// Label of the choice of where the selected joint is held.
pub const PIN: &str = "Pin";
/// Label of the choice of what the selected joint looks at.
pub const LOOK: &str = "Look";
/// Choice: the joint follows the clip.
pub const NOT_PINNED: &str = "Off";
/// Choice: the joint stays at a point.
pub const PIN_TO_POINT: &str = "To a point";
/// Choice: the joint stays at another joint.
pub const PIN_TO_JOINT: &str = "To a joint";
/// What to do with a pinned joint.
pub const PIN_HINT: &str = "Drag the handle in the viewport.";
/// What dragging a handle does, in the help.
pub const HELP_HANDLE: &str = "Move the goal of a pinned joint";
/// The list of joints that the selected joint can be held at.
pub const PINNED_TO: &str = "Pinned to";
/// Switch: the pin holds only between the in and out points.
pub const PIN_IN_RANGE: &str = "Only in the range";
/// Button that moves a pin's times to the in and out points.
pub const PIN_TO_RANGE: &str = "Use the current range";

/// Returns the accessible name of a pin's track under the timeline. `when` is that of [`pin_times`].
pub fn pin_track(joint: &str, when: &str) -> String {
    format!("Pin {joint}: {when}")
}

/// Returns when a pin holds.
pub fn pin_times(PinTimes { start_secs, end_secs, .. }: PinTimes) -> String {
    format!("Holds from {start_secs:.2} s to {end_secs:.2} s.")
}
