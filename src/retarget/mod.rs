//! Borrowed motion: a clip of one skeleton and a joint map make an ordinary clip of another skeleton. Knows no file format.
//!
//! ```
//! use gaitway::formats::{FileSet, load};
//! use gaitway::retarget::propose;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let open = |name: &str| -> Result<_, Box<dyn std::error::Error>> {
//!     let mut files = FileSet::default();
//!     files.insert(name, std::fs::read(format!("assets/samples/{name}"))?);
//!     Ok(load(&files)?)
//! };
//! let (model, motion) = (open("mannequin.glb")?, open("walk.bvh")?);
//!
//! let proposal = propose(&model, &motion);
//! let hips = model.skeleton.find("mixamorig:Hips").ok_or("no hips")?;
//! let pair = proposal.pairs.iter().find(|pair| pair.target == hips).ok_or("unmapped")?;
//! assert_eq!(motion.skeleton.name(pair.source), "hip");
//! println!("{} ({:.0} %)", pair.reason, 100.0 * pair.confidence);
//! # Ok(())
//! # }
//! ```

mod align;
mod bake;
mod contacts;
mod detached;
mod feet;
mod figures;
mod law;
mod layers;
mod locals;
mod map;
mod propose;
mod recognize;
mod resample;
mod resolve;
mod resolved;
mod rest;
mod root;
mod sides;
mod stage;
mod track;
mod vocabulary;

pub use bake::{Body, RetargetError, Retargeted, Retargeting};
pub use figures::{Figures, FootTrack};
pub use layers::{Baking, LayerClip, bake_layers, baking, layer_clips};
pub use map::{
    ClipRef, Feet, JointMap, Keep, MapEntry, MutedChannel, MutedProperty, RestChoice, RestChoices, RootOptions,
    RootPart, SourceRef, Unmapped,
};
pub use propose::{Proposal, ProposedPair, propose};
pub use recognize::{Contradiction, Facing, Part, Reason, Recognized, recognize};
pub use resolve::MapError;
pub use resolved::{Layer, Pair, ResolvedMap};
pub use sides::opposite_joints;
pub use stage::StagePair;
