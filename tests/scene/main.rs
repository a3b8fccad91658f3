//! From a model and a view state to a picture's numbers: library, state, link, frame, and the command line. No GPU.

mod address;
mod allocation;
mod by_hand;
mod cli;
mod cli_borrow;
#[path = "../support/coursework.rs"]
mod coursework;
mod coursework_scene;
mod crossfade;
mod data;
mod decode;
mod extent;
mod frame;
mod framing;
mod generator_animations;
mod history;
mod link;
mod link_files;
mod link_properties;
mod map_edits;
mod motion;
mod real_models;
mod samples;
mod scale;
mod sets;
mod stage;
mod state;
mod walker;
