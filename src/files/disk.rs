//! Models from disk: the named files, folders with all that is in them, and what a model names beside itself.

use std::path::{Component, Path, PathBuf};

use super::sort::Origins;
use super::{Role, SortError, decode_images, sort};
use crate::editor::{Contents, ModelFiles, OpenedModel};
use crate::formats::{FileSet, missing_files};
use crate::library::{Model, Motion};
use crate::retarget::JointMap;
use crate::samples;

/// What was read: a model, what it may borrow from, and the names of all files.
#[derive(Debug)]
pub struct Opened {
    pub model: Model,
    /// What the model was read from; none for a sample.
    pub model_files: Option<ModelFiles>,
    pub motions: Vec<Motion>,
    pub map: Option<JointMap>,
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
    #[error("{name}: there is no such sample; there are: sample:{}", samples::names().join(", sample:"))]
    NoSuchSample { name: String },
    #[error(transparent)]
    Files(#[from] SortError),
}

const MOST_BYTES: u64 = 2 << 30;
const MOST_FILES: usize = 4096;
const MOST_FOLDERS_DEEP: usize = 16;

/// Reads one model from files and folders, together with the files that it names beside itself, motions and a joint map.
/// `sample:NAME` is one of the characters that come along. A motion alone is shown as a model.
pub fn open_paths(paths: &[PathBuf]) -> Result<Opened, OpenError> {
    let (set, samples, origins) = read(paths)?;
    open_set(&set, samples, &origins, Role::Model)
}

/// The bytes behind paths, as they are: for whoever writes a file anew from them.
pub fn read_set(paths: &[PathBuf]) -> Result<FileSet, OpenError> {
    Ok(read(paths)?.0)
}

/// A model from files in memory, as they are dropped onto the window.
pub fn open_bytes(files: &FileSet, source: String) -> Result<Opened, OpenError> {
    open_set(files, Vec::new(), &Origins { other: source, ..Origins::default() }, Role::Model)
}

/// Reads whatever the files are: a model, motions, a joint map, or several of these.
pub fn read_paths(paths: &[PathBuf], role: Role) -> Result<Contents, OpenError> {
    let (set, samples, origins) = read(paths)?;
    contents(&set, samples, &origins, role)
}

fn open_set(set: &FileSet, samples: Vec<Model>, origins: &Origins, role: Role) -> Result<Opened, OpenError> {
    let has_sample = !samples.is_empty();
    let Contents { mut models, motions, map, .. } = contents(set, samples, origins, role)?;
    if models.len() > 1 {
        let found = models.into_iter().map(|opened| opened.model.source).collect();
        return Err(SortError::SeveralModels { found }.into());
    }
    let no_model = || SortError::NoModel { found: set.names().map(str::to_owned).collect() };
    let OpenedModel { model, files: model_files } = models.pop().ok_or_else(no_model)?;
    let mut files: Vec<String> = set.names().map(str::to_owned).collect();
    if has_sample {
        files.insert(0, model.source.clone());
    }
    Ok(Opened { model, model_files, motions: motions.unwrap_or_default(), map, files })
}

fn contents(set: &FileSet, samples: Vec<Model>, origins: &Origins, role: Role) -> Result<Contents, OpenError> {
    // Files beside a sample that is the model are what it borrows from, whatever they hold.
    let role = if samples.is_empty() || role == Role::Motion { role } else { Role::Any };
    let mut sorted = if set.is_empty() && !samples.is_empty() { Default::default() } else { sort(set, role)? };
    let models = std::mem::take(&mut sorted.models).into_iter().map(|(name, mut asset)| {
        let images = decode_images(&mut asset);
        origins.model(set, name, asset, images)
    });
    Ok(origins.contents(sorted, models.collect(), samples, role))
}

/// All files that the paths stand for, with what they name beside themselves; and the samples among the paths.
fn read(paths: &[PathBuf]) -> Result<(FileSet, Vec<Model>, Origins), OpenError> {
    let mut reader = Reader::default();
    let mut samples = Vec::new();
    let mut origins = Origins::default();
    for path in paths {
        if let Some(name) = path.to_str().and_then(|path| path.strip_prefix("sample:")) {
            let source = format!("sample:{name}");
            let before = origins.known.len();
            for (file, bytes) in samples::files(name) {
                reader.set.insert(file.to_owned(), bytes.to_vec());
                origins.known.push((file.to_owned(), source.clone()));
            }
            if origins.known.len() == before {
                samples.push(samples::load(name).ok_or_else(|| OpenError::NoSuchSample { name: source.clone() })?);
                origins.known.push((source.clone(), source));
            }
        } else if let Some(name) = reader.add(path)? {
            origins.known.push((name.clone(), name));
        }
    }
    origins.other = paths.iter().find_map(|path| path.file_name()).map_or_else(String::new, lossy);
    // A sidecar may name others in turn, as a .gltf inside a folder does: look again until nothing new turns up.
    let mut missing = missing_files(&reader.set);
    while reader.add_beside(&missing)? {
        missing = missing_files(&reader.set);
    }
    Ok((reader.set, samples, origins))
}

#[derive(Default)]
struct Reader {
    set: FileSet,
    bytes: u64,
    /// Folders that the named files lie in: where what they name is looked for.
    folders: Vec<PathBuf>,
}

impl Reader {
    /// The name in the set, unless the path is a folder.
    fn add(&mut self, path: &Path) -> Result<Option<String>, OpenError> {
        // A model of several files may be named by what their names share.
        let of_stem = path.file_name().map(|stem| path.with_file_name(lossy(stem) + ".obj"));
        let of_stem = of_stem.filter(|of_stem| !path.exists() && of_stem.is_file());
        let path = of_stem.as_deref().unwrap_or(path);
        let folder = if path.is_dir() { path } else { path.parent().unwrap_or(Path::new("")) };
        if !self.folders.iter().any(|other| other == folder) {
            self.folders.push(folder.to_owned());
        }
        if path.is_dir() {
            return self.add_folder(path, path, 0).map(|()| None);
        }
        let name = path.file_name().map_or_else(String::new, lossy);
        // Two files of the same name from two folders: the second keeps its path.
        let name = if self.set.get(&name).is_some() { slashed(path) } else { name };
        self.read(path, name.clone())?;
        Ok(Some(name))
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
