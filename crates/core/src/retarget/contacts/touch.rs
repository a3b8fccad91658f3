//! Where the source touches itself, and how far the target is from touching itself alike.

use glam::{DQuat, DVec3};

use super::body::{Bodies, Frames};
use super::solid::Place;
use crate::retarget::math::smooth;

/// Surfaces that are closer than this share of the body's height begin to touch. For a person of 1.7 m: 3 cm.
const REACH: f64 = 0.018;

/// A point is inside a part if it is deeper by this share of the body's height than at rest: 2 mm.
const INSIDE: f64 = 0.0012;

/// A point on a hand of the source that touches a part.
#[derive(Debug, Clone, Copy)]
pub struct Touch {
    pub point: usize,
    pub part: usize,
    place: Place,
    /// From 0 to 1.
    pub weight: f64,
    /// From the place to the point, if it is outside.
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

/// A point that moves faster over a part than this many heights of the body per second passes it: 0.5 m/s.
const MAX_SLIDE: f64 = 0.3;

/// Contacts that are shorter are not meant.
const MIN_SECS: f32 = 0.1;

impl Bodies {
    /// What touches on the source at each of the times, whose poses are given.
    pub fn touches(&self, times: &[f32], source: &[Frames]) -> Vec<Touches> {
        let reach = REACH * self.heights[0];
        let parts = self.regions.len();
        let mut found: Vec<Touches> = Vec::with_capacity(times.len());
        // For each part that touches, each part that is touched, and each time.
        let mut is_met = vec![false; parts * parts * times.len()];
        for (at, frames) in source.iter().enumerate() {
            let mut now = Touches::default();
            for (index, point) in self.points.iter().enumerate() {
                let position = self.source.point(index, point.part, frames);
                for &(part, _) in &self.others[index] {
                    let Some((distance, place)) = self.source.locate(part, frames, position, reach) else { continue };
                    if distance < 0.0 && self.source.has_mesh {
                        now.depths.push((index, part, -distance));
                    }
                    if !point.is_hand || (distance < -reach && self.source.has_mesh) {
                        continue;
                    }
                    let near = [at.saturating_sub(1), (at + 1).min(times.len() - 1)];
                    let locals = near.map(|near| {
                        let (origin, turn) = source[near][part];
                        turn.conjugate() * (self.source.point(index, point.part, &source[near]) - origin)
                    });
                    let secs = f64::from(times[near[1]] - times[near[0]]).max(1e-6);
                    if locals[0].distance(locals[1]) / secs > MAX_SLIDE * self.heights[0] {
                        continue;
                    }
                    let surface = self.source.surface(part, frames, place);
                    // Overlaps of the source's surfaces count as touching.
                    let gap = if distance < 0.0 { DVec3::ZERO } else { position - surface };
                    // How deep a guessed body is in itself says nothing.
                    let apart = if self.source.has_mesh { distance.abs() } else { distance.max(0.0) };
                    let weight = smooth(1.0 - apart / reach);
                    now.touches.push(Touch { point: index, part, place, weight, gap });
                    is_met[(point.part * parts + part) * times.len() + at] = true;
                }
            }
            found.push(now);
        }
        for row in is_met.chunks_mut(times.len().max(1)) {
            let mut from = 0;
            while from < row.len() {
                let to = (from..row.len()).find(|&at| !row[at]).unwrap_or(row.len());
                if to > from && times[to - 1] - times[from] < MIN_SECS {
                    row[from..to].fill(false);
                }
                from = to + 1;
            }
        }
        for (at, now) in found.iter_mut().enumerate() {
            now.touches.retain(|touch| is_met[(self.points[touch.point].part * parts + touch.part) * times.len() + at]);
        }
        found
    }

    /// Contacts of hands with other parts: hand, part, how much they touch, and how the hand would have to move on the target for
    /// the middles of both surfaces to meet as on the source. `target_from_source` turns and scales.
    pub fn misses(
        &self,
        touches: &Touches,
        point: impl Fn(usize) -> DVec3,
        target: &Frames,
        (turn, scale): (DQuat, f64),
    ) -> Vec<(usize, usize, f64, DVec3)> {
        let mut sums: Vec<(usize, usize, f64, f64, DVec3)> = Vec::new();
        for touch in &touches.touches {
            let hand = self.points[touch.point].part;
            let surface = self.target.surface(touch.part, target, touch.place);
            let miss = surface + turn * (scale * touch.gap) - point(touch.point);
            let at = sums.iter().position(|sum| (sum.0, sum.1) == (hand, touch.part)).unwrap_or_else(|| {
                sums.push((hand, touch.part, 0.0, 0.0, DVec3::ZERO));
                sums.len() - 1
            });
            sums[at].2 = touch.weight.max(sums[at].2);
            sums[at].3 += touch.weight;
            sums[at].4 += touch.weight * miss;
        }
        sums.retain(|sum| sum.3 > 0.0);
        sums.into_iter().map(|(hand, part, weight, sum, miss)| (hand, part, weight, miss / sum)).collect()
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
    pub fn add(&mut self, bodies: &Bodies, touches: &Touches, target: &Frames, target_from_source: (DQuat, f64)) {
        let position = |index: usize| bodies.target.point(index, bodies.points[index].part, target);
        for (_, _, weight, miss) in bodies.misses(touches, position, target, target_from_source) {
            self.miss += weight * miss.length();
            self.weight += weight;
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
