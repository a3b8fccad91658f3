//! Text before shaping and glyphs after it, in the same allocations.

use std::ops::BitOrAssign;

/// Where a piece of text lies in its paragraph. Only unsupported scripts depend on it.
#[derive(Debug, Clone, Copy, Default)]
pub struct BufferFlags;

impl BufferFlags {
    /// The text begins a paragraph.
    pub const BEGINNING_OF_TEXT: Self = Self;
    /// The text ends a paragraph.
    pub const END_OF_TEXT: Self = Self;

    /// No flags.
    pub fn empty() -> Self {
        Self
    }
}

impl BitOrAssign for BufferFlags {
    fn bitor_assign(&mut self, _other: Self) {}
}

/// A glyph and the text it stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GlyphInfo {
    /// Number of the glyph in the font; before shaping, the character.
    pub glyph_id: u32,
    /// Offset of the first byte of the glyph's text.
    pub cluster: u32,
}

/// How far a glyph advances and where it is drawn, in the font's units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct GlyphPosition {
    /// To the origin of the next glyph.
    pub x_advance: i32,
    /// From the glyph's origin to where it is drawn, to the right.
    pub x_offset: i32,
    /// The same, up. Always 0.
    pub y_offset: i32,
}

/// Text to shape.
#[derive(Debug, Default)]
pub struct UnicodeBuffer {
    pub(crate) infos: Vec<GlyphInfo>,
    pub(crate) positions: Vec<GlyphPosition>,
}

impl UnicodeBuffer {
    /// Creates an empty buffer.
    pub fn new() -> Self {
        Self::default()
    }

    /// Does nothing, see [`BufferFlags`].
    pub fn set_flags(&mut self, _flags: BufferFlags) {}

    /// Appends the characters of a text.
    pub fn push_str(&mut self, text: &str) {
        let info =
            |(offset, character): (usize, char)| GlyphInfo { glyph_id: u32::from(character), cluster: offset as u32 };
        self.infos.extend(text.char_indices().map(info));
    }

    /// Does nothing: every text is shaped as Latin is.
    pub fn guess_segment_properties(&mut self) {}
}

/// Shaped text.
#[derive(Debug)]
pub struct GlyphBuffer {
    pub(crate) infos: Vec<GlyphInfo>,
    pub(crate) positions: Vec<GlyphPosition>,
}

impl GlyphBuffer {
    /// Returns the glyphs in the order of the text.
    pub fn glyph_infos(&self) -> &[GlyphInfo] {
        &self.infos
    }

    /// Returns one position for each glyph.
    pub fn glyph_positions(&self) -> &[GlyphPosition] {
        &self.positions
    }

    /// Returns an empty buffer with the same allocations.
    pub fn clear(self) -> UnicodeBuffer {
        let Self { mut infos, mut positions } = self;
        infos.clear();
        positions.clear();
        UnicodeBuffer { infos, positions }
    }
}
