//! Writes GLB: a glTF model with clips added, a model of another format, a skeleton with clips and nothing else, or a
//! VRM animation.
//!
//! A glTF model is not re-exported: its JSON is kept as text, member by member, and changes only where clips are added, renamed or
//! left out. So unknown extensions and extras survive, and so does every digit. The original buffer is the beginning of the new one
//! unless clips are left out.

mod asset;
mod clip;
mod error;
mod glb;
mod in_mirror;
mod model;
mod motion;
mod own_clips;
mod root_joint;
mod vrma;

pub use asset::asset;
pub use error::WriteError;
pub(crate) use error::check_frames;
pub(super) use glb::glb;
pub use model::model;
pub use motion::motion;
pub use own_clips::OwnClips;
pub use root_joint::insert_root;
pub use vrma::vrma;
