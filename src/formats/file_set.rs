//! A set of named files in memory: what was dropped, picked, unzipped, read beside a model or fetched.

use std::sync::Arc;

/// Files by path, `/` between folders, in the order they were added.
#[derive(Debug, Clone, Default)]
pub struct FileSet {
    files: Vec<(String, Arc<[u8]>)>,
}

impl FileSet {
    /// Adds a file; one of the same name is replaced.
    pub fn insert(&mut self, name: impl Into<String>, bytes: impl Into<Arc<[u8]>>) {
        let (name, bytes) = (name.into(), bytes.into());
        match self.files.iter_mut().find(|(other, _)| *other == name) {
            Some(file) => file.1 = bytes,
            None => self.files.push((name, bytes)),
        }
    }

    pub fn get(&self, name: &str) -> Option<&Arc<[u8]>> {
        self.files.iter().find(|(other, _)| other == name).map(|(_, bytes)| bytes)
    }

    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|(name, _)| name.as_str())
    }

    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }
}
