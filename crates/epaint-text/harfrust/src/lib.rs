//! Turns text into positioned glyphs for epaint 0.37.0, in place of `harfrust` 0.12.0 (see `[patch.crates-io]` in the
//! workspace's Cargo.toml).
//!
//! `harfrust` shapes every script there is. This crate has the part of its interface that epaint uses and does what Latin, Greek
//! and Cyrillic in one font need: a glyph for each character (`cmap`), its advance (`hmtx`, `HVAR`), pair kerning (`GPOS`),
//! letters and accents joined into one character (macOS writes file names that way), no width for invisible characters, and
//! spaces of all widths. Texts are as wide as with `harfrust`; tests/ui/text_widths.rs holds that.
//!
//! Left out, because the interface's font has nothing of the kind: substitutions and ligatures (`GSUB`), marks positioned by
//! anchors, right-to-left and complex scripts, the legacy `kern` table, and features on request. All kerning lookups apply to any
//! script. A font for Arabic or Indic scripts would need the original crate again.

#![forbid(unsafe_code)]

mod buffer;
mod characters;
mod kerning;

use skrifa::charmap::Charmap;
use skrifa::instance::{Location, LocationRef, Size};
use skrifa::raw::TableProvider;
use skrifa::{FontRef, MetadataProvider, Tag};

pub use buffer::{BufferFlags, GlyphBuffer, GlyphInfo, GlyphPosition, UnicodeBuffer};

/// What is looked up once per font: its kerning lookups.
#[derive(Debug, Clone)]
pub struct ShaperData {
    kerning: Vec<u16>,
}

impl ShaperData {
    /// Finds the kerning of a font.
    pub fn new(font: &FontRef<'_>) -> Self {
        Self { kerning: kerning::lookups(font) }
    }

    /// Begins a shaper for the font given to [`Self::new`].
    pub fn shaper<'a>(&'a self, font: &FontRef<'a>) -> ShaperBuilder<'a> {
        ShaperBuilder(Shaper { data: self, font: font.clone(), location: LocationRef::default() })
    }
}

/// The value of an axis of a variable font.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Variation {
    /// The axis.
    pub tag: Tag,
    /// In the axis' own units.
    pub value: f32,
}

/// A location in the design space of a variable font.
#[derive(Debug, Clone)]
pub struct ShaperInstance(Location);

impl ShaperInstance {
    /// Sets the given axes; the others keep their defaults.
    pub fn from_variations(font: &FontRef<'_>, variations: impl IntoIterator<Item = Variation>) -> Self {
        Self(font.axes().location(variations.into_iter().map(|Variation { tag, value }| (tag, value))))
    }
}

/// Sets up a [`Shaper`].
#[derive(Debug)]
pub struct ShaperBuilder<'a>(Shaper<'a>);

impl<'a> ShaperBuilder<'a> {
    /// Sets the instance of a variable font.
    pub fn instance(mut self, instance: Option<&'a ShaperInstance>) -> Self {
        self.0.location = instance.map(|instance| LocationRef::from(&instance.0)).unwrap_or_default();
        self
    }

    /// Returns the shaper.
    pub fn build(self) -> Shaper<'a> {
        self.0
    }
}

/// Options of the original crate, none of which epaint uses.
#[derive(Debug, Default)]
pub struct ShapeOptions;

impl ShapeOptions {
    /// The defaults.
    pub fn new() -> Self {
        Self
    }
}

/// Shapes text with one font.
pub struct Shaper<'a> {
    data: &'a ShaperData,
    font: FontRef<'a>,
    location: LocationRef<'a>,
}

impl std::fmt::Debug for Shaper<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Shaper").field("data", &self.data).finish_non_exhaustive()
    }
}

impl Shaper<'_> {
    /// Replaces characters by positioned glyphs in the font's units. A character that the font lacks becomes glyph 0.
    pub fn shape(&self, buffer: UnicodeBuffer, _options: ShapeOptions) -> GlyphBuffer {
        let UnicodeBuffer { mut infos, mut positions } = buffer;
        let charmap = self.font.charmap();
        characters::compose(&mut infos, |character| charmap.map(character).is_some());
        let metrics = self.font.glyph_metrics(Size::unscaled(), self.location);
        for info in &mut infos {
            let blank = self.blank_width(info.glyph_id, &charmap);
            // A blank is drawn as a space, which means not at all.
            let glyph = charmap.map(if blank.is_some() { u32::from(' ') } else { info.glyph_id }).unwrap_or_default();
            info.glyph_id = glyph.to_u32();
            let advance = blank.or_else(|| metrics.advance_width(glyph)).unwrap_or_default();
            positions.push(GlyphPosition { x_advance: advance.round() as i32, ..GlyphPosition::default() });
        }
        kerning::apply(&self.font, &self.data.kerning, &infos, &mut positions);
        GlyphBuffer { infos, positions }
    }

    /// Returns the width of characters that leave a gap or nothing instead of their own glyph.
    fn blank_width(&self, character: u32, charmap: &Charmap<'_>) -> Option<f32> {
        if characters::is_ignorable(character) {
            return Some(0.0);
        }
        let width = characters::space_width(character).filter(|_| charmap.map(character).is_none())?;
        Some(width * f32::from(self.font.head().ok()?.units_per_em()))
    }
}
