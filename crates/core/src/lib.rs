//! Skeletons, clips, poses, meshes and skins: what runs for every joint and vertex of every frame.
//!
//! The two lowest layers of Gaitway, which uses them as its own modules. They are a package of their own because the page
//! builds them for speed and the rest for size.

#![forbid(unsafe_code)]
// Files are untrusted: whatever is wrong with them must be reported, never panic.
#![warn(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

pub mod anim;
pub mod mesh;
