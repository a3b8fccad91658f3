//! A set of named files in memory: what was dropped, picked, unzipped, read beside a model or fetched.

use std::io::{Cursor, Read};
use std::sync::Arc;

use super::LoadError;

/// Bounds on what an archive may unpack to.
const MAX_ARCHIVE_ENTRIES: usize = 10_000;
const MAX_ARCHIVE_BYTES: u64 = 1 << 30;

/// Files by path, `/` between folders, in the order they were added.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FileSet {
    files: Vec<(String, Arc<[u8]>)>,
}

/// A file found for a reference, and whether only its bare name matched.
pub(super) struct Found<'a> {
    pub name: &'a str,
    pub bytes: &'a Arc<[u8]>,
    pub by_bare_name: bool,
}

impl FileSet {
    /// Adds a file; one of the same name is replaced.
    pub fn insert(&mut self, name: impl Into<String>, bytes: impl Into<Arc<[u8]>>) {
        let (name, bytes) = (join("", &name.into()), bytes.into());
        match self.files.iter_mut().find(|(other, _)| *other == name) {
            Some(file) => file.1 = bytes,
            None => self.files.push((name, bytes)),
        }
    }

    pub fn get(&self, name: &str) -> Option<&Arc<[u8]>> {
        self.files.iter().find(|(other, _)| other == name).map(|(_, bytes)| bytes)
    }

    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|(name, _)| name.as_str())
    }

    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    pub fn iter(&self) -> impl Iterator<Item = (&str, &Arc<[u8]>)> {
        self.files.iter().map(|(name, bytes)| (name.as_str(), bytes))
    }

    /// The file that `uri` (already percent-decoded) means in the file `base`: by its path from there, else by its bare
    /// name anywhere, since exports often carry paths of another machine.
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

    /// The set with every .zip replaced by what is in it. Sizes are bounded while unpacking: headers can lie.
    pub fn unpacked(&self) -> Result<FileSet, LoadError> {
        let mut unpacked = FileSet::default();
        let mut budget = MAX_ARCHIVE_BYTES;
        for (name, bytes) in &self.files {
            if bytes.starts_with(b"PK\x03\x04") {
                unpack(name, bytes, &mut budget, &mut unpacked)?;
            } else {
                unpacked.insert(name.clone(), bytes.clone());
            }
        }
        Ok(unpacked)
    }
}

fn unpack(file: &str, bytes: &[u8], budget: &mut u64, out: &mut FileSet) -> Result<(), LoadError> {
    let error = |problem: String| LoadError::Archive { file: file.to_owned(), problem };
    let mut archive =
        zip::ZipArchive::new(Cursor::new(bytes)).map_err(|problem| error(format!("not a readable zip: {problem}")))?;
    if archive.len() > MAX_ARCHIVE_ENTRIES {
        return Err(error(format!("{} files in the archive; at most {MAX_ARCHIVE_ENTRIES} are read", archive.len())));
    }
    for index in 0..archive.len() {
        let entry = archive.by_index(index).map_err(|problem| error(format!("entry {index}: {problem}")))?;
        let name = entry.name().map_err(|problem| error(format!("entry {index}: {problem}")))?.into_owned();
        if entry.is_dir() || name.starts_with("__MACOSX/") || bare_name(&name).starts_with("._") {
            continue;
        }
        let too_large = || error(format!("unpacks to more than {} MiB, which is not read", MAX_ARCHIVE_BYTES >> 20));
        // An honest header saves the work; one that lies is caught while unpacking.
        if entry.size() > *budget {
            return Err(too_large());
        }
        let mut content = Vec::new();
        entry
            .take(*budget + 1)
            .read_to_end(&mut content)
            .map_err(|problem| error(format!("“{name}” cannot be unpacked: {problem}")))?;
        *budget = budget.checked_sub(content.len() as u64).ok_or_else(too_large)?;
        out.insert(name, content);
    }
    Ok(())
}

pub(super) fn bare_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

/// `uri` as seen from the folder of `base`, with `.` and `..` worked out. An address with a scheme stays as it is.
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
