//! Models from disk: the named files, folders with all that is in them, and what a model names beside itself.

use std::path::{Component, Path, PathBuf};

use super::decode_images;
use crate::formats::{FileSet, LoadError, load, missing_files};
use crate::library::{Model, sample};

/// What was read: the model, and the names of the files it came from.
#[derive(Debug)]
pub struct Opened {
    pub model: Model,
    pub files: Vec<String>,
}

/// Why nothing could be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    #[error("{}: {source}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error("{}: {found} bytes, more than the {most} that are read at once", path.display())]
    TooLarge { path: PathBuf, found: u64, most: u64 },
    #[error("{}: more than {most} files in the folder; name the model's own files instead", path.display())]
    TooManyFiles { path: PathBuf, most: usize },
    #[error("{name}: there is no such sample; there are: {}", sample::NAMES.map(|name| format!("sample:{name}")).join(", "))]
    NoSuchSample { name: String },
    #[error(transparent)]
    Load(#[from] LoadError),
}

const MOST_BYTES: u64 = 2 << 30;
const MOST_FILES: usize = 4096;
const MOST_FOLDERS_DEEP: usize = 16;

/// Reads one model from files and folders, together with the files that it names beside itself. `sample:NAME` alone is a
/// built-in character.
pub fn open_paths(paths: &[PathBuf]) -> Result<Opened, OpenError> {
    if let [path] = paths
        && let Some(name) = path.to_str().and_then(|path| path.strip_prefix("sample:"))
    {
        let model = sample::load(name).ok_or_else(|| OpenError::NoSuchSample { name: format!("sample:{name}") })?;
        return Ok(Opened { files: vec![model.source.clone()], model });
    }
    let mut reader = Reader::default();
    for path in paths {
        reader.add(path)?;
    }
    // A sidecar may name others in turn, as a .gltf inside a folder does: look again until nothing new turns up.
    let mut missing = missing_files(&reader.set);
    while reader.add_beside(&missing)? {
        missing = missing_files(&reader.set);
    }
    let source = paths.iter().find_map(|path| path.file_name()).map_or_else(String::new, lossy);
    open_bytes(&reader.set, source)
}

/// A model from files in memory, as they are dropped onto the window.
pub fn open_bytes(files: &FileSet, source: String) -> Result<Opened, OpenError> {
    let mut asset = load(files)?;
    let images = decode_images(&mut asset);
    let files = files.names().map(str::to_owned).collect();
    Ok(Opened { model: Model::new(source, asset, images), files })
}

#[derive(Default)]
struct Reader {
    set: FileSet,
    bytes: u64,
    /// Folders that the named files lie in: where what they name is looked for.
    folders: Vec<PathBuf>,
}

impl Reader {
    fn add(&mut self, path: &Path) -> Result<(), OpenError> {
        let folder = if path.is_dir() { path } else { path.parent().unwrap_or(Path::new("")) };
        if !self.folders.iter().any(|other| other == folder) {
            self.folders.push(folder.to_owned());
        }
        if path.is_dir() {
            return self.add_folder(path, path, 0);
        }
        let name = path.file_name().map_or_else(String::new, lossy);
        // Two files of the same name from two folders: the second keeps its path.
        let name = if self.set.get(&name).is_some() { slashed(path) } else { name };
        self.read(path, name)
    }

    fn add_folder(&mut self, root: &Path, folder: &Path, depth: usize) -> Result<(), OpenError> {
        let failed = |source| OpenError::Read { path: folder.to_owned(), source };
        let entries = std::fs::read_dir(folder).map_err(failed)?;
        let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, _>>().map_err(failed)?;
        paths.sort();
        for path in paths {
            if path.is_dir() {
                // A link to a folder further up would go round and round.
                if depth < MOST_FOLDERS_DEEP && !path.is_symlink() {
                    self.add_folder(root, &path, depth + 1)?;
                }
            } else if path.is_file() {
                if self.set.names().count() >= MOST_FILES {
                    return Err(OpenError::TooManyFiles { path: root.to_owned(), most: MOST_FILES });
                }
                let name = slashed(path.strip_prefix(root).unwrap_or(&path));
                self.read(&path, name)?;
            }
        }
        Ok(())
    }

    /// Reads those of the missing files that lie beside the named ones; true when there was one.
    fn add_beside(&mut self, missing: &[String]) -> Result<bool, OpenError> {
        let mut found = false;
        for uri in missing {
            let relative = Path::new(uri);
            let plain = relative
                .components()
                .all(|part| matches!(part, Component::Normal(_) | Component::ParentDir | Component::CurDir));
            let beside = self.folders.iter().map(|folder| folder.join(relative)).find(|path| plain && path.is_file());
            if let Some(path) = beside.filter(|_| self.set.get(uri).is_none()) {
                self.read(&path, uri.clone())?;
                found = true;
            }
        }
        Ok(found)
    }

    fn read(&mut self, path: &Path, name: String) -> Result<(), OpenError> {
        let failed = |source| OpenError::Read { path: path.to_owned(), source };
        let found = std::fs::metadata(path).map_err(failed)?.len();
        self.bytes = self.bytes.saturating_add(found);
        if self.bytes > MOST_BYTES {
            return Err(OpenError::TooLarge { path: path.to_owned(), found, most: MOST_BYTES });
        }
        self.set.insert(name, std::fs::read(path).map_err(failed)?);
        Ok(())
    }
}

fn lossy(name: &std::ffi::OsStr) -> String {
    name.to_string_lossy().into_owned()
}

/// `/` between folders on every system.
fn slashed(path: &Path) -> String {
    path.components().map(|part| lossy(part.as_os_str())).collect::<Vec<_>>().join("/")
}
