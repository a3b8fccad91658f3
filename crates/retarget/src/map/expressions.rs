//! Motions that move a face and no body, as a VRM animation may: they need no joint map.

use gaitway_character::anim::{PropertyChannel, PropertyTarget};
use gaitway_character::asset::Asset;

/// Whether the motion animates expressions or the gaze, and no body.
pub fn has_expressions_alone(motion: &Asset) -> bool {
    let is_expression =
        |channel: &PropertyChannel| matches!(channel.target, PropertyTarget::Expression(_) | PropertyTarget::LookAt);
    let has_body = motion.humanoid.as_ref().is_some_and(|humanoid| !humanoid.0.is_empty());
    !has_body && motion.clips.iter().any(|clip| clip.properties().iter().any(is_expression))
}
