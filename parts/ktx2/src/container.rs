//! The KTX 2.0 container: a header, an index of the mip levels, a data format descriptor and, for ETC1S, the data that
//! all levels share. Nothing in it is trusted.

use std::borrow::Cow;

use ruzstd::StreamingDecoder;
use ruzstd::io::Read;

use crate::texture::level_size;

/// Magic number at the start of a file.
pub const MAGIC: [u8; 12] = *b"\xABKTX 20\xBB\r\n\x1A\n";

/// Longest edge in pixels. The decoder would overflow beyond.
const MAX_EDGE: u32 = 16_384;

/// Offset of the level index, and the size of an entry in bytes.
const LEVELS: usize = 80;
const LEVEL: usize = 24;

/// Values of `supercompressionScheme`.
const NONE: u32 = 0;
const BASIS_LZ: u32 = 1;
const ZSTANDARD: u32 = 2;

/// Colour models of the data format descriptor.
const ETC1S: u32 = 163;
const UASTC: u32 = 166;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Codec {
    Etc1s,
    Uastc,
    /// Red, red and green, and so on: a byte for each.
    Plain {
        channels: usize,
    },
}

impl Codec {
    /// Vulkan's `R8`, `R8G8`, `R8G8B8` and `R8G8B8A8`, each `_UNORM` and `_SRGB`: the material decides which colour space applies.
    fn plain(format: u32) -> Option<Self> {
        let channels = match format {
            9 | 15 => 1,
            16 | 22 => 2,
            23 | 29 => 3,
            37 | 43 => 4,
            _ => return None,
        };
        Some(Self::Plain { channels })
    }
}

#[derive(Debug)]
pub struct Container<'a> {
    pub size: [u32; 2],
    pub codec: Codec,
    /// Only for ETC1S.
    pub has_alpha: bool,
    /// Whether the levels are compressed once more, with Zstandard.
    pub is_packed: bool,
    /// From the largest; at least one.
    pub levels: Vec<&'a [u8]>,
    /// Data shared by all levels of ETC1S.
    pub global: &'a [u8],
}

fn word(file: &[u8], at: usize) -> Result<u32, String> {
    let bytes = file.get(at..).and_then(|rest| rest.first_chunk());
    bytes.map(|bytes| u32::from_le_bytes(*bytes)).ok_or_else(|| format!("it ends after {} bytes", file.len()))
}

/// Returns the bytes that two 64-bit numbers, an offset and a length, refer to.
fn section(file: &[u8], at: usize) -> Result<&[u8], String> {
    let number = |at| Ok::<_, String>(u64::from(word(file, at)?) | u64::from(word(file, at + 4)?) << 32);
    let (start, length) = (number(at)?, number(at + 8)?);
    let range = usize::try_from(start).ok().zip(start.checked_add(length).and_then(|end| usize::try_from(end).ok()));
    let bytes = range.and_then(|(start, end)| file.get(start..end));
    bytes.ok_or_else(|| format!("it refers to {length} bytes at {start} and has {}", file.len()))
}

/// Returns the width and height of an image in pixels, without reading more than the header.
///
/// # Errors
/// If it is another kind of image than the decoder reads.
pub fn size(file: &[u8]) -> Result<[u32; 2], String> {
    if !file.starts_with(&MAGIC) {
        return Err("it is not a KTX2 file".to_owned());
    }
    let [format, width, height, depth] = [word(file, 12)?, word(file, 20)?, word(file, 24)?, word(file, 28)?];
    if format != 0 && Codec::plain(format).is_none() {
        let expected = "expected ETC1S, UASTC, or 8 bits for each of 1 to 4 channels";
        return Err(format!("its texels are of Vulkan's format {format}; {expected}"));
    }
    let [layers, faces] = [word(file, 32)?, word(file, 36)?];
    if depth > 0 || layers > 1 || faces != 1 {
        return Err("it is not a single 2D image".to_owned());
    }
    if [width, height].into_iter().any(|edge| edge == 0 || edge > MAX_EDGE) {
        return Err(format!("it has {width} × {height} pixels; expected 1 to {MAX_EDGE} each way"));
    }
    Ok([width, height])
}

impl<'a> Container<'a> {
    pub fn read(file: &'a [u8]) -> Result<Self, String> {
        let size = size(file)?;
        let plain = Codec::plain(word(file, 12)?);
        // 0 asks the reader to generate mip levels from the one that is there.
        let count = (word(file, 40)? as usize).max(usize::from(plain.is_some()));
        let max_levels = size[0].max(size[1]).ilog2() as usize + 1;
        if count == 0 || count > max_levels {
            return Err(format!("it has {count} mip levels; expected 1 to {max_levels}"));
        }
        let description = word(file, 48)? as usize;
        let model = word(file, description.saturating_add(12))? & 0xFF;
        let scheme = word(file, 44)?;
        let codec = match (plain, model, scheme) {
            (Some(plain), _, NONE | ZSTANDARD) => plain,
            (None, ETC1S, BASIS_LZ) => Codec::Etc1s,
            (None, UASTC, NONE | ZSTANDARD) => Codec::Uastc,
            _ => {
                let expected = "expected BasisLZ for ETC1S, Zstandard or nothing for others";
                return Err(format!("its texels are of model {model}, compressed with scheme {scheme}; {expected}"));
            }
        };
        // 24 bytes of the block are before its samples, of 16 bytes each.
        let samples = ((word(file, description + 8)? >> 16).saturating_sub(24)) / 16;
        Ok(Self {
            size,
            codec,
            has_alpha: codec == Codec::Etc1s && samples > 1,
            is_packed: scheme == ZSTANDARD,
            levels: (0..count).map(|level| section(file, LEVELS + LEVEL * level)).collect::<Result<_, _>>()?,
            global: if codec == Codec::Etc1s { section(file, 64)? } else { &[] },
        })
    }

    /// Returns the first `length` bytes of a level, decompressed. `None` if it has fewer.
    pub fn unpacked(&self, level: usize, length: usize) -> Option<Cow<'a, [u8]>> {
        let bytes = self.levels[level];
        if !self.is_packed {
            return bytes.get(..length).map(Cow::Borrowed);
        }
        let mut unpacked = vec![0; length];
        StreamingDecoder::new(bytes).ok()?.read_exact(&mut unpacked).ok()?;
        Some(Cow::Owned(unpacked))
    }

    pub fn level_size(&self, level: usize) -> [u32; 2] {
        level_size(self.size, level as u32)
    }

    /// Blocks of 4 × 4 texels.
    pub fn level_blocks(&self, level: usize) -> [u32; 2] {
        self.level_size(level).map(|edge| edge.div_ceil(4))
    }
}
