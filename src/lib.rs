//! Gaitway: drop in a glTF or FBX character, watch it move, and see why it bends the way it does.
//!
//! One core with three front ends: a web page, a native window and a command line, which are here. The layers below are
//! packages of their own in `crates`, and ARCHITECTURE.md lists them.
//!
//! Units are metres, seconds and radians; right-handed, Y up, column vectors, quaternions x y z w, as in glTF. Transforms are
//! named `target_from_source`, so that adjacent names in a product match: `model_from_joint * joint_from_bind`.
//!
//! # The main path
//!
//! Load two files, propose a joint map, retarget a clip, sample it, and write the model with the new clip. `examples/` has the
//! same steps as programs.
//!
//! ```
//! use gaitway_character::anim::SampleCursor;
//! use gaitway_formats::{FileSet, load, write_model};
//! use gaitway_retarget::{Body, Retargeting, propose};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // Loaders never touch the disk: they read an in-memory set of named files.
//! let mut model_files = FileSet::default();
//! model_files.insert("dwarf.glb", std::fs::read("assets/samples/dwarf.glb")?);
//! let mut motion_files = FileSet::default();
//! motion_files.insert("walk.bvh", std::fs::read("assets/samples/walk.bvh")?);
//! let (model, motion) = (load(&model_files)?, load(&motion_files)?);
//!
//! // A map pairs the joints of these two files by number; `JointMapFile` reads one with names. Resolving checks it.
//! let proposal = propose(&model, &motion);
//! let map = proposal.to_map(&model, &motion).resolve(&model, &motion)?;
//!
//! // Retargeting bakes an ordinary clip of the model.
//! let (model_slots, motion_slots) = (proposal.model.humanoid(), proposal.motion.humanoid());
//! let target = Body { asset: &model, slots: &model_slots };
//! let source = Body { asset: &motion, slots: &motion_slots };
//! let clip = Retargeting::new(target, source, 0, &map)?.bake()?.clip;
//!
//! // Joints that the clip doesn't animate keep their values: start from the rest pose.
//! let mut pose = model.skeleton.rest().clone();
//! clip.sample(&model.skeleton, 0.5, &mut SampleCursor::default(), &mut pose);
//! assert_ne!(pose, *model.skeleton.rest());
//!
//! // The new file keeps everything in the old one.
//! let glb = write_model(&model_files, "dwarf.glb", &model.skeleton, &[&clip])?;
//! let mut written = FileSet::default();
//! written.insert("new.glb", glb);
//! assert_eq!(load(&written)?.clips.len(), model.clips.len() + 1);
//! # Ok(())
//! # }
//! ```

#![forbid(unsafe_code)]
// Files are untrusted: whatever is wrong with them must be reported, never panic.
#![warn(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

#[cfg(feature = "viewer")]
pub mod app;
#[cfg(feature = "viewer")]
pub mod ui;

pub mod files;

#[cfg(not(target_arch = "wasm32"))]
pub mod cli;
#[cfg(all(target_arch = "wasm32", feature = "viewer"))]
pub mod web;
