//! From a model and a view state to a picture's numbers: library, state, link, frame, and the command line. No GPU.

mod address;
mod allocation;
mod cli;
mod cli_borrow;
mod crossfade;
mod data;
mod decode;
mod extent;
mod frame;
mod framing;
mod generator_animations;
mod history;
mod link;
mod motion;
mod real_models;
mod scale;
mod sets;
mod state;
mod walker;
