//! The archive of arrays.

use gaitway_unzip::{Member, Method, members};
use miniz_oxide::inflate::decompress_to_vec_with_limit;

use crate::array::Array;

/// Maximum size of an array, unpacked: half an hour of 52 joints at 120 frames a second, in float64.
const MAX_ARRAY_BYTES: u64 = 1 << 28;

/// Maximum number of arrays that are looked at.
const MAX_ARRAYS: usize = 10_000;

/// An opened `.npz`.
pub struct Archive<'a> {
    file: &'a [u8],
    members: Vec<Member<'a>>,
}

impl<'a> Archive<'a> {
    pub fn open(file: &'a [u8]) -> Result<Archive<'a>, String> {
        let members = members(file, MAX_ARRAYS).ok_or(
            "the .npz file is damaged: expected a zip archive of arrays, found none that can be read. Download or save it \
             again.",
        )?;
        Ok(Archive { file, members })
    }

    /// Returns the names of the arrays, for messages.
    pub fn names(&self) -> String {
        const MAX_NAMES: usize = 12;
        let names = self.members.iter().map(|member| member.name.strip_suffix(".npy").unwrap_or(&member.name));
        let mut names: Vec<&str> = names.collect();
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
            let is_it = |member: &&Member| member.name.strip_suffix(".npy") == Some(*name);
            if let Some(member) = self.members.iter().find(is_it) {
                return Array::read(name, &self.unpack(name, member)?).map(Some);
            }
        }
        Ok(None)
    }

    fn unpack(&self, name: &str, member: &Member) -> Result<Vec<u8>, String> {
        if member.bytes > MAX_ARRAY_BYTES {
            return Err(format!(
                "array \"{name}\" is too large: expected at most {MAX_ARRAY_BYTES} bytes, found {}. Cut the motion into \
                 several files.",
                member.bytes
            ));
        }
        let packed = member
            .packed(self.file)
            .ok_or_else(|| damaged(name, &format!("{} bytes", member.packed_bytes), "the end of the file"))?;
        let bytes = match member.method {
            Method::Stored => packed.to_vec(),
            Method::Deflated => decompress_to_vec_with_limit(packed, member.bytes as usize)
                .map_err(|problem| damaged(name, "deflated data", &format!("{:?}", problem.status)))?,
            Method::Encrypted => return Err(unreadable(name, "encrypted")),
            Method::Other(method) => return Err(unreadable(name, &format!("method {method}"))),
        };
        if !member.is_sound(bytes.len(), crc32fast::hash(&bytes)) {
            return Err(damaged(name, &format!("{} bytes with checksum {:08x}", member.bytes, member.crc), "others"));
        }
        Ok(bytes)
    }
}

fn unreadable(name: &str, found: &str) -> String {
    format!("array \"{name}\": expected plain or deflated data, found {found}. Save the file again with numpy.savez.")
}

/// Returns a message about a damaged array.
pub fn damaged(name: &str, expected: &str, found: &str) -> String {
    format!("array \"{name}\" is damaged: expected {expected}, found {found}. Download or save the .npz file again.")
}
