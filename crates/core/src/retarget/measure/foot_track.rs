//! The feet of source and target over time: contacts and how far feet slide during them.

use glam::DVec3;

use crate::anim::JointIndex;
use crate::asset::Slot;
use crate::retarget::feet::{contacts, source_height};
use crate::retarget::math::HORIZONTAL;
use crate::retarget::transfer::Transfer;

/// One foot over the whole clip, at the measured times.
#[derive(Debug, Clone, PartialEq)]
pub struct FootTrack {
    /// The model's toes, or ankle.
    pub joint: JointIndex,
    /// The measured times in seconds, ascending: the source's keys and halfway between them.
    pub times: Vec<f32>,
    /// Whether the source's foot is in contact with the ground.
    pub touching: Vec<bool>,
    /// Horizontal speed of the model's foot, from the previous time to this one.
    pub metres_per_sec: Vec<f32>,
}

/// Positions of a foot that both sides have, as they are sampled.
#[derive(Debug)]
pub struct FootPositions {
    pub source_joint: JointIndex,
    pub target_joint: JointIndex,
    pub source: Vec<DVec3>,
    pub target: Vec<DVec3>,
}

/// Feet that both sides have: toes if both have those, else ankles.
pub fn mapped_feet(transfer: &Transfer) -> Vec<FootPositions> {
    [(Slot::LeftFoot, Slot::LeftToes), (Slot::RightFoot, Slot::RightToes)]
        .into_iter()
        .filter_map(|(ankle, toes)| transfer.pair(toes).or_else(|| transfer.pair(ankle)))
        .map(|pair| FootPositions {
            source_joint: pair.source,
            target_joint: pair.target,
            source: Vec::new(),
            target: Vec::new(),
        })
        .collect()
}

/// Mean horizontal speed of feet in contact.
#[derive(Debug, Clone, Copy, Default)]
pub struct FootSlide {
    pub target: Option<f64>,
    /// Scaled to the target.
    pub source: Option<f64>,
}

pub fn foot_tracks(transfer: &Transfer, times: &[f32], feet: &[FootPositions]) -> (FootSlide, Vec<FootTrack>) {
    let scale = transfer.hips.map_or(1.0, |hips| hips.scale);
    let (mut target, mut source) = (Slide::default(), Slide::default());
    let mut tracks = Vec::with_capacity(feet.len());
    for foot in feet {
        let touching = contacts(times, &foot.source, source_height(transfer.map, transfer.alignment));
        target.add(times, &foot.target, &touching, 1.0);
        source.add(times, &foot.source, &touching, scale);
        let metres_per_sec = horizontal_speeds(times, &foot.target);
        tracks.push(FootTrack { joint: foot.target_joint, times: times.to_vec(), touching, metres_per_sec });
    }
    (FootSlide { target: target.speed(), source: source.speed() }, tracks)
}

fn horizontal_speeds(times: &[f32], positions: &[DVec3]) -> Vec<f32> {
    let speed = |at: usize| {
        let before = at.saturating_sub(1);
        let secs = f64::from(times[at] - times[before]);
        let distance = ((positions[at] - positions[before]) * HORIZONTAL).length();
        if secs > 0.0 { (distance / secs) as f32 } else { 0.0 }
    };
    (0..times.len()).map(speed).collect()
}

/// Horizontal distance covered in contact, and how long the contacts last.
#[derive(Debug, Default)]
struct Slide {
    distance: f64,
    secs: f64,
}

impl Slide {
    fn add(&mut self, times: &[f32], positions: &[DVec3], touching: &[bool], scale: f64) {
        for at in 1..times.len() {
            if touching[at - 1] && touching[at] {
                let step = (positions[at] - positions[at - 1]) * HORIZONTAL;
                self.distance += scale * step.length();
                self.secs += f64::from(times[at] - times[at - 1]);
            }
        }
    }

    fn speed(&self) -> Option<f64> {
        (self.secs > 0.0).then(|| self.distance / self.secs)
    }
}
