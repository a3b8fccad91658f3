//! Retargets a clip: turns a clip of one skeleton and a joint map into an ordinary clip of another skeleton. Knows no file
//! format.
//!
//! The steps, in order: `recognize` finds humanoid slots, `body` the chains that they form, `map` proposes and resolves a joint
//! map, `align` brings the two rests together, `transfer` computes the channels, `feet` plants the feet, `contacts` keeps those of
//! hands and knees, `bake` builds the clip, `measure` compares it with its source. `change` mirrors, trims, loops and moves any
//! clip, or holds parts of it still, `stack` puts others over it, `pins` holds hands and feet, and `baker` makes a clip of what
//! these two do. For files, `merge` keeps the keys of clips of one rig, `root_bone` moves travel from the hips to a root, and
//! `fewer_keys` drops what interpolation restores. `budget`, `pose`, `keys`, `math`, `times`, `limit`, `side`, `skin` and
//! `two_bones` are shared.
//!
//! The result is an ordinary clip: the library lists it after the model's own, and the player cannot tell them apart.
//! `docs/retargeting.md` has the math.
//!
//! ```
//! use gaitway_formats::{FileSet, load};
//! use gaitway_retarget::propose;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let open = |name: &str| -> Result<_, Box<dyn std::error::Error>> {
//!     let mut files = FileSet::default();
//!     files.insert(name, std::fs::read(format!("../../assets/samples/{name}"))?);
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

#![forbid(unsafe_code)]
// Files are untrusted: whatever is wrong with them must be reported, never panic.
#![warn(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

mod align;
mod bake;
mod baker;
mod body;
mod budget;
mod change;
mod contacts;
mod feet;
mod fewer_keys;
mod keys;
mod limit;
mod map;
mod math;
mod measure;
mod merge;
mod pins;
mod pose;
mod recognize;
mod retargeting;
mod root_bone;
mod side;
mod skin;
mod stack;
mod times;
mod transfer;
mod two_bones;

pub use align::rest::{FoundRest, RestOrigin};
pub use bake::{RetargetError, Retargeted};
pub use body::{Anatomy, Chain, ChainJoint, ChainPart, Follower, Segment, TwistJoint};
pub use change::{ChangedClip, ClipChanges, HeldValues, Seam, Symmetry, change_clip, hold_values};
pub use feet::Planting;
pub use fewer_keys::{KeyTolerance, Thinned, fewer_keys};
pub use map::{
    Chains, ClipRef, Contacts, Feet, JointMap, JointMapFile, Keep, Layer, MapEntry, MapError, MutedChannel,
    MutedProperty, Pair, PathOrigin, Proposal, ProposedPair, ResolvedMap, RestChoice, RestChoices, RootOptions,
    RootPart, SourceRef, Unmapped, UpChoice, has_expressions_alone, opposite_joints, propose, propose_recognized,
};
pub use measure::{Figures, FitWarning, FootTrack, StagePair, Verdict, Verdicts};
pub use merge::{clip_for, merged_clip};
pub use pins::{Pin, PinGoal, PinTimes, Pinning};
pub use recognize::{Contradiction, Facing, Reason, Recognized, RecognizedJoint, recognize, words};
pub use retargeting::Retargeting;
pub use root_bone::{RootError, RootTravel, with_root_motion};
pub use side::Body;
pub use stack::{BodyPart, ClipLayer, ClipOverLayers, LayerBuffers, LayerMask, LayerMode, StackedLayer, bake_stack};
pub use transfer::{Baking, LayerClip, bake_layers, baking, layer_clips};
