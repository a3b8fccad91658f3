//! The core of Gaitway: reads files into skeletons, clips, meshes and skins, plays them, and moves clips from one skeleton to
//! another.
//!
//! Gaitway re-exports these modules, its lowest layers. They are a package of their own so that the page can build them with
//! opt-level `s` and the rest with `z`.

#![forbid(unsafe_code)]
// Files are untrusted: whatever is wrong with them must be reported, never panic.
#![warn(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

pub mod anim;
pub mod asset;
pub mod avatar;
pub mod formats;
mod json_text;
pub mod library;
pub mod mesh;
pub mod retarget;
