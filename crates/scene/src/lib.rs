//! The scene: what is loaded (the library) and what is set (the view state), the editor, which is the only one to change them,
//! and the frame that follows from both. Without GPU, user interface, disk, network or clock.

#![forbid(unsafe_code)]
// Files are untrusted: whatever is wrong with them must be reported, never panic.
#![warn(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

pub mod editor;
pub mod frame;
pub mod library;
pub mod samples;
pub mod state;
