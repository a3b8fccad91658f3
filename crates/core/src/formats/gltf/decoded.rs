//! Shared by the decoders of compressed glTF: finding a file that needs one, and writing it without the extension.

use super::container::{self, Container};
use super::document::{Document, as_text};
use super::object::Object;
use super::{WriteError, write};
use crate::formats::error::Problem;
use crate::formats::file_set::Conversion;
use crate::formats::{FileSet, LoadError};

/// Calls `read` for a file that mentions one of the extensions. `None` if it has nothing to decode, or if something
/// else is wrong with the file, which loading it will report.
pub fn start<T>(
    file: &str,
    bytes: &[u8],
    extensions: &[&str],
    read: impl FnOnce(&Container, &Document) -> Result<Option<T>, Problem>,
) -> Result<Option<T>, LoadError> {
    let Ok(container) = container::open(file, bytes) else { return Ok(None) };
    let json = as_text(container.json);
    if !extensions.iter().any(|name| json.contains(name)) {
        return Ok(None);
    }
    let Ok(document) = Document::read(file, &container) else { return Ok(None) };
    match read(&container, &document) {
        Err(Problem::MissingFile { .. }) => Ok(None),
        read => read.map_err(|problem| problem.in_file(file)),
    }
}

/// Replaces a file with one that has different JSON and no longer uses the extensions.
pub fn replace(
    files: &mut FileSet,
    file: &str,
    binary: Option<&[u8]>,
    mut json: Object,
    extensions: &[&str],
) -> Result<(), LoadError> {
    json.remove_strings("extensionsRequired", extensions);
    let extensions = json.remove_strings("extensionsUsed", extensions);
    let json = serde_json::to_vec(&json).unwrap_or_default();
    let too_large = |problem: WriteError| LoadError::Conversion { file: file.to_owned(), problem: problem.to_string() };
    let plain = match binary {
        Some(binary) => write::glb(json, binary.to_vec()).map_err(too_large)?,
        None => json,
    };
    files.convert(file, plain, Conversion { extensions, ..Conversion::default() });
    Ok(())
}

/// Removes the extensions from an object.
pub fn without_extensions(object: &mut Object, names: &[&str]) {
    let Some(mut extensions) = object.read::<Object>("extensions") else { return };
    names.iter().for_each(|name| extensions.remove(name));
    match extensions.is_empty() {
        true => object.remove("extensions"),
        false => object.set("extensions", &extensions),
    }
}
