//! One side of a retarget: a model or a motion.

use gaitway_character::asset::{Asset, Humanoid};

/// An asset and its joints by humanoid slot: one side of a retarget.
#[derive(Debug, Clone, Copy)]
pub struct Body<'a> {
    /// The file, with skeleton, skins and clips.
    pub asset: &'a Asset,
    /// Joints of `asset` by humanoid slot; empty if it is not a human body.
    pub slots: &'a Humanoid,
}
