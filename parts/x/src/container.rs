//! The header, and the unpacked data after it.

use std::borrow::Cow;

use miniz_oxide::inflate::TINFLStatus;
use miniz_oxide::inflate::core::{DecompressorOxide, decompress, inflate_flags};

use crate::{damaged, too_large};

/// Maximum size of a file, as read and unpacked.
const MAX_BYTES: usize = 1 << 28;
const HEADER: usize = 16;

/// How the objects are written.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    Text,
    Binary {
        /// Bytes of a float.
        float: usize,
    },
}

/// The data after the header.
pub struct Contents<'a> {
    pub encoding: Encoding,
    pub bytes: Cow<'a, [u8]>,
    is_packed: bool,
}

/// Reads the header and unpacks the rest.
pub fn open(file: &[u8]) -> Result<Contents<'_>, String> {
    if file.len() > MAX_BYTES {
        return Err(too_large(MAX_BYTES, "bytes", file.len()));
    }
    let wrong = |what: &str, found: &[u8]| {
        let found = if found.is_empty() { "nothing".to_owned() } else { format!("\"{}\"", found.escape_ascii()) };
        Err(format!("not a .x file that can be read: expected {what}, found {found}. Export it again."))
    };
    let Some((head, body)) = file.split_first_chunk::<HEADER>() else {
        return wrong("a header of 16 bytes, such as \"xof 0303txt 0032\"", file);
    };
    if !head.starts_with(b"xof ") {
        return wrong("\"xof \" at the beginning", &head[..4]);
    }
    if !head[4..].starts_with(b"03") {
        return wrong("version 03.02 or 03.03", &head[4..8]);
    }
    let float = match &head[12..] {
        b"0032" => 4,
        b"0064" => 8,
        found => return wrong("floats of \"0032\" or \"0064\" bits", found),
    };
    let (encoding, is_packed) = match &head[8..12] {
        b"txt " => (Encoding::Text, false),
        b"bin " => (Encoding::Binary { float }, false),
        b"tzip" => (Encoding::Text, true),
        b"bzip" => (Encoding::Binary { float }, true),
        found => return wrong("\"txt \", \"bin \", \"tzip\" or \"bzip\"", found),
    };
    let bytes = if is_packed { Cow::Owned(unpack(body)?) } else { Cow::Borrowed(body) };
    Ok(Contents { encoding, bytes, is_packed })
}

impl Contents<'_> {
    /// Describes where something starts, for messages.
    pub fn place(&self, at: usize) -> String {
        self.name(self.place_after((0, self.first()), at))
    }

    /// Returns the number of a place, as [`Self::name`] has it: lines in text, else bytes. `before` is an earlier place with its
    /// number.
    pub fn place_after(&self, before: (usize, usize), at: usize) -> usize {
        let (start, number) = before;
        let between = self.bytes.get(start..at).unwrap_or_default();
        match self.encoding {
            Encoding::Text => number + between.iter().filter(|&&byte| byte == b'\n').count(),
            Encoding::Binary { .. } => number + between.len(),
        }
    }

    /// Returns the number of the first place after the header.
    pub fn first(&self) -> usize {
        // The header is on the first line.
        if self.encoding == Encoding::Text { 1 } else { HEADER }
    }

    /// Describes a place with a number.
    pub fn name(&self, place: usize) -> String {
        match self.encoding {
            Encoding::Text => format!("line {place}"),
            Encoding::Binary { .. } if self.is_packed => format!("byte {place} (unpacked)"),
            Encoding::Binary { .. } => format!("byte {place}"),
        }
    }
}

fn unpack(body: &[u8]) -> Result<Vec<u8>, String> {
    let Some((total, mut rest)) = body.split_first_chunk() else {
        return Err(damaged("byte 16", "the unpacked size", "the end of the file"));
    };
    let total = u32::from_le_bytes(*total) as usize;
    let mut out = Vec::new();
    let mut inflater = DecompressorOxide::new();
    // Some exporters pad the file after the last block.
    while !rest.is_empty() && (total == 0 || out.len() + HEADER < total) {
        let at = format!("byte {}", HEADER + body.len() - rest.len());
        let cut = || damaged(&at, "a compressed block", "the end of the file");
        let sizes = rest.split_off(..4).ok_or_else(cut)?;
        let [unpacked, packed] = [0, 2].map(|at| usize::from(u16::from_le_bytes([sizes[at], sizes[at + 1]])));
        let block = rest.split_off(..packed).ok_or_else(cut)?;
        let Some(stream) = block.strip_prefix(b"CK") else {
            return Err(damaged(&at, "a compressed block that begins with \"CK\"", "other bytes"));
        };
        let start = out.len();
        if start + unpacked > MAX_BYTES {
            return Err(too_large(MAX_BYTES, "bytes unpacked", start + unpacked));
        }
        out.resize(start + unpacked, 0);
        inflater.init();
        let flags = inflate_flags::TINFL_FLAG_USING_NON_WRAPPING_OUTPUT_BUF;
        // The blocks before are in the same buffer, so that back-references find them.
        let (status, _, written) = decompress(&mut inflater, stream, &mut out, start, flags);
        if status != TINFLStatus::Done || written != unpacked {
            return Err(damaged(
                &at,
                &format!("a block of {unpacked} bytes"),
                &format!("only {written} that can be unpacked"),
            ));
        }
    }
    // Counted with the header.
    if out.len() + HEADER < total {
        let found = format!("{} (is the file cut short?)", out.len() + HEADER);
        return Err(damaged("its end", &format!("{total} bytes unpacked"), &found));
    }
    Ok(out)
}
