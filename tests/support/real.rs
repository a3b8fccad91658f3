//! Real files.

use std::path::Path;

use gaitway::asset::Asset;
use gaitway::formats::{FileSet, load, prepare};

/// Loads a file of the test data.
pub fn read(folder: &Path, name: &str) -> Asset {
    let mut files = FileSet::default();
    let bytes = std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    files.insert(name.rsplit('/').next().unwrap(), bytes);
    prepare(&mut files).unwrap_or_else(|error| panic!("{name}: {error}"));
    load(&files).unwrap_or_else(|error| panic!("{name}: {error}"))
}
