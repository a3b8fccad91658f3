//! The archive of arrays: sections 4.3.7, 4.3.12, 4.3.16 and 4.5.3 of PKWARE's APPNOTE.TXT. The `zip` crate depends on
//! JavaScript in wasm, which a module without imports can't call.

use std::borrow::Cow;

use miniz_oxide::inflate::decompress_to_vec_with_limit;

use crate::array::Array;

/// Maximum size of an array, unpacked: half an hour of 52 joints at 120 frames a second, in float64.
const MAX_ARRAY_BYTES: usize = 1 << 28;

/// An archive ends with a record of this size and a comment of up to 65,535 bytes.
const END_BYTES: usize = 22;
const END: &[u8] = b"PK\x05\x06";
const LISTED: &[u8] = b"PK\x01\x02";
const MEMBER: &[u8] = b"PK\x03\x04";
/// Id of the extra field with sizes of 64 bits, and what stands in place of those sizes.
const ZIP64: u16 = 1;
const IN_ZIP64: u32 = u32::MAX;

const STORED: u16 = 0;
const DEFLATED: u16 = 8;

/// A file of the archive, as its directory lists it.
struct Member<'a> {
    name: &'a str,
    is_encrypted: bool,
    method: u16,
    crc: u32,
    packed_bytes: usize,
    bytes: usize,
    offset: usize,
}

/// An opened `.npz`.
pub struct Archive<'a> {
    file: &'a [u8],
    members: Vec<Member<'a>>,
}

impl<'a> Archive<'a> {
    pub fn open(file: &'a [u8]) -> Result<Archive<'a>, String> {
        let members = members(file).ok_or(
            "the .npz file is damaged: expected a zip archive of arrays, found none that can be read. Download or save it \
             again.",
        )?;
        Ok(Archive { file, members })
    }

    /// Returns the names of the arrays, for messages.
    pub fn names(&self) -> String {
        const MAX_NAMES: usize = 12;
        let names = self.members.iter().map(|member| member.name.strip_suffix(".npy").unwrap_or(member.name));
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

    fn unpack(&self, name: &str, member: &Member) -> Result<Cow<'a, [u8]>, String> {
        if member.bytes > MAX_ARRAY_BYTES {
            return Err(format!(
                "array \"{name}\" is too large: expected at most {MAX_ARRAY_BYTES} bytes, found {}. Cut the motion into \
                 several files.",
                member.bytes
            ));
        }
        if member.is_encrypted || !matches!(member.method, STORED | DEFLATED) {
            let found = if member.is_encrypted { "encrypted".to_owned() } else { format!("method {}", member.method) };
            return Err(format!(
                "array \"{name}\": expected plain or deflated data, found {found}. Save the file again with numpy.savez."
            ));
        }
        let packed = packed(self.file, member)
            .ok_or_else(|| damaged(name, &format!("{} bytes", member.packed_bytes), "the end of the file"))?;
        let bytes = match member.method {
            STORED => Cow::Borrowed(packed),
            _ => decompress_to_vec_with_limit(packed, member.bytes)
                .map_err(|problem| damaged(name, "deflated data", &format!("{:?}", problem.status)))?
                .into(),
        };
        // A fuzzer can't be expected to get checksums right.
        let has_checksum = cfg!(fuzzing) || crc32fast::hash(&bytes) == member.crc;
        if bytes.len() != member.bytes || !has_checksum {
            return Err(damaged(name, &format!("{} bytes with checksum {:08x}", member.bytes, member.crc), "others"));
        }
        Ok(bytes)
    }
}

/// Returns a message about a damaged array.
pub fn damaged(name: &str, expected: &str, found: &str) -> String {
    format!("array \"{name}\" is damaged: expected {expected}, found {found}. Download or save the .npz file again.")
}

/// Reads the directory. `None` if it is damaged.
fn members(file: &[u8]) -> Option<Vec<Member<'_>>> {
    let last = file.len().checked_sub(END_BYTES)?;
    let end = (last.saturating_sub(usize::from(u16::MAX))..=last).rev().find(|&at| file[at..].starts_with(END))?;
    let count = u16_at(file, end + 10)?;
    let mut at = u32_at(file, end + 16)? as usize;
    let mut members = Vec::new();
    for _ in 0..count {
        if !file.get(at..)?.starts_with(LISTED) {
            return None;
        }
        let [name_bytes, extra_bytes, comment_bytes] =
            [u16_at(file, at + 28)?, u16_at(file, at + 30)?, u16_at(file, at + 32)?].map(usize::from);
        let name = file.get(at + 46..at + 46 + name_bytes)?;
        let extra = file.get(at + 46 + name_bytes..at + 46 + name_bytes + extra_bytes)?;
        let [bytes, packed_bytes, offset] =
            sizes([u32_at(file, at + 24)?, u32_at(file, at + 20)?, u32_at(file, at + 42)?], extra)?;
        // Names in other encodings than UTF-8 aren't those of arrays.
        if let Ok(name) = std::str::from_utf8(name) {
            members.push(Member {
                name,
                is_encrypted: u16_at(file, at + 8)? & 1 != 0,
                method: u16_at(file, at + 10)?,
                crc: u32_at(file, at + 16)?,
                packed_bytes,
                bytes,
                offset,
            });
        }
        at += 46 + name_bytes + extra_bytes + comment_bytes;
    }
    Some(members)
}

/// Returns size, packed size and offset, which are among the extra fields if they don't fit into 32 bits.
fn sizes(short: [u32; 3], extra: &[u8]) -> Option<[usize; 3]> {
    let mut long = field(extra, ZIP64).unwrap_or_default().chunks_exact(8);
    let mut sizes = [0; 3];
    for (size, short) in sizes.iter_mut().zip(short) {
        *size = match short {
            IN_ZIP64 => usize::try_from(u64::from_le_bytes(long.next()?.try_into().ok()?)).ok()?,
            _ => short as usize,
        };
    }
    Some(sizes)
}

/// Returns the extra field with an id.
fn field(mut extra: &[u8], id: u16) -> Option<&[u8]> {
    while let (Some(found), Some(length)) = (u16_at(extra, 0), u16_at(extra, 2)) {
        let (contents, rest) = extra[4..].split_at_checked(length.into())?;
        if found == id {
            return Some(contents);
        }
        extra = rest;
    }
    None
}

/// Returns a member's data, which follows its own header.
fn packed<'a>(file: &'a [u8], member: &Member) -> Option<&'a [u8]> {
    let own = file.get(member.offset..).filter(|own| own.starts_with(MEMBER))?;
    let start = 30 + usize::from(u16_at(own, 26)?) + usize::from(u16_at(own, 28)?);
    own.get(start..start.checked_add(member.packed_bytes)?)
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    bytes.get(at..)?.first_chunk().map(|word| u16::from_le_bytes(*word))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|word| u32::from_le_bytes(*word))
}
