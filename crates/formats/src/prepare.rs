//! The step between a set of files and [`load`](super::load): whatever needs a decoder of its own is converted into plain glTF.
//! That is the only asynchronous part of loading, because the page has to download the decoder first.
//!
//! As long as [`next_preparation`] finds something, callers run the part that it names, and [`Preparation::finish`] puts the
//! result in its place. So loading itself stays synchronous and independent of parts.

use std::borrow::Cow;

use gaitway_character::asset::SharedBytes;
use gaitway_part::Answer;

use super::encoding;
use super::file_set::Conversion;
use super::file_set::is_npy;
use super::gltf::decode_names;
use super::gltf::decoded::{self, Decoding};
use super::part::Part;
use super::{FileSet, LoadError, is_bvh, is_gltf, whole_file_part};

/// One conversion: run `part` on `input`, then call [`finish`](Preparation::finish).
#[derive(Debug)]
pub struct Preparation {
    /// The decoder to run.
    pub part: Part,
    /// What it converts.
    pub input: SharedBytes,
    file: String,
    step: Step,
}

/// What the part's output is.
#[derive(Debug)]
enum Step {
    /// A GLB that replaces a file of this format.
    File(&'static str),
    /// Data of a glTF.
    Data(Decoding),
}

impl Preparation {
    /// Name of the file in the set.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Replaces the file with the part's output.
    ///
    /// # Errors
    /// If the part returned an error.
    pub fn finish(self, files: &mut FileSet, answer: Answer) -> Result<(), LoadError> {
        let failed = |problem| LoadError::Conversion { file: self.file.clone(), problem };
        let mut output = answer.map_err(failed)?;
        match self.step {
            Step::File(format) => {
                let bytes = decode_names(output.bytes, &mut output.warnings);
                let conversion =
                    Conversion { format: Some(format), warnings: output.warnings, ..Conversion::default() };
                files.convert(&self.file, bytes, conversion);
                Ok(())
            }
            Step::Data(decoding) => decoding.finish(files, &self.file, &output.bytes),
        }
    }
}

/// Returns a conversion that can be done with the files that are in the set. `None` once there is none left.
///
/// # Errors
/// If a file describes its compressed data incorrectly.
pub fn next_preparation(files: &FileSet) -> Result<Option<Preparation>, LoadError> {
    for (name, bytes) in files.iter() {
        let preparation = |part, input, step| Ok(Some(Preparation { part, input, file: name.to_owned(), step }));
        if let Some(part) = whole_file_part(name, bytes) {
            let format = if is_npy(bytes) { "npy" } else { part.name() };
            return preparation(part, input_of(part, bytes), Step::File(format));
        }
        if !is_gltf(name, bytes) || is_bvh(name, bytes) {
            continue;
        }
        if let Some((decoding, input)) = decoded::start(files, name, bytes)? {
            return preparation(decoding.part(), input.into(), Step::Data(decoding));
        }
    }
    Ok(None)
}

/// Returns a part's input. Text is converted to UTF-8 for it, since parts have no encoding tables.
fn input_of(part: Part, bytes: &SharedBytes) -> SharedBytes {
    let is_text = part == Part::X && bytes.get(8..12) == Some(b"txt ");
    match is_text.then(|| encoding::utf8(bytes)) {
        Some(Cow::Owned(text)) => text.into(),
        _ => bytes.clone(),
    }
}

/// Converts whatever has to be converted before [`load`](super::load), with the decoders linked into this program.
///
/// # Errors
/// If a file cannot be converted.
#[cfg(not(target_arch = "wasm32"))]
pub fn prepare(files: &mut FileSet) -> Result<(), LoadError> {
    while let Some(preparation) = next_preparation(files)? {
        let answer = preparation.part.run(&preparation.input);
        preparation.finish(files, answer)?;
    }
    Ok(())
}
