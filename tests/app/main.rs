//! The app without a window: opening, closing, retargeting, undoing and recording, with their notices.

#[path = "../support/gpu.rs"]
mod adapter;
#[path = "../support/data_folder.rs"]
mod data_folder;
mod desk;
mod open;
mod record;
mod validate;
mod view;
