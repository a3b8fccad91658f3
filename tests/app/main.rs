//! The app without a window: opening, closing, retargeting, undoing and recording, with their notices.

#[path = "../support/gpu.rs"]
mod adapter;
#[allow(dead_code)]
#[path = "../support/by_place.rs"]
mod by_place;
#[path = "../support/data_folder.rs"]
mod data_folder;
mod desk;
mod open;
mod record;
mod validate;
mod view;
