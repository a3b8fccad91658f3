//! Where tests find real files. They are not part of the repository.

use std::path::PathBuf;

/// Returns the folder named by `GAITWAY_DATA`, or else `../shared/data` beside the repository. Without it this prints
/// `skipped: …` and returns none, so that the test passes; with `GAITWAY_REQUIRE_DATA=1` it panics instead.
#[allow(dead_code)]
pub fn data_folder() -> Option<PathBuf> {
    let folder = match std::env::var_os("GAITWAY_DATA") {
        Some(folder) => PathBuf::from(folder),
        None => repository().join("../shared/data"),
    };
    if folder.is_dir() {
        return Some(folder);
    }
    let missing = format!("no real files at {}: set GAITWAY_DATA", folder.display());
    assert!(std::env::var("GAITWAY_REQUIRE_DATA").as_deref() != Ok("1"), "{missing}");
    println!("skipped: {missing}");
    None
}

/// Cargo runs tests in the folder of their package, which may be a subfolder of the repository.
#[allow(dead_code)]
fn repository() -> PathBuf {
    let package = std::env::current_dir().expect("the folder of the package");
    package.ancestors().find(|folder| folder.join("Cargo.lock").is_file()).unwrap_or(&package).to_owned()
}
