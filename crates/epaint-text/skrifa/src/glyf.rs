//! Outlines of the `glyf` table: contours of quadratic curves, and glyphs composed of others.

use read_fonts::model::pen::OutlinePen;
use read_fonts::tables::glyf::{Anchor, Component, Glyf, Glyph};
use read_fonts::tables::loca::Loca;
use read_fonts::{FontRef, ReadError, TableProvider};

use crate::GlyphId;

/// Maximum nesting of composite glyphs, which could be endless in a damaged font.
const MAX_DEPTH: u32 = 6;

/// A point of a contour, in font units or pixels, up positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    pub x: f32,
    pub y: f32,
    /// A point off the curve controls a quadratic Bézier curve. Between two of them the curve passes through their middle.
    pub on_curve: bool,
}

impl Point {
    fn middle(self, other: Self) -> Self {
        Self { x: self.x.midpoint(other.x), y: self.y.midpoint(other.y), on_curve: true }
    }
}

/// An outline in font units.
#[derive(Debug, Default)]
pub struct Outline {
    pub points: Vec<Point>,
    /// For each contour the number of points up to its end.
    ends: Vec<usize>,
}

/// The tables with outlines.
#[derive(Clone)]
pub struct Outlines<'a> {
    loca: Loca<'a>,
    glyf: Glyf<'a>,
}

impl<'a> Outlines<'a> {
    pub fn new(font: &FontRef<'a>) -> Result<Self, ReadError> {
        Ok(Self { loca: font.loca(None)?, glyf: font.glyf()? })
    }

    /// Returns the lowest and the highest point of a glyph in font units, as its header says.
    pub fn extent(&self, glyph: GlyphId) -> Option<[f32; 2]> {
        let glyph = self.loca.get_glyf(glyph, &self.glyf).ok()??;
        Some([glyph.y_min(), glyph.y_max()].map(f32::from))
    }

    /// Returns the outline of a glyph, empty for a blank.
    pub fn outline(&self, glyph: GlyphId) -> Result<Outline, ReadError> {
        let mut outline = Outline::default();
        self.append(glyph, MAX_DEPTH, &mut outline)?;
        Ok(outline)
    }

    fn append(&self, glyph: GlyphId, depth: u32, outline: &mut Outline) -> Result<(), ReadError> {
        match self.loca.get_glyf(glyph, &self.glyf)? {
            None => {}
            Some(Glyph::Simple(glyph)) => {
                let first = outline.points.len();
                let point = |(x, y, on_curve): (i16, i16, bool)| Point { x: x.into(), y: y.into(), on_curve };
                outline.points.extend(glyph.points().map(|p| point((p.x, p.y, p.on_curve))));
                outline.ends.extend(glyph.end_pts_of_contours().iter().map(|end| first + usize::from(end.get()) + 1));
            }
            Some(Glyph::Composite(glyph)) => {
                let depth = depth.checked_sub(1).ok_or(ReadError::MalformedData("glyphs are composed too deeply"))?;
                for component in glyph.components() {
                    let first = outline.points.len();
                    self.append(component.glyph.into(), depth, outline)?;
                    outline.points[first..].iter_mut().for_each(|point| place(point, &component));
                }
            }
        }
        Ok(())
    }
}

fn place(point: &mut Point, component: &Component) {
    let offset = match component.anchor {
        Anchor::Offset { x, y } => [x, y],
        Anchor::Point { .. } => [0; 2],
    };
    let matrix = &component.transform;
    let [xx, yx, xy, yy] = [matrix.xx, matrix.yx, matrix.xy, matrix.yy].map(|element| element.to_f32());
    let Point { x, y, .. } = *point;
    point.x = xx * x + xy * y + f32::from(offset[0]);
    point.y = yx * x + yy * y + f32::from(offset[1]);
}

impl Outline {
    /// Hands the contours to a pen.
    pub fn draw(&self, pen: &mut impl OutlinePen) -> Result<(), ReadError> {
        let mut start = 0;
        for &end in &self.ends {
            let contour = self.points.get(start..end).ok_or(ReadError::MalformedData("contours out of order"))?;
            draw_contour(contour, pen);
            start = end;
        }
        Ok(())
    }
}

fn draw_contour(contour: &[Point], pen: &mut impl OutlinePen) {
    let (Some(&first), Some(&last)) = (contour.first(), contour.last()) else { return };
    let (start, rest) = match (first.on_curve, last.on_curve) {
        (true, _) => (first, &contour[1..]),
        (false, true) => (last, &contour[..contour.len() - 1]),
        (false, false) => (last.middle(first), contour),
    };
    pen.move_to(start.x, start.y);
    let mut control: Option<Point> = None;
    for &point in rest.iter().chain([&start]) {
        match (control, point.on_curve) {
            (None, true) => pen.line_to(point.x, point.y),
            (None, false) => control = Some(point),
            (Some(before), on_curve) => {
                let to = if on_curve { point } else { before.middle(point) };
                pen.quad_to(before.x, before.y, to.x, to.y);
                control = (!on_curve).then_some(point);
            }
        }
    }
    pen.close();
}
