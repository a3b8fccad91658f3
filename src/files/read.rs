//! Reads a set of items into memory, together with the files they refer to.

use std::ffi::{OsStr, OsString};

use gaitway_formats::limits::MAX_FOLDER_FILES;
use gaitway_formats::{FileSet, GLTF_EXTENSIONS, OTHER_MOTION_EXTENSIONS, missing_files, next_preparation};
use gaitway_scene::editor::short_name;
use gaitway_scene::library::{Model, container_of};
use gaitway_scene::samples;

use super::origins::Origins;
use super::source::{Content, Located, Progress, Reading, Source};
use super::{OpenError, SortError};

/// One part of a set to open.
#[derive(Debug)]
pub enum Item {
    /// A path (not necessarily Unicode), a URL, or `sample:NAME`.
    Address(OsString),
    /// A file already in memory: its path, with `/` between folders, and its content.
    File(String, Vec<u8>),
}

/// Files in memory, not sorted yet.
#[derive(Default)]
pub(super) struct FilesRead {
    pub set: FileSet,
    /// Names of the files in the order they were read. An archive appears under its own name.
    pub names: Vec<String>,
    /// Samples generated in code.
    pub samples: Vec<Model>,
    pub origins: Origins,
}

/// Maximum depth of files that refer to other files.
const MAX_ROUNDS: usize = 4;
/// Extensions that identify the model among the items, besides those of files that may be motions.
const MODEL_EXTENSIONS: [&str; 2] = ["obj", "zip"];

/// Extensions of files that go with a model, in lower case: its parts, an environment, a joint map.
const COMPANION_EXTENSIONS: [&str; 4] = ["skel", "attach", "hdr", "json"];

/// Returns the extensions of all files that can be opened but images and buffers, in lower case.
pub fn extensions() -> impl Iterator<Item = &'static str> {
    GLTF_EXTENSIONS.into_iter().chain(OTHER_MOTION_EXTENSIONS).chain(MODEL_EXTENSIONS).chain(COMPANION_EXTENSIONS)
}

pub(super) async fn read_items<S: Source>(
    source: &S,
    items: Vec<Item>,
    progress: Progress<'_>,
) -> Result<FilesRead, OpenError> {
    if items.is_empty() {
        return Err(OpenError::Nothing);
    }
    let mut reader = Reader::new(source, progress);
    for item in items {
        reader.add(item).await?;
        reader.note_members();
    }
    reader.finish().await
}

/// Like [`read_items`], but leaves out what can't be read, unless that is all. Also returns why.
pub(super) async fn read_available<S: Source>(
    source: &S,
    items: Vec<Item>,
    progress: Progress<'_>,
) -> Result<(FilesRead, Vec<OpenError>), OpenError> {
    let mut reader = Reader::new(source, progress);
    let mut failed = Vec::new();
    for item in items {
        let (bases, labels) = (reader.bases.len(), reader.labels.len());
        match reader.add(item).await {
            Ok(()) => reader.note_members(),
            Err(error) => {
                reader.bases.truncate(bases);
                reader.labels.truncate(labels);
                failed.push(error);
            }
        }
    }
    if reader.labels.is_empty() {
        return Err(failed.into_iter().next().unwrap_or(OpenError::Nothing));
    }
    Ok((reader.finish().await?, failed))
}

struct Reader<'a, S: Source> {
    source: &'a S,
    reading: Reading<'a>,
    files: FilesRead,
    /// Where files that others refer to are looked for.
    bases: Vec<S::Base>,
    /// What each item is called.
    labels: Vec<String>,
    /// Number of files in all folders.
    folder_files: usize,
}

impl<'a, S: Source> Reader<'a, S> {
    fn new(source: &'a S, progress: Progress<'a>) -> Self {
        let (reading, files) = (Reading::new(progress), FilesRead::default());
        Self { source, reading, files, bases: Vec::new(), labels: Vec::new(), folder_files: 0 }
    }

    async fn add(&mut self, item: Item) -> Result<(), OpenError> {
        match item {
            Item::File(name, bytes) => {
                (self.reading.progress)(&short_name(&name), 0, bytes.len() as u64);
                self.reading.spend(&name, bytes.len() as u64)?;
                self.labels.push(name.clone());
                let known = self.keep(name.clone(), bytes)?;
                self.files.origins.known.push((known, name));
                Ok(())
            }
            Item::Address(address) => {
                (self.reading.progress)(&short_name(&address.to_string_lossy()), 0, 0);
                match address.to_str().and_then(|address| address.strip_prefix("sample:")) {
                    Some(name) => self.add_sample(name).await,
                    None => self.add_address(&address).await,
                }
            }
        }
    }

    /// Records which files came from the last item.
    fn note_members(&mut self) {
        let FilesRead { set, origins, .. } = &mut self.files;
        let Some(label) = self.labels.last() else { return };
        let new = set.names().skip(origins.members.len());
        let members: Vec<_> = new.map(|name| (name.to_owned(), container_of(label).to_owned())).collect();
        origins.members.extend(members);
    }

    async fn add_sample(&mut self, name: &str) -> Result<(), OpenError> {
        let origin = format!("sample:{name}");
        self.labels.push(origin.clone());
        if let Some(model) = samples::load(name) {
            self.files.samples.push(model);
            self.files.origins.known.push((origin.clone(), origin));
            return Ok(());
        }
        for (file, place) in self.source.sample(name)? {
            let known = self.read(&place, file).await?;
            self.files.origins.known.push((known, origin.clone()));
        }
        Ok(())
    }

    async fn add_address(&mut self, address: &OsStr) -> Result<(), OpenError> {
        let Located { content, base, label } = self.source.locate(address)?;
        self.labels.push(label);
        if !self.bases.contains(&base) {
            self.bases.push(base);
        }
        match content {
            Content::File { place, name, full_name, origin } => {
                let name = if self.files.names.contains(&name) { full_name } else { name };
                let known = self.read(&place, name).await?;
                let origin = origin.unwrap_or_else(|| known.clone());
                self.files.origins.known.push((known, origin));
            }
            Content::Folder(files) => {
                let folder = address.to_string_lossy();
                self.folder_files += files.len();
                if self.folder_files > MAX_FOLDER_FILES {
                    return Err(OpenError::TooManyFiles { path: address.into(), max: MAX_FOLDER_FILES });
                }
                // All of them, since they refer to each other.
                let is_taken = files.iter().any(|(name, _)| self.files.names.contains(name));
                for (name, place) in files {
                    let name = if is_taken { format!("{folder}/{name}") } else { name };
                    self.read(&place, name).await?;
                }
            }
        }
        Ok(())
    }

    async fn finish(mut self) -> Result<FilesRead, OpenError> {
        self.add_missing().await?;
        self.files.origins.container = container_of(model_label(&self.labels)).to_owned();
        Ok(self.files)
    }

    /// Converts files to plain glTF where necessary, and reads the files that the set refers to and that lie next to
    /// the named ones. The loader reports missing files, and whether that matters.
    async fn add_missing(&mut self) -> Result<(), OpenError> {
        let mut tried: Vec<String> = Vec::new();
        for _ in 0..MAX_ROUNDS {
            // First, since converted files may refer to more files. Others can be converted only with files that are
            // still missing.
            self.prepare().await?;
            // Nothing lies next to files in memory.
            if self.bases.is_empty() {
                return Ok(());
            }
            let missing = missing_files(&self.files.set);
            let missing: Vec<String> = missing.into_iter().filter(|path| !tried.contains(path)).collect();
            if missing.is_empty() {
                return Ok(());
            }
            for path in &missing {
                if let Some(bytes) = self.read_beside(path).await? {
                    self.keep(path.clone(), bytes)?;
                }
            }
            tried.extend(missing);
        }
        self.prepare().await
    }

    /// Converts what can be converted with the files read so far.
    async fn prepare(&mut self) -> Result<(), OpenError> {
        while let Some(preparation) = next_preparation(&self.files.set).map_err(SortError::from)? {
            let answer = self.source.convert(&preparation, &mut self.reading).await?;
            // From here on, progress is about the file again, not about the part.
            (self.reading.progress)(&short_name(preparation.file()), 0, 0);
            preparation.finish(&mut self.files.set, answer).map_err(SortError::from)?;
        }
        Ok(())
    }

    async fn read_beside(&mut self, path: &str) -> Result<Option<Vec<u8>>, OpenError> {
        for base in &self.bases {
            let found = self.source.read_beside(base, path, &mut self.reading).await?;
            if found.is_some() {
                return Ok(found);
            }
        }
        Ok(None)
    }

    async fn read(&mut self, place: &S::Place, name: String) -> Result<String, OpenError> {
        let bytes = self.source.read(place, &name, &mut self.reading).await?;
        self.keep(name, bytes)
    }

    /// Puts a file into the set and returns its name there.
    fn keep(&mut self, name: String, bytes: Vec<u8>) -> Result<String, OpenError> {
        let (held, packed) = (self.files.set.byte_count(), bytes.len() as u64);
        let name = self.files.set.add(name, bytes).map_err(SortError::from)?;
        let unpacked = self.files.set.byte_count().saturating_sub(held);
        self.reading.spend(&name, unpacked.saturating_sub(packed))?;
        if !self.files.names.contains(&name) {
            self.files.names.push(name.clone());
        }
        Ok(name)
    }
}

/// Returns the label of the item that looks like the model, otherwise of the first one.
fn model_label(labels: &[String]) -> &str {
    let is_model = |label: &&String| {
        let label = label.to_lowercase();
        let path = label.split(['?', '#']).next().unwrap_or_default();
        let known = GLTF_EXTENSIONS.iter().chain(&OTHER_MOTION_EXTENSIONS).chain(&MODEL_EXTENSIONS);
        path.rsplit_once('.').is_some_and(|(_, extension)| known.into_iter().any(|known| *known == extension))
    };
    let named = || labels.iter().filter(|label| !label.is_empty());
    named().find(is_model).or_else(|| named().next()).map_or("", String::as_str)
}
