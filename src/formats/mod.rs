//! From files in memory to an [`Asset`]. Knows no disk and no network: whoever has one asks [`missing_files`] what else a
//! file names, adds it to the [`FileSet`], and then calls [`load`].

mod error;
mod file_set;

pub use error::LoadError;
pub use file_set::FileSet;

use crate::asset::Asset;

/// Relative URIs (percent-decoded, as [`FileSet`] names them) that the model in this set refers to and that are not in
/// the set, not even by their bare names. Empty when the set is complete or cannot be read at all.
pub fn missing_files(_files: &FileSet) -> Vec<String> {
    Vec::new()
}

/// Reads the one model in a set of files. A set with none, or with several, is an error that lists what was found.
pub fn load(files: &FileSet) -> Result<Asset, LoadError> {
    Err(LoadError::NoModel { found: files.names().map(str::to_owned).collect() })
}
