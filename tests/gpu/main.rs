//! GPU tests: shaders, layouts, skinning against the shared cases, and small pictures.

#[path = "../support/gpu.rs"]
mod adapter;
mod animated;
#[allow(dead_code)]
#[path = "../support/build_gltf.rs"]
mod build_gltf;
mod channels;
mod cli;
#[path = "../support/coursework.rs"]
mod coursework;
#[path = "../support/data_folder.rs"]
mod data_folder;
mod device;
mod environment;
mod gallery;
mod golden;
mod layouts;
mod lights;
mod lobes;
mod maps;
mod mtoon;
mod pictures;
#[path = "../support/random.rs"]
mod random;
mod refine;
mod scene;
mod shaders;
mod skinning;
#[path = "../support/skinning_cases.rs"]
mod skinning_cases;
mod transparency;
