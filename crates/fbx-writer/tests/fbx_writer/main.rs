//! Tests of the writer: what is written is read back by the project's own readers.

mod built;
mod characters;
#[path = "../../../../tests/support/data_folder.rs"]
mod data_folder;
mod mutation;
#[path = "../../../../tests/support/random.rs"]
mod random;
mod read;
