//! What joints without a source do meanwhile: parts of the model's own clips, each looping on its own duration.

use crate::anim::{Channel, Clip, ClipBuilder, JointIndex, Keys, Pose, SampleCursor, Skeleton};

use crate::asset::Asset;
use crate::retarget::map::ResolvedMap;

/// One of the model's own clips, cut down to the joints that play it.
#[derive(Debug, Clone)]
pub struct LayerClip {
    pub clip: Clip,
    /// The loop's length: that of the whole clip.
    pub duration_secs: f32,
    /// The first key for all time.
    pub frozen: bool,
}

impl LayerClip {
    /// Where in the clip it is when the player has run for so long, in seconds from 0 up.
    pub fn time_secs(&self, elapsed_secs: f64) -> f32 {
        let duration_secs = f64::from(self.duration_secs);
        if self.frozen || duration_secs <= 0.0 || !elapsed_secs.is_finite() {
            return 0.0;
        }
        elapsed_secs.rem_euclid(duration_secs) as f32
    }

    /// Writes the layer's joints into `pose`; others are left as they are.
    pub fn sample(&self, skeleton: &Skeleton, elapsed_secs: f64, cursor: &mut SampleCursor, pose: &mut Pose) {
        self.clip.sample(skeleton, self.time_secs(elapsed_secs), cursor, pose);
    }
}

/// The layers of a map over the model it was resolved against.
pub fn layer_clips(model: &Asset, map: &ResolvedMap) -> Vec<LayerClip> {
    let mut layers: Vec<LayerClip> = Vec::new();
    let mut kinds: Vec<(usize, bool)> = map.layers.iter().map(|layer| (layer.clip, layer.frozen)).collect();
    kinds.sort_unstable();
    kinds.dedup();
    for (index, frozen) in kinds {
        let Some(clip) = model.clips.get(index) else { continue };
        let plays = |joint: JointIndex| {
            map.layers.iter().any(|layer| layer.joint == joint && layer.clip == index && layer.frozen == frozen)
        };
        let channels = clip.channels().iter().filter(|channel| plays(channel.joint));
        layers.push(LayerClip { clip: part(model, clip, channels), duration_secs: clip.duration_secs(), frozen });
    }
    layers
}

/// Channels of a clip as a clip of their own.
fn part<'a>(model: &Asset, clip: &Clip, channels: impl Iterator<Item = &'a Channel>) -> Clip {
    let mut builder = ClipBuilder::new(clip.name(), &model.skeleton);
    for channel in channels {
        let times = &clip.timelines()[channel.timeline as usize];
        // They come from a valid clip over the same skeleton.
        let copied = builder.channel(channel.joint, channel.interpolation, times, channel.keys.clone());
        debug_assert!(copied.is_ok());
    }
    builder.build()
}

/// Most rounds of the borrowed clip that are looked at when it is to come out even with its layers.
const MOST_LOOPS: usize = 16;

/// A layer may run this much faster or slower to fit.
const MOST_STRETCH: f64 = 0.1;

/// How layered motion is written down.
#[derive(Debug, Clone, PartialEq)]
pub struct Baking {
    /// Rounds of the borrowed clip.
    pub loops: usize,
    /// All layers end with it; else the seam shows.
    pub seamless: bool,
}

/// The smallest number of rounds in which every layer comes within a tenth of whole loops; else one.
pub fn baking(clip: &Clip, layers: &[LayerClip], asked_loops: Option<usize>) -> Baking {
    let moving = || layers.iter().filter(|layer| !layer.frozen && layer.duration_secs > 0.0);
    let fits = |loops: usize| {
        let secs = loops as f64 * f64::from(clip.duration_secs());
        moving().all(|layer| {
            let rounds = secs / f64::from(layer.duration_secs);
            rounds.round() >= 1.0 && (rounds / rounds.round() - 1.0).abs() <= MOST_STRETCH
        })
    };
    match asked_loops {
        Some(loops) => Baking { loops: loops.clamp(1, 1000), seamless: fits(loops.clamp(1, 1000)) },
        None => match (1..=MOST_LOOPS).find(|&loops| fits(loops)) {
            Some(loops) => Baking { loops, seamless: true },
            None => Baking { loops: 1, seamless: false },
        },
    }
}

/// The borrowed clip and its layers as one ordinary clip: keys are repeated, layers stretched to whole loops where they
/// fit. Nothing is resampled.
pub fn bake_layers(model: &Asset, clip: &Clip, layers: &[LayerClip], baking: &Baking) -> Clip {
    let mut builder = ClipBuilder::new(clip.name(), &model.skeleton);
    let total_secs = f64::from(clip.duration_secs()) * baking.loops as f64;
    let mut add = |source: &Clip, period_secs: f64, stretch: f64, rounds: usize| {
        for channel in source.channels() {
            let times = &source.timelines()[channel.timeline as usize];
            let (times, keys) = repeated(times, channel, period_secs, stretch, rounds, total_secs);
            let added = builder.channel(channel.joint, channel.interpolation, &times, keys);
            debug_assert!(added.is_ok(), "{added:?}");
        }
    };
    for layer in layers {
        let duration_secs = f64::from(layer.duration_secs);
        if layer.frozen || duration_secs <= 0.0 || total_secs <= 0.0 {
            add(&layer.clip, 0.0, 0.0, 1);
            continue;
        }
        let rounds = total_secs / duration_secs;
        let stretch = if baking.seamless { rounds / rounds.round().max(1.0) } else { 1.0 };
        add(&layer.clip, duration_secs * stretch, stretch, (total_secs / (duration_secs * stretch)).ceil() as usize);
    }
    add(clip, f64::from(clip.duration_secs()), 1.0, baking.loops);
    builder.build()
}

/// Keys of `rounds` rounds of a channel, each `period_secs` long; keys after `total_secs` are left out, but for the first
/// of them, which the way there leads to. A stretch of 0 keeps the first key alone.
fn repeated(
    times: &[f32],
    channel: &Channel,
    period_secs: f64,
    stretch: f64,
    rounds: usize,
    total_secs: f64,
) -> (Vec<f32>, Keys) {
    let mut at: Vec<usize> = Vec::new();
    let mut out: Vec<f32> = Vec::new();
    if stretch == 0.0 {
        (at, out) = (vec![0], vec![0.0]);
    }
    'rounds: for round in 0..if stretch == 0.0 { 0 } else { rounds.max(1) } {
        for (key, &time) in times.iter().enumerate() {
            let exact = round as f64 * period_secs + f64::from(time) * stretch;
            let mut time = exact as f32;
            // The end of one round is the start of the next: both keys stay, the second as soon after as can be told.
            if let Some(&before) = out.last()
                && time <= before
            {
                time = before.next_up();
            }
            out.push(time);
            at.push(key);
            if exact >= total_secs && round > 0 {
                break 'rounds;
            }
        }
    }
    let per_key = if channel.interpolation == crate::anim::Interpolation::CubicSpline { 3 } else { 1 };
    fn pick<T: Copy>(values: &[T], at: &[usize], per_key: usize) -> Vec<T> {
        at.iter().flat_map(|&key| values[key * per_key..(key + 1) * per_key].iter().copied()).collect()
    }
    let keys = match &channel.keys {
        Keys::Translation(values) => Keys::Translation(pick(values, &at, per_key)),
        Keys::Scale(values) => Keys::Scale(pick(values, &at, per_key)),
        Keys::Rotation(values) => Keys::Rotation(pick(values, &at, per_key)),
        Keys::MorphWeights { values, targets } => {
            Keys::MorphWeights { values: pick(values, &at, per_key * targets), targets: *targets }
        }
    };
    (out, keys)
}
