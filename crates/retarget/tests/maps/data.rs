//! Real files, loaded as the program loads them.

#[path = "../../../../tests/support/data_folder.rs"]
mod data_folder;
#[path = "../../../../tests/support/real.rs"]
mod real;

use gaitway_character::asset::Asset;

/// None if there is no data folder.
pub fn open(path: &str) -> Option<Asset> {
    Some(real::read(&data_folder::data_folder()?, path))
}
