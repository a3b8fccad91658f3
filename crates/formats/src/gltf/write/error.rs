//! Why a file cannot be written.

use gaitway_character::anim::Clip;

use crate::LoadError;
use crate::limits::{MAX_WRITTEN_FRAMES, MAX_WRITTEN_POSES};

/// Everything that prevents writing a file. The user sees these texts.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WriteError {
    /// The source files cannot be read.
    #[error(transparent)]
    Read(#[from] LoadError),
    /// No channel of the clip can be written, for example only morph weights to a file without meshes.
    #[error("clip “{clip}” has no channel that could be written")]
    EmptyClip {
        /// Name of the clip.
        clip: String,
    },
    /// A key value is infinite or not a number.
    #[error("clip “{clip}” has a key that is not a number, for joint {joint}")]
    NotFinite {
        /// Name of the clip.
        clip: String,
        /// Name of the joint that the channel animates; `#NODE` without one.
        joint: String,
    },
    /// A VRM animation holds nothing but humanoid bones.
    #[error("clip “{clip}” moves no human body, at least none with hips; a .glb or a .bvh holds any skeleton")]
    NoBody {
        /// Name of the clip.
        clip: String,
    },
    /// The skeleton given for the clips has another number of joints than the file.
    #[error("the clips are for {joints} joints, but {file} has {nodes} nodes: they belong to another model")]
    OtherSkeleton {
        /// Name of the model's file in the set.
        file: String,
        /// Number of nodes in the file; for an .obj, of joints.
        nodes: usize,
        /// Number of joints in the given skeleton.
        joints: usize,
    },
    /// The skeleton given for the clips has as many joints as the file, but another hierarchy.
    #[error("the clips belong to another model: joint {joint} does not have the parent that it has in {file}")]
    OtherParent {
        /// Name of the model's file in the set.
        file: String,
        /// The first such joint: its name in the given skeleton; `#NODE` without one.
        joint: String,
    },
    /// The clip would have too many frames.
    #[error("clip “{clip}”: expected at most {max} frames, found {found}; trim it first")]
    TooLong {
        /// Name of the clip.
        clip: String,
        /// Maximum number of frames for a clip of that many joints.
        max: usize,
        /// Number of frames that it would have.
        found: usize,
    },
    /// The file would exceed the 32-bit length in the GLB header.
    #[error("the file would have {bytes} bytes; a GLB holds at most 4 GiB")]
    TooLarge {
        /// Length of the whole GLB.
        bytes: usize,
    },
}

/// Checks at how many frames a clip of this many joints is about to be sampled.
pub(crate) fn check_frames(clip: &Clip, found: usize, joints: usize) -> Result<(), WriteError> {
    let max = MAX_WRITTEN_FRAMES.min(MAX_WRITTEN_POSES / joints.max(1));
    if found <= max {
        return Ok(());
    }
    Err(WriteError::TooLong { clip: clip.name().to_owned(), max, found })
}
