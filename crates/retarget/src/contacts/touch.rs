//! Where the source touches itself with its hands, and how far the target is from touching itself alike.

use glam::{DQuat, DVec3};

use super::bodies::Bodies;
use super::body::{Frames, place_of};
use super::solid::Place;
use crate::math::smooth;

/// Surfaces that are closer than this share of the body's height begin to touch. For a person of 1.7 m: 3 cm.
const REACH: f64 = 0.018;

/// A point that moves faster over a part than this many heights of the body per second passes it: 0.5 m/s.
const MAX_SLIDE: f64 = 0.3;

/// Shorter contacts are chance.
const MIN_SECS: f32 = 0.1;

/// A point is inside a part if it is deeper by this share of the body's height than at rest: 2 mm.
const INSIDE: f64 = 0.0012;

/// A point on a hand of the source that touches a part.
#[derive(Debug, Clone, Copy)]
struct Touch {
    pair: usize,
    point: usize,
    place: Place,
    /// From 0 to 1.
    weight: f64,
    /// From the place to the point.
    gap: DVec3,
}

/// What the source touches at one time.
#[derive(Debug, Default)]
pub struct Touches {
    touches: Vec<Touch>,
    /// Pair and point, ascending, and how deep the point is inside.
    depths: Vec<((usize, usize), f64)>,
}

impl Touches {
    pub fn depth(&self, pair: usize, point: usize) -> f64 {
        self.depths.binary_search_by_key(&(pair, point), |depth| depth.0).map_or(0.0, |at| self.depths[at].1)
    }
}

/// A contact of the source that the target misses.
#[derive(Debug, Clone, Copy)]
pub struct Miss {
    pub pair: usize,
    /// How much the two touch, from 0 to 1.
    pub weight: f64,
    /// How the hand would have to move for the middles of both surfaces to meet as they do on the source.
    pub by: DVec3,
}

impl Bodies {
    /// What touches on the source at each of the times, whose poses are given.
    pub fn touches(&self, times: &[f32], source: &[Frames]) -> Vec<Touches> {
        let body = &self.source;
        let reach = REACH * body.height;
        // What an arm with a thing in its hand touches is mostly that.
        let is_holding = |part: usize| self.regions[part].arm().is_some_and(|arm| body.is_holding[arm]);
        let mut found: Vec<Touches> = Vec::with_capacity(times.len());
        let mut is_met = vec![vec![false; times.len()]; self.pairs.len()];
        for (at, frames) in source.iter().enumerate() {
            let near = [at.saturating_sub(1), (at + 1).min(times.len() - 1)];
            let secs = f64::from(times[near[1]] - times[near[0]]).max(1e-6);
            let mut now = Touches::default();
            for meeting in self.meetings(body, frames, reach) {
                let pair = &self.pairs[meeting.pair];
                // How deep a guessed body is in itself says nothing.
                let distance = if body.has_mesh { meeting.distance } else { meeting.distance.max(0.0) };
                if distance < 0.0 {
                    now.depths.push(((meeting.pair, meeting.point), -distance));
                }
                if !pair.is_hand || is_holding(pair.limb) || is_holding(pair.other) || distance < -reach {
                    continue;
                }
                let [before, after] = near.map(|near| {
                    let (origin, turn) = source[near][pair.other];
                    turn.conjugate() * (body.point(pair.limb, meeting.point, &source[near]) - origin)
                });
                if before.distance(after) > MAX_SLIDE * body.height * secs {
                    continue;
                }
                // Surfaces that face the same way don't touch: it is the other side of the hand that does.
                let hand = body.outward(pair.limb, place_of(meeting.point), frames);
                let facing = -hand.dot(body.outward(pair.other, meeting.place, frames));
                let weight = smooth(1.0 - distance.abs() / reach) * smooth(0.5 + facing);
                if weight <= 0.0 {
                    continue;
                }
                let is_overlap = meeting.distance < 0.0 && !body.has_mesh;
                let surface = body.surface(pair.other, meeting.place, frames);
                let gap = if is_overlap { DVec3::ZERO } else { body.point(pair.limb, meeting.point, frames) - surface };
                now.touches.push(Touch { pair: meeting.pair, point: meeting.point, place: meeting.place, weight, gap });
                is_met[meeting.pair][at] = true;
            }
            found.push(now);
        }
        for row in &mut is_met {
            drop_short(times, row);
        }
        for (at, now) in found.iter_mut().enumerate() {
            now.touches.retain(|touch| is_met[touch.pair][at]);
        }
        found
    }

    /// Returns how the target misses the source's contacts, one by one. `target_from_source` turns and scales.
    pub fn misses(&self, touches: &Touches, target: &Frames, (turn, scale): (DQuat, f64)) -> Vec<Miss> {
        let mut misses: Vec<Miss> = Vec::new();
        for touches in touches.touches.chunk_by(|a, b| a.pair == b.pair) {
            let pair = &self.pairs[touches[0].pair];
            let (mut max, mut weights, mut sum) = (0.0_f64, 0.0, DVec3::ZERO);
            for touch in touches {
                let surface = self.target.surface(pair.other, touch.place, target);
                let goal = surface + turn * (scale * touch.gap);
                sum += touch.weight * (goal - self.target.point(pair.limb, touch.point, target));
                weights += touch.weight;
                max = max.max(touch.weight);
            }
            misses.push(Miss { pair: touches[0].pair, weight: max, by: sum / weights });
        }
        misses
    }
}

/// Clears the runs of a row that are shorter than a contact.
fn drop_short(times: &[f32], row: &mut [bool]) {
    let mut start = 0;
    for at in 0..=row.len() {
        if at == row.len() || !row[at] {
            if at > start && times[at - 1] - times[start] < MIN_SECS {
                row[start..at].fill(false);
            }
            start = at + 1;
        }
    }
}

/// Sums over the clip.
#[derive(Debug, Default)]
pub struct TouchFigures {
    inside: u32,
    points: u32,
    miss: f64,
    weight: f64,
}

impl TouchFigures {
    /// Adds one time. `on_ground` are the distances of hands and knees that rest on the ground from where they should be.
    pub fn add(
        &mut self,
        bodies: &Bodies,
        touches: &Touches,
        on_ground: impl Iterator<Item = f64>,
        target: &Frames,
        target_from_source: (DQuat, f64),
    ) {
        for miss in on_ground {
            self.miss += miss.abs();
            self.weight += 1.0;
        }
        for miss in bodies.misses(touches, target, target_from_source) {
            self.miss += miss.weight * miss.by.length();
            self.weight += miss.weight;
        }
        // One bit per point of each part.
        let mut inside = vec![0_u32; bodies.regions.len()];
        for meeting in bodies.meetings(&bodies.target, target, 0.0) {
            let pair = &bodies.pairs[meeting.pair];
            if -meeting.distance > pair.at_rest[meeting.point] + INSIDE * bodies.target.height {
                inside[pair.limb] |= 1 << meeting.point;
            }
        }
        self.inside += inside.iter().map(|points| points.count_ones()).sum::<u32>();
        self.points += bodies.limb_points;
    }

    /// Share of the target's limb points that are inside other parts.
    pub fn self_penetration_share(&self) -> Option<f64> {
        (self.points > 0).then(|| f64::from(self.inside) / f64::from(self.points))
    }

    /// Mean distance of the target's contacts from where they are on the source.
    pub fn contact_error(&self) -> Option<f64> {
        (self.weight > 0.0).then(|| self.miss / self.weight)
    }
}
