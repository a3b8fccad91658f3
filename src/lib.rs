//! Gaitway: drop in a glTF character, watch it move, and see why it bends as it does.
//!
//! One core with three faces: a web page, a native window and a command line. The layers go one way; ARCHITECTURE.md
//! lists them and `tests/core/layering.rs` holds them.
//!
//! Metres, seconds, radians; right-handed, Y up, column vectors, quaternions x y z w, as glTF. Transforms are named
//! `to_from_from`, so that neighbours in a product match: `model_from_joint * joint_from_bind`.

pub mod anim;
pub mod asset;
pub mod editor;
pub mod formats;
pub mod frame;
pub mod library;
pub mod mesh;
pub mod retarget;
pub mod samples;
pub mod state;

#[cfg(feature = "render")]
pub mod render;

#[cfg(feature = "viewer")]
pub mod app;
#[cfg(feature = "viewer")]
pub mod ui;

pub mod files;

#[cfg(not(target_arch = "wasm32"))]
pub mod cli;
#[cfg(all(target_arch = "wasm32", feature = "viewer"))]
pub mod web;
