//! The ground as something that hands and knees rest on and arms stay out of. It is where the feet stand, as for planting them.

use glam::DVec3;

use super::bodies::{Bodies, GroundPart};
use super::body::{Body, BodyMotion, Frames, POINTS};
use super::limb::ARMS;
use crate::feet::{contacts_of, foot_pairs, standing_height};
use crate::transfer::Transfer;

/// An arm that is deeper in the ground than this share of the body's height on the source is beside what the feet stand on.
const BESIDE: f64 = 0.04;

/// The ground of a clip, and where the source's arms and knees are above it.
#[derive(Debug)]
pub struct Ground {
    /// Height of the target's ground.
    height: f64,
    source_height: f64,
    scale: f64,
    /// How deep a guessed body is in the ground says nothing.
    is_guess: bool,
    /// Heights of the source's lowest points above its ground, scaled to the target, by index into [`Bodies::ground_parts`] and
    /// time.
    heights: Vec<Vec<f64>>,
    /// Whether a hand or knee of the source rests on its ground, by the same index and time.
    pub touching: Vec<Vec<bool>>,
    /// The same for feet, in the order of their soles.
    pub feet: Vec<Vec<bool>>,
}

/// A point of an arm in the ground.
pub struct Sunken {
    pub part: usize,
    pub point: usize,
    /// How much deeper it is than on the source.
    pub depth: f64,
}

impl Ground {
    /// Returns `None` without feet.
    pub fn new(
        transfer: &Transfer,
        bodies: &Bodies,
        times: &[f32],
        [source, target]: [&BodyMotion; 2],
        scale: f64,
    ) -> Option<Self> {
        let feet: Vec<_> = foot_pairs(transfer).into_iter().flatten().map(|pair| pair.source).collect();
        let contacts = contacts_of(transfer, &feet, times);
        let ground = |motion: &BodyMotion| {
            let touching = contacts.touching.iter().map(Vec::as_slice);
            standing_height(&motion.soles.iter().cloned().zip(touching).collect::<Vec<_>>())
        };
        let (source_height, height) = (ground(source)?, ground(target)?);
        let is_guess = bodies.target.has_mesh && !bodies.source.has_mesh;
        let (heights, touching) = (Vec::new(), Vec::new());
        let mut ground = Self { height, source_height, scale, is_guess, heights, touching, feet: Vec::new() };
        for part in &bodies.ground_parts {
            let lowest = |frames| lowest(&bodies.source, part, frames) - source_height;
            let lowest: Vec<f64> = source.frames.iter().map(lowest).collect();
            let path = source.frames.iter().zip(&lowest).map(|(frames, &y)| DVec3 { y, ..frames[part.part].0 });
            ground.touching.push(if part.rests {
                contacts.of_part(times, &path.collect::<Vec<_>>(), bodies.source.height)
            } else {
                vec![false; times.len()]
            });
            let heights = lowest.into_iter().map(|y| ground.scaled(y)).collect();
            ground.heights.push(heights);
        }
        ground.feet = contacts.touching;
        Some(ground)
    }

    /// A height of the source above its ground, scaled to the target.
    fn scaled(&self, y: f64) -> f64 {
        self.scale * if self.is_guess { y.max(0.0) } else { y }
    }

    /// How much higher the target's hands and knees should be where the source's rest on the ground: their parts, and by how much.
    pub fn misses(&self, bodies: &Bodies, at: usize, target: &Frames) -> impl Iterator<Item = (usize, f64)> {
        let parts = bodies.ground_parts.iter().enumerate().filter(move |(index, _)| self.touching[*index][at]);
        parts.map(move |(index, part)| {
            (part.part, self.heights[index][at] - (lowest(&bodies.target, part, target) - self.height))
        })
    }

    /// Whether a leg stands or kneels on the ground at each time. `side` is 0 for the left one, 1 for the right one.
    pub fn standing(&self, bodies: &Bodies, side: usize) -> Vec<bool> {
        let foot = self.feet.get(bodies.target.soles.index(side));
        let is_own = |part: &GroundPart| part.is_knee && bodies.regions[part.part].limb() == Some(ARMS + side);
        let knee = bodies.ground_parts.iter().position(is_own).map(|knee| &self.touching[knee]);
        let rests = |row: Option<&Vec<bool>>, at: usize| row.is_some_and(|row| row[at]);
        (0..self.feet.first().map_or(0, Vec::len)).map(|at| rests(foot, at) || rests(knee, at)).collect()
    }

    /// How much higher a sole of the target should be behind a knee that goes up by `along`: on the ground if it is planted there, else
    /// as high as the source's. One that isn't as low as `low` goes along, but stays out of the ground.
    pub fn sole_miss(&self, [source, target]: [f64; 2], is_planted: bool, low: f64, along: f64) -> f64 {
        let (wanted, height) = (self.scaled(source - self.source_height), target - self.height);
        match wanted < low {
            true if is_planted => -height,
            true => wanted - height,
            false => along.max(-height),
        }
    }

    /// Points of the target's arms that are deeper in the ground than the source's arm, by more than `tolerated`.
    pub fn sunken(&self, bodies: &Bodies, at: usize, target: &Frames, tolerated: f64) -> Vec<Sunken> {
        let body = &bodies.target;
        let mut sunken = Vec::new();
        let arms = bodies.ground_parts.iter().enumerate().filter(|(_, part)| !part.is_knee);
        for (index, &GroundPart { part, .. }) in arms {
            let source = self.heights[index][at];
            let floor = self.height + source.min(0.0) - tolerated;
            let (position, turn) = target[part];
            let lowest = (position + turn * body.solids[part].center).y - body.solids[part].bound;
            if source < -BESIDE * body.height || lowest > floor {
                continue;
            }
            let depths = (0..POINTS).map(|point| (point, floor - body.point(part, point, target).y));
            let deep = depths.filter(|(_, depth)| *depth > 0.0);
            sunken.extend(deep.map(|(point, depth)| Sunken { part, point, depth }));
        }
        sunken
    }
}

fn lowest(body: &Body, &GroundPart { part, is_knee, .. }: &GroundPart, frames: &Frames) -> f64 {
    if is_knee {
        return body.knee(part, frames);
    }
    (0..POINTS).map(|point| body.point(part, point, frames).y).fold(f64::INFINITY, f64::min)
}
