//! Polygons cut into triangles: a fan where the polygon is convex, ear clipping where it is not.

use glam::{DVec2, DVec3};

/// Corners of a polygon that ears are looked for in; larger ones are cut as a fan.
const MOST_CLIPPED_CORNERS: usize = 1024;

/// Cuts polygons, within a bound on the work for all of a file together: clipping ears takes time by the cube of corners.
pub struct Cutter {
    steps_left: usize,
    flat: Vec<DVec2>,
    ring: Vec<usize>,
}

impl Default for Cutter {
    fn default() -> Self {
        Self { steps_left: 1 << 27, flat: Vec::new(), ring: Vec::new() }
    }
}

impl Cutter {
    /// Calls `triangle` with the positions in the list of each triangle's corners, in the polygon's own winding. A polygon
    /// without an area, or one that crosses itself, is cut in some way; corners − 2 triangles always come out.
    pub fn cut(&mut self, corners: &[DVec3], mut triangle: impl FnMut([usize; 3])) {
        let count = corners.len();
        if count > 3 && count <= MOST_CLIPPED_CORNERS {
            self.flatten(corners);
            if !is_convex(&self.flat) {
                return self.clip_ears(triangle);
            }
        }
        for second in 1..count.saturating_sub(1) {
            triangle([0, second, second + 1]);
        }
    }

    /// Seen along the polygon's normal (Newell's, which needs no three corners in general position), counter-clockwise.
    fn flatten(&mut self, corners: &[DVec3]) {
        let next = corners.iter().cycle().skip(1);
        let normal: DVec3 = corners.iter().zip(next).map(|(a, b)| (*a - corners[0]).cross(*b - corners[0])).sum();
        let normal = normal.normalize_or(DVec3::Z);
        let (x, y) = normal.any_orthonormal_pair();
        self.flat.clear();
        self.flat.extend(corners.iter().map(|corner| DVec2::new(x.dot(*corner), y.dot(*corner))));
    }

    fn clip_ears(&mut self, mut triangle: impl FnMut([usize; 3])) {
        let flat = &self.flat;
        let ring = &mut self.ring;
        ring.clear();
        ring.extend(0..flat.len());
        while ring.len() > 3 {
            let steps_left = &mut self.steps_left;
            let ear = (0..ring.len()).find(|&at| {
                *steps_left = steps_left.saturating_sub(ring.len());
                *steps_left > 0 && is_ear(flat, ring, at)
            });
            // Of a polygon that crosses itself something is cut off all the same.
            let at = ear.unwrap_or(0);
            triangle(around(ring, at));
            ring.remove(at);
        }
        if let [a, b, c] = ring[..] {
            triangle([a, b, c]);
        }
    }
}

fn around(ring: &[usize], at: usize) -> [usize; 3] {
    let count = ring.len();
    [ring[(at + count - 1) % count], ring[at], ring[(at + 1) % count]]
}

/// Twice the signed area.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

fn is_convex(flat: &[DVec2]) -> bool {
    let count = flat.len();
    // All corners turn left, and from the first one all triangles of the fan do: else it winds around more than once.
    (0..count).all(|at| area(flat[at], flat[(at + 1) % count], flat[(at + 2) % count]) >= 0.0)
        && (1..count - 1).all(|at| area(flat[0], flat[at], flat[at + 1]) >= 0.0)
}

fn is_ear(flat: &[DVec2], ring: &[usize], at: usize) -> bool {
    let [a, b, c] = around(ring, at);
    let (a, b, c) = (flat[a], flat[b], flat[c]);
    // A corner without an area is no ear: its neighbours would be left without one to cut them off by.
    area(a, b, c) > 0.0
        && ring
            .iter()
            .map(|&other| flat[other])
            .filter(|&other| other != a && other != b && other != c)
            .all(|other| area(a, b, other) < 0.0 || area(b, c, other) < 0.0 || area(c, a, other) < 0.0)
}
