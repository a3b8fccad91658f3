//! The archive of arrays.

use std::borrow::Cow;

use gaitway_unzip::{Data, Directory, Member};
use miniz_oxide::inflate::decompress_to_vec_with_limit;

use crate::array::Array;

/// Maximum size of an array, unpacked: half an hour of 52 joints at 120 frames a second, in float64.
const MAX_ARRAY_BYTES: u64 = 1 << 28;

/// An opened `.npz`.
pub struct Archive<'a> {
    file: &'a [u8],
    members: Vec<Member<'a>>,
}

impl<'a> Archive<'a> {
    pub fn open(file: &'a [u8]) -> Result<Archive<'a>, String> {
        let members = Directory::find(file).and_then(|directory| directory.members().collect());
        let members = members.map_err(|problem| format!("the .npz file is damaged: {problem}."))?;
        Ok(Archive { file, members })
    }

    /// Returns the names of the arrays, for messages.
    pub fn names(&self) -> String {
        const MAX_NAMES: usize = 12;
        let names = self.members.iter().filter_map(|member| str::from_utf8(member.raw_name).ok());
        let mut names: Vec<&str> = names.map(|name| name.strip_suffix(".npy").unwrap_or(name)).collect();
        names.sort_unstable();
        let more = names.len().saturating_sub(MAX_NAMES);
        names.truncate(MAX_NAMES);
        match (names.is_empty(), more) {
            (true, _) => "nothing".to_owned(),
            (_, 0) => names.join(", "),
            _ => format!("{} and {more} more", names.join(", ")),
        }
    }

    /// Reads the first array that has one of the names. `None` if none has.
    pub fn find(&self, names: &[&str]) -> Result<Option<Array>, String> {
        for name in names {
            if let Some(member) = self.member(name) {
                return Array::read(name, &self.unpack(name, member)?).map(Some);
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

    fn unpack(&self, name: &str, member: &Member) -> Result<Cow<'a, [u8]>, String> {
        if member.bytes > MAX_ARRAY_BYTES {
            return Err(format!(
                "array \"{name}\" is too large: expected at most {MAX_ARRAY_BYTES} bytes, found {}. Cut the motion into \
                 several files.",
                member.bytes
            ));
        }
        unpacked(self.file, member).map_err(|problem| format!("array \"{name}\": {problem}."))
    }
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
pub fn damaged(name: &str, expected: &str, found: &str) -> String {
    format!("array \"{name}\" is damaged: expected {expected}, found {found}. Download or save the .npz file again.")
}
