//! From a model and a view state to the numbers of a frame: library, state, link, frame, and the command line. No GPU.

mod address;
mod allocation;
#[path = "../support/allocations.rs"]
mod allocations;
mod avatar;
#[allow(dead_code)]
#[path = "../support/by_place.rs"]
mod by_place;

#[allow(dead_code)]
#[path = "../support/build_gltf.rs"]
mod build_gltf;
mod cli;
mod cli_batch;
mod cli_motion;
mod cli_output;
#[path = "../support/coursework.rs"]
mod coursework;
mod coursework_scene;
mod crossfade;
mod data;
#[path = "../support/data_folder.rs"]
mod data_folder;
mod decode;
mod editor;
mod extent;
mod findings;
mod frame;
mod framing;
mod generator_animations;
mod hidden;
mod history;
mod instancing;
mod layers;
mod link;
mod link_properties;
mod loop_frames;
mod manual_pose;
mod map_edits;
#[path = "../support/model_files.rs"]
mod model_files;
mod motion;
mod pins;
mod pointers;
#[path = "../support/random.rs"]
mod random;
mod real_models;
mod samples;
mod scale;
mod sets;
#[path = "../support/skeletons.rs"]
mod skeletons;
mod stage;
mod state;
mod takes;
mod texts;
mod variants;
mod view_problems;
mod walker;
