//! Where the source touches itself, and how far the target is from touching itself alike.

use glam::{DQuat, DVec3};

use super::body::{Bodies, Frames};
use super::solid::Place;
use crate::retarget::feet::smooth;

/// Surfaces that are closer than this share of the body's height begin to touch. For a person of 1.7 m: 3 cm.
const REACH: f64 = 0.018;

/// A point is inside a part if it is deeper by this share of the body's height than at rest: 2 mm.
const INSIDE: f64 = 0.0012;

/// A limb point of the source that touches a part.
#[derive(Debug, Clone, Copy)]
pub struct Touch {
    pub point: usize,
    pub part: usize,
    place: Place,
    /// From 0 to 1.
    pub weight: f64,
    /// From the place to the point.
    gap: DVec3,
}

/// All that touches at one time.
#[derive(Debug, Default)]
pub struct Touches {
    pub touches: Vec<Touch>,
    /// Point and part, ascending, and how deep the point is in it.
    depths: Vec<(usize, usize, f64)>,
}

impl Touches {
    pub fn depth(&self, point: usize, part: usize) -> f64 {
        self.depths.binary_search_by_key(&(point, part), |depth| (depth.0, depth.1)).map_or(0.0, |at| self.depths[at].2)
    }
}

impl Bodies {
    pub fn touches(&self, source: &Frames) -> Touches {
        let mut found = Touches::default();
        let reach = REACH * self.heights[0];
        for (index, point) in self.points.iter().enumerate() {
            let position = self.source.point(index, point.part, source);
            for &(part, _) in &self.others[index] {
                let Some((distance, place)) = self.source.locate(part, source, position, reach) else { continue };
                let is_inside = distance < 0.0;
                // How deep a guessed body is in itself says nothing.
                let gap = if is_inside && !self.source.has_mesh {
                    DVec3::ZERO
                } else {
                    position - self.source.surface(part, source, place)
                };
                let weight = smooth(1.0 - distance.max(0.0) / reach);
                found.touches.push(Touch { point: index, part, place, weight, gap });
                if is_inside && self.source.has_mesh {
                    found.depths.push((index, part, -distance));
                }
            }
        }
        found
    }

    /// Returns how the target's point has to move relative to the part to touch it as on the source. `target_from_source` turns
    /// and scales.
    pub fn miss(&self, touch: &Touch, position: DVec3, target: &Frames, (turn, scale): (DQuat, f64)) -> DVec3 {
        self.target.surface(touch.part, target, touch.place) + turn * (scale * touch.gap) - position
    }
}

/// Sums over the clip.
#[derive(Debug, Default)]
pub struct TouchFigures {
    inside: usize,
    points: usize,
    miss: f64,
    weight: f64,
}

impl TouchFigures {
    pub fn add(&mut self, bodies: &Bodies, [source, target]: [Frames; 2], target_from_source: (DQuat, f64)) {
        let target = &target;
        let position = |index: usize| bodies.target.point(index, bodies.points[index].part, target);
        for touch in bodies.touches(&source).touches {
            let miss = bodies.miss(&touch, position(touch.point), target, target_from_source);
            self.miss += touch.weight * miss.length();
            self.weight += touch.weight;
        }
        let margin = INSIDE * bodies.heights[1];
        for (index, others) in bodies.others.iter().enumerate() {
            let position = position(index);
            let is_inside = |&(part, at_rest): &(usize, f64)| {
                let located = bodies.target.locate(part, target, position, 0.0);
                located.is_some_and(|(distance, _)| -distance > at_rest + margin)
            };
            self.inside += usize::from(others.iter().any(is_inside));
            self.points += 1;
        }
    }

    /// Share of the target's limb points that are inside other parts.
    pub fn self_penetration_share(&self) -> Option<f64> {
        (self.points > 0).then(|| self.inside as f64 / self.points as f64)
    }

    /// Mean distance of the target's contacts from where they are on the source.
    pub fn contact_error(&self) -> Option<f64> {
        (self.weight > 0.0).then(|| self.miss / self.weight)
    }
}
