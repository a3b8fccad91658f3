//! Tests of the converter, on text made here and on real files.

mod ascii;
mod data;
#[path = "../../../../tests/support/data_folder.rs"]
mod data_folder;
#[path = "../../../../tests/support/glb.rs"]
mod glb;
mod mutation;
#[path = "../../../../tests/support/random.rs"]
mod random;
mod text;
