//! Triangulates polygons: as a fan if the polygon is convex, else by ear clipping. A separate package, since .obj and
//! .x files are read by different programs on the page.

use glam::{DVec2, DVec3};

/// Polygons with more corners are always triangulated as a fan.
const MAX_CLIPPED_CORNERS: usize = 1024;

/// Triangulates the polygons of one file within a total budget: ear clipping is cubic in the number of corners.
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
    /// Calls `triangle` with the indices of each triangle's corners in the list, keeping the polygon's winding. Always
    /// produces corners − 2 triangles, also for degenerate and self-intersecting polygons.
    pub fn cut(&mut self, corners: &[DVec3], mut triangle: impl FnMut([usize; 3])) {
        let count = corners.len();
        if count > 3 && count <= MAX_CLIPPED_CORNERS {
            self.flatten(corners);
            if !is_convex(&self.flat) {
                return self.clip_ears(&mut triangle);
            }
        }
        for second in 1..count.saturating_sub(1) {
            triangle([0, second, second + 1]);
        }
    }

    /// Projects the polygon along its normal (Newell's method, which tolerates collinear corners), counter-clockwise.
    fn flatten(&mut self, corners: &[DVec3]) {
        let next = corners.iter().cycle().skip(1);
        let normal: DVec3 = corners.iter().zip(next).map(|(a, b)| (*a - corners[0]).cross(*b - corners[0])).sum();
        let normal = normal.normalize_or(DVec3::Z);
        let (x, y) = normal.any_orthonormal_pair();
        self.flat.clear();
        self.flat.extend(corners.iter().map(|corner| DVec2::new(x.dot(*corner), y.dot(*corner))));
    }

    fn clip_ears(&mut self, triangle: &mut dyn FnMut([usize; 3])) {
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
            // A self-intersecting polygon may have no ear; any corner will do.
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
    // Every corner turns left, and so does every triangle of the fan: otherwise it winds around more than once.
    (0..count).all(|at| area(flat[at], flat[(at + 1) % count], flat[(at + 2) % count]) >= 0.0)
        && (1..count - 1).all(|at| area(flat[0], flat[at], flat[at + 1]) >= 0.0)
}

fn is_ear(flat: &[DVec2], ring: &[usize], at: usize) -> bool {
    let [a, b, c] = around(ring, at);
    let (a, b, c) = (flat[a], flat[b], flat[c]);
    // A corner without area is not an ear: cutting it off would leave its neighbours without one.
    area(a, b, c) > 0.0
        && ring
            .iter()
            .map(|&other| flat[other])
            .filter(|&other| other != a && other != b && other != c)
            .all(|other| area(a, b, other) < 0.0 || area(b, c, other) < 0.0 || area(c, a, other) < 0.0)
}
