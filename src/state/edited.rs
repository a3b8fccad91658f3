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
            (a.retarget.map != b.retarget.map, Self::JointMap),
            (a.retarget != b.retarget, Self::Retargeting),
            (a.edits.morph != b.edits.morph, Self::MorphWeights),
            (a.edits.expressions != b.edits.expressions, Self::Expressions),
            (a.edits.pose != b.edits.pose, Self::Pose),
            (a.edits.pins != b.edits.pins, Self::Pins),
            (a.edits.names != b.edits.names, Self::JointNames),
            (a.edits.clips != b.edits.clips, Self::Clips),
            (a.edits.layers != b.edits.layers, Self::Layers),
            (a.edits.variant != b.edits.variant, Self::Variant),
            (a.edits.hidden != b.edits.hidden, Self::Hidden),
            (a.edits.up != b.edits.up, Self::UpAxis),
            (a.lighting != b.lighting, Self::Lighting),
            (a.display != b.display || a.inspect != b.inspect, Self::Display),
        ]
        .into_iter()
        .find_map(|(differs, edited)| differs.then_some(edited))
    }
}
