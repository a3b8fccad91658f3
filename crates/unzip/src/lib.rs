//! Reads the directory of a zip archive: sections 4.3.7, 4.3.12 to 4.3.16, 4.4.4, 4.4.5, 4.5.3, 4.6.9 and appendix D of PKWARE's
//! APPNOTE.TXT. Decompression and checksums are left to callers, who have code for both. Split and encrypted archives and methods
//! other than Deflate are not supported.
//!
//! The crate `zip`, with as few features as it has, took 18 KB more, and in wasm it calls JavaScript, which a part can't.
//! `rawzip` is as small, but leaves names in CP437, messages and overlapping files to its user. `rc-zip` needs libraries for
//! dates and text encodings.

use std::borrow::Cow;

/// The archive ends with a record of this size and a comment of up to 65,535 bytes.
const END_BYTES: usize = 22;
const END: &[u8] = b"PK\x05\x06";
/// Precedes that record if its numbers don't fit, and points to the record with 64-bit numbers.
const LOCATOR_BYTES: usize = 20;
const LOCATOR: &[u8] = b"PK\x06\x07";
/// Size without the data that may be appended to the record.
const LONG_END_BYTES: usize = 56;
const LONG_END: &[u8] = b"PK\x06\x06";

const LISTED: &[u8] = b"PK\x01\x02";
const LISTED_BYTES: usize = 46;
const MEMBER: &[u8] = b"PK\x03\x04";
const MEMBER_BYTES: usize = 30;

/// Id of the extra field with 64-bit numbers, and the value that refers to it.
const ZIP64: u16 = 1;
const IN_ZIP64: u32 = u32::MAX;
/// Id of the extra field with the name in UTF-8: its version, the checksum of the other name, and the name.
const UNICODE_PATH: u16 = 0x7075;

const ENCRYPTED: u16 = 1;
const UTF8: u16 = 1 << 11;
const STORED: u16 = 0;
const DEFLATED: u16 = 8;

/// Characters 128 to 255 of names that aren't UTF-8.
const CP437: &str = "ÇüéâäàåçêëèïîìÄÅÉæÆôöòûùÿÖÜ¢£¥₧ƒáíóúñÑªº¿⌐¬½¼¡«»░▒▓│┤╡╢╖╕╣║╗╝╜╛┐└┴┬├─┼╞╟╚╔╩╦╠═╬╧╨╤╥╙╘╒╓╫╪┘┌█▄▌▐▀\
    αßΓπΣσµτΦΘΩδ∞φε∩≡±≥≤⌠⌡÷≈°∙·√ⁿ²■\u{a0}";

/// Ends messages about damage.
const AGAIN: &str = "; download or save it again";
/// Ends messages about unsupported archives.
const ELSEWHERE: &str = "; unpack it with another program and open its files";

/// The list of an archive's files.
#[derive(Debug, Clone, Copy)]
pub struct Directory<'a> {
    file: &'a [u8],
    /// Number of members, according to the archive's end.
    pub count: u64,
    start: usize,
    /// Bytes before the archive's own, which its offsets don't count. Wraps around if there are too few.
    prefix: u64,
}

/// A file or folder of an archive, as the directory lists it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Member<'a> {
    /// Path inside the archive, in some encoding.
    pub raw_name: &'a [u8],
    extra: &'a [u8],
    /// Size when unpacked.
    pub bytes: u64,
    packed_bytes: u64,
    crc: u32,
    is_encrypted: bool,
    is_utf8: bool,
    method: u16,
    offset: u64,
}

/// A member's data in the archive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Data<'a> {
    /// The file itself.
    Stored(&'a [u8]),
    /// A Deflate stream without a header.
    Deflated(&'a [u8]),
}

impl<'a> Directory<'a> {
    /// Finds the directory.
    ///
    /// # Errors
    /// If there is none, or if it is that of a split archive.
    pub fn find(file: &'a [u8]) -> Result<Self, String> {
        let last = file.len().saturating_sub(END_BYTES);
        // Comments can contain anything, and some downloads have a few bytes too many.
        let mut ends = (last.saturating_sub(u16::MAX.into())..=last).rev().filter(|&at| file[at..].starts_with(END));
        let found = ends.find_map(|at| Some((Self::ending(file, at)?, u16_at(file, at + 4)?)));
        match found {
            Some((directory, 0 | u16::MAX)) => Ok(directory),
            Some(_) => Err(format!("expected a whole archive, found the last part of a split one{ELSEWHERE}")),
            None => {
                Err(format!("expected a zip archive with a list of files at its end, found none (cut short?){AGAIN}"))
            }
        }
    }

    /// Returns the directory that ends with the record at `end`; `None` if it isn't where the record says.
    fn ending(file: &'a [u8], end: usize) -> Option<Self> {
        let numbers = [u16_at(file, end + 10)?.into(), u32_at(file, end + 12)?, u32_at(file, end + 16)?];
        let (end, [count, bytes, start]) = long_end(file, end).unwrap_or((end, numbers.map(u64::from)));
        // Bytes may precede the archive, or the size may be wrong: a whole directory is right.
        let places = [(end as u64).checked_sub(bytes), Some(start)].into_iter().flatten();
        let mut found = places.filter(|&at| (count, bytes) == (0, 0) || has(file, at, LISTED)).filter_map(|at| {
            Some(Self { file, count, start: usize::try_from(at).ok()?, prefix: at.wrapping_sub(start) })
        });
        let is_whole = |directory: &Self| directory.members().all(|member| member.is_ok());
        found.clone().find(is_whole).or_else(|| found.next())
    }

    /// Reads the members. The first error ends the directory.
    ///
    /// # Errors
    /// If the directory is damaged or cut short, or if its members overlap, so that a small archive could take hours.
    pub fn members(&self) -> impl Iterator<Item = Result<Member<'a>, String>> + use<'a> {
        let (directory, mut bytes_left) = (*self, self.file.len() as u64);
        let mut rest = directory.file.get(directory.start..).unwrap_or_default();
        (0..directory.count).map(move |index| {
            let damaged = |expected: &str, found: &str| {
                let (entry, count) = (index + 1, directory.count);
                format!("entry {entry} of {count} in the list of files: expected {expected}, found {found}{AGAIN}")
            };
            let (member, after) = directory.member(rest).ok_or_else(|| damaged("a file", "other data"))?;
            rest = after;
            bytes_left = bytes_left
                .checked_sub(member.packed_bytes)
                .ok_or_else(|| damaged("data of its own", "more data than the archive has"))?;
            Ok(member)
        })
    }

    /// Reads a member, and returns what follows it.
    fn member(&self, rest: &'a [u8]) -> Option<(Member<'a>, &'a [u8])> {
        let lengths = [u16_at(rest, 28)?, u16_at(rest, 30)?, u16_at(rest, 32)?].map(usize::from);
        let [name, extra, comment] = lengths;
        let (listed, after) = rest.split_at_checked(LISTED_BYTES + name + extra + comment)?;
        let (name, extra) = listed.strip_prefix(LISTED)?[LISTED_BYTES - LISTED.len()..].split_at(name);
        let extra = &extra[..extra.len() - comment];
        let numbers = [u32_at(listed, 24)?, u32_at(listed, 20)?, u32_at(listed, 42)?];
        let [bytes, packed_bytes, offset] = long_numbers(numbers, extra)?;
        let moved = offset.wrapping_add(self.prefix);
        let member = Member {
            raw_name: name,
            extra,
            bytes,
            packed_bytes,
            crc: u32_at(listed, 16)?,
            is_encrypted: u16_at(listed, 8)? & ENCRYPTED != 0,
            is_utf8: u16_at(listed, 8)? & UTF8 != 0,
            method: u16_at(listed, 10)?,
            offset: if has(self.file, moved, MEMBER) { moved } else { offset },
        };
        Some((member, after))
    }
}

impl<'a> Member<'a> {
    /// Returns the path inside the archive. An unknown encoding is taken for MS-DOS's.
    pub fn name(&self) -> Cow<'a, str> {
        unicode_path(self.raw_name, self.extra).unwrap_or_else(|| decoded(self.raw_name))
    }

    /// Returns whether the archive doesn't state the path's encoding, so that [`Self::name`] is a guess.
    pub fn has_unknown_encoding(&self) -> bool {
        !self.raw_name.is_ascii() && !self.is_utf8 && unicode_path(self.raw_name, self.extra).is_none()
    }

    /// Returns whether it is a folder. Old programs for Windows write backslashes.
    pub fn is_folder(&self) -> bool {
        self.raw_name.ends_with(b"/") || self.raw_name.ends_with(b"\\")
    }

    /// Returns its data in the archive.
    ///
    /// # Errors
    /// If the data is missing, encrypted or compressed by another method than Deflate.
    pub fn data<'f>(&self, file: &'f [u8]) -> Result<Data<'f>, String> {
        let found = match self.method {
            _ if self.is_encrypted => "encrypted data",
            STORED => return self.packed(file).map(Data::Stored),
            DEFLATED => return self.packed(file).map(Data::Deflated),
            9 => "Deflate64",
            12 => "bzip2",
            14 => "LZMA",
            93 => "Zstandard",
            95 => "XZ",
            98 => "PPMd",
            method => &format!("compression method {method}"),
        };
        Err(format!("expected stored or deflated data, found {found}{ELSEWHERE}"))
    }

    fn packed<'f>(&self, file: &'f [u8]) -> Result<&'f [u8], String> {
        let (offset, bytes) = (self.offset, self.packed_bytes);
        let find = || {
            let own = file.get(usize::try_from(offset).ok()?..).filter(|own| own.starts_with(MEMBER))?;
            let start = MEMBER_BYTES + usize::from(u16_at(own, 26)?) + usize::from(u16_at(own, 28)?);
            own.get(start..)?.get(..usize::try_from(bytes).ok()?)
        };
        find().ok_or_else(|| {
            format!("expected {bytes} bytes of data at byte {offset} of the archive, found no such data{AGAIN}")
        })
    }

    /// Returns whether unpacked data has the size and the checksum that the directory lists.
    pub fn is_sound(&self, bytes: usize, crc: u32) -> bool {
        // A fuzzer can't be expected to get checksums right.
        bytes as u64 == self.bytes && (cfg!(fuzzing) || crc == self.crc)
    }

    /// Returns a message for data that can't be unpacked or isn't sound.
    pub fn damaged(&self) -> String {
        format!("expected {} bytes with checksum {:08x}, found other data{AGAIN}", self.bytes, self.crc)
    }
}

/// Returns where the end record with 64-bit numbers is, and these: members, bytes of the directory, and its start.
fn long_end(file: &[u8], end: usize) -> Option<(usize, [u64; 3])> {
    let locator = end.checked_sub(LOCATOR_BYTES)?;
    let listed = file[locator..].starts_with(LOCATOR).then(|| u64_at(file, locator + 8))??;
    // The first place is right if bytes precede the archive, the second one if data is appended to the record.
    let places = [locator.checked_sub(LONG_END_BYTES)? as u64, listed];
    let at = usize::try_from(places.into_iter().find(|&at| has(file, at, LONG_END))?).ok()?;
    Some((at, [u64_at(file, at + 32)?, u64_at(file, at + 40)?, u64_at(file, at + 48)?]))
}

/// Returns numbers, which are in an extra field if they don't fit into 32 bits.
fn long_numbers(short: [u32; 3], extra: &[u8]) -> Option<[u64; 3]> {
    let mut long = field(extra, ZIP64).unwrap_or_default();
    let mut numbers = short.map(u64::from);
    for number in numbers.iter_mut().filter(|number| **number == u64::from(IN_ZIP64)) {
        *number = u64_at(long, 0)?;
        long = &long[8..];
    }
    Some(numbers)
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

/// Returns the name in the extra field for it, unless a program renamed the file and left the field.
fn unicode_path<'a>(name: &[u8], extra: &'a [u8]) -> Option<Cow<'a, str>> {
    let field = field(extra, UNICODE_PATH)?;
    let path = field.get(5..).filter(|_| field[0] == 1 && u32_at(field, 1) == Some(checksum(name)))?;
    str::from_utf8(path).ok().map(Cow::Borrowed)
}

/// Returns the CRC-32 of a few bytes.
fn checksum(bytes: &[u8]) -> u32 {
    let bit = |crc: u32| (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg());
    !bytes.iter().fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| bit(crc)))
}

/// Decodes a name. The flag for UTF-8 is ignored, since many programs write UTF-8 without setting it.
fn decoded(name: &[u8]) -> Cow<'_, str> {
    let character = |&byte: &u8| match byte {
        0..128 => char::from(byte),
        _ => CP437.chars().nth(usize::from(byte - 128)).unwrap_or_default(),
    };
    str::from_utf8(name).map_or_else(|_| name.iter().map(character).collect(), Cow::Borrowed)
}

/// Returns whether `file` has `mark` at a place.
fn has(file: &[u8], at: u64, mark: &[u8]) -> bool {
    usize::try_from(at).ok().and_then(|at| file.get(at..)).is_some_and(|there| there.starts_with(mark))
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    bytes.get(at..)?.first_chunk().map(|word| u16::from_le_bytes(*word))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|word| u32::from_le_bytes(*word))
}

fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    bytes.get(at..)?.first_chunk().map(|word| u64::from_le_bytes(*word))
}
