//! Finding models in folders.

use std::path::{Path, PathBuf};

/// Collects the files of a folder and those below it that have one of the extensions, sorted by name.
pub fn models_under(folder: &Path, extensions: &[&str], out: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            models_under(&path, extensions, out);
        } else if path.extension().is_some_and(|extension| extensions.iter().any(|wanted| extension == *wanted)) {
            out.push(path);
        }
    }
}
