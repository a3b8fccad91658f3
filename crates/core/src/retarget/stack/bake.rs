//! Bakes a stack of layers into one clip.

use super::sampled::{Poses, bake};
use super::{ClipLayer, ClipOverLayers, LayerBuffers};
use crate::anim::{Clip, Interpolation, JointMask, Pose, SampleCursor, Skeleton};
use crate::retarget::keys::resample::union;

/// A layer with its clip and joints.
#[derive(Debug, Clone)]
pub struct StackedLayer<'a> {
    /// The settings.
    pub layer: &'a ClipLayer,
    /// The clip they name.
    pub source: ClipOverLayers<'a>,
    /// The joints of its mask, one flag per joint.
    pub included: Vec<bool>,
}

/// Clips that repeat more often than this are sampled without regard to their keys.
const MAX_REPEATS: f64 = 10_000.0;

/// When to sample.
struct Times {
    end_secs: f32,
    times: Vec<f32>,
    /// The first time after each jump.
    jumps: Vec<f32>,
}

/// Returns a clip with the layers in it, as long as the given one. Joints that no layer changes keep their keys; others get as
/// few as hold every joint within 0.05° and 0.1 mm per metre of height.
pub fn bake_stack(skeleton: &Skeleton, clip: &Clip, layers: &[StackedLayer<'_>]) -> Clip {
    let layers: Vec<_> = layers.iter().filter(|stacked| stacked.layer.weight > 0.0).collect();
    let masks: Vec<JointMask> = layers.iter().map(|stacked| JointMask::new(skeleton, &stacked.included)).collect();
    let included: Vec<bool> =
        (0..skeleton.len()).map(|joint| layers.iter().any(|stacked| stacked.included[joint])).collect();
    if !included.contains(&true) {
        return clip.clone();
    }
    let mut times = Times::new(clip);
    let last_secs: Vec<f64> = layers.iter().map(|stacked| times.add_layer(stacked)).collect();
    let (times, jumps) = times.finish();
    let mut buffers: Vec<LayerBuffers> = vec![LayerBuffers::default(); layers.len()];
    let mut cursor = SampleCursor::default();
    let mut pose_at = |time_secs: f32, pose: &mut Pose| {
        pose.copy_from(skeleton.rest());
        clip.sample(skeleton, time_secs, &mut cursor, pose);
        for (index, stacked) in layers.iter().enumerate() {
            let elapsed_secs = f64::from(time_secs).min(last_secs[index]);
            stacked.layer.apply(skeleton, stacked.source, &masks[index], elapsed_secs, &mut buffers[index], pose);
        }
    };
    bake(clip, Poses { skeleton, included: &included, times, jumps, pose_at: &mut pose_at })
}

/// More than what times of this size are rounded by.
fn rounding(secs: f64) -> f64 {
    4.0 * f64::from(f32::EPSILON) * secs.abs()
}

/// The timelines of a clip, each with whether it has steps.
fn timelines(clip: &Clip) -> impl Iterator<Item = (&Vec<f32>, bool)> {
    let mut steps = vec![false; clip.timelines().len()];
    for channel in clip.channels() {
        steps[channel.timeline as usize] |= channel.interpolation == Interpolation::Step;
    }
    clip.timelines().iter().zip(steps)
}

/// Returns the first time in a range for which `is_after` holds, if it holds for its end. Neither end is negative.
fn first_time([mut from, mut to]: [f32; 2], is_after: impl Fn(f32) -> bool) -> Option<f32> {
    if is_after(from) {
        return Some(from);
    }
    // The bits of positive floats are in the order of their values.
    while from.next_up() < to {
        let middle = f32::from_bits(from.to_bits().midpoint(to.to_bits()));
        *(if is_after(middle) { &mut to } else { &mut from }) = middle;
    }
    is_after(to).then_some(to)
}

impl Times {
    fn new(clip: &Clip) -> Self {
        let end_secs = clip.duration_secs();
        let mut times = Self { end_secs, times: vec![0.0, end_secs], jumps: Vec::new() };
        for (keys, is_step) in timelines(clip) {
            if is_step { &mut times.jumps } else { &mut times.times }.extend(keys);
        }
        times
    }

    /// Adds a layer's keys, and returns how long it has run when it is sampled last: one that starts over at the very end would
    /// show its first frame there.
    fn add_layer(&mut self, StackedLayer { layer, source, .. }: &StackedLayer<'_>) -> f64 {
        let mut starts_over = self.add_rounds(layer, source.clip, source.clip.duration_secs());
        for below in source.below.iter().filter(|below| !below.frozen) {
            starts_over |= self.add_rounds(layer, &below.clip, below.duration_secs);
        }
        let end_secs = f64::from(self.end_secs);
        if starts_over { end_secs - rounding(end_secs) } else { end_secs }
    }

    /// Adds the keys of a clip that repeats with a period of its own seconds. Returns whether it starts over at the end.
    fn add_rounds(&mut self, layer: &ClipLayer, clip: &Clip, period_secs: f32) -> bool {
        let (period_secs, end_secs) = (f64::from(period_secs), f64::from(self.end_secs));
        let repeats = end_secs * layer.speed / period_secs;
        if layer.speed <= 0.0 || period_secs <= 0.0 || repeats > MAX_REPEATS {
            return false;
        }
        let rounding = rounding(end_secs + period_secs / layer.speed);
        let first = layer.run_secs(0.0).div_euclid(period_secs);
        let mut starts_over = false;
        for round in 0..=repeats.ceil() as usize + 1 {
            let round = first + round as f64;
            let at = |key: f32| (round * period_secs + f64::from(key)) / layer.speed + layer.start_secs;
            let is_after = |key: f32, time: f32| {
                let run_secs = layer.run_secs(time.into());
                let secs = run_secs.rem_euclid(period_secs);
                let rounds = ((run_secs - secs) / period_secs).round();
                rounds > round || (rounds == round && secs as f32 >= key)
            };
            let mut jump = |key: f32| {
                let range = [at(key) - rounding, at(key) + rounding].map(|secs| secs.clamp(0.0, end_secs) as f32);
                self.jumps.extend(first_time(range, |time| is_after(key, time)));
            };
            jump(0.0);
            starts_over |= (at(0.0) - end_secs).abs() <= rounding;
            for (keys, is_step) in timelines(clip) {
                if is_step {
                    keys.iter().for_each(|&key| jump(key));
                } else {
                    self.times.extend(keys.iter().map(|&key| at(key) as f32));
                }
            }
        }
        starts_over
    }

    /// Returns all times, and those of jumps.
    fn finish(self) -> (Vec<f32>, Vec<f32>) {
        let jumps = union([&self.jumps[..]]);
        let mut times = union([&self.times[..], &jumps]);
        times.retain(|time| (0.0..=self.end_secs).contains(time));
        (times, jumps)
    }
}
