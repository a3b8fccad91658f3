//! Outlines of glyphs, scaled to pixels and, if hinted, aligned with pixel rows.

use read_fonts::FontRef;
use read_fonts::ReadError;

use crate::GlyphId;
use crate::alignment::Zones;
use crate::charmap::Charmap;
use crate::glyf::Outlines;
use crate::instance::{LocationRef, Size};
use crate::metrics::units_per_em;

pub use read_fonts::model::pen::OutlinePen;

/// The outlines of a font.
#[derive(Clone)]
pub struct OutlineGlyphCollection<'a> {
    outlines: Option<Outlines<'a>>,
    zones: Zones,
    units_per_em: u16,
}

impl<'a> OutlineGlyphCollection<'a> {
    pub(crate) fn new(font: &FontRef<'a>) -> Self {
        let outlines = Outlines::new(font).ok();
        let charmap = Charmap::new(font);
        let extent = |letter: char| outlines.as_ref()?.extent(charmap.map(letter)?);
        Self { zones: Zones::new(extent), outlines, units_per_em: units_per_em(font) }
    }

    /// Returns a glyph if the font has outlines.
    pub fn get(&self, glyph: GlyphId) -> Option<OutlineGlyph<'_>> {
        let outlines = self.outlines.as_ref()?;
        Some(OutlineGlyph { outlines, zones: &self.zones, units_per_em: self.units_per_em, glyph })
    }
}

impl std::fmt::Debug for OutlineGlyphCollection<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("OutlineGlyphCollection").field("zones", &self.zones).finish_non_exhaustive()
    }
}

/// A glyph that can be drawn.
pub struct OutlineGlyph<'a> {
    outlines: &'a Outlines<'a>,
    zones: &'a Zones,
    units_per_em: u16,
    glyph: GlyphId,
}

impl std::fmt::Debug for OutlineGlyph<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("OutlineGlyph").field("glyph", &self.glyph).finish_non_exhaustive()
    }
}

impl OutlineGlyph<'_> {
    /// Draws the glyph in pixels, up positive, with its origin at zero.
    pub fn draw(&self, settings: DrawSettings, pen: &mut impl OutlinePen) -> Result<(), ReadError> {
        let mut outline = self.outlines.outline(self.glyph)?;
        let scale = settings.size.scale(self.units_per_em);
        if settings.is_hinted {
            self.zones.align(scale, &mut outline.points);
        } else {
            outline.points.iter_mut().for_each(|point| point.y *= scale);
        }
        outline.points.iter_mut().for_each(|point| point.x *= scale);
        outline.draw(pen)
    }
}

/// How a glyph is drawn.
#[derive(Debug, Clone, Copy)]
pub struct DrawSettings {
    size: Size,
    is_hinted: bool,
}

impl DrawSettings {
    /// Aligned with pixel rows.
    pub fn hinted(instance: &HintingInstance, _is_pedantic: bool) -> Self {
        Self { size: instance.size, is_hinted: true }
    }

    /// As designed.
    pub fn unhinted(size: Size, _location: LocationRef<'_>) -> Self {
        Self { size, is_hinted: false }
    }
}

/// The size at which glyphs are hinted. There is nothing else to prepare.
#[derive(Debug, Clone)]
pub struct HintingInstance {
    size: Size,
    target: Target,
}

impl HintingInstance {
    /// For one size.
    pub fn new(
        _glyphs: &OutlineGlyphCollection<'_>,
        size: Size,
        _location: LocationRef<'_>,
        target: Target,
    ) -> Result<Self, ReadError> {
        Ok(Self { size, target })
    }

    /// Changes the size.
    pub fn reconfigure(
        &mut self,
        _glyphs: &OutlineGlyphCollection<'_>,
        size: Size,
        _location: LocationRef<'_>,
        target: Target,
    ) -> Result<(), ReadError> {
        *self = Self { size, target };
        Ok(())
    }

    /// The size.
    pub fn size(&self) -> Size {
        self.size
    }

    /// The only location there is.
    pub fn location(&self) -> LocationRef<'_> {
        LocationRef::default()
    }

    /// As given. It changes nothing.
    pub fn target(&self) -> Target {
        self.target
    }
}

/// The target of hinting. It changes nothing: glyphs are aligned only vertically.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// Pixels that are on or off.
    Mono,
    /// Antialiased pixels.
    Smooth {
        /// The strength.
        mode: SmoothMode,
        /// Whether a glyph looks the same wherever it lies in a pixel.
        symmetric_rendering: bool,
        /// Whether advances stay as they are.
        preserve_linear_metrics: bool,
    },
}

impl Default for Target {
    fn default() -> Self {
        Self::Smooth { mode: SmoothMode::Normal, symmetric_rendering: true, preserve_linear_metrics: false }
    }
}

/// The strength of antialiased hinting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SmoothMode {
    /// In both directions.
    Normal,
    /// Vertically.
    Light,
}
