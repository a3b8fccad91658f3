//! The command line, run as a program.

#[cfg(feature = "render")]
#[path = "../support/gpu.rs"]
mod adapter;
mod avatar;
mod batch;
#[path = "../support/bent_exercise.rs"]
mod bent_exercise;
#[allow(dead_code)]
#[path = "../support/build_gltf.rs"]
mod build_gltf;
#[path = "../support/coursework.rs"]
mod coursework;
#[path = "../support/data_folder.rs"]
mod data_folder;
mod exercise;
mod export;
#[cfg(feature = "render")]
mod gallery;
mod motion;
mod output;
mod pins;
mod program;
#[path = "../support/random.rs"]
mod random;
mod reach;
#[cfg(feature = "render")]
mod render;
mod terminal;
mod variants;
#[path = "../support/walk_bvh.rs"]
mod walk_bvh;
mod web_page;
