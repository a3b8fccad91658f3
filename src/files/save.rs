//! Writes files so that nothing is lost: the old file stays until the new one is complete on the disk. Whatever the program
//! writes for the user is written here, never over a file that was read: [`Disk`](super::Disk) remembers those, side files
//! included.

use std::fs::{
    File, Metadata, OpenOptions, Permissions, TryLockError, metadata, read_link, remove_file, rename, symlink_metadata,
};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::error::describe;

/// Why a file was not written. What was at its place is unchanged, unless that is a device or a pipe.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// The output is a file that was read, perhaps by another name.
    #[error("{}: this is one of the files that were read, and it would be lost; choose another output", path.display())]
    IsInput {
        /// Path of the output as given.
        path: PathBuf,
    },
    /// The folder of the output does not exist.
    #[error("{}: there is no folder “{}”; create it first", path.display(), folder.display())]
    NoFolder {
        /// Path of the output as given.
        path: PathBuf,
        /// Its folder.
        folder: PathBuf,
    },
    /// The operating system refused, or the disk is full.
    #[error("{}: {}", path.display(), describe(problem))]
    Write {
        /// Path of the output as given.
        path: PathBuf,
        /// The operating system's error.
        problem: io::Error,
    },
}

/// Maximum length of a chain of symbolic links, as on Linux.
const MAX_LINKS: usize = 40;
/// Maximum number of temporary files in a folder.
const MAX_TEMPORARY_FILES: usize = 100;

/// Creates or replaces a file. A symbolic link stays, and the file it leads to is replaced. Devices, pipes and open descriptors
/// (`/dev/stdout`) are written to directly.
///
/// # Errors
/// If the output is one of the files at `inputs`, by whatever name, or cannot be written completely.
pub fn save_file(path: &Path, bytes: &[u8], inputs: &[PathBuf]) -> Result<(), SaveError> {
    refuse_input(path, inputs)?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.exists()) {
        return Err(SaveError::NoFolder { path: path.to_owned(), folder: folder.to_owned() });
    }
    write(path, bytes).map_err(|problem| SaveError::Write { path: path.to_owned(), problem })
}

/// # Errors
/// If the output is one of the files at `inputs`, by whatever name.
pub fn refuse_input(path: &Path, inputs: &[PathBuf]) -> Result<(), SaveError> {
    match inputs.iter().any(|input| is_same_file(input, path)) {
        true => Err(SaveError::IsInput { path: path.to_owned() }),
        false => Ok(()),
    }
}

/// Whether an output at this path is a device, a pipe or an open descriptor.
pub fn is_stream(path: &Path) -> bool {
    is_descriptor(path) || metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if is_stream(path) {
        // Appending, since the shell may have opened the descriptor for that.
        return OpenOptions::new().append(true).open(path)?.write_all(bytes);
    }
    match metadata(path) {
        Ok(found) => {
            // A folder or a write-protected file stays as it is, although it could be renamed over.
            OpenOptions::new().write(true).open(path)?;
            replace(&followed(path), bytes, Some(found.permissions()))
        }
        Err(error) if error.kind() == ErrorKind::NotFound => replace(&followed(path), bytes, None),
        Err(error) => Err(error),
    }
}

/// Whether a path names something already open, which no other file can replace.
fn is_descriptor(path: &Path) -> bool {
    let folders = ["/dev/fd", "/proc/self/fd"];
    [Path::new("/dev/stdout"), Path::new("/dev/stderr")].contains(&path)
        || path.parent().is_some_and(|folder| folders.iter().any(|other| folder == Path::new(other)))
}

/// Returns the path at the end of a chain of symbolic links, where there may be no file yet.
fn followed(path: &Path) -> PathBuf {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        let Ok(next) = read_link(&path) else { break };
        path = path.parent().unwrap_or(Path::new("")).join(next);
    }
    path
}

fn replace(path: &Path, bytes: &[u8], permissions: Option<Permissions>) -> io::Result<()> {
    let temporary = TemporaryFile::create(|name| path.with_file_name(format!(".{name}.tmp")))?;
    fill(&temporary.file, bytes, permissions)?;
    temporary.rename(path)
}

/// A new file, which is removed again unless it is renamed. If the program is killed, the next one that creates such a file in that
/// folder removes it, since nothing holds its lock any more. Only on Unix: elsewhere a lock would keep ffmpeg out, so each process
/// uses names of its own.
#[derive(Debug)]
pub struct TemporaryFile {
    file: File,
    path: PathBuf,
}

impl TemporaryFile {
    /// Creates a file where `place` puts one of a given name.
    ///
    /// # Errors
    /// If no file can be created there.
    pub fn create(place: impl Fn(&str) -> PathBuf) -> io::Result<Self> {
        let place = |attempt: usize| match cfg!(unix) {
            true => place(&format!("gaitway-{attempt}")),
            false => place(&format!("gaitway-{}-{attempt}", std::process::id())),
        };
        let paths = || (0..MAX_TEMPORARY_FILES).map(&place);
        paths().for_each(|path| remove_abandoned(&path));
        let is_free =
            |created: &io::Result<Self>| !matches!(created, Err(error) if error.kind() == ErrorKind::AlreadyExists);
        paths().map(Self::create_at).find(is_free).unwrap_or_else(|| Err(ErrorKind::AlreadyExists.into()))
    }

    fn create_at(path: PathBuf) -> io::Result<Self> {
        let file = OpenOptions::new().write(true).create_new(true).open(&path)?;
        // Until it is locked, another process may take it for abandoned.
        if cfg!(unix) && (matches!(file.try_lock(), Err(TryLockError::WouldBlock)) || !is_at(&file, &path)) {
            return Err(ErrorKind::AlreadyExists.into());
        }
        Ok(Self { file, path })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn rename(mut self, path: &Path) -> io::Result<()> {
        rename(&self.path, path)?;
        self.path.clear();
        Ok(())
    }
}

impl Drop for TemporaryFile {
    fn drop(&mut self) {
        if !self.path.as_os_str().is_empty() {
            // If that fails, the next run does it.
            let _ = remove_file(&self.path);
        }
    }
}

/// Removes a temporary file whose program was killed: the system has given its lock back.
fn remove_abandoned(path: &Path) {
    // Opening a pipe would wait for its reader.
    if !cfg!(unix) || !symlink_metadata(path).is_ok_and(|found| found.is_file()) {
        return;
    }
    let Ok(file) = OpenOptions::new().write(true).open(path) else { return };
    if file.try_lock().is_ok() && is_at(&file, path) {
        // If that fails, another name is used.
        let _ = remove_file(path);
    }
}

/// Whether an open file is still the one at this path.
fn is_at(file: &File, path: &Path) -> bool {
    matches!((file.metadata(), metadata(path)), (Ok(open), Ok(found)) if is_same(&open, &found))
}

#[cfg(not(unix))]
fn is_same(_one: &Metadata, _other: &Metadata) -> bool {
    false
}

#[cfg(unix)]
fn is_same(one: &Metadata, other: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

fn fill(mut file: &File, bytes: &[u8], permissions: Option<Permissions>) -> io::Result<()> {
    file.write_all(bytes)?;
    if let Some(permissions) = permissions {
        file.set_permissions(permissions)?;
    }
    // Some file systems run out of space only now.
    file.sync_all()
}

/// Whether two paths lead to one file: by a different spelling, symbolic or hard links.
fn is_same_file(one: &Path, other: &Path) -> bool {
    let (Ok(found), Ok(other_found)) = (metadata(one), metadata(other)) else { return false };
    if !found.is_file() || !other_found.is_file() {
        return false;
    }
    #[cfg(unix)]
    {
        is_same(&found, &other_found)
    }
    #[cfg(not(unix))]
    {
        matches!((one.canonicalize(), other.canonicalize()), (Ok(one), Ok(other)) if one == other)
    }
}
