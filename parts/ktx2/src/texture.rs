//! The transcoder's input and output as bytes. All numbers are 32-bit, little-endian.

use gaitway_part::words;

/// How one texel, or one block of 4 × 4, is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Red, green, blue and alpha bytes.
    Rgba8,
    /// Blocks of 16 bytes.
    Bc7,
    /// Blocks of 8 bytes; opaque.
    Etc2Rgb,
    /// Blocks of 16 bytes.
    Etc2Rgba,
    /// Blocks of 16 bytes.
    Astc4x4,
}

/// What a device can sample besides RGBA, as bits.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Formats(pub u32);

/// An image with its mip levels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Texture {
    /// Of all levels.
    pub format: Format,
    /// Of the first level, in pixels.
    pub width: u32,
    /// Of the first level, in pixels.
    pub height: u32,
    /// Number of levels in `data`, each half as large as the one before.
    pub levels: u32,
    /// The levels, one after the other, from the largest.
    pub data: Vec<u8>,
}

impl Format {
    const ALL: [Self; 5] = [Self::Rgba8, Self::Bc7, Self::Etc2Rgb, Self::Etc2Rgba, Self::Astc4x4];

    /// Bytes of a row of texels or blocks, and the number of rows.
    pub fn layout(self, [width, height]: [u32; 2]) -> (u32, u32) {
        match self {
            Self::Rgba8 => (4 * width, height),
            Self::Etc2Rgb => (8 * width.div_ceil(4), height.div_ceil(4)),
            Self::Bc7 | Self::Etc2Rgba | Self::Astc4x4 => (16 * width.div_ceil(4), height.div_ceil(4)),
        }
    }

    /// Bytes of an image of this size.
    pub fn byte_count(self, size: [u32; 2]) -> usize {
        let (row, rows) = self.layout(size);
        row as usize * rows as usize
    }
}

impl Formats {
    /// BC7.
    pub const BC7: Self = Self(1);
    /// ETC2, with and without alpha.
    pub const ETC2: Self = Self(2);
    /// ASTC with blocks of 4 × 4 texels.
    pub const ASTC: Self = Self(4);

    /// Whether all of `others` are among these.
    pub fn contains(self, others: Self) -> bool {
        self.0 & others.0 == others.0
    }
}

/// Size of a mip level.
pub fn level_size([width, height]: [u32; 2], level: u32) -> [u32; 2] {
    [width, height].map(|edge| edge.checked_shr(level).unwrap_or(0).max(1))
}

/// Writes the input of [`decode`](crate::decode): a KTX2 file, what the device can sample, and its longest edge in pixels.
pub fn request(formats: Formats, largest_edge: u32, file: &[u8]) -> Vec<u8> {
    [&formats.0.to_le_bytes()[..], &largest_edge.to_le_bytes(), file].concat()
}

/// Reads what [`request`] wrote.
pub fn read_request(mut input: &[u8]) -> Option<(Formats, u32, &[u8])> {
    let [formats, largest_edge] = words(&mut input)?;
    Some((Formats(formats), largest_edge, input))
}

impl Texture {
    /// Returns each level's size and bytes.
    pub fn levels(&self) -> impl Iterator<Item = ([u32; 2], &[u8])> {
        let mut rest = &self.data[..];
        (0..self.levels).map_while(move |level| {
            let size = level_size([self.width, self.height], level);
            Some((size, rest.split_off(..self.format.byte_count(size))?))
        })
    }

    /// Makes an RGBA image half as large. The other levels are lost.
    pub(crate) fn halve(&mut self) {
        let [old_width, old_height] = [self.width, self.height].map(|edge| edge as usize);
        let [width, height] = level_size([self.width, self.height], 1);
        let mut data = Vec::with_capacity(Format::Rgba8.byte_count([width, height]));
        for y in 0..height as usize {
            for x in 0..width as usize {
                let corners = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(right, down)| {
                    (2 * y + down).min(old_height - 1) * old_width + (2 * x + right).min(old_width - 1)
                });
                let sum = |channel: usize| corners.iter().map(|at| u32::from(self.data[4 * at + channel])).sum::<u32>();
                data.extend((0..4).map(|channel| ((sum(channel) + 2) / 4) as u8));
            }
        }
        *self = Self { format: Format::Rgba8, width, height, levels: 1, data };
    }

    /// Writes the output of [`decode`](crate::decode).
    pub(crate) fn write(&self) -> Vec<u8> {
        let numbers = [self.format as u32, self.width, self.height, self.levels];
        let mut output: Vec<u8> = numbers.into_iter().flat_map(u32::to_le_bytes).collect();
        output.extend(&self.data);
        output
    }

    /// Reads what [`decode`](crate::decode) returned. `None` if it is something else.
    pub fn read(mut output: &[u8]) -> Option<Self> {
        let mut next = || words(&mut output).map(|[word]| word);
        let format = *Format::ALL.get(next()? as usize)?;
        let [width, height, levels] = [next()?, next()?, next()?];
        let texture = Self { format, width, height, levels, data: output.to_vec() };
        let is_complete = texture.levels().count() == levels as usize && levels > 0;
        is_complete.then_some(texture)
    }
}
