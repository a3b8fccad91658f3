//! The solid of one body part: how far its surface is from an axis, by height along the axis and by direction. It bends with no
//! joint. A place on the surface of one body corresponds to the place at the same height and direction on another.

use std::f64::consts::TAU;

use glam::DVec3;

const RINGS: usize = 6;
const SECTORS: usize = 12;

/// A point at most this share of a cell before the next one belongs to that one.
const BETWEEN: f64 = 1e-4;

/// Fewer points than this are no body part.
const MIN_POINTS: usize = 8;

/// Towards its ends, over this share of its length, a solid is less and less deep.
const END: f64 = 0.15;

/// A solid around an axis through the origin, which is its joint.
#[derive(Debug)]
pub struct Solid {
    pub axis: DVec3,
    front: DVec3,
    side: DVec3,
    /// Where it begins and ends along the axis.
    from: f64,
    to: f64,
    /// Distances of the surface from the axis.
    radii: [[f64; SECTORS]; RINGS],
    /// A sphere around it.
    pub center: DVec3,
    pub bound: f64,
}

/// A place on the surface of a solid.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// From 0 to 1 along the axis.
    pub share: f64,
    /// About the axis.
    pub angle: f64,
}

impl Solid {
    /// Returns the solid that the points cover, with `front` as the direction of angle 0; `None` if there are too few.
    pub fn around(points: &[DVec3], axis: DVec3, front: DVec3) -> Option<Self> {
        let (from, to) = points
            .iter()
            .map(|point| point.dot(axis))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| (a.min(t), b.max(t)));
        if points.len() < MIN_POINTS || to <= from {
            return None;
        }
        let mut solid = Self::new(axis, front, from, to);
        for point in points {
            let (share, angle, radius) = solid.coordinates(*point);
            // Regular meshes have vertices right between two cells, which must not depend on rounding.
            let ring = ((share * RINGS as f64 + BETWEEN) as usize).min(RINGS - 1);
            let sector = ((angle / TAU).rem_euclid(1.0) * SECTORS as f64 + BETWEEN) as usize % SECTORS;
            solid.radii[ring][sector] = solid.radii[ring][sector].max(radius);
        }
        fill_gaps(&mut solid.radii);
        Some(solid.bounded())
    }

    /// Returns an elliptic cylinder; `radii` are to the front and to the side.
    pub fn elliptic(axis: DVec3, front: DVec3, [from, to]: [f64; 2], radii: [f64; 2]) -> Self {
        let mut solid = Self::new(axis, front, from, to);
        let ring: [f64; SECTORS] = std::array::from_fn(|sector| {
            let (sin, cos) = (TAU * (sector as f64 + 0.5) / SECTORS as f64).sin_cos();
            (cos / radii[0]).hypot(sin / radii[1]).recip()
        });
        solid.radii = [ring; RINGS];
        solid.bounded()
    }

    fn new(axis: DVec3, front: DVec3, from: f64, to: f64) -> Self {
        let front = front.reject_from_normalized(axis).normalize_or(axis.any_orthonormal_vector());
        let side = axis.cross(front);
        Self { axis, front, side, from, to, radii: [[0.0; SECTORS]; RINGS], center: DVec3::ZERO, bound: 0.0 }
    }

    fn bounded(self) -> Self {
        let radius = self.radii.iter().flatten().copied().fold(0.0, f64::max);
        let center = 0.5 * (self.from + self.to) * self.axis;
        Self { center, bound: radius.hypot(0.5 * (self.to - self.from)), ..self }
    }

    /// Share of the length (not limited), angle and distance from the axis.
    fn coordinates(&self, point: DVec3) -> (f64, f64, f64) {
        let (x, y) = (point.dot(self.front), point.dot(self.side));
        ((point.dot(self.axis) - self.from) / (self.to - self.from), y.atan2(x), x.hypot(y))
    }

    pub fn radius(&self, place: Place) -> f64 {
        let ring = (place.share * RINGS as f64 - 0.5).clamp(0.0, (RINGS - 1) as f64);
        let sector = ((place.angle / TAU).rem_euclid(1.0) * SECTORS as f64 - 0.5).rem_euclid(SECTORS as f64);
        let (lower, left) = (ring as usize, sector as usize % SECTORS);
        let (upper, right) = ((lower + 1).min(RINGS - 1), (left + 1) % SECTORS);
        let (up, along) = (ring.fract(), sector.fract());
        let at = |ring: usize| self.radii[ring][left] * (1.0 - along) + self.radii[ring][right] * along;
        at(lower) * (1.0 - up) + at(upper) * up
    }

    /// Returns how far a point is outside (negative inside), and the nearest place about the axis. `None` if it is further away
    /// than `reach`.
    pub fn locate(&self, point: DVec3, reach: f64) -> Option<(f64, Place)> {
        if point.distance_squared(self.center) > (self.bound + reach).powi(2) {
            return None;
        }
        let (share, angle, radius) = self.coordinates(point);
        let place = Place { share: share.clamp(0.0, 1.0), angle };
        let gap = radius - self.radius(place);
        let beyond = (share - place.share).abs() * (self.to - self.from);
        let distance = if gap > 0.0 || beyond > 0.0 {
            gap.max(0.0).hypot(beyond)
        } else {
            gap * (share.min(1.0 - share) / END).min(1.0)
        };
        (distance < reach).then_some((distance, place))
    }

    pub fn surface(&self, place: Place) -> DVec3 {
        let along = self.from + place.share * (self.to - self.from);
        along * self.axis + self.radius(place) * self.outward(place)
    }

    /// The direction away from the axis.
    pub fn outward(&self, place: Place) -> DVec3 {
        let (sin, cos) = place.angle.sin_cos();
        cos * self.front + sin * self.side
    }
}

/// Gives cells without points the mean of their neighbours, from the filled ones outwards.
fn fill_gaps(radii: &mut [[f64; SECTORS]; RINGS]) {
    while radii.iter().flatten().any(|&radius| radius == 0.0) {
        let before = *radii;
        for ring in 0..RINGS {
            for sector in (0..SECTORS).filter(|&sector| before[ring][sector] == 0.0) {
                let around = [
                    before[ring][(sector + 1) % SECTORS],
                    before[ring][(sector + SECTORS - 1) % SECTORS],
                    before[ring.saturating_sub(1)][sector],
                    before[(ring + 1).min(RINGS - 1)][sector],
                ];
                let (sum, count) = around
                    .iter()
                    .filter(|&&radius| radius > 0.0)
                    .fold((0.0, 0), |(sum, count), radius| (sum + radius, count + 1));
                if count > 0 {
                    radii[ring][sector] = sum / f64::from(count);
                }
            }
        }
        if *radii == before {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners of a square column of half a metre, two metres high.
    fn column() -> Solid {
        let points: Vec<DVec3> = (0..=20)
            .flat_map(|level| {
                let y = f64::from(level) * 0.1;
                [(0.25, 0.25), (0.25, -0.25), (-0.25, 0.25), (-0.25, -0.25)].map(|(x, z)| DVec3::new(x, y, z))
            })
            .collect();
        Solid::around(&points, DVec3::Y, DVec3::Z).unwrap()
    }

    #[test]
    fn a_solid_reaches_its_points() {
        let solid = column();
        let (distance, _) = solid.locate(DVec3::new(0.5, 1.0, 0.5), 1.0).unwrap();
        assert!((distance - 0.25 * 2_f64.sqrt()).abs() < 0.01, "{distance}");
        let (depth, place) = solid.locate(DVec3::new(0.125, 1.0, 0.125), 1.0).unwrap();
        assert!((depth + 0.125 * 2_f64.sqrt()).abs() < 0.01, "{depth}");
        assert!((solid.surface(place) - DVec3::new(0.25, 1.0, 0.25)).length() < 0.01);
        assert!(solid.locate(DVec3::new(0.0, 1.0, 3.0), 1.0).is_none());
    }

    #[test]
    fn the_distance_is_continuous_across_an_end() {
        let solid = column();
        let at = |y: f64| solid.locate(DVec3::new(0.1, y, 0.1), 1.0).unwrap().0;
        assert!(at(1.0) < -0.1 && at(1.999).abs() < 0.01 && at(2.001).abs() < 0.01, "{} {}", at(1.999), at(2.001));
        assert!((at(2.5) - 0.5).abs() < 1e-9);
    }

    #[test]
    fn few_points_make_no_solid() {
        assert!(Solid::around(&[DVec3::ZERO, DVec3::Y], DVec3::Y, DVec3::Z).is_none());
        assert!(Solid::around(&[DVec3::Y; 20], DVec3::Y, DVec3::Z).is_none());
    }

    #[test]
    fn an_elliptic_solid_is_wider_to_one_side() {
        let solid = Solid::elliptic(DVec3::Y, DVec3::Z, [0.0, 1.0], [0.1, 0.2]);
        let at = |point: DVec3| solid.locate(point, 1.0).unwrap().0;
        assert!(at(DVec3::new(0.0, 0.5, 0.15)) > 0.03 && at(DVec3::new(0.15, 0.5, 0.0)) < -0.03);
    }
}
