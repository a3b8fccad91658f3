//! When a function is sampled.

use crate::anim::{Clip, Interpolation};
use crate::retarget::keys::resample::union;

/// Collected in any order.
#[derive(Debug)]
pub struct SampleTimes {
    end_secs: f32,
    pub times: Vec<f32>,
    /// The first time after each jump.
    pub jumps: Vec<f32>,
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
        let mut found = Self { end_secs, times: vec![0.0, end_secs], jumps: Vec::new() };
        for (keys, is_step) in timelines(clip) {
            if is_step { &mut found.jumps } else { &mut found.times }.extend(keys);
        }
        found
    }

    /// Returns all times within the clip, and those of jumps, ascending.
    pub fn finish(self) -> (Vec<f32>, Vec<f32>) {
        let jumps = union([&self.jumps[..]]);
        let mut times = union([&self.times[..], &jumps]);
        times.retain(|time| (0.0..=self.end_secs).contains(time));
        (times, jumps)
    }
}
