//! Tests of the converter, on text made here. `crates/formats/tests/formats/x.rs` compares real files with what another program
//! made of them.

#[path = "../../../../tests/support/damage.rs"]
mod damage;
#[path = "../../../../tests/support/data_folder.rs"]
mod data_folder;
mod encode;
mod errors;
#[path = "../../../../tests/support/glb.rs"]
mod glb;
mod meaning;
mod mutation;
