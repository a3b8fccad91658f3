//! What the GPU draws: shaders, layouts, skinning against the shared cases, and a few small pictures.

#[path = "../support/gpu.rs"]
mod adapter;
#[path = "../support/coursework.rs"]
mod coursework;
#[path = "../support/data_folder.rs"]
mod data_folder;
mod device;
mod golden;
mod layouts;
mod lights;
mod maps;
mod pictures;
mod scene;
mod shaders;
mod skinning;
#[path = "../support/skinning_cases.rs"]
mod skinning_cases;
