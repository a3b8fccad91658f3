//! Aligns the horizontal edges of letters with pixel rows, so that small text is sharp.
//!
//! Letters end at a few common heights: the baseline, the height of "x", of "H", of "l", and below the baseline. FreeType's
//! automatic hinter calls them blue zones, with a flat and a round height each, since round letters overshoot
//! (<https://freetype.org/autohinting/hinter.html>). Here a zone moves to a whole row, the stroke that ends there becomes a whole
//! number of rows thick, and everything between is stretched. Strokes that end elsewhere, such as the bar of "e", stay as they are.

use crate::glyf::Point;

/// The zones of a font, in font units. A font without Latin letters has none.
#[derive(Debug, Clone)]
pub struct Zones {
    zones: Vec<Zone>,
    /// The thickness of a horizontal stroke.
    stroke: f32,
}

/// A height at which letters end.
#[derive(Debug, Clone, Copy)]
struct Zone {
    flat: f32,
    round: f32,
    /// Whether letters end there at the top.
    is_top: bool,
}

/// The letters that show the zones from the bottom up: flat, round, and whether at the top.
const EXAMPLES: [(char, char, bool); 5] =
    [('p', 'g', false), ('H', 'O', false), ('x', 'o', true), ('H', 'O', true), ('l', 'f', true)];

impl Zones {
    /// `extent` returns the lowest and the highest point of a letter.
    pub fn new(extent: impl Fn(char) -> Option<[f32; 2]>) -> Self {
        let stroke = extent('-').map_or(0.0, |[bottom, top]| top - bottom);
        let zone = |(flat, round, is_top): (char, char, bool)| {
            let [flat, round] = [extent(flat)?[usize::from(is_top)], extent(round)?[usize::from(is_top)]];
            // If the letters are of another design, only the flat height counts.
            let round = if (round - flat).abs() < stroke { round } else { flat };
            Some(Zone { flat, round, is_top })
        };
        Self { zones: EXAMPLES.into_iter().filter_map(zone).collect(), stroke }
    }

    /// Scales the heights of points to pixels and aligns them.
    pub fn align(&self, scale: f32, points: &mut [Point]) {
        let mut anchors: Vec<[f32; 2]> = Vec::new();
        for zone in self.zones.iter().filter(|zone| points.iter().any(|point| zone.contains(point.y))) {
            let next = zone.anchors(scale, self.stroke);
            // If zones are too close to each other for their strokes, the lower one wins.
            if anchors.last().is_none_or(|last| last[0] < next[0][0] && last[1] <= next[0][1]) {
                anchors.extend(next);
            }
        }
        points.iter_mut().for_each(|point| point.y = aligned(point.y, scale, &anchors));
    }
}

impl Zone {
    fn contains(&self, height: f32) -> bool {
        (self.flat.min(self.round)..=self.flat.max(self.round)).contains(&height)
    }

    /// Returns heights in font units and their positions in pixels: both ends of the zone, and the other edge of its
    /// stroke.
    fn anchors(&self, scale: f32, stroke: f32) -> [[f32; 2]; 3] {
        let row = (self.flat * scale).round();
        let overshoot = ((self.round - self.flat) * scale).round();
        let rows = (stroke * scale).round().max(1.0);
        let ends = [[self.flat, row], [self.round, row + overshoot]];
        if self.is_top {
            [[self.flat - stroke, row - rows], ends[0], ends[1]]
        } else {
            [ends[1], ends[0], [self.flat + stroke, row + rows]]
        }
    }
}

/// Interpolates between the anchors around a height. Beyond them, heights are scaled and shifted.
fn aligned(height: f32, scale: f32, anchors: &[[f32; 2]]) -> f32 {
    let above = anchors.partition_point(|anchor| anchor[0] < height);
    match (above.checked_sub(1).map(|below| anchors[below]), anchors.get(above)) {
        (Some(below), Some(above)) => below[1] + (height - below[0]) * (above[1] - below[1]) / (above[0] - below[0]),
        (Some(anchor), None) | (None, Some(&anchor)) => anchor[1] + (height - anchor[0]) * scale,
        (None, None) => height * scale,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::charmap::Charmap;
    use crate::glyf::Outlines;
    use crate::{FontRef, GlyphId};

    #[test]
    fn heights_keep_their_order_and_move_by_less_than_a_row() {
        let bytes = include_bytes!("../../../../assets/font/Ubuntu-Light-derivative-Gaitway.ttf");
        let font = FontRef::new(bytes).unwrap();
        let outlines = Outlines::new(&font).unwrap();
        let charmap = Charmap::new(&font);
        let zones = Zones::new(|letter| outlines.extent(charmap.map(letter)?));
        assert_eq!(zones.zones.len(), EXAMPLES.len());
        for (character, glyph) in charmap.mappings() {
            for scale in [8.0, 12.0, 14.0, 17.5, 28.0, 56.0].map(|size| size / 1000.0) {
                check(&zones, &outlines, glyph, scale, &format!("U+{character:04X} at {scale}"));
            }
        }
    }

    fn check(zones: &Zones, outlines: &Outlines<'_>, glyph: GlyphId, scale: f32, name: &str) {
        let designed = outlines.outline(glyph).unwrap().points;
        let mut hinted = designed.clone();
        zones.align(scale, &mut hinted);
        let mut heights: Vec<[f32; 2]> = designed.iter().zip(&hinted).map(|(from, to)| [from.y, to.y]).collect();
        heights.sort_by(|a, b| a[0].total_cmp(&b[0]));
        assert!(heights.is_sorted_by(|a, b| a[1] <= b[1] + 1e-4), "{name}: {heights:?}");
        assert!(heights.iter().all(|[from, to]| (to - from * scale).abs() < 1.0), "{name}: {heights:?}");
    }
}
