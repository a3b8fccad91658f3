//! Texts about pins.

use gaitway_retarget::{PinGoal, PinTimes};

use super::labelled;

/// Heading in the Motion tab.
pub const PINS: &str = "Pins";
/// Where pins are made.
pub const ABOUT_PINS: &str = "To hold a hand or foot in place, or to make the head look at something, select the joint: its card in \
                              the Scene tab has the choice. Pins hold in every clip.";
/// Label of the choice of where the selected joint is held.
pub const PIN: &str = "Pin";
/// Label of the choice of what the selected joint looks at.
pub const LOOK: &str = "Look at";
/// Choice: the joint looks at a fixed point.
pub const LOOK_POINT: &str = "Point";
/// Choice: the joint looks at the camera.
pub const LOOK_CAMERA: &str = "Camera";
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
/// The list of joints that the selected joint can be held at, and the coordinates of a point.
pub const PINNED_TO: &str = "Pinned to";
/// Switch: the pin holds only between the in and out points.
pub const PIN_IN_RANGE: &str = "Only in the range";
/// Button that moves a pin's times to the in and out points.
pub const PIN_TO_RANGE: &str = "Use the current range";

/// Returns the name of a pin's track under the timeline: the joint and its goal. `other` is the name of the goal if that is a joint.
pub fn pin_name(joint: &str, goal: PinGoal, other: Option<&str>) -> String {
    let goal = match goal {
        PinGoal::Point(_) => "point",
        PinGoal::Joint(..) => other.unwrap_or("joint"),
        PinGoal::Look(_) => "look at point",
        PinGoal::Camera => "look at camera",
    };
    labelled(joint, goal)
}

/// Returns what a pin does, as a phrase: “LeftHand pinned to Head”.
pub fn pin_to(joint: &str, goal: PinGoal, other: Option<&str>) -> String {
    match goal {
        PinGoal::Point(_) => format!("{joint} pinned to a point"),
        PinGoal::Joint(..) => format!("{joint} pinned to {}", other.unwrap_or("a joint")),
        PinGoal::Look(_) => format!("{joint} looks at a point"),
        PinGoal::Camera => format!("{joint} looks at the camera"),
    }
}

/// Returns the name of the button that removes a joint's pin.
pub fn remove_pin(joint: &str) -> String {
    format!("Remove pin of {joint}")
}

/// Returns the accessible name and tooltip of that track. `pin` is from [`pin_to`], `when` from [`pin_times`].
pub fn pin_track(pin: &str, when: &str) -> String {
    format!("{pin}. {when}")
}

/// Returns when a pin holds.
pub fn pin_times(PinTimes { start_secs, end_secs, .. }: PinTimes) -> String {
    format!("Holds from {start_secs:.2} s to {end_secs:.2} s.")
}
