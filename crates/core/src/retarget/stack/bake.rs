//! Bakes a stack of layers into one clip.

use super::sampled::{Poses, bake};
use super::{ClipLayer, ClipOverLayers, LayerBuffers};
use crate::anim::{Clip, Interpolation, JointMask, Pose, SampleCursor, Skeleton};

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
    end_secs: f64,
    times: Vec<f32>,
    /// Times of jumps, each with the time around it in which rounding may have it.
    jumps: Vec<[f32; 2]>,
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
    let end_secs = f64::from(clip.duration_secs());
    let mut times = Times { end_secs, times: vec![0.0, clip.duration_secs()], jumps: Vec::new() };
    times.add(clip, 1.0, 0.0, 0.0);
    for StackedLayer { layer, source, .. } in &layers {
        let start_secs = layer.start_secs;
        times.add(source.clip, layer.speed, start_secs, f64::from(source.clip.duration_secs()));
        for below in source.below.iter().filter(|below| !below.frozen) {
            times.add(&below.clip, layer.speed, start_secs, f64::from(below.duration_secs));
        }
    }
    let (times, jumps) = times.finish();
    let mut buffers: Vec<LayerBuffers> = vec![LayerBuffers::default(); layers.len()];
    let mut cursor = SampleCursor::default();
    // A layer that starts over at the very end would show its first frame there.
    let just_before_end = end_secs - rounding(end_secs);
    let mut pose_at = |time_secs: f32, pose: &mut Pose| {
        pose.copy_from(skeleton.rest());
        clip.sample(skeleton, time_secs, &mut cursor, pose);
        let elapsed_secs = f64::from(time_secs).min(just_before_end);
        for ((stacked, mask), buffers) in layers.iter().zip(&masks).zip(&mut buffers) {
            stacked.layer.apply(skeleton, stacked.source, mask, elapsed_secs, buffers, pose);
        }
    };
    bake(clip, Poses { skeleton, included: &included, times, jumps, pose_at: &mut pose_at })
}

/// More than what times of this size are rounded by.
fn rounding(secs: f64) -> f64 {
    4.0 * f64::from(f32::EPSILON) * secs.abs()
}

impl Times {
    /// Adds the keys of a clip that repeats with a period of its own seconds, 0 for one that doesn't.
    fn add(&mut self, clip: &Clip, speed: f64, start_secs: f64, period_secs: f64) {
        let repeats = if period_secs > 0.0 { self.end_secs * speed / period_secs } else { 0.0 };
        if speed <= 0.0 || repeats > MAX_REPEATS {
            return;
        }
        let rounding = rounding(self.end_secs + f64::from(clip.duration_secs()) / speed);
        let mut steps = vec![false; clip.timelines().len()];
        for channel in clip.channels() {
            steps[channel.timeline as usize] |= channel.interpolation == Interpolation::Step;
        }
        let first = if period_secs > 0.0 { (-start_secs * speed / period_secs).floor() } else { 0.0 };
        for round in 0..=repeats.ceil() as usize + 1 {
            let begin_secs = (first + round as f64) * period_secs;
            let at = |secs: f64| (begin_secs + secs) / speed + start_secs;
            if period_secs > 0.0 {
                self.jump(at(0.0), rounding);
            }
            for (times, is_step) in clip.timelines().iter().zip(&steps) {
                let secs = times.iter().map(|&time| at(time.into()));
                if *is_step {
                    secs.for_each(|secs| self.jump(secs, rounding));
                } else {
                    secs.for_each(|secs| self.push(secs));
                }
            }
        }
    }

    fn push(&mut self, secs: f64) {
        if (0.0..=self.end_secs).contains(&secs) {
            self.times.push(secs as f32);
        }
    }

    fn jump(&mut self, secs: f64, rounding: f64) {
        if secs > rounding && secs < self.end_secs - rounding {
            self.jumps.push([secs - rounding, secs + rounding].map(|secs| secs as f32));
        }
    }

    /// Returns the times, with those around jumps but none within, and the times right before jumps.
    fn finish(mut self) -> (Vec<f32>, Vec<f32>) {
        self.jumps.sort_by(|a, b| a[0].total_cmp(&b[0]));
        self.times.extend(self.jumps.iter().flatten());
        self.times.sort_by(f32::total_cmp);
        self.times.dedup();
        let jumps = &self.jumps;
        let is_within = |time: f32| {
            let after = jumps.partition_point(|jump| jump[0] < time);
            // Jumps of several clips may overlap, but hardly more than a few.
            jumps[..after].iter().rev().take(8).any(|jump| time < jump[1])
        };
        self.times.retain(|&time| !is_within(time));
        let before = jumps.iter().map(|jump| jump[0]).filter(|&time| !is_within(time)).collect();
        (self.times, before)
    }
}
