//! When a function is sampled.

use gaitway_character::anim::{Clip, Interpolation};

use crate::keys::resample::union;

/// Most samples between two given times: a damaged file has keys at any. Where joints turn fast, there are more.
const MAX_STEPS: usize = 600;

/// Collected in any order.
#[derive(Debug)]
pub struct SampleTimes {
    end_secs: f32,
    pub times: Vec<f32>,
    /// The first time after each jump.
    pub jumps: Vec<f32>,
    /// Longest time between two.
    pub max_step_secs: f32,
}

/// Returns the timelines of a clip, each with whether it has steps.
pub fn timelines(clip: &Clip) -> impl Iterator<Item = (&Vec<f32>, bool)> {
    let mut steps = vec![false; clip.timelines().len()];
    for channel in clip.channels() {
        steps[channel.timeline as usize] |= channel.interpolation == Interpolation::Step;
    }
    clip.timelines().iter().zip(steps)
}

impl SampleTimes {
    pub fn of(clip: &Clip) -> Self {
        let end_secs = clip.duration_secs();
        let (times, jumps) = (vec![0.0, end_secs], Vec::new());
        let mut found = Self { end_secs, times, jumps, max_step_secs: f32::INFINITY };
        for (keys, is_step) in timelines(clip) {
            if is_step { &mut found.jumps } else { &mut found.times }.extend(keys);
        }
        found
    }

    /// Returns all times within the clip, and those of jumps, ascending; no more than `max_times` unless there are more keys.
    pub fn finish(self, max_times: usize) -> (Vec<f32>, Vec<f32>) {
        let jumps = union([&self.jumps[..]]);
        let mut times = union([&self.times[..], &jumps]);
        times.retain(|time| (0.0..=self.end_secs).contains(time));
        if self.max_step_secs.is_finite() {
            times = split(&times, self.max_step_secs, max_times);
        }
        (times, jumps)
    }
}

/// Adds times where two are more than a step apart.
fn split(times: &[f32], max_step_secs: f32, max_times: usize) -> Vec<f32> {
    let max_steps = MAX_STEPS.min(max_times / times.len().max(1)).max(1);
    let mut close = Vec::with_capacity(times.len());
    for pair in times.windows(2) {
        let steps = (((pair[1] - pair[0]) / max_step_secs).ceil() as usize).clamp(1, max_steps);
        close.extend((0..steps).map(|step| pair[0] + (pair[1] - pair[0]) * (step as f32 / steps as f32)));
    }
    close.extend(times.last());
    close.dedup();
    close
}
