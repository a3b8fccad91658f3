//! The feet of source and target over time: contacts, and how far feet slide and how high they hover during them.

use gaitway_character::anim::JointIndex;
use glam::DVec3;

use crate::feet::{Sole, SourceContacts, foot_pairs, source_contacts, source_height};
use crate::math::HORIZONTAL;
use crate::transfer::Transfer;

/// One foot over the whole clip, at the measured times.
#[derive(Debug, Clone, PartialEq)]
pub struct FootTrack {
    /// The model's toes, or ankle.
    pub joint: JointIndex,
    /// The measured times in seconds, ascending: the source's keys and halfway between them.
    pub times: Vec<f32>,
    /// Whether the source's foot is in contact with the ground.
    pub touching: Vec<bool>,
    /// Horizontal speed of the model's foot over the ground, from the previous time to this one.
    pub metres_per_sec: Vec<f32>,
}

/// Positions of a foot that both sides have, as they are sampled.
#[derive(Debug)]
pub struct FootPositions {
    pub source_joint: JointIndex,
    pub target_joint: JointIndex,
    pub source: Vec<DVec3>,
    pub target: Vec<DVec3>,
    /// Of the target.
    pub sole: Sole,
    /// Heights of the sole's lowest point above the ground.
    pub heights: Vec<f64>,
}

/// Feet that both sides have.
pub fn mapped_feet(transfer: &Transfer, soles: [Option<Sole>; 2]) -> Vec<FootPositions> {
    foot_pairs(transfer)
        .into_iter()
        .zip(soles)
        .filter_map(|(pair, sole)| pair.zip(sole))
        .map(|(pair, sole)| FootPositions {
            source_joint: pair.source,
            target_joint: pair.target,
            source: Vec::new(),
            target: Vec::new(),
            sole,
            heights: Vec::new(),
        })
        .collect()
}

/// Feet in contact, over all contacts.
#[derive(Debug, Clone, Copy, Default)]
pub struct FootContacts {
    /// Mean horizontal speed over the ground.
    pub slide: Option<f64>,
    /// The source's, scaled to the target.
    pub source_slide: Option<f64>,
    /// Mean height of the sole's lowest point.
    pub hover: Option<f64>,
}

/// `feet` have been sampled at all times, with the travel of the target's hips as the source has it.
pub fn foot_tracks(transfer: &Transfer, times: &[f32], mut feet: Vec<FootPositions>) -> (FootContacts, Vec<FootTrack>) {
    let scale = transfer.scale();
    let source: Vec<Vec<DVec3>> = feet.iter().map(|foot| foot.source.clone()).collect();
    let hips: Vec<DVec3> = times.iter().filter_map(|&time| transfer.source_hips(time)).collect();
    let height = source_height(transfer.map, transfer.alignment);
    let SourceContacts { touching, ground } = source_contacts(times, &source, &hips, height);
    let (mut slide, mut source_slide, mut hover) = (Mean::default(), Mean::default(), Mean::default());
    let mut tracks = Vec::with_capacity(feet.len());
    for (foot, touching) in feet.iter_mut().zip(touching) {
        for (at, &travel) in ground.travel.iter().enumerate() {
            foot.source[at] -= travel;
            foot.target[at] -= scale * travel;
        }
        slide.add(times, &touching, |at, _| horizontal_step(&foot.target, at));
        source_slide.add(times, &touching, |at, _| scale * horizontal_step(&foot.source, at));
        hover.add(times, &touching, |at, secs| 0.5 * secs * (foot.heights[at - 1] + foot.heights[at]));
        let metres_per_sec = horizontal_speeds(times, &foot.target);
        tracks.push(FootTrack { joint: foot.target_joint, times: times.to_vec(), touching, metres_per_sec });
    }
    (FootContacts { slide: slide.value(), source_slide: source_slide.value(), hover: hover.value() }, tracks)
}

/// Horizontal distance from the position before.
fn horizontal_step(positions: &[DVec3], at: usize) -> f64 {
    ((positions[at] - positions[at - 1]) * HORIZONTAL).length()
}

fn horizontal_speeds(times: &[f32], positions: &[DVec3]) -> Vec<f32> {
    let speed = |at: usize| {
        let before = at.saturating_sub(1);
        let secs = f64::from(times[at] - times[before]);
        let distance = if at > 0 { horizontal_step(positions, at) } else { 0.0 };
        if secs > 0.0 { (distance / secs) as f32 } else { 0.0 }
    };
    (0..times.len()).map(speed).collect()
}

/// A mean over the time in contact.
#[derive(Debug, Default)]
struct Mean {
    sum: f64,
    secs: f64,
}

impl Mean {
    /// `step` integrates from the time before to a time, given its index and the seconds between.
    fn add(&mut self, times: &[f32], touching: &[bool], step: impl Fn(usize, f64) -> f64) {
        for at in (1..times.len()).filter(|&at| touching[at - 1] && touching[at]) {
            let secs = f64::from(times[at] - times[at - 1]);
            self.sum += step(at, secs);
            self.secs += secs;
        }
    }

    fn value(&self) -> Option<f64> {
        (self.secs > 0.0).then(|| self.sum / self.secs)
    }
}
