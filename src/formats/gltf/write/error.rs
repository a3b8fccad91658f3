//! Why a file cannot be written.

use crate::formats::LoadError;

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WriteError {
    #[error(transparent)]
    Read(#[from] LoadError),
    #[error("clip “{clip}” has no channel that could be written")]
    EmptyClip { clip: String },
    #[error("clip “{clip}” has a key that is not a number, for joint {joint}")]
    NotFinite { clip: String, joint: String },
    #[error("the clips are for {joints} joints, but {file} has {nodes} nodes: they belong to another model")]
    OtherSkeleton { file: String, nodes: usize, joints: usize },
    #[error("{file}: its first buffer has no data, so that there is nothing to append to")]
    NoBuffer { file: String },
    #[error("the file would have {bytes} bytes; a GLB holds at most 4 GiB")]
    TooLarge { bytes: usize },
}
