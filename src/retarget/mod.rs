//! Borrowed motion: a clip of one skeleton and a joint map make an ordinary clip of another skeleton. Knows no file format.

mod align;
mod bake;
mod feet;
mod keys;
mod map;
mod math;
mod measure;
mod pose;
mod recognize;
mod retargeting;
mod transfer;

pub use bake::{RetargetError, Retargeted};
pub use map::{
    ClipRef, Feet, JointMap, Keep, Layer, MapEntry, MapError, MutedChannel, MutedProperty, Pair, Proposal,
    ProposedPair, ResolvedMap, RestChoice, RestChoices, RootOptions, RootPart, SourceRef, Unmapped, opposite_joints,
    propose,
};
pub use measure::{Figures, FootTrack, StagePair};
pub use recognize::{Contradiction, Facing, Part, Reason, Recognized, recognize};
pub use retargeting::{Body, Retargeting};
pub use transfer::{Baking, LayerClip, bake_layers, baking, layer_clips};
