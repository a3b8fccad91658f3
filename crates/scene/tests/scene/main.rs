//! From a model and a view state to the numbers of a frame: library, state, link, editor and frame.

mod allocation;
#[path = "../../../../tests/support/allocations.rs"]
mod allocations;
mod avatar;
#[allow(dead_code)]
#[path = "../../../../tests/support/by_place.rs"]
mod by_place;

#[path = "../../../../tests/support/bent_exercise.rs"]
mod bent_exercise;
#[allow(dead_code)]
#[path = "../../../../tests/support/build_gltf.rs"]
mod build_gltf;
#[path = "../../../../tests/support/coursework.rs"]
mod coursework;
mod coursework_scene;
mod crossfade;
mod data;
#[path = "../../../../tests/support/data_folder.rs"]
mod data_folder;
mod editor;
mod extent;
#[path = "../../../../tests/support/file_set.rs"]
mod file_set;
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
mod link_texts;
mod loop_frames;
mod manual_pose;
mod map_edits;
#[path = "../../../../tests/support/model_files.rs"]
mod model_files;
mod motion;
mod opened;
mod pins;
mod pointers;
#[path = "../../../../tests/support/random.rs"]
mod random;
#[path = "../../../../tests/support/read_back.rs"]
mod read_back;
mod real_models;
mod scale;
#[path = "../../../../tests/support/skeletons.rs"]
mod skeletons;
mod stage;
mod state;
mod takes;
mod texts;
mod variants;
mod view_problems;
#[path = "../../../../tests/support/walk_bvh.rs"]
mod walk_bvh;
mod walker;
mod written_samples;
