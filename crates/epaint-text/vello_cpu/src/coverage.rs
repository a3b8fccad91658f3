//! The area that closed contours cover in each pixel, from one pass over their lines and one over the pixels.

use crate::kurbo::Point;

/// Differences of the signed coverage between each pixel and the one to its left. A line changes only the pixels it crosses and
/// the one after them in each row.
#[derive(Debug)]
pub struct Coverage {
    differences: Vec<f32>,
    width: usize,
    height: usize,
}

/// Cells after a row's pixels, changed by lines along the right border.
const MARGIN: usize = 2;

impl Coverage {
    pub fn new(width: usize, height: usize) -> Self {
        Self { differences: vec![0.0; (width + MARGIN) * height], width, height }
    }

    pub fn add_line(&mut self, from: Point, to: Point) {
        let (sign, top, bottom) = if from.y < to.y { (1.0, from, to) } else { (-1.0, to, from) };
        let slope = if top.y < bottom.y { (bottom.x - top.x) / (bottom.y - top.y) } else { return };
        let width = self.width as f64;
        // Casts saturate, so rows outside the picture are left out.
        let end = self.height.min(bottom.y.ceil() as usize);
        let start = end.min(top.y.floor() as usize);
        let stride = self.width + MARGIN;
        let rows = self.differences[start * stride..end * stride].chunks_exact_mut(stride);
        for (row, cells) in (start..end).zip(rows) {
            let (y0, y1) = (top.y.max(row as f64), bottom.y.min((row + 1) as f64));
            let x_at = |y: f64| ((y - top.y) * slope + top.x).clamp(0.0, width);
            add_in_row(cells, sign * (y1 - y0), x_at(y0), x_at(y1));
        }
    }

    /// Returns the coverage of the pixels row by row; 255 is a fully covered pixel.
    pub fn pixels(&self) -> impl Iterator<Item = u8> {
        self.differences.chunks_exact(self.width + MARGIN).flat_map(|row| {
            let sums = row[..self.width].iter().scan(0.0, |sum, difference| {
                *sum += difference;
                Some(*sum)
            });
            sums.map(|sum: f32| (sum.abs().min(1.0) * 255.0).round() as u8)
        })
    }
}

/// Adds a line that crosses `height` of the row between two positions: all pixels to its right are covered by `height`, those it
/// passes by the part of their area that lies to its right.
fn add_in_row(cells: &mut [f32], height: f64, x0: f64, x1: f64) {
    let (left, right) = if x0 < x1 { (x0, x1) } else { (x1, x0) };
    let (first, end) = (left.floor() as usize, right.ceil() as usize);
    if end <= first + 1 {
        let beside = (left + right) * 0.5 - first as f64;
        cells[first] += (height * (1.0 - beside)) as f32;
        cells[first + 1] += (height * beside) as f32;
        return;
    }
    // Area to the right of the line and to the left of x, per unit of height.
    let area = |x: f64| match x {
        x if x <= left => 0.0,
        x if x < right => (x - left) * (x - left) / (2.0 * (right - left)),
        x => x - (left + right) * 0.5,
    };
    let (mut area_before, mut covered_before) = (0.0, 0.0);
    for (index, cell) in cells.iter_mut().enumerate().take(end + 1).skip(first) {
        let area_after = area((index + 1) as f64);
        let covered = area_after - area_before;
        *cell += (height * (covered - covered_before)) as f32;
        (area_before, covered_before) = (area_after, covered);
    }
}
