//! What a step of undo or redo was about.

use super::ViewerState;

/// A group of settings that undo covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edited {
    /// The pairs of joint maps.
    JointMap,
    /// How motions are retargeted otherwise.
    Retargeting,
    /// Weights of morph targets.
    MorphWeights,
    /// Weights of expressions.
    Expressions,
    /// Joints posed manually.
    Pose,
    /// Pinned joints.
    Pins,
    /// Custom joint names.
    JointNames,
    /// Changed and copied clips.
    Clips,
    /// Clips over the active one.
    Layers,
    /// The material variant.
    Variant,
    /// Hidden nodes and materials.
    Hidden,
    /// Which axis of the file points up.
    UpAxis,
    /// Image-based light and the key light.
    Lighting,
    /// How the scene is drawn and explained.
    Display,
}

impl Edited {
    /// Returns in what two states differ, the first group of those above; `None` if in none.
    pub fn between(a: &ViewerState, b: &ViewerState) -> Option<Self> {
        [
            (a.character.retarget.map != b.character.retarget.map, Self::JointMap),
            (a.character.retarget != b.character.retarget, Self::Retargeting),
            (a.character.edits.morph != b.character.edits.morph, Self::MorphWeights),
            (a.character.edits.expressions != b.character.edits.expressions, Self::Expressions),
            (a.character.edits.pose != b.character.edits.pose, Self::Pose),
            (a.character.edits.pins != b.character.edits.pins, Self::Pins),
            (a.character.edits.names != b.character.edits.names, Self::JointNames),
            (a.character.edits.clips != b.character.edits.clips, Self::Clips),
            (a.character.edits.layers != b.character.edits.layers, Self::Layers),
            (a.character.edits.variant != b.character.edits.variant, Self::Variant),
            (a.character.edits.hidden != b.character.edits.hidden, Self::Hidden),
            (a.character.edits.up != b.character.edits.up, Self::UpAxis),
            (a.lighting != b.lighting, Self::Lighting),
            (a.display != b.display || a.inspect != b.inspect, Self::Display),
        ]
        .into_iter()
        .find_map(|(differs, edited)| differs.then_some(edited))
    }
}
