//! Reads the directory of a zip archive: sections 4.3.7, 4.3.12 to 4.3.16, 4.5.3 and appendix D of PKWARE's APPNOTE.TXT.
//! Decompression is left to the caller, who has a decoder for other things. Archives that are split or encrypted, and methods
//! other than Deflate, are not read.
//!
//! The `zip` crate would take 16 KB of the page's download, and in wasm it depends on JavaScript, which a module without
//! imports can't call.

use std::borrow::Cow;

/// The archive ends with a record of this size and a comment of up to 65,535 bytes.
const END_BYTES: usize = 22;
const END: &[u8] = b"PK\x05\x06";
/// What precedes that record if its numbers don't fit, and the record with 64 bits that it leads to.
const LOCATOR_BYTES: usize = 20;
const LOCATOR: &[u8] = b"PK\x06\x07";
const LONG_END: &[u8] = b"PK\x06\x06";

const LISTED: &[u8] = b"PK\x01\x02";
const LISTED_BYTES: usize = 46;
const MEMBER: &[u8] = b"PK\x03\x04";
const MEMBER_BYTES: usize = 30;

/// Id of the extra field with numbers of 64 bits, and what stands in place of them.
const ZIP64: u16 = 1;
const IN_ZIP64: u32 = u32::MAX;

const ENCRYPTED: u16 = 1;
const STORED: u16 = 0;
const DEFLATED: u16 = 8;

/// Characters 128 to 255 of names that aren't UTF-8.
const CP437: &str = "ÇüéâäàåçêëèïîìÄÅÉæÆôöòûùÿÖÜ¢£¥₧ƒáíóúñÑªº¿⌐¬½¼¡«»░▒▓│┤╡╢╖╕╣║╗╝╜╛┐└┴┬├─┼╞╟╚╔╩╦╠═╬╧╨╤╥╙╘╒╓╫╪┘┌█▄▌▐▀\
    αßΓπΣσµτΦΘΩδ∞φε∩≡±≥≤⌠⌡÷≈°∙·√ⁿ²■\u{a0}";

/// How a file is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// As it is.
    Stored,
    /// Deflated.
    Deflated,
    /// In another way, by its number.
    Other(u16),
    /// Encrypted.
    Encrypted,
}

/// A file of an archive, as its directory lists it. A folder's name ends with a slash.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Member<'a> {
    /// Path inside the archive.
    pub name: Cow<'a, str>,
    /// How it is stored.
    pub method: Method,
    /// Size when unpacked.
    pub bytes: u64,
    /// Size in the archive.
    pub packed_bytes: u64,
    /// CRC-32 of its unpacked data.
    pub crc: u32,
    offset: u64,
}

impl Member<'_> {
    /// Returns its data in the archive; `None` if it isn't there.
    pub fn packed<'a>(&self, file: &'a [u8]) -> Option<&'a [u8]> {
        let own = file.get(usize::try_from(self.offset).ok()?..).filter(|own| own.starts_with(MEMBER))?;
        let start = MEMBER_BYTES + usize::from(u16_at(own, 26)?) + usize::from(u16_at(own, 28)?);
        own.get(start..start.checked_add(usize::try_from(self.packed_bytes).ok()?)?)
    }

    /// Whether its unpacked data has the size and the checksum that the directory lists.
    pub fn is_sound(&self, bytes: usize, crc: u32) -> bool {
        // A fuzzer can't be expected to get checksums right.
        bytes as u64 == self.bytes && (cfg!(fuzzing) || crc == self.crc)
    }
}

/// Reads the directory, of more than `max` members one more than that. `None` if it is missing or damaged.
pub fn members(file: &[u8], max: usize) -> Option<Vec<Member<'_>>> {
    let (count, start) = directory(file)?;
    let mut rest = file.get(usize::try_from(start).ok()?..)?;
    let mut members = Vec::new();
    for _ in 0..count.min(max as u64 + 1) {
        let lengths = [28, 30, 32].map(|at| u16_at(rest, at).map(usize::from));
        let ([Some(name), Some(extra), Some(comment)], true) = (lengths, rest.starts_with(LISTED)) else { return None };
        let (listed, after) = rest.split_at_checked(LISTED_BYTES + name + extra + comment)?;
        let (name, extra) = listed[LISTED_BYTES..].split_at(name);
        let short = [u32_at(listed, 24)?, u32_at(listed, 20)?, u32_at(listed, 42)?];
        let [bytes, packed_bytes, offset] = long_numbers(short, &extra[..extra.len() - comment])?;
        let method = match u16_at(listed, 10)? {
            _ if u16_at(listed, 8)? & ENCRYPTED != 0 => Method::Encrypted,
            STORED => Method::Stored,
            DEFLATED => Method::Deflated,
            other => Method::Other(other),
        };
        members.push(Member { name: decoded(name), method, bytes, packed_bytes, crc: u32_at(listed, 16)?, offset });
        rest = after;
    }
    Some(members)
}

/// Returns the number of members, and where the directory begins.
fn directory(file: &[u8]) -> Option<(u64, u64)> {
    let last = file.len().checked_sub(END_BYTES)?;
    let end = (last.saturating_sub(usize::from(u16::MAX))..=last).rev().find(|&at| file[at..].starts_with(END))?;
    let short = (u64::from(u16_at(file, end + 10)?), u64::from(u32_at(file, end + 16)?));
    let locator = end.checked_sub(LOCATOR_BYTES).and_then(|at| file.get(at..)).filter(|at| at.starts_with(LOCATOR));
    let Some(locator) = locator else { return Some(short) };
    let long = file.get(usize::try_from(u64_at(locator, 8)?).ok()?..).filter(|long| long.starts_with(LONG_END))?;
    Some((u64_at(long, 32)?, u64_at(long, 48)?))
}

/// Returns numbers, which are in an extra field if they don't fit into 32 bits.
fn long_numbers(short: [u32; 3], extra: &[u8]) -> Option<[u64; 3]> {
    let mut long = field(extra, ZIP64).unwrap_or_default();
    let mut numbers = short.map(u64::from);
    for (number, short) in numbers.iter_mut().zip(short) {
        if short == IN_ZIP64 {
            *number = u64_at(long, 0)?;
            long = &long[8..];
        }
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

/// Whatever an archive says about the encoding of its names: many are UTF-8 without a word about it.
fn decoded(name: &[u8]) -> Cow<'_, str> {
    let character = |&byte: &u8| match byte {
        0..128 => char::from(byte),
        _ => CP437.chars().nth(usize::from(byte - 128)).unwrap_or_default(),
    };
    str::from_utf8(name).map_or_else(|_| name.iter().map(character).collect(), Cow::Borrowed)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// An archive of one file, whose checksum is 7. Its numbers are where they are written if they don't fit, or not.
    fn archive(name: &[u8], is_long: bool) -> Vec<u8> {
        const CONTENTS: &[u8] = b"contents";
        let length = CONTENTS.len() as u32;
        let name_bytes = (name.len() as u16).to_le_bytes();
        let mut file = [MEMBER, &[0; 22], &name_bytes, &[0; 2], name, CONTENTS].concat();
        let start = file.len();
        let (short, offset) = if is_long { (IN_ZIP64, IN_ZIP64) } else { (length, 0) };
        let mut extra = vec![9, 0, 1, 0, 7];
        if is_long {
            let numbers = [u64::from(length), u64::from(length), 0].map(u64::to_le_bytes);
            extra.extend([&[1, 0, 24, 0], numbers.as_flattened()].concat());
        }
        let sizes = [7, short, short].map(u32::to_le_bytes);
        let lengths = [extra.len() as u16, 3].map(u16::to_le_bytes);
        file.extend([LISTED, &[0; 12], sizes.as_flattened(), &name_bytes, lengths.as_flattened(), &[0; 8]].concat());
        file.extend([&offset.to_le_bytes(), name, &extra, b"???"].concat());
        let mut end = (1, start as u32);
        if is_long {
            let numbers = [1, 1, 0, start as u64].map(u64::to_le_bytes);
            let record = [LONG_END, &44_u64.to_le_bytes(), &[0; 12], numbers.as_flattened()].concat();
            let locator = [LOCATOR, &[0; 4], &(file.len() as u64).to_le_bytes(), &[1, 0, 0, 0]].concat();
            file.extend([record, locator].concat());
            end = (u16::MAX, IN_ZIP64);
        }
        let (count, start) = (end.0.to_le_bytes(), end.1.to_le_bytes());
        file.extend([END, &[0; 4], &count, &count, &[0; 4], &start, b"\x07\0comment"].concat());
        file
    }

    #[test]
    fn numbers_have_32_or_64_bits_and_names_either_encoding() {
        for is_long in [false, true] {
            for name in ["ü/é".as_bytes(), b"\x81/\x82"] {
                let file = archive(name, is_long);
                let members = members(&file, 1).unwrap();
                let [member] = &members[..] else { panic!("{members:?}") };
                assert_eq!((&*member.name, member.method, member.bytes), ("ü/é", Method::Stored, 8));
                assert_eq!(member.packed(&file), Some(&b"contents"[..]));
                assert!(member.is_sound(8, 7) && !member.is_sound(8, 6) && !member.is_sound(7, 7));
            }
        }
        assert_eq!(CP437.chars().count(), 128);
    }

    #[test]
    fn what_is_cut_short_has_no_members() {
        for is_long in [false, true] {
            let file = archive(b"a", is_long);
            // The end of the comment isn't missed.
            for end in 0..file.len() - 7 {
                assert_eq!(members(&file[..end], 1), None, "{end}");
            }
            for start in 1..file.len() {
                let cut = &file[start..];
                let found = members(cut, 1).into_iter().flatten().find(|member| member.packed(cut).is_some());
                assert_eq!(found, None, "{start}");
            }
        }
    }
}
