//! Which target joint follows which source joint: the map's file form, its resolved form, and proposals.

mod file;
mod propose;
mod resolve;
mod resolved;
mod sides;

pub use file::{
    ClipRef, Feet, JointMap, Keep, MapEntry, MutedChannel, MutedProperty, RestChoice, RestChoices, RootOptions,
    RootPart, SourceRef, Unmapped,
};
pub use propose::{Proposal, ProposedPair, propose};
pub use resolve::MapError;
pub use resolved::{Layer, Pair, ResolvedMap};
pub use sides::opposite_joints;
