//! Reads glyphs for epaint 0.37.0, in place of `skrifa` 0.44.0 (see `[patch.crates-io]` in the workspace's Cargo.toml).
//!
//! `skrifa` scales every kind of OpenType font and hints it by the font's own program or by analysis of its outlines. This crate
//! has the part of its interface that epaint and `harfrust` beside it use, over the same parser (`read-fonts`), and does what a
//! static TrueType font needs: characters (`cmap`), metrics (`head`, `hhea`, `OS/2`, `hmtx`) and outlines (`glyf`), whose
//! horizontal edges it aligns with pixel rows ([`outline`]).
//!
//! Left out, because the interface's fonts have nothing of the kind: PostScript outlines (`CFF`), variations, bitmaps and colour
//! layers, hinting programs, and components placed by points instead of offsets.

#![forbid(unsafe_code)]

mod alignment;
pub mod charmap;
mod glyf;
pub mod instance;
pub mod metrics;
pub mod outline;
mod variation;

use charmap::Charmap;
use instance::{LocationRef, Size};
use metrics::{GlyphMetrics, Metrics};
use outline::OutlineGlyphCollection;
use variation::{AxisCollection, LocalizedStrings, Never};

pub use raw::FontRef;
pub use raw::types::{GlyphId, Tag};
pub use read_fonts as raw;

/// What a font says about itself.
pub trait MetadataProvider<'a> {
    /// The axes of a variable font: none.
    fn axes(&self) -> AxisCollection;
    /// The names of an axis. There is no axis to call it with.
    fn localized_strings(&self, name: Never) -> LocalizedStrings;
    /// Metrics of the font as a whole, in pixels of the given size.
    fn metrics(&self, size: Size, location: impl Into<LocationRef<'a>>) -> Metrics;
    /// Metrics of its glyphs, in pixels of the given size.
    fn glyph_metrics(&self, size: Size, location: impl Into<LocationRef<'a>>) -> GlyphMetrics<'a>;
    /// The glyphs of its characters.
    fn charmap(&self) -> Charmap<'a>;
    /// The outlines of its glyphs.
    fn outline_glyphs(&self) -> OutlineGlyphCollection<'a>;
}

impl<'a> MetadataProvider<'a> for FontRef<'a> {
    fn axes(&self) -> AxisCollection {
        AxisCollection
    }

    fn localized_strings(&self, name: Never) -> LocalizedStrings {
        match name {}
    }

    fn metrics(&self, size: Size, _location: impl Into<LocationRef<'a>>) -> Metrics {
        Metrics::new(self, size)
    }

    fn glyph_metrics(&self, size: Size, _location: impl Into<LocationRef<'a>>) -> GlyphMetrics<'a> {
        GlyphMetrics::new(self, size)
    }

    fn charmap(&self) -> Charmap<'a> {
        Charmap::new(self)
    }

    fn outline_glyphs(&self) -> OutlineGlyphCollection<'a> {
        OutlineGlyphCollection::new(self)
    }
}
