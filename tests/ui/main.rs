//! The panels without a GPU: what they show for a model, and which commands its controls produce.

#[path = "../support/allocations.rs"]
mod allocations;
mod bench;
mod by_hand;
#[allow(dead_code)]
#[path = "../support/by_place.rs"]
mod by_place;
mod change;
mod clips;
mod design;
mod exercise;
mod header;
mod inspector;
mod keys;
mod layers;
mod layout;
mod mirror;
mod models;
mod motion;
mod picture;
mod pins;
mod scene_tree;
#[path = "../support/skeletons.rs"]
mod skeletons;
mod text_widths;
mod transport;
