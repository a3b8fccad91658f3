//! Tests of the loaders: broken files first, then what a good file means, then every real file at hand.

mod behaviour;
mod build_gltf;
mod bvh;
mod file_sets;
mod humanoid;
mod influences;
mod invalid;
mod lenient;
mod mutation;
mod obj;
mod sweep;
mod tangents;
mod write;

#[path = "../support/coursework.rs"]
mod coursework;
#[path = "../support/data_folder.rs"]
mod data_folder;
#[path = "../support/random.rs"]
mod random;
