//! Which target joint follows which source joint: the map's file form, its resolved form, and proposals.

mod error;
mod file;
mod opposite;
mod options;
mod propose;
mod resolve;
mod resolved;
mod shared_names;

pub use error::MapError;
pub use file::{ClipRef, JointMap, MapEntry, MutedChannel, MutedProperty, SourceRef, Unmapped};
pub use opposite::opposite_joints;
pub use options::{Feet, Keep, RestChoice, RestChoices, RootOptions, RootPart};
pub use propose::{Proposal, ProposedPair, propose};
pub use resolved::{Layer, Pair, ResolvedMap};
