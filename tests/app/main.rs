//! The app without a window: what is opened, closed, borrowed, taken back, and what is said about it.

#[path = "../support/gpu.rs"]
mod adapter;
#[path = "../support/data_folder.rs"]
mod data_folder;
mod desk;
mod open;
mod view;
