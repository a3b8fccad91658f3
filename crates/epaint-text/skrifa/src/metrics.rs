//! Metrics of a font and of its glyphs.

use read_fonts::tables::hmtx::Hmtx;
use read_fonts::tables::os2::SelectionFlags;
use read_fonts::{FontRef, TableProvider};

use crate::GlyphId;
use crate::instance::Size;

/// Metrics of a font.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Metrics {
    /// Font units in an em.
    pub units_per_em: u16,
    /// From the baseline up to the top of a line.
    pub ascent: f32,
    /// From the baseline to the bottom of a line: negative.
    pub descent: f32,
    /// Between the bottom of a line and the top of the next.
    pub leading: f32,
}

impl Metrics {
    /// As FreeType does: the typographic metrics of `OS/2` if its flag `USE_TYPO_METRICS` is set, else those of `hhea`.
    pub(crate) fn new(font: &FontRef<'_>, size: Size) -> Self {
        let typographic = font.os2().ok().filter(|os2| os2.fs_selection().contains(SelectionFlags::USE_TYPO_METRICS));
        let line = match (typographic, font.hhea()) {
            (Some(os2), _) => [os2.s_typo_ascender(), os2.s_typo_descender(), os2.s_typo_line_gap()],
            (None, Ok(hhea)) => [hhea.ascender(), hhea.descender(), hhea.line_gap()].map(|distance| distance.to_i16()),
            (None, Err(_)) => [0; 3],
        };
        let units_per_em = units_per_em(font);
        let [ascent, descent, leading] = line.map(|units| f32::from(units) * size.scale(units_per_em));
        Self { units_per_em, ascent, descent, leading }
    }
}

pub(crate) fn units_per_em(font: &FontRef<'_>) -> u16 {
    font.head().map(|head| head.units_per_em()).unwrap_or_default()
}

/// Metrics of the glyphs of a font.
#[derive(Clone)]
pub struct GlyphMetrics<'a> {
    hmtx: Option<Hmtx<'a>>,
    scale: f32,
}

impl<'a> GlyphMetrics<'a> {
    pub(crate) fn new(font: &FontRef<'a>, size: Size) -> Self {
        Self { hmtx: font.hmtx().ok(), scale: size.scale(units_per_em(font)) }
    }

    /// Returns the distance to the origin of the next glyph.
    pub fn advance_width(&self, glyph: GlyphId) -> Option<f32> {
        Some(f32::from(self.hmtx.as_ref()?.advance(glyph)?) * self.scale)
    }
}

impl std::fmt::Debug for GlyphMetrics<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("GlyphMetrics").field("scale", &self.scale).finish_non_exhaustive()
    }
}
