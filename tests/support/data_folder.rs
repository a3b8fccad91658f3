//! Real model files for tests. They are not part of the repository.

use std::path::{Path, PathBuf};

use gaitway::asset::Asset;
use gaitway::formats::{FileSet, load};

/// Returns the folder named by `GAITWAY_DATA`, or else `../shared/data`. Without it this prints `skipped: …` and
/// returns none, so that the test passes; with `GAITWAY_REQUIRE_DATA=1` it panics instead.
#[allow(dead_code)]
pub fn data_folder() -> Option<PathBuf> {
    let folder = match std::env::var_os("GAITWAY_DATA") {
        Some(folder) => PathBuf::from(folder),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"),
    };
    if folder.is_dir() {
        return Some(folder);
    }
    let missing = format!("no real files at {}: set GAITWAY_DATA", folder.display());
    assert!(std::env::var("GAITWAY_REQUIRE_DATA").as_deref() != Ok("1"), "{missing}");
    println!("skipped: {missing}");
    None
}

/// Loads one of the files.
#[allow(dead_code)]
pub fn read(folder: &Path, name: &str) -> Asset {
    let mut files = FileSet::default();
    let bytes = std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    files.insert(name.rsplit('/').next().unwrap(), bytes);
    load(&files).unwrap_or_else(|error| panic!("{name}: {error}"))
}
