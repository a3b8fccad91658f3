//! A set of named files in memory: dropped, picked, unpacked from an archive, read from disk or fetched.

use std::borrow::Cow;

use flate2::{Crc, Decompress, FlushDecompress, Status};
use gaitway_character::asset::SharedBytes;
use gaitway_unzip::{Data, Directory, Member};

use super::LoadError;
use super::encoding;
use super::limits::{MAX_ARCHIVE_FILES, MAX_READ_BYTES};

/// How a zip archive begins.
const ZIP: &[u8] = b"PK\x03\x04";

/// Maximum compression ratio of Deflate.
const MAX_COMPRESSION: u64 = 1032;

/// Files by path, with `/` between folders, in the order they were added.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FileSet {
    files: Vec<(String, SharedBytes)>,
    conversions: Vec<(String, Conversion)>,
}

/// What a file was before it was converted into plain glTF.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Conversion {
    /// `None`: still the format of the glTF.
    pub format: Option<&'static str>,
    /// glTF extensions that the file no longer has.
    pub extensions: Vec<String>,
    /// What could not be carried over.
    pub warnings: Vec<String>,
    /// A glTF as it was added; `None` for other formats. Set by [`FileSet::convert`].
    pub original: Option<SharedBytes>,
}

/// The file that a reference resolves to, and whether only its bare name matched.
pub(super) struct Found<'a> {
    pub name: &'a str,
    pub bytes: &'a SharedBytes,
    pub by_bare_name: bool,
}

impl FileSet {
    /// Adds a file, or the files inside it if it is a zip archive other than an .npz. Returns its normalized name.
    ///
    /// # Errors
    /// If the archive cannot be read, or unpacks to more than is kept in memory. Some of its files may already have
    /// been added.
    pub fn add(&mut self, name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Result<String, LoadError> {
        let (name, bytes) = (join("", &name.into()), bytes.into());
        if is_zip(&name, &bytes) {
            self.unpack(&name, &bytes)?;
        } else {
            self.insert(name.clone(), bytes);
        }
        Ok(name)
    }

    /// Adds a file as it is, replacing any file of the same name. Archives are not unpacked, so their contents are not
    /// found.
    pub fn insert(&mut self, name: impl Into<String>, bytes: impl Into<Vec<u8>>) {
        let (name, mut bytes) = (join("", &name.into()), bytes.into());
        // Files of unknown length are read with room to spare.
        bytes.shrink_to_fit();
        match self.files.iter_mut().find(|(other, _)| *other == name) {
            Some(file) => file.1 = bytes.into(),
            None => self.files.push((name, bytes.into())),
        }
    }

    /// Adds a file of another set. Its name is normalized and not taken.
    pub(super) fn insert_shared(&mut self, name: &str, bytes: SharedBytes) {
        self.files.push((name.to_owned(), bytes));
    }

    /// Replaces a file with what it was converted into. The original of a glTF is kept.
    pub(super) fn convert(&mut self, name: &str, bytes: Vec<u8>, mut conversion: Conversion) {
        conversion.original = self.get(name).filter(|_| conversion.format.is_none()).cloned();
        self.insert(name, bytes);
        let known = self.conversions.iter_mut().find(|(of, _)| of == name);
        match known {
            Some((_, earlier)) => {
                earlier.extensions.extend(conversion.extensions);
                earlier.warnings.extend(conversion.warnings);
            }
            None => self.conversions.push((name.to_owned(), conversion)),
        }
    }

    /// Returns what a file was before it was converted.
    pub(super) fn conversion(&self, name: &str) -> Option<&Conversion> {
        self.conversions.iter().find(|(of, _)| of == name).map(|(_, conversion)| conversion)
    }

    /// Returns the contents of the file with exactly this normalized name.
    pub fn get(&self, name: &str) -> Option<&SharedBytes> {
        self.files.iter().find(|(other, _)| other == name).map(|(_, bytes)| bytes)
    }

    /// Returns a file as it was added, without the conversions of compressed glTFs; `None` if it was of another format.
    pub fn original(&self, name: &str) -> Option<&SharedBytes> {
        self.conversion(name).map_or_else(|| self.get(name), |conversion| conversion.original.as_ref())
    }

    /// Returns the normalized names, in the order the files were added.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|(name, _)| name.as_str())
    }

    /// Returns whether the set has no files.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// Returns the size of all files together.
    pub fn byte_count(&self) -> u64 {
        self.files.iter().map(|(_, bytes)| bytes.len() as u64).sum()
    }

    /// Returns the normalized names and contents, in the order the files were added.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &SharedBytes)> {
        self.files.iter().map(|(name, bytes)| (name.as_str(), bytes))
    }

    /// Finds the file that `base` refers to as `uri` (already percent-decoded). Falls back to a file of the same bare name in
    /// any folder, since exporters often write paths of the machine they ran on.
    pub(super) fn resolve(&self, base: &str, uri: &str) -> Option<Found<'_>> {
        let path = join(base, uri);
        if let Some((name, bytes)) = self.files.iter().find(|(name, _)| *name == path) {
            return Some(Found { name, bytes, by_bare_name: false });
        }
        fn folded(name: &str) -> impl Iterator<Item = char> {
            name.chars().flat_map(char::to_lowercase)
        }
        let bare = bare_name(uri);
        self.files
            .iter()
            .find(|(name, _)| !bare.is_empty() && folded(bare_name(name)).eq(folded(bare)))
            .map(|(name, bytes)| Found { name, bytes, by_bare_name: true })
    }

    fn unpack(&mut self, archive_name: &str, bytes: &[u8]) -> Result<(), LoadError> {
        let error = |problem: String| LoadError::Archive { file: archive_name.to_owned(), problem };
        let directory = Directory::find(bytes).map_err(error)?;
        let too_large = |expected: String, found: String| {
            let file = archive_name.to_owned();
            LoadError::TooLarge { file, place: String::new(), expected, found }
        };
        if directory.count > MAX_ARCHIVE_FILES as u64 {
            let expected = format!("at most {MAX_ARCHIVE_FILES} files in an archive");
            return Err(too_large(expected, directory.count.to_string()));
        }
        // The archive is in memory together with what is unpacked from it.
        let mut bytes_left = MAX_READ_BYTES.saturating_sub(self.byte_count() + bytes.len() as u64);
        let mut decoded = decoded_names(&directory).into_iter();
        for member in directory.members() {
            let member = member.map_err(error)?;
            let decoded = if member.has_unknown_encoding() { decoded.next() } else { None };
            let name = &*decoded.map_or_else(|| member.name(), Cow::Owned);
            if member.is_folder() || name.starts_with("__MACOSX/") || bare_name(name).starts_with("._") {
                continue;
            }
            let too_many_bytes = || {
                let max = MAX_READ_BYTES >> 20;
                too_large(format!("at most {max} MiB in all, packed and unpacked"), "more".to_owned())
            };
            bytes_left = bytes_left.checked_sub(member.bytes).ok_or_else(too_many_bytes)?;
            let content = unpacked(bytes, &member).map_err(|problem| error(format!("“{name}”: {problem}")))?;
            self.insert(name, content);
        }
        Ok(())
    }
}

/// Returns the names of members whose encoding is unknown, or nothing if MS-DOS's fits them. Archives made on an East Asian Windows
/// have names in other encodings.
fn decoded_names(directory: &Directory) -> Vec<String> {
    let names = directory.members().flatten().filter(Member::has_unknown_encoding);
    encoding::double_byte_names(&names.map(|member| member.raw_name).collect::<Vec<_>>()).unwrap_or_default()
}

/// Returns a member's contents.
fn unpacked(archive: &[u8], member: &Member) -> Result<Vec<u8>, String> {
    let content = match member.data(archive)? {
        Data::Stored(bytes) => Cow::Borrowed(bytes),
        Data::Deflated(packed) => inflated(packed, member.bytes).ok_or_else(|| member.damaged())?.into(),
    };
    let mut crc = Crc::new();
    crc.update(&content);
    if member.is_sound(content.len(), crc.sum()) { Ok(content.into_owned()) } else { Err(member.damaged()) }
}

/// Returns what a Deflate stream holds, if that has the expected size.
fn inflated(packed: &[u8], bytes: u64) -> Option<Vec<u8>> {
    let possible = (packed.len() as u64).saturating_mul(MAX_COMPRESSION);
    let mut content = Vec::with_capacity(usize::try_from(bytes).ok().filter(|_| bytes <= possible)?);
    let status = Decompress::new(false).decompress_vec(packed, &mut content, FlushDecompress::Finish);
    matches!(status, Ok(Status::StreamEnd)).then_some(content)
}

/// Returns whether a file is an archive to unpack. The name decides if something else precedes the archive, or if the file is
/// damaged.
fn is_zip(name: &str, bytes: &[u8]) -> bool {
    let has_extension = without_query(name).to_ascii_lowercase().ends_with(".zip");
    (has_extension || bytes.starts_with(ZIP)) && !is_npz(bytes)
}

/// Returns whether a zip archive holds NumPy arrays, so that it stays one file. Its first member's name decides.
pub(super) fn is_npz(bytes: &[u8]) -> bool {
    // A member begins with 30 bytes, among them the length of its name, which follows.
    let length = bytes.get(26..).and_then(|rest| rest.first_chunk()).map(|length| u16::from_le_bytes(*length));
    let name = length.and_then(|length| bytes.get(30..30 + usize::from(length)));
    bytes.starts_with(ZIP) && name.is_some_and(|name| name.ends_with(b".npy"))
}

/// Returns whether a file is one NumPy array.
pub(super) fn is_npy(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x93NUMPY")
}

pub(super) fn bare_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

/// Returns the name in the set of a file `part` that was made from `base`, and the URI by which `base` refers to it.
pub(super) fn beside(base: &str, part: &str) -> (String, String) {
    let uri = format!("{}.{part}", bare_name(base));
    (join(base, &uri), uri)
}

/// A file's own name without folders, query and extension.
pub fn file_stem(name: &str) -> &str {
    let bare = bare_name(without_query(name));
    bare.rsplit_once('.').map_or(bare, |(stem, _)| stem)
}

/// Strips the query and the fragment, which may contain slashes of their own, from a URL. Folder names in a path may
/// contain `?` or `#`.
pub(super) fn without_query(name: &str) -> &str {
    let start = if name.contains("://") { 0 } else { name.len() - bare_name(name).len() };
    let end = name[start..].find(['?', '#']).map_or(name.len(), |length| start + length);
    &name[..end]
}

/// Resolves `uri` against the folder of `base`, including `.` and `..`. A URL with a scheme is returned unchanged.
fn join(base: &str, uri: &str) -> String {
    if uri.contains("://") {
        return uri.to_owned();
    }
    let (origin, base_path) = match base.split_once("://") {
        Some((scheme, rest)) => {
            let (host, path) = rest.split_once('/').unwrap_or((rest, ""));
            (format!("{scheme}://{host}/"), path)
        }
        None => (String::new(), base),
    };
    let uri = uri.replace('\\', "/");
    let mut parts: Vec<&str> = base_path.split('/').collect();
    parts.pop();
    if uri.starts_with('/') {
        parts.clear();
    }
    for part in uri.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    origin + &parts.join("/")
}
