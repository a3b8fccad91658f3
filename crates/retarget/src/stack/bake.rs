//! Bakes a stack of layers into one clip.

use gaitway_character::anim::{Clip, JointIndex, JointMask, Pose, Skeleton};

use super::{ClipLayer, ClipOverLayers, LayerBuffers};
use crate::baker::{Baker, timelines};
use crate::keys::resample::union;

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

/// Clips that repeat more often than this, or have too many keys for it, are sampled without regard to their keys.
const MAX_REPEATS: usize = 10_000;

/// A stack of layers while it is baked, alone or with other changes to the clip.
#[derive(Debug)]
pub struct BakedStack<'a> {
    skeleton: &'a Skeleton,
    layers: Vec<BakedLayer<'a>>,
}

#[derive(Debug)]
struct BakedLayer<'a> {
    stacked: &'a StackedLayer<'a>,
    mask: JointMask,
    /// How long it has run when it is sampled last.
    last_secs: f64,
    buffers: LayerBuffers,
}

impl<'a> BakedStack<'a> {
    /// Registers the channels that the layers replace and the times to sample.
    pub fn new(skeleton: &'a Skeleton, layers: &'a [StackedLayer<'a>], baker: &mut Baker<'_>) -> Self {
        let with_effect = layers.iter().filter(|stacked| stacked.layer.weight > 0.0);
        let layers = with_effect.map(|stacked| {
            let is_included = |joint: &JointIndex| stacked.included[joint.get()];
            skeleton.joints().filter(is_included).for_each(|joint| baker.replace_all(joint));
            BakedLayer {
                stacked,
                mask: JointMask::new(skeleton, &stacked.included),
                last_secs: add_layer(baker, stacked),
                buffers: LayerBuffers::default(),
            }
        });
        Self { skeleton, layers: layers.collect() }
    }

    /// Changes the pose that the clip below has at a time.
    pub fn apply(&mut self, time_secs: f32, pose: &mut Pose) {
        for BakedLayer { stacked, mask, last_secs, buffers } in &mut self.layers {
            let elapsed_secs = f64::from(time_secs).min(*last_secs);
            stacked.layer.apply(self.skeleton, stacked.source, mask, elapsed_secs, buffers, pose);
        }
    }
}

/// Returns a clip with the layers in it, as long as the given one. Joints that no layer changes keep their keys.
pub fn bake_stack(skeleton: &Skeleton, clip: &Clip, layers: &[StackedLayer<'_>]) -> Clip {
    let mut baker = Baker::new(skeleton, clip);
    let mut stack = BakedStack::new(skeleton, layers, &mut baker);
    baker.bake(|time_secs, pose| stack.apply(time_secs, pose))
}

/// More than what times of this size are rounded by.
fn rounding(secs: f64) -> f64 {
    4.0 * f64::from(f32::EPSILON) * secs.abs()
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

/// Adds a layer's keys, and returns how long it has run when it is sampled last: one that starts over at the very end would show
/// its first frame there.
fn add_layer(baker: &mut Baker<'_>, StackedLayer { layer, source, .. }: &StackedLayer<'_>) -> f64 {
    let mut starts_over = add_rounds(baker, layer, source.clip, source.clip.duration_secs());
    for below in source.below.iter().filter(|below| !below.frozen) {
        starts_over |= add_rounds(baker, layer, &below.clip, below.duration_secs);
    }
    let end_secs = f64::from(baker.end_secs());
    if starts_over { end_secs - rounding(end_secs) } else { end_secs }
}

/// Adds the keys of a clip that repeats with a period of its own seconds. Returns whether it starts over at the end.
fn add_rounds(baker: &mut Baker<'_>, layer: &ClipLayer, clip: &Clip, period_secs: f32) -> bool {
    let (period_secs, end_secs) = (f64::from(period_secs), f64::from(baker.end_secs()));
    let repeats = end_secs * layer.speed / period_secs;
    let keys = union(clip.timelines().iter().map(Vec::as_slice)).len();
    if layer.speed <= 0.0 || period_secs <= 0.0 || repeats > baker.max_repeats(keys).min(MAX_REPEATS) as f64 {
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
        let jump = |key: f32| {
            let range = [at(key) - rounding, at(key) + rounding].map(|secs| secs.clamp(0.0, end_secs) as f32);
            first_time(range, |time| is_after(key, time))
        };
        baker.jump_at(jump(0.0));
        starts_over |= (at(0.0) - end_secs).abs() <= rounding;
        for (keys, is_step) in timelines(clip) {
            if is_step {
                baker.jump_at(keys.iter().filter_map(|&key| jump(key)));
            } else {
                baker.sample_at(keys.iter().map(|&key| at(key) as f32));
            }
        }
    }
    starts_over
}
