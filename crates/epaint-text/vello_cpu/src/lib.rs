//! Draws the outlines of glyphs for epaint 0.37.0, in place of `vello_cpu` 0.2.0 (see `[patch.crates-io]` in the
//! workspace's Cargo.toml).
//!
//! epaint uses a complete 2D renderer to fill one white path at a time. This crate has just that part of its interface. A pixel
//! gets the exact area that the path covers: every edge adds its signed area to an accumulation buffer, and a running sum along
//! each row is the coverage, as in font-rs and stb_truetype. The absolute sum, limited to 1, is the non-zero winding rule except
//! in pixels where edges of overlapping contours meet.
//!
//! Left out because the interface has no use for it: colours, images, gradients, strokes, clips and layers, blending of several
//! fills, transforms other than a translation, and colour glyphs (epaint's feature `color_fonts` doesn't compile with this
//! crate). Paths are expected to lie within the picture; outside, they are clamped to its border.

#![forbid(unsafe_code)]

pub mod color;
pub mod kurbo;

mod coverage;

use coverage::Coverage;
use kurbo::{Affine, BezPath};

/// Draws paths in white.
#[derive(Debug)]
pub struct RenderContext {
    coverage: Coverage,
    transform: Affine,
}

impl RenderContext {
    /// Creates a context for a picture of this many pixels, without any path.
    pub fn new(width: u16, height: u16) -> Self {
        Self { coverage: Coverage::new(width.into(), height.into()), transform: Affine::default() }
    }

    /// Sets the translation of the paths that follow.
    pub fn set_transform(&mut self, transform: Affine) {
        self.transform = transform;
    }

    /// Does nothing: white is the only colour there is.
    pub fn set_paint(&mut self, _paint: color::OpaqueColor<color::Srgb>) {}

    /// Fills a path by the non-zero winding rule. Several paths count as one.
    pub fn fill_path(&mut self, path: &BezPath) {
        path.flatten(self.transform, |from, to| self.coverage.add_line(from, to));
    }

    /// Writes the picture, which must have the size given to [`RenderContext::new`].
    pub fn render(&self, target: &mut Pixmap, _resources: &mut Resources) {
        for (pixel, coverage) in target.rgba.as_chunks_mut::<4>().0.iter_mut().zip(self.coverage.pixels()) {
            *pixel = [coverage; 4];
        }
    }
}

/// A picture of premultiplied RGBA with 8 bits each, transparent at first.
#[derive(Debug)]
pub struct Pixmap {
    rgba: Vec<u8>,
}

impl Pixmap {
    /// Creates a transparent picture.
    pub fn new(width: u16, height: u16) -> Self {
        Self { rgba: vec![0; usize::from(width) * usize::from(height) * 4] }
    }

    /// Returns the pixels row by row from the top, four bytes each.
    pub fn data_as_u8_slice(&self) -> &[u8] {
        &self.rgba
    }
}

/// Caches of the original crate, which this one doesn't need.
#[derive(Debug, Default)]
pub struct Resources;

impl Resources {
    /// Creates nothing.
    pub fn new() -> Self {
        Self
    }
}
