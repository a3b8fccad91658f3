//! Opens files and folders on disk.

use std::cell::{Cell, RefCell};
use std::ffi::OsStr;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Component, Path, PathBuf};
use std::pin::pin;
use std::task::{Context, Poll, Waker};

use gaitway_character::asset::{Asset, Image};
use gaitway_formats::limits::{MAX_FOLDER_DEPTH, MAX_FOLDER_FILES};
use gaitway_formats::{FileSet, LoadError, Preparation};
use gaitway_part::Answer;
use gaitway_retarget::JointMapFile;
use gaitway_scene::editor::{Contents, ModelFiles, OpenedMap, OpenedModel};
use gaitway_scene::library::{ImageData, Model, Motion, container_of};
use gaitway_scene::samples;
use gaitway_scene::state::{MEMBER_SEPARATOR, ViewerState};

use super::open::open_read;
use super::read::{FilesRead, Item, read_items};
use super::source::{Content, Located, Progress, Reading, Source};
use super::{Held, ImageLimits, OpenError, Role, SortError, decode_images, view};

/// One model with the motions and the joint map that were opened along with it.
#[derive(Debug)]
pub struct Opened {
    /// The only model among the files and samples.
    pub model: Model,
    /// `None` for a sample generated in code.
    pub model_files: Option<ModelFiles>,
    /// Motions to borrow, in addition to the model's own clips.
    pub motions: Vec<Motion>,
    /// `None` if no file is a joint map.
    pub map: Option<OpenedMap>,
    /// Names of all files that were read.
    pub files: Vec<String>,
}

/// Opens exactly one model: see [`Disk::open_paths`].
pub fn open_paths(paths: &[PathBuf]) -> Result<Opened, OpenError> {
    Disk::default().open_paths(paths)
}

/// Opens whatever the files are: see [`Disk::read_paths`].
pub fn read_paths(paths: &[PathBuf], role: Role) -> Result<Contents, OpenError> {
    Disk::default().read_paths(paths, role)
}

/// The file system. It remembers which files it has read, so that none of them is overwritten.
#[derive(Debug, Default)]
pub struct Disk {
    images: ImageLimits,
    read: RefCell<Vec<PathBuf>>,
    /// The files and folders that were named by the user, as opposed to those that a link or another file names.
    given: RefCell<Vec<PathBuf>>,
    /// Only what [`find_linked`] finds near `given` can be opened.
    is_for_link: bool,
    standard_input: Cell<StandardInput>,
}

/// What the path `-` stands for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum StandardInput {
    /// A file of that name.
    #[default]
    Ignored,
    Unread,
    Read,
}

/// The path that stands for standard input or output.
pub const STANDARD_STREAM: &str = "-";
/// What standard input is called in messages.
const STANDARD_INPUT_NAME: &str = "stdin";

impl Disk {
    /// Returns the file system for what a device with these limits draws.
    pub fn for_device(images: ImageLimits) -> Self {
        Self { images, ..Self::default() }
    }

    /// Returns the file system for views of what has been opened from these files and folders.
    pub fn beside(given: Vec<PathBuf>) -> Self {
        Self { given: given.into(), ..Self::default() }
    }

    /// Returns a file system where the path `-` stands for standard input.
    pub fn with_standard_input() -> Self {
        Self { standard_input: Cell::new(StandardInput::Unread), ..Self::default() }
    }

    /// Opens exactly one model from files, folders and samples (`sample:NAME`), together with the files they refer to, motions
    /// and a joint map. A motion by itself is opened as a model. `ARCHIVE#!/FILE` is one of several models in an archive or a
    /// folder.
    pub fn open_paths(&self, paths: &[PathBuf]) -> Result<Opened, OpenError> {
        let members: Vec<&str> = paths.iter().filter_map(|path| member_of(path)).collect();
        finish(async { only_model(self, self.read_all(paths).await?, &members).await })
    }

    /// Reads files, folders and samples, and the files they refer to, without parsing them.
    pub fn read_set(&self, paths: &[PathBuf]) -> Result<FileSet, OpenError> {
        Ok(finish(self.read_all(paths))?.set)
    }

    /// Opens whatever the files are: models, motions, a joint map, or several of these.
    pub fn read_paths(&self, paths: &[PathBuf], role: Role) -> Result<Contents, OpenError> {
        finish(async { open_read(self, self.read_all(paths).await?, role).await })
    }

    /// Opens the files of a view that are on disk, except for its model if `with_model` is not set and for what is
    /// `held`. See `view` for the details. A link may come from anyone: it can name what the user has named, and files in those
    /// folders or below, but neither other files nor devices and pipes.
    pub fn open_view(
        &self,
        view: ViewerState,
        with_model: bool,
        held: Held<'_>,
    ) -> Result<(Contents, ViewerState), OpenError> {
        let given = self.given.borrow().clone();
        let disk = Self { images: self.images.clone(), is_for_link: true, ..Self::beside(given) };
        let opened = finish(view::open_view(&disk, view, with_model, held, NO_PROGRESS));
        self.read.borrow_mut().append(&mut disk.read.borrow_mut());
        opened
    }

    /// Opens a joint map.
    pub fn read_map(&self, path: &Path) -> Result<JointMapFile, OpenError> {
        finish(view::open_map(self, path.as_os_str(), NO_PROGRESS))
    }

    /// Returns the paths of all files that were read, including those that others refer to.
    pub fn files_read(&self) -> Vec<PathBuf> {
        self.read.borrow().clone()
    }

    async fn read_all(&self, paths: &[PathBuf]) -> Result<FilesRead, OpenError> {
        let items = paths.iter().map(|path| Item::Address(path.into())).collect();
        let read = read_items(self, items, NO_PROGRESS).await?;
        let mut members = paths.iter().filter_map(|path| member_of(path));
        if let Some(name) = members.find(|member| read.set.get(member).is_none()) {
            let found = read.set.names().map(str::to_owned).collect();
            return Err(SortError::from(LoadError::NoSuchFile { name: name.to_owned(), found }).into());
        }
        Ok(read)
    }

    fn read_standard_input(&self, reading: &mut Reading<'_>) -> Result<Vec<u8>, OpenError> {
        let path = PathBuf::from(STANDARD_STREAM);
        if self.standard_input.replace(StandardInput::Read) == StandardInput::Read {
            return Err(OpenError::StandardInputTwice);
        }
        // Where there is such a path, it leads to the file that the input was redirected from.
        self.read.borrow_mut().push("/dev/stdin".into());
        let mut bytes = Vec::new();
        // Reading one byte past the budget reveals that there is more.
        let most = reading.bytes_left() + 1;
        std::io::stdin().take(most).read_to_end(&mut bytes).map_err(|source| OpenError::Read { path, source })?;
        reading.spend(STANDARD_INPUT_NAME, bytes.len() as u64)?;
        Ok(bytes)
    }
}

const NO_PROGRESS: Progress<'_> = &|_, _, _| ();

/// Opens the only model of a set, or the one that is among `members`.
async fn only_model(disk: &Disk, read: FilesRead, members: &[&str]) -> Result<Opened, OpenError> {
    let mut files = read.names.clone();
    let has_sample = !read.samples.is_empty();
    let Contents { mut models, motions, map, .. } = open_read(disk, read, Role::Model).await?;
    let is_named = |opened: &OpenedModel| opened.files.as_ref().is_some_and(|files| members.contains(&&*files.name));
    if models.iter().any(is_named) {
        models.retain(is_named);
    }
    let several = |models: Vec<OpenedModel>| SortError::SeveralModels {
        found: models.into_iter().map(|opened| opened.model.source).collect(),
    };
    let [OpenedModel { model, files: model_files }] = <[_; 1]>::try_from(models).map_err(several)?;
    if has_sample {
        files.insert(0, model.source.clone());
    }
    Ok(Opened { model, model_files, motions: motions.unwrap_or_default(), map, files })
}

/// Drives a future of [`Disk`], which never has to wait.
fn finish<T>(future: impl Future<Output = T>) -> T {
    let mut future = pin!(future);
    loop {
        if let Poll::Ready(output) = future.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
            return output;
        }
    }
}

pub(super) enum Place {
    Path(PathBuf),
    StandardInput,
    Embedded(&'static [u8]),
}

impl Source for Disk {
    type Place = Place;
    /// The folder.
    type Base = PathBuf;
    type Decoding = ();

    fn locate(&self, address: &OsStr) -> Result<Located<Place, PathBuf>, OpenError> {
        if address == STANDARD_STREAM && self.standard_input.get() != StandardInput::Ignored {
            let (place, name) = (Place::StandardInput, STANDARD_INPUT_NAME.to_owned());
            let content = Content::File { place, name: name.clone(), full_name: name.clone(), origin: None };
            self.given.borrow_mut().push(STANDARD_STREAM.into());
            return Ok(Located { content, base: PathBuf::new(), label: name });
        }
        let path = if self.is_for_link {
            find_linked(&self.given.borrow(), Path::new(address))?
        } else {
            let path = existing(Path::new(address));
            self.given.borrow_mut().push(path.clone());
            path
        };
        let label = path.file_name().map_or_else(String::new, lossy);
        if path.is_dir() {
            let mut files = Vec::new();
            list_folder(&path, &path, 0, &mut files)?;
            return Ok(Located { content: Content::Folder(files), base: path, label });
        }
        let base = path.parent().unwrap_or(Path::new("")).to_owned();
        let (name, full_name) = (label.clone(), slashed(&path));
        let content = Content::File { place: Place::Path(path), name, full_name, origin: None };
        Ok(Located { content, base, label })
    }

    fn sample(&self, name: &str) -> Result<Vec<(String, Place)>, OpenError> {
        let files: Vec<_> =
            samples::files(name).map(|(file, bytes)| (file.to_owned(), Place::Embedded(bytes))).collect();
        if files.is_empty() {
            let known = samples::names().iter().map(|name| format!("sample:{name}")).collect();
            return Err(OpenError::NoSuchSample { name: format!("sample:{name}"), known });
        }
        Ok(files)
    }

    async fn read(&self, place: &Place, name: &str, reading: &mut Reading<'_>) -> Result<Vec<u8>, OpenError> {
        let path = match place {
            Place::Path(path) => path,
            Place::StandardInput => return self.read_standard_input(reading),
            Place::Embedded(bytes) => return Ok(bytes.to_vec()),
        };
        let failed = |source| OpenError::Read { path: path.clone(), source };
        let file = File::open(path).map_err(failed)?;
        let length = file.metadata().map_err(failed)?.len();
        (reading.progress)(name, 0, length);
        reading.check(name, length)?;
        self.read.borrow_mut().push(path.clone());
        let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
        // A device or a pipe has a length of 0 and may never end. Reading one byte past the budget reveals that there
        // is more.
        file.take(reading.bytes_left() + 1).read_to_end(&mut bytes).map_err(failed)?;
        reading.spend(name, bytes.len() as u64)?;
        Ok(bytes)
    }

    async fn read_beside(
        &self,
        base: &PathBuf,
        path: &str,
        reading: &mut Reading<'_>,
    ) -> Result<Option<Vec<u8>>, OpenError> {
        let Some(file) = file_below(base, Path::new(path)) else { return Ok(None) };
        self.read(&Place::Path(file), path, reading).await.map(Some)
    }

    async fn convert(&self, preparation: &Preparation, _reading: &mut Reading<'_>) -> Result<Answer, OpenError> {
        Ok(preparation.part.run(&preparation.input))
    }

    fn start_decoding(&self, _images: &[Image]) {}

    async fn finish_decoding(&self, _decoding: (), asset: &mut Asset, _is_only: bool) -> Vec<Option<ImageData>> {
        decode_images(asset, &self.images)
    }

    fn describe_omission(&self, part: &str, error: &OpenError) -> String {
        format!("{error}; the link's {part} is left out: it has to be a file here")
    }
}

/// Returns the file that a path names inside an archive or a folder: `FILE` of `ARCHIVE#!/FILE`.
pub fn member_of(path: &Path) -> Option<&str> {
    Some(path.to_str()?.split_once(MEMBER_SEPARATOR)?.1)
}

/// Resolves a path to the file that is meant: links mark files with `file:`, and a model of several files may go by the
/// name they share.
fn existing(path: &Path) -> PathBuf {
    if path.exists() {
        return path.to_owned();
    }
    if let Some(marked) = path.to_str().and_then(|path| path.strip_prefix("file:")) {
        return existing(Path::new(marked));
    }
    if let Some((container, _)) = path.to_str().and_then(|path| path.split_once(MEMBER_SEPARATOR)) {
        return existing(Path::new(container));
    }
    let of_stem = path.file_name().map(|stem| path.with_file_name(lossy(stem) + ".obj"));
    of_stem.filter(|of_stem| of_stem.is_file()).unwrap_or_else(|| path.to_owned())
}

/// Finds what a link names: something `given`, by its path or file name, or a file in the folder of one or below. Any other path is
/// not even looked up, since it may lead to another machine.
fn find_linked(given: &[PathBuf], address: &Path) -> Result<PathBuf, OpenError> {
    let unmarked = address.to_str().map(|address| container_of(address.strip_prefix("file:").unwrap_or(address)));
    let path = unmarked.map_or(address, Path::new);
    let folders = || given.iter().map(|given| if given.is_dir() { given } else { given.parent().unwrap_or(given) });
    let by_path = given.iter().find(|given| *given == path).cloned();
    let below =
        || folders().find_map(|folder| file_below(folder, path).or_else(|| file_below(folder, &beyond(folder, path)?)));
    let by_name = || given.iter().find(|given| given.file_name() == Some(path.as_os_str())).cloned();
    if let Some(found) = by_path.or_else(below).or_else(by_name) {
        return Ok(found);
    }
    let may_look = is_relative(path) || folders().any(|folder| beyond(folder, path).is_some());
    let path = path.to_owned();
    match may_look && !path.exists() {
        true => Err(OpenError::Read { path, source: ErrorKind::NotFound.into() }),
        false => Err(OpenError::NotGiven { path }),
    }
}

/// Returns the rest of a path that begins with a folder, as they are spelled.
fn beyond(folder: &Path, path: &Path) -> Option<PathBuf> {
    let [folder, path] = [or_here(folder), path].map(std::path::absolute);
    Some(path.ok()?.strip_prefix(folder.ok()?).ok()?.to_owned())
}

/// Returns the file at `path` if it lies in `folder` or below. `..`, an absolute path, a drive letter or a symbolic link may
/// lead elsewhere, and a model must not read, let alone embed, what the user did not give.
fn file_below(folder: &Path, path: &Path) -> Option<PathBuf> {
    let file = folder.join(path);
    (is_relative(path) && is_below(folder, &file) && file.is_file()).then_some(file)
}

/// Whether a path has neither a root nor a drive.
fn is_relative(path: &Path) -> bool {
    path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir | Component::ParentDir))
}

fn or_here(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

/// Whether a path that exists lies in `folder` or below, symbolic links resolved.
pub fn is_below(folder: &Path, path: &Path) -> bool {
    let folder = or_here(folder);
    match (folder.canonicalize(), path.canonicalize()) {
        (Ok(folder), Ok(path)) => path.starts_with(folder),
        _ => false,
    }
}

/// Adds all files of `folder`, named by their paths inside `root`. Symbolic links that lead out of it are skipped.
fn list_folder(root: &Path, folder: &Path, depth: usize, files: &mut Vec<(String, Place)>) -> Result<(), OpenError> {
    let failed = |source| OpenError::Read { path: folder.to_owned(), source };
    let entries = std::fs::read_dir(folder).map_err(failed)?;
    let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, _>>().map_err(failed)?;
    paths.sort();
    for path in paths {
        if path.is_dir() {
            // Following a symbolic link to a parent folder would never end.
            if depth < MAX_FOLDER_DEPTH && !path.is_symlink() {
                list_folder(root, &path, depth + 1, files)?;
            }
        } else if path.is_file() && (!path.is_symlink() || is_below(root, &path)) {
            if files.len() >= MAX_FOLDER_FILES {
                return Err(OpenError::TooManyFiles { path: root.to_owned(), max: MAX_FOLDER_FILES });
            }
            let name = slashed(path.strip_prefix(root).unwrap_or(&path));
            files.push((name, Place::Path(path)));
        }
    }
    Ok(())
}

fn lossy(name: &OsStr) -> String {
    name.to_string_lossy().into_owned()
}

/// The path with `/` between folders on every system.
fn slashed(path: &Path) -> String {
    path.components().map(|part| lossy(part.as_os_str())).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use super::*;

    #[test]
    fn a_load_is_reported_before_it_can_fail() {
        let names: RefCell<Vec<String>> = RefCell::default();
        let progress = |name: &str, _, _| RefCell::borrow_mut(&names).push(name.to_owned());
        let address = Item::Address("nowhere/walk.bvh".into());
        let items = vec![Item::File("a/fox.zip".to_owned(), b"PK\x03\x04".to_vec())];
        assert!(finish(read_items(&Disk::default(), items, &progress)).is_err());
        assert!(finish(read_items(&Disk::default(), vec![address], &progress)).is_err());
        assert_eq!(names.take(), ["fox.zip", "walk.bvh"], "what the error's title says");
    }

    /// A device has no length, and this one no end.
    #[cfg(unix)]
    #[test]
    fn a_file_without_an_end_is_read_up_to_the_budget() {
        let mut reading = Reading::with_budget(1 << 16);
        let read = finish(Disk::default().read(&Place::Path("/dev/zero".into()), "zero", &mut reading));
        assert!(matches!(read, Err(OpenError::TooLarge { .. })), "{read:?}");
    }
}
