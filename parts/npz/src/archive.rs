//! The file: an archive of arrays (`.npz`), or one array (`.npy`).

use std::borrow::Cow;

use gaitway_unzip::{Data, Directory, Member};
use miniz_oxide::inflate::decompress_to_vec_with_limit;

use crate::array::{Array, MAGIC};

/// Maximum size of an array, unpacked: half an hour of 52 joints at 120 frames a second, in float64.
const MAX_ARRAY_BYTES: u64 = 1 << 28;

/// What messages call the only array of a `.npy`, which has no name.
pub const LONE: &str = "the array";

/// An opened file.
pub struct Archive<'a> {
    file: &'a [u8],
    /// Empty for a `.npy`.
    members: Vec<Member<'a>>,
}

impl<'a> Archive<'a> {
    pub fn open(file: &'a [u8]) -> Result<Archive<'a>, String> {
        if file.starts_with(MAGIC) {
            return Ok(Archive { file, members: Vec::new() });
        }
        let members = Directory::find(file).and_then(|directory| directory.members().collect());
        let members = members.map_err(|problem| format!("the .npz file is damaged: {problem}."))?;
        Ok(Archive { file, members })
    }

    /// Returns whether the file is one array.
    pub fn is_npy(&self) -> bool {
        self.file.starts_with(MAGIC)
    }

    /// Returns the shape of the only array of a `.npy`.
    pub fn lone_shape(&self) -> Vec<usize> {
        Array::shape_of(self.file).unwrap_or_default()
    }

    /// Returns the extension that fits the contents.
    pub fn extension(&self) -> &'static str {
        if self.is_npy() { ".npy" } else { ".npz" }
    }

    /// Returns the names of the arrays, for messages.
    pub fn names(&self) -> String {
        const MAX_NAMES: usize = 12;
        let mut names: Vec<&str> = self.member_names().collect();
        names.sort_unstable();
        let more = names.len().saturating_sub(MAX_NAMES);
        names.truncate(MAX_NAMES);
        match (names.is_empty(), more) {
            (true, _) => "nothing".to_owned(),
            (_, 0) => names.join(", "),
            _ => format!("{} and {more} more", names.join(", ")),
        }
    }

    fn member_names(&self) -> impl Iterator<Item = &'a str> {
        let names = self.members.iter().filter_map(|member| str::from_utf8(member.raw_name).ok());
        names.map(|name| name.strip_suffix(".npy").unwrap_or(name))
    }

    /// Reads the first array that has one of the names. `None` if none has.
    pub fn find(&self, names: &[&str]) -> Result<Option<Array>, String> {
        for name in names {
            if let Some(member) = self.member(name) {
                let label = label(name);
                return Array::read(&label, &self.unpack(&label, member)?).map(Some);
            }
        }
        Ok(None)
    }

    /// Calls `read` with each array whose shape `fits`, and returns its first result. Arrays that can't be read are skipped,
    /// except that of a `.npy`.
    pub fn find_fitting<T>(
        &self,
        fits: &dyn Fn(&[usize]) -> bool,
        read: &dyn Fn(Array) -> Result<Option<T>, String>,
    ) -> Result<Option<T>, String> {
        if self.is_npy() {
            let array = Array::read(LONE, self.file)?;
            return if fits(&array.shape) { read(array) } else { Ok(None) };
        }
        for (name, member) in self.member_names().zip(&self.members) {
            let label = label(name);
            let Ok(bytes) = self.unpack(&label, member) else { continue };
            if !Array::shape_of(&bytes).is_some_and(|shape| fits(&shape)) {
                continue;
            }
            if let Ok(array) = Array::read(&label, &bytes)
                && let Some(found) = read(array)?
            {
                return Ok(Some(found));
            }
        }
        Ok(None)
    }

    /// Returns whether there is an array of that name.
    pub fn has(&self, name: &str) -> bool {
        self.member(name).is_some()
    }

    fn member(&self, name: &str) -> Option<&Member<'a>> {
        self.members.iter().find(|member| member.raw_name.strip_suffix(b".npy") == Some(name.as_bytes()))
    }

    fn unpack(&self, label: &str, member: &Member) -> Result<Cow<'a, [u8]>, String> {
        if member.bytes > MAX_ARRAY_BYTES {
            return Err(format!(
                "{label} is too large: expected at most {MAX_ARRAY_BYTES} bytes, found {}. Cut the motion into several \
                 files.",
                member.bytes
            ));
        }
        unpacked(self.file, member).map_err(|problem| format!("{label}: {problem}."))
    }
}

/// Returns what messages call an array.
fn label(name: &str) -> String {
    format!("array \"{name}\"")
}

fn unpacked<'a>(file: &'a [u8], member: &Member) -> Result<Cow<'a, [u8]>, String> {
    let bytes = match member.data(file)? {
        Data::Stored(bytes) => Cow::Borrowed(bytes),
        Data::Deflated(packed) => {
            decompress_to_vec_with_limit(packed, member.bytes as usize).map_err(|_| member.damaged())?.into()
        }
    };
    if member.is_sound(bytes.len(), crc32fast::hash(&bytes)) { Ok(bytes) } else { Err(member.damaged()) }
}

/// Returns a message about a damaged array.
pub fn damaged(label: &str, expected: &str, found: &str) -> String {
    format!("{label} is damaged: expected {expected}, found {found}. Download or save the file again.")
}
