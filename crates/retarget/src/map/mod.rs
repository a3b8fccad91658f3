//! Which target joint follows which source joint: the map in joint numbers, its file form with names, its resolved form, and
//! proposals.
//!
//! Names exist only where files and links are read and written; everything else identifies joints by number.
//! `tests/layering/main.rs` keeps the file form to those places.

mod convert;
mod error;
mod expressions;
mod file;
mod joint_map;
mod names;
mod opposite;
mod options;
mod propose;
mod resolve;
mod resolved;
mod shared_names;
mod unmapped;

pub use error::MapError;
pub use expressions::has_expressions_alone;
pub use file::{JointMapFile, SourceRef};
pub use joint_map::{JointMap, MapEntry, MutedChannel, MutedProperty};
pub use opposite::{opposite_joints, pairs_by_side};
pub use options::{Chains, Contacts, Feet, Keep, PathOrigin, RestChoice, RestChoices, RootOptions, RootPart, UpChoice};
pub use propose::{Proposal, ProposedPair, propose, propose_recognized};
pub use resolved::{Layer, Pair, ResolvedMap};
pub(super) use shared_names::shared_names;
pub use unmapped::{ClipRef, Unmapped};
