//! Where the real files are that some tests read. They are not part of the repository.

use std::path::{Path, PathBuf};

use gaitway::asset::Asset;
use gaitway::formats::{FileSet, load};

/// The folder named by `GAITWAY_DATA`, else `../shared/data` beside the repository. None when there is none: the caller
/// prints `skipped: …` through this function and passes, unless `GAITWAY_REQUIRE_DATA=1` turns that into a failure.
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

/// What one of the real files holds.
#[allow(dead_code)]
pub fn read(folder: &Path, name: &str) -> Asset {
    let mut files = FileSet::default();
    files.insert(name.rsplit('/').next().unwrap(), std::fs::read(folder.join(name)).unwrap());
    load(&files).unwrap()
}
