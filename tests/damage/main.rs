//! Damaged files through every reader, from bytes to written clips and links: nothing panics, hangs or is inconsistent.

#[allow(dead_code)]
#[path = "../support/build_gltf.rs"]
mod build_gltf;
mod compressed;
#[path = "../support/data_folder.rs"]
mod data_folder;
#[path = "../support/examples.rs"]
mod examples;
#[path = "../support/file_set.rs"]
mod file_set;
mod fuzz;
mod memory;
mod mutation;
#[path = "../support/numpy.rs"]
mod numpy;
#[path = "../support/random.rs"]
mod random;
