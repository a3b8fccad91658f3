//! Real files, loaded as the program loads them.

#[path = "../support/data_folder.rs"]
mod data_folder;

use gaitway::asset::Asset;

/// None if there is no data folder.
pub fn open(path: &str) -> Option<Asset> {
    Some(data_folder::read(&data_folder::data_folder()?, path))
}
