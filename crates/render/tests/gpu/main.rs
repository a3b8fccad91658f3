//! GPU tests: shaders, layouts, skinning against the shared cases, and small pictures.

#[path = "../../../../tests/support/gpu.rs"]
mod adapter;
mod animated;
#[allow(dead_code)]
#[path = "../../../../tests/support/build_gltf.rs"]
mod build_gltf;
mod channels;
#[path = "../../../../tests/support/coursework.rs"]
mod coursework;
#[path = "../../../../tests/support/data_folder.rs"]
mod data_folder;
mod device;
mod environment;
mod golden;
mod layouts;
mod lights;
mod lobes;
mod maps;
mod mtoon;
mod pictures;
#[path = "../../../../tests/support/random.rs"]
mod random;
mod refine;
mod scene;
mod shaders;
mod skinning;
#[path = "../../../../tests/support/skinning_cases.rs"]
mod skinning_cases;
mod transparency;
