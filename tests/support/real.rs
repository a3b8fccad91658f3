//! Real files.

use std::path::Path;

use gaitway_character::asset::Asset;
use gaitway_formats::{FileSet, load, prepare};

/// Loads a file of the test data.
pub fn read(folder: &Path, name: &str) -> Asset {
    let mut files = FileSet::default();
    let bytes = std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    files.insert(name.rsplit('/').next().unwrap(), bytes);
    // The other files of a model in the exercise's format.
    for extension in ["skel", "attach"].into_iter().filter(|_| name.ends_with(".obj")) {
        let path = folder.join(name).with_extension(extension);
        if let Ok(bytes) = std::fs::read(&path) {
            files.insert(path.file_name().and_then(|name| name.to_str()).unwrap(), bytes);
        }
    }
    prepare(&mut files).unwrap_or_else(|error| panic!("{name}: {error}"));
    load(&files).unwrap_or_else(|error| panic!("{name}: {error}"))
}
