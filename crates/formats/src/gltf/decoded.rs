//! What the decoders of compressed glTF have in common: finding a file that needs one, and writing it without the extension.

use super::container::{self, Container};
use super::document::{Document, as_text};
use super::object::Object;
use super::{WriteError, draco, meshopt, write};
use crate::error::Problem;
use crate::file_set::Conversion;
use crate::{FileSet, LoadError, Part};

/// Where a decoder's output belongs.
#[derive(Debug)]
pub enum Decoding {
    Views(meshopt::Decoding),
    Meshes(draco::Decoding),
}

/// Returns the first decoding that a file needs, with the decoder's input. `None` if it needs none, or if something else is wrong
/// with the file, which loading it will report.
pub fn start(files: &FileSet, file: &str, bytes: &[u8]) -> Result<Option<(Decoding, Vec<u8>)>, LoadError> {
    let Ok(container) = container::open(file, bytes) else { return Ok(None) };
    // All of the extensions' names end like this, and searching takes a while in a large file.
    if !as_text(container.json).contains("_compression") {
        return Ok(None);
    }
    let Ok(document) = Document::read(file, &container) else { return Ok(None) };
    match read(files, file, &container, &document) {
        Err(Problem::MissingFile { .. }) => Ok(None),
        read => read.map_err(|problem| problem.in_file(file)),
    }
}

fn read(
    files: &FileSet,
    file: &str,
    container: &Container,
    document: &Document,
) -> Result<Option<(Decoding, Vec<u8>)>, Problem> {
    if let Some((views, input)) = meshopt::read(files, file, container, document)? {
        return Ok(Some((Decoding::Views(views), input)));
    }
    let meshes = draco::read(files, file, container, document)?;
    Ok(meshes.map(|(meshes, input)| (Decoding::Meshes(meshes), input)))
}

impl Decoding {
    /// The decoder.
    pub fn part(&self) -> Part {
        match self {
            Self::Views(_) => Part::Meshopt,
            Self::Meshes(_) => Part::Draco,
        }
    }

    /// Replaces the file with one that has the decoded data and no longer uses the extension.
    pub fn finish(self, files: &mut FileSet, file: &str, decoded: &[u8]) -> Result<(), LoadError> {
        let Some(bytes) = files.get(file).cloned() else { return Ok(()) };
        let container = container::open(file, &bytes)?;
        let mut json: Object = serde_json::from_str(&as_text(container.json)).unwrap_or_default();
        let extensions = match self {
            Self::Views(views) => {
                views.finish(files, file, &container, &mut json, decoded)?;
                &meshopt::NAMES[..]
            }
            Self::Meshes(meshes) => {
                meshes.finish(files, file, &mut json, decoded)?;
                &draco::NAMES
            }
        };
        json.remove_strings("extensionsRequired", extensions);
        let extensions = json.remove_strings("extensionsUsed", extensions);
        let json = serde_json::to_vec(&json).unwrap_or_default();
        let too_large =
            |problem: WriteError| LoadError::Conversion { file: file.to_owned(), problem: problem.to_string() };
        let plain = match container.binary {
            Some(binary) => write::glb(json, binary.to_vec()).map_err(too_large)?,
            None => json,
        };
        files.convert(file, plain, Conversion { extensions, ..Conversion::default() });
        Ok(())
    }
}
