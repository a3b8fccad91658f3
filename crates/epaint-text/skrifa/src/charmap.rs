//! Characters and their glyphs.

use read_fonts::tables::cmap::{Cmap4, CmapSubtable};
use read_fonts::{FontRef, TableProvider};

use crate::GlyphId;

/// The glyphs of characters: the font's best `cmap` subtable, if that is of format 4 (the basic multilingual plane).
#[derive(Clone, Default)]
pub struct Charmap<'a>(Option<Cmap4<'a>>);

impl<'a> Charmap<'a> {
    pub(crate) fn new(font: &FontRef<'a>) -> Self {
        match font.cmap().ok().and_then(|cmap| cmap.best_subtable()) {
            Some((_, _, CmapSubtable::Format4(subtable))) => Self(Some(subtable)),
            _ => Self(None),
        }
    }

    /// Returns the glyph of a character if the font has one.
    pub fn map(&self, character: impl Into<u32>) -> Option<GlyphId> {
        self.0.as_ref()?.map_codepoint(character)
    }

    /// Iterates over all characters and their glyphs.
    pub fn mappings(&self) -> impl Iterator<Item = (u32, GlyphId)> + 'a {
        self.0.iter().flat_map(Cmap4::iter).collect::<Vec<_>>().into_iter()
    }
}

impl std::fmt::Debug for Charmap<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Charmap").finish_non_exhaustive()
    }
}
