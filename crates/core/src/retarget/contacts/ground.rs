//! The ground as something that hands rest on and arms stay out of. It is where the feet stand, as for planting them.

use glam::DVec3;

use super::body::{ArmPart, Bodies, Body, BodyMotion, Frames, POINTS};
use crate::retarget::feet::{contacts_of, foot_pairs, standing_height};
use crate::retarget::transfer::Transfer;

/// An arm that is deeper in the ground than this share of the body's height on the source is beside what the feet stand on.
const BESIDE: f64 = 0.04;

/// The ground of a clip, and where the source's arms are above it.
#[derive(Debug)]
pub struct Ground {
    /// Height of the target's ground.
    height: f64,
    /// Heights of the source's lowest points above its ground, scaled to the target, by index into [`Bodies::arm_parts`] and time.
    heights: Vec<Vec<f64>>,
    /// Whether a hand of the source rests on its ground, by the same index and time.
    pub touching: Vec<Vec<bool>>,
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
        let (source_ground, height) = (ground(source)?, ground(target)?);
        // How deep a guessed body is in the ground says nothing.
        let is_guess = bodies.target.has_mesh && !bodies.source.has_mesh;
        let mut heights = Vec::new();
        let mut touching = Vec::new();
        for part in &bodies.arm_parts {
            let lowest = |frames| lowest(&bodies.source, part.part, frames) - source_ground;
            let lowest: Vec<f64> = source.frames.iter().map(lowest).collect();
            let path = source.frames.iter().zip(&lowest).map(|(frames, &y)| DVec3 { y, ..frames[part.part].0 });
            touching.push(if part.is_hand {
                contacts.of_hand(times, &path.collect::<Vec<_>>(), bodies.source.height)
            } else {
                vec![false; times.len()]
            });
            let scaled = |y: f64| scale * if is_guess { y.max(0.0) } else { y };
            heights.push(lowest.into_iter().map(scaled).collect());
        }
        Some(Self { height, heights, touching })
    }

    /// How much higher the target's hands should be where the source's rest on the ground: the hands' parts, and by how much.
    pub fn misses(&self, bodies: &Bodies, at: usize, target: &Frames) -> impl Iterator<Item = (usize, f64)> {
        let parts = bodies.arm_parts.iter().enumerate().filter(move |(index, _)| self.touching[*index][at]);
        parts.map(move |(index, part)| {
            (part.part, self.heights[index][at] - (lowest(&bodies.target, part.part, target) - self.height))
        })
    }

    /// Points of the target's arms that are deeper in the ground than the source's arm, by more than `tolerated`.
    pub fn sunken(&self, bodies: &Bodies, at: usize, target: &Frames, tolerated: f64) -> Vec<Sunken> {
        let body = &bodies.target;
        let mut sunken = Vec::new();
        for (index, &ArmPart { part, .. }) in bodies.arm_parts.iter().enumerate() {
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

fn lowest(body: &Body, part: usize, frames: &Frames) -> f64 {
    (0..POINTS).map(|point| body.point(part, point, frames).y).fold(f64::INFINITY, f64::min)
}
