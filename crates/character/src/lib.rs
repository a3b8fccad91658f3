//! What a character is made of, whatever file it is from: skeletons, clips and poses, meshes and skins, what an avatar adds, and
//! the asset that holds them. Data and arithmetic, without files, GPU, user interface or clock.

#![forbid(unsafe_code)]
// Files are untrusted: whatever is wrong with them must be reported, never panic.
#![warn(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

pub mod anim;
pub mod asset;
pub mod avatar;
pub mod mesh;
pub mod sort;
