//! What the disk and the network have in common: finding files, reading them and decoding their images.

use std::ffi::OsStr;

use gaitway_character::asset::{Asset, Image};
use gaitway_formats::Preparation;
use gaitway_formats::limits::MAX_READ_BYTES;
use gaitway_part::Answer;
use gaitway_scene::library::ImageData;

use super::OpenError;

/// Called with the name of the file being read, the bytes received so far and the total, 0 if unknown.
pub type Progress<'a> = &'a dyn Fn(&str, u64, u64);

/// Where files are read from. The futures of the disk resolve immediately.
pub(super) trait Source {
    /// A file that can be read.
    type Place;
    /// What relative paths are resolved against.
    type Base: PartialEq;
    /// Images being decoded.
    type Decoding;

    /// Finds what an address stands for. Whether it exists may turn out only when it is read.
    fn locate(&self, address: &OsStr) -> Result<Located<Self::Place, Self::Base>, OpenError>;

    /// Returns the files of a bundled sample, each with its name in the set.
    fn sample(&self, name: &str) -> Result<Vec<(String, Self::Place)>, OpenError>;

    async fn read(&self, place: &Self::Place, name: &str, reading: &mut Reading<'_>) -> Result<Vec<u8>, OpenError>;

    /// Reads a file that another one refers to by the relative path `path`; `None` if there is none at `base`.
    async fn read_beside(
        &self,
        base: &Self::Base,
        path: &str,
        reading: &mut Reading<'_>,
    ) -> Result<Option<Vec<u8>>, OpenError>;

    /// Runs the part that a conversion needs. The outer error means that the part is unavailable.
    async fn convert(&self, preparation: &Preparation, reading: &mut Reading<'_>) -> Result<Answer, OpenError>;

    fn start_decoding(&self, images: &[Image]) -> Self::Decoding;

    /// Returns one entry per image of the asset; `None` for one that cannot be decoded, for which a warning is added. `is_only`: no
    /// other model is opened with it, so it will be shown.
    async fn finish_decoding(
        &self,
        decoding: Self::Decoding,
        asset: &mut Asset,
        is_only: bool,
    ) -> Vec<Option<ImageData>>;

    /// Explains that a view is opened without one of the files it lists; `part` is "motion" or "map".
    fn describe_omission(&self, part: &str, error: &OpenError) -> String;
}

/// What an address stands for.
pub(super) struct Located<P, B> {
    pub content: Content<P>,
    pub base: B,
    /// What the file or folder is called.
    pub label: String,
}

pub(super) enum Content<P> {
    File {
        place: P,
        name: String,
        /// Replaces `name` if another file already has it.
        full_name: String,
        /// What a view lists to open the file again; `None`: its name.
        origin: Option<String>,
    },
    /// The files of a folder, named by their paths inside it.
    #[cfg_attr(target_arch = "wasm32", expect(dead_code, reason = "the network has no folders"))]
    Folder(Vec<(String, P)>),
}

/// Progress and memory budget shared by everything that is read together.
pub(super) struct Reading<'a> {
    pub progress: Progress<'a>,
    bytes_left: u64,
}

impl<'a> Reading<'a> {
    pub fn new(progress: Progress<'a>) -> Self {
        Self { progress, bytes_left: MAX_READ_BYTES }
    }

    /// Checks that this many bytes of the file `name` fit the budget.
    pub fn check(&self, name: &str, bytes: u64) -> Result<(), OpenError> {
        if bytes > self.bytes_left {
            return Err(OpenError::TooLarge { name: name.to_owned(), max: MAX_READ_BYTES });
        }
        Ok(())
    }

    #[cfg(test)]
    pub fn with_budget(bytes_left: u64) -> Self {
        Self { progress: &|_, _, _| (), bytes_left }
    }

    /// The rest of the budget.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn bytes_left(&self) -> u64 {
        self.bytes_left
    }

    /// Deducts bytes of the file `name` from the budget.
    pub fn spend(&mut self, name: &str, bytes: u64) -> Result<(), OpenError> {
        self.check(name, bytes)?;
        self.bytes_left -= bytes;
        Ok(())
    }
}
