//! The times at which clips are corrected: planted feet and kept contacts.

use std::ops::Range;

use gaitway_character::anim::{Clip, Interpolation};

use crate::budget::{corrected_poses, parts_between};
use crate::keys::resample::union;

/// Maximum distance between keys of a corrected clip.
const MAX_STEP_SECS: f32 = 1.0 / 30.0;
/// Most parts of the time between two keys, which a damaged file has anywhere.
const MAX_PARTS: usize = 1000;

/// The clip's key times, and more where these are far apart and just before a jump.
pub fn dense_times(clip: &Clip) -> Vec<f32> {
    let keys = union(clip.timelines().iter().map(Vec::as_slice));
    let stepped = clip.channels().iter().filter(|channel| channel.interpolation == Interpolation::Step);
    let jumps = union(stepped.map(|channel| clip.timelines()[channel.timeline as usize].as_slice()));
    let max_parts = parts_between(keys.len(), MAX_PARTS);
    let mut times: Vec<f32> = Vec::with_capacity(keys.len());
    for &key in &keys {
        if let Some(&before) = times.last() {
            let parts = (((key - before) / MAX_STEP_SECS).ceil() as usize).clamp(1, max_parts);
            let step = (key - before) / parts as f32;
            times.extend((1..parts).map(|part| before + step * part as f32));
            let is_jump = jumps.binary_search_by(|jump| jump.total_cmp(&key)).is_ok();
            times.extend(Some(key.next_down()).filter(|&time| is_jump && time > before));
        }
        times.push(key);
    }
    times
}

/// The times at which feet are planted and contacts kept, which holds the poses at all of them; `None` if these are too many
/// for a model with this number of joints.
pub fn corrected_times(clip: &Clip, joints: usize) -> Option<Vec<f32>> {
    let times = dense_times(clip);
    (times.len() <= corrected_poses(joints)).then_some(times)
}

/// The times within `secs` of one of them.
pub fn near(times: &[f32], at: usize, secs: f64) -> Range<usize> {
    let from = times.partition_point(|&time| f64::from(times[at] - time) > secs);
    let to = times.partition_point(|&time| f64::from(time - times[at]) <= secs);
    from..to
}
