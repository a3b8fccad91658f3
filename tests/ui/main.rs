//! The panels without a GPU: what is shown for a model, and which commands come of pressing things, found by label.

mod bench;
mod by_hand;
mod clips;
mod exercise;
mod inspector;
mod keys;
mod layout;
mod models;
mod motion;
mod picture;
#[path = "../support/skeletons.rs"]
mod skeletons;
mod transport;
