//! Tests of the loaders and writers: invalid files first, then behaviour, then every real file in the data folder.

mod behaviour;
mod bvh;
mod draco;
mod early;
mod encodings;
mod exercise;
mod file_sets;
mod hdr;
mod humanoid;
mod influences;
mod instancing;
mod invalid;
mod lenient;
mod limits;
mod lobes;
mod meshopt;
mod mtoon;
mod npz;
mod obj;
mod own_clips;
mod playback;
mod pointer;
mod sweep;
mod tangents;
mod variants;
mod write;
mod write_clip;
mod x;

#[path = "../../../../tests/support/allocations.rs"]
mod allocations;
#[path = "../../../../tests/support/build_gltf.rs"]
mod build_gltf;
#[path = "../../../../tests/support/coursework.rs"]
mod coursework;
#[path = "../../../../tests/support/data_folder.rs"]
mod data_folder;
#[path = "../../../../tests/support/examples.rs"]
mod examples;
#[path = "../../../../tests/support/file_set.rs"]
mod file_set;
#[path = "../../../../tests/support/model_files.rs"]
mod model_files;
#[path = "../../../../tests/support/numpy.rs"]
mod numpy;
#[path = "../../../../tests/support/random.rs"]
mod random;
#[path = "../../../../tests/support/read_back.rs"]
mod read_back;
#[path = "../../../../tests/support/skeletons.rs"]
mod skeletons;
