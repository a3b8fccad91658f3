//! Layers whose clips a model lacks.

use super::UnknownName;
use super::clip_names::{look_up_clip, unknown_name};
use crate::library::{LayeredClip, Model};

/// Returns the clips of layers that the model lacks.
pub fn unknown_layers(model: &Model, layers: &[LayeredClip]) -> impl Iterator<Item = UnknownName> {
    let unknown = layers.iter().filter(|over| look_up_clip(model, &over.clip).is_none());
    unknown.map(|over| unknown_name(model, &over.clip))
}
