//! Opening files: from paths, folders, archives and links to what the editor opens.

mod address;
#[allow(dead_code)]
#[path = "../support/build_gltf.rs"]
mod build_gltf;
mod decode;
mod early;
mod extensions;
mod samples;
mod sets;
