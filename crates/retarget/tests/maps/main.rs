//! Joint maps: recognition of humanoid slots, proposals for two skeletons, and the file form.

mod data;
mod evidence;
mod facing;
mod files;
#[path = "../../../../tests/support/numpy.rs"]
mod numpy;
mod proposals;
mod recognition;
mod resolving;
mod rigs;
#[path = "../../../../tests/support/skeletons.rs"]
mod skeletons;
mod truth;
mod unnamed;
