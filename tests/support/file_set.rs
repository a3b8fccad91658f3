//! The files of a model on disk.

// Each test program uses a part of it.
#![allow(dead_code)]

use std::path::Path;

use gaitway_formats::{FileSet, LoadError, missing_files, prepare};

/// A model with the files that it refers to, as a user would drop them, ready to be loaded.
pub fn file_set(path: &Path) -> FileSet {
    prepared(path).unwrap_or_else(|problem| panic!("{}: {problem}", path.display()))
}

pub fn prepared(path: &Path) -> Result<FileSet, LoadError> {
    let folder = path.parent().expect("a file lies in a folder");
    let mut files = FileSet::default();
    files
        .insert(path.file_name().expect("a file has a name").to_string_lossy(), std::fs::read(path).expect("readable"));
    for uri in missing_files(&files) {
        if let Ok(bytes) = std::fs::read(folder.join(&uri)) {
            files.insert(uri, bytes);
        }
    }
    prepare(&mut files)?;
    Ok(files)
}
