//! Changes to the current clip, and layers over it.

use gaitway_retarget::{BodyPart, ClipChanges, LayerMode, Seam};

/// Heading.
pub const CHANGE_CLIP: &str = "Edit clip";
/// Field with the clip's name.
pub const CLIP_NAME: &str = "Clip name";
/// What shows in it while it is empty.
pub const CLIP_NAME_IN_FILE: &str = "As in its file";
/// Switch: left and right are swapped.
pub const MIRROR: &str = "Mirror";
/// Switch: the clip is reversed.
pub const BACKWARDS: &str = "Reverse";
/// Button that keeps the part between the in and out points.
pub const TRIM_TO_RANGE: &str = "Trim to range";
/// Button that adds that part as a clip of its own.
pub const TRIM_TO_COPY: &str = "Trim to a new clip";
/// Why that button is disabled.
pub const ENOUGH_COPIES: &str = "The maximum number of new clips is reached: remove one first.";
/// Button that removes such a clip.
pub const REMOVE_COPY: &str = "Remove this clip";
/// Why that button is disabled.
pub const NEEDS_RANGE: &str = "Set a range on the timeline first (keys I and O).";
/// Why that button is disabled.
pub const REVERSED: &str = "To trim, turn off Reverse.";
/// Why that button is disabled.
pub const OTHER_SPEED: &str = "To trim, reset the clip speed.";
/// Why that button is disabled.
pub const RETIMED: &str = "To trim, turn off Reverse and reset the clip speed.";
/// Button that brings back the whole clip.
pub const UNDO_TRIM: &str = "Undo trim";
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

/// Returns what was changed about a clip.
pub fn changes(changes: &ClipChanges) -> String {
    let ClipChanges { mirror, trim, reverse, speed, loop_secs, offset, turn_degrees } = *changes;
    let kinds = [
        (mirror, "mirrored"),
        (trim.is_some(), "trimmed"),
        (reverse, "reversed"),
        (speed != 1.0, "other speed"),
        (loop_secs.is_some(), "made loopable"),
        (offset != [0.0; 2], "moved"),
        (turn_degrees != 0.0, "turned"),
    ];
    let kinds: Vec<&str> = kinds.into_iter().filter_map(|(is_changed, kind)| is_changed.then_some(kind)).collect();
    format!("Changed: {}", kinds.join(", "))
}

// Layers
/// Heading.
pub const LAYERS: &str = "Layers";
/// Button that adds a layer on top.
pub const ADD_LAYER: &str = "Add layer";
/// What layers are.
pub const ABOUT_LAYERS: &str = "Layers play over every clip, the first one on top. Choose body parts, or select a joint, \
                                to limit a layer to them. Without either, it plays on the whole body.";
/// Chooser of a layer's clip.
pub const LAYER_CLIP: &str = "Layer's clip";
/// Button that swaps a layer with the next.
pub const RAISE_LAYER: &str = "Raise";
/// Button that removes a layer.
pub const REMOVE_LAYER: &str = "Remove layer";
/// Topic of the choice of modes.
pub const LAYER_MODE: &str = "Layer";
/// Heading of the parts of the body that a layer moves.
pub const LAYER_PARTS: &str = "Body parts";
/// Slider: the weight.
pub const LAYER_WEIGHT: &str = "Layer weight";
/// Slider: the speed.
pub const LAYER_SPEED: &str = "Layer speed";
/// Slider: where on the timeline the clip begins.
pub const LAYER_START: &str = "Layer start";

/// Returns the name of a layer's controls; layers are counted from the bottom, from 1.
pub fn layer(number: usize, clip: &str) -> String {
    format!("Layer {number}: {clip}")
}

/// Returns the label of a mode.
pub fn layer_mode(mode: LayerMode) -> &'static str {
    match mode {
        LayerMode::Override => "Override",
        LayerMode::Additive => "Add",
        LayerMode::AdditiveToRest => "Add to rest",
    }
}

/// Returns the label of a part of the body.
pub fn body_part(part: BodyPart) -> &'static str {
    match part {
        BodyPart::Hips => "Hips",
        BodyPart::Torso => "Torso",
        BodyPart::Head => "Head",
        BodyPart::LeftArm => "Left arm",
        BodyPart::RightArm => "Right arm",
        BodyPart::LeftLeg => "Left leg",
        BodyPart::RightLeg => "Right leg",
    }
}

/// Returns the label of a joint with everything below it.
pub fn below_joint(name: &str) -> String {
    format!("{name} and below")
}

/// Returns the accessible name of a layer's track under the timeline.
pub fn layer_track(name: &str) -> String {
    format!("Layer {name}")
}
