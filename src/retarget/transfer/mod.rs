//! Carries the motion over: rotations, the hips' path, copied channels, detached limbs, and layers below.

pub mod copy;
pub mod detached;
mod layers;
pub mod root;
pub mod rotation;

pub use layers::{Baking, LayerClip, bake_layers, baking, layer_clips};
