//! Real files, loaded as the program loads them.

#[path = "../support/data_folder.rs"]
mod data_folder;

use gaitway::asset::Asset;
use gaitway::formats::{self, FileSet};

/// None if there is no data folder.
pub fn open(path: &str) -> Option<Asset> {
    let folder = data_folder::data_folder()?;
    let path = folder.join(path);
    let mut files = FileSet::default();
    let bytes = std::fs::read(&path).unwrap_or_else(|error| panic!("{path:?}: {error}"));
    files.insert(path.file_name().unwrap_or_default().to_string_lossy(), bytes);
    Some(formats::load(&files).unwrap_or_else(|error| panic!("{path:?}: {error}")))
}
