//! Tests of the loaders and writers: invalid files first, then behaviour, then every real file in the data folder.

mod behaviour;
mod bvh;
mod draco;
mod early;
mod exercise;
mod file_sets;
mod fuzz;
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
mod mutation;
mod npz;
mod obj;
mod playback;
mod pointer;
mod rehearsal;
mod sweep;
mod tangents;
mod variants;
mod write;
mod write_clip;
mod x;

#[path = "../support/allocations.rs"]
mod allocations;
#[path = "../support/build_gltf.rs"]
mod build_gltf;
#[path = "../support/coursework.rs"]
mod coursework;
#[path = "../support/data_folder.rs"]
mod data_folder;
#[path = "../support/model_files.rs"]
mod model_files;
#[path = "../support/numpy.rs"]
mod numpy;
#[path = "../support/random.rs"]
mod random;
#[path = "../support/skeletons.rs"]
mod skeletons;
