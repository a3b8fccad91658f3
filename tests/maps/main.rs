//! Joint maps: which joint is which part of a body, what is proposed for two skeletons, and the file form.

mod data;
mod facing;
mod files;
mod proposals;
mod resolving;
mod rigs;
#[path = "../support/skeletons.rs"]
mod skeletons;
mod truth;
