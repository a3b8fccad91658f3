//! Joints without a source may play one of the model's own clips, which loops with its own duration. In the player they stay
//! a layer; exports bake it into the clip.

use std::ops::Mul;

use gaitway_character::anim::{Channel, Clip, ClipBuilder, Interpolation, Keys, Pose, SampleCursor, Skeleton};
use gaitway_character::asset::Asset;
use gaitway_character::sort::sort_by;

use crate::budget::affordable_rounds;
use crate::change::{time::trim, track::Tracks};
use crate::map::ResolvedMap;

/// One of the model's own clips, cut down to the joints that play it.
#[derive(Debug, Clone)]
pub struct LayerClip {
    /// The channels of those joints only, so it may end before `duration_secs`.
    pub clip: Clip,
    /// Duration of the whole clip, which is that of the loop.
    pub duration_secs: f32,
    /// Holds the first key.
    pub frozen: bool,
}

impl LayerClip {
    /// Time within the clip after the player has run for `elapsed_secs`.
    pub fn time_secs(&self, elapsed_secs: f64) -> f32 {
        let duration_secs = f64::from(self.duration_secs);
        if self.frozen || duration_secs <= 0.0 || !elapsed_secs.is_finite() {
            return 0.0;
        }
        elapsed_secs.rem_euclid(duration_secs) as f32
    }

    /// Writes the layer's joints into `pose`; leaves others as they are.
    pub fn sample(&self, skeleton: &Skeleton, elapsed_secs: f64, cursor: &mut SampleCursor, pose: &mut Pose) {
        self.clip.sample(skeleton, self.time_secs(elapsed_secs), cursor, pose);
    }
}

/// Returns the layers of a map for the model it was resolved against.
pub fn layer_clips(model: &Asset, map: &ResolvedMap) -> Vec<LayerClip> {
    let mut layers: Vec<LayerClip> = Vec::new();
    let mut kinds: Vec<(usize, bool)> = map.layers.iter().map(|layer| (layer.clip, layer.frozen)).collect();
    sort_by(&mut kinds, Ord::cmp);
    kinds.dedup();
    for (index, frozen) in kinds {
        let Some(clip) = model.clips.get(index) else { continue };
        let mut plays = vec![false; model.skeleton.len()];
        let of_kind = map.layers.iter().filter(|layer| layer.clip == index && layer.frozen == frozen);
        of_kind.for_each(|layer| plays[layer.joint.get()] = true);
        let channels = clip.channels().iter().filter(|channel| plays[channel.joint.get()]);
        layers.push(LayerClip { clip: clip_of(model, clip, channels), duration_secs: clip.duration_secs(), frozen });
    }
    layers
}

/// A clip of some of another's channels.
fn clip_of<'a>(model: &Asset, clip: &Clip, channels: impl Iterator<Item = &'a Channel>) -> Clip {
    let mut builder = ClipBuilder::new(clip.name(), &model.skeleton);
    for channel in channels {
        let times = &clip.timelines()[channel.timeline as usize];
        // Channels of a valid clip for the same skeleton are valid.
        let copied = builder.channel(channel.joint, channel.interpolation, times, channel.keys.clone());
        debug_assert!(copied.is_ok());
    }
    builder.build()
}

/// Maximum number of loops to try for a seamless end.
const MAX_LOOPS: usize = 16;

/// Maximum share by which a layer may run faster or slower to fit.
const MAX_STRETCH: f64 = 0.1;

/// How a clip and its layers become one clip.
#[derive(Debug, Clone, PartialEq)]
pub struct Baking {
    /// Loops of the borrowed clip.
    pub loops: usize,
    /// All layers end with it; otherwise the loop has a visible seam.
    pub seamless: bool,
}

impl Baking {
    /// Returns why the loop has a seam, as part of a sentence; `None` if it has none.
    pub fn seam(&self) -> Option<String> {
        let loops = match self.loops {
            1 => "the clip".to_owned(),
            loops => format!("{loops} loops of the clip"),
        };
        (!self.seamless).then(|| format!("{loops} and its layers don't end together"))
    }
}

/// Maximum time by which a layer that isn't stretched may miss the end.
const MAX_GAP_SECS: f64 = 1e-3;

/// Chooses the smallest number of loops in which every layer comes close to a whole number of its own; one if there is none.
/// `periods_secs` are those of layers over the clip, which aren't stretched.
pub fn baking(clip: &Clip, layers: &[LayerClip], periods_secs: &[f64], asked_loops: Option<usize>) -> Baking {
    let moving = || layers.iter().filter(|layer| !layer.frozen && layer.duration_secs > 0.0);
    let fits = |loops: usize| {
        let secs = loops as f64 * f64::from(clip.duration_secs());
        let below = moving().all(|layer| {
            let rounds = secs / f64::from(layer.duration_secs);
            rounds.round() >= 1.0 && (rounds / rounds.round() - 1.0).abs() <= MAX_STRETCH
        });
        below && periods_secs.iter().all(|&period| (secs - (secs / period).round() * period).abs() <= MAX_GAP_SECS)
    };
    match asked_loops {
        Some(loops) => {
            let loops = loops.clamp(1, max_loops(clip));
            Baking { loops, seamless: fits(loops) }
        }
        None => match (1..=MAX_LOOPS.min(max_loops(clip))).find(|&loops| fits(loops)) {
            Some(loops) => Baking { loops, seamless: true },
            None => Baking { loops: 1, seamless: false },
        },
    }
}

/// Merges the borrowed clip and its layers into one ordinary clip: repeats keys, and stretches layers to whole loops if they
/// fit. Nothing is resampled.
pub fn bake_layers(model: &Asset, clip: &Clip, layers: &[LayerClip], baking: &Baking) -> Clip {
    let mut builder = ClipBuilder::new(clip.name(), &model.skeleton);
    let total_secs = f64::from(clip.duration_secs()) * baking.loops as f64;
    let mut add = |source: &Clip, repeat: Option<Repeat>| {
        let stretch = repeat.as_ref().map_or(1.0, |repeat| repeat.stretch);
        let repeated = |times: &[f32]| match &repeat {
            Some(repeat) => repeated_times(times, repeat),
            None => (vec![0.0], vec![0]),
        };
        for channel in source.channels() {
            let (times, kept) = repeated(&source.timelines()[channel.timeline as usize]);
            let keys = select_keys(channel, &kept, stretch);
            let added = builder.channel(channel.joint, channel.interpolation, &times, keys);
            debug_assert!(added.is_ok(), "{added:?}");
        }
        for channel in source.properties() {
            let (times, kept) = repeated(&source.property_timelines()[channel.timeline as usize]);
            let is_spline = channel.interpolation == Interpolation::CubicSpline;
            let values = select(&channel.values, &kept, channel.target.width(), is_spline, stretch);
            let added = builder.property(channel.target, channel.interpolation, &times, values);
            debug_assert!(added.is_ok(), "{added:?}");
        }
    };
    for layer in layers {
        let duration_secs = f64::from(layer.duration_secs);
        if layer.frozen || duration_secs <= 0.0 || total_secs <= 0.0 {
            add(&layer.clip, None);
            continue;
        }
        let loops = total_secs / duration_secs;
        let stretch = if baking.seamless { loops / loops.round().max(1.0) } else { 1.0 };
        let period_secs = duration_secs * stretch;
        // One that is too short for that stands still from there.
        let loops = affordable_rounds(key_count(&layer.clip), total_secs / period_secs);
        add(&layer.clip, Some(Repeat { loops, period_secs, stretch, total_secs }));
    }
    let period_secs = f64::from(clip.duration_secs());
    add(clip, Some(Repeat { loops: baking.loops, period_secs, stretch: 1.0, total_secs }));
    let baked = builder.build();
    if f64::from(baked.duration_secs()) <= total_secs + MAX_GAP_SECS {
        return baked;
    }
    // A layer that doesn't fit ends with the clip, wherever it is.
    let mut tracks = Tracks::of(&baked);
    trim(&mut tracks, 0.0, total_secs as f32);
    tracks.build(clip.name(), &model.skeleton)
}

/// Most loops that a clip can have: the budget has so many keys, and floats such times.
fn max_loops(clip: &Clip) -> usize {
    affordable_rounds(key_count(clip), 1000.0).min((f32::MAX / clip.duration_secs()) as usize).max(1)
}

/// Number of keys of all channels.
fn key_count(clip: &Clip) -> usize {
    let joints = clip.channels().iter().map(|channel| clip.timelines()[channel.timeline as usize].len());
    let properties = clip.properties().iter().map(|channel| clip.property_timelines()[channel.timeline as usize].len());
    joints.chain(properties).sum()
}

/// How often a clip is repeated, and how long one loop is after stretching.
struct Repeat {
    loops: usize,
    period_secs: f64,
    /// Factor on the clip's times.
    stretch: f64,
    total_secs: f64,
}

/// Returns the repeated times and which key each belongs to. Of the keys after `total_secs` only the first is kept, as the
/// end of the last segment.
fn repeated_times(times: &[f32], repeat: &Repeat) -> (Vec<f32>, Vec<usize>) {
    let mut repeated: Vec<f32> = Vec::new();
    let mut kept: Vec<usize> = Vec::new();
    for round in 0..repeat.loops.max(1) {
        for (key, &time) in times.iter().enumerate() {
            let exact = round as f64 * repeat.period_secs + f64::from(time) * repeat.stretch;
            let mut time = exact as f32;
            // The end of one loop is the start of the next: both keys stay, the second at the next representable time.
            if let Some(&before) = repeated.last()
                && time <= before
            {
                time = before.next_up();
            }
            repeated.push(time);
            kept.push(key);
            if exact >= repeat.total_secs {
                return (repeated, kept);
            }
        }
    }
    (repeated, kept)
}

/// The channel's keys with these indices, for times multiplied by `stretch`.
fn select_keys(channel: &Channel, kept: &[usize], stretch: f64) -> Keys {
    let is_spline = channel.interpolation == Interpolation::CubicSpline;
    match &channel.keys {
        Keys::Translation(values) => Keys::Translation(select(values, kept, 1, is_spline, stretch)),
        Keys::Scale(values) => Keys::Scale(select(values, kept, 1, is_spline, stretch)),
        Keys::Rotation(values) => Keys::Rotation(select(values, kept, 1, is_spline, stretch)),
        Keys::MorphWeights { values, targets } => {
            Keys::MorphWeights { values: select(values, kept, *targets, is_spline, stretch), targets: *targets }
        }
    }
}

/// `width`: values per entry. A spline has three entries per key: in-tangent, value, out-tangent.
fn select<T>(values: &[T], kept: &[usize], width: usize, is_spline: bool, stretch: f64) -> Vec<T>
where
    T: Copy + Mul<f32, Output = T>,
{
    let per_key = if is_spline { 3 * width } else { width };
    // Tangents are per second.
    let tangent_factor = (1.0 / stretch) as f32;
    let mut selected = Vec::with_capacity(kept.len() * per_key);
    for &key in kept {
        for (index, &value) in values[key * per_key..(key + 1) * per_key].iter().enumerate() {
            let is_tangent = is_spline && index / width != 1;
            selected.push(if is_tangent { value * tangent_factor } else { value });
        }
    }
    selected
}
