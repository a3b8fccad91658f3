//! Animation clips: keyframe channels for one skeleton, stored exactly as loaded. Sampling lives in `sampler`.

use std::sync::Arc;

use foldhash::HashMap;

use super::channel::{Channel, ChannelError, Interpolation, Keys};
use super::property::{Properties, PropertyChannel, PropertyTarget, PropertyValues};
use super::sampler::Sampler;
use super::{JointIndex, Pose, Skeleton};

/// A named set of channels for one skeleton. Immutable once built; clones share the keys.
#[derive(Debug, Clone)]
pub struct Clip {
    name: String,
    shared: Arc<Shared>,
}

/// Everything but the name, which clones share.
#[derive(Debug, Clone)]
struct Shared {
    duration_secs: f32,
    timelines: Vec<Vec<f32>>,
    channels: Vec<Channel>,
    sampler: Sampler,
    properties: Properties,
}

/// How to look up a clip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClipQuery<'a> {
    /// Position in the list, from 0.
    Index(usize),
    /// An exact name.
    Name(&'a str),
    /// A name, or an index in decimal if no clip has that name.
    NameOrIndex(&'a str),
}

/// Finds a clip in a list; of several with the same name, the first.
pub fn find_clip<'a>(clips: impl Iterator<Item = &'a Clip> + Clone, query: ClipQuery<'_>) -> Option<usize> {
    let by_index = |index: usize| clips.clone().nth(index).map(|_| index);
    let by_name = |name: &str| clips.clone().position(|clip| clip.name() == name);
    match query {
        ClipQuery::Index(index) => by_index(index),
        ClipQuery::Name(name) => by_name(name),
        ClipQuery::NameOrIndex(text) => by_name(text).or_else(|| by_index(text.parse().ok()?)),
    }
}

/// Caches the last segment of each timeline to make forward playback cheap. It never affects the result.
#[derive(Debug, Clone, Default)]
pub struct SampleCursor {
    pub(super) segments: Vec<u32>,
    property_segments: Vec<u32>,
}

/// Builds a [`Clip`]. Each channel is validated when it is added.
#[derive(Debug)]
pub struct ClipBuilder<'a> {
    skeleton: &'a Skeleton,
    name: String,
    duration_secs: f32,
    timelines: Timelines,
    channels: Vec<Channel>,
    property_timelines: Timelines,
    properties: Vec<PropertyChannel>,
}

/// Distinct lists of key times.
#[derive(Debug, Default)]
struct Timelines {
    times_secs: Vec<Vec<f32>>,
    /// Indices by the bit patterns of the times.
    indices: HashMap<Vec<u32>, u32>,
}

impl Timelines {
    /// Returns the index of these times, adding them if they are new. `last` is the index returned by the previous
    /// call.
    fn index(&mut self, times_secs: &[f32], last: Option<u32>) -> u32 {
        let bits = times_secs.iter().map(|time_secs| time_secs.to_bits());
        // Most channels share their times with the previous one.
        if let Some(last) = last
            && bits.clone().eq(self.times_secs[last as usize].iter().map(|time_secs| time_secs.to_bits()))
        {
            return last;
        }
        *self.indices.entry(bits.collect()).or_insert_with(|| {
            self.times_secs.push(times_secs.to_vec());
            self.times_secs.len() as u32 - 1
        })
    }
}

impl<'a> ClipBuilder<'a> {
    /// Starts a clip without channels. The name may be empty.
    pub fn new(name: impl Into<String>, skeleton: &'a Skeleton) -> Self {
        Self {
            skeleton,
            name: name.into(),
            duration_secs: 0.0,
            timelines: Timelines::default(),
            channels: Vec::new(),
            property_timelines: Timelines::default(),
            properties: Vec::new(),
        }
    }

    /// Adds a channel. `times_secs` must be non-negative and strictly increasing; `keys` has one entry per key, three
    /// for CUBICSPLINE. Rotations are normalized when sampled. If a property of a joint has several channels, the last
    /// one wins.
    pub fn channel(
        &mut self,
        joint: JointIndex,
        interpolation: Interpolation,
        times_secs: &[f32],
        keys: Keys,
    ) -> Result<(), ChannelError> {
        self.check_joint(joint)?;
        let last_secs = check_times(times_secs)?;
        if let Keys::MorphWeights { targets, .. } = &keys {
            let expected = self.skeleton.morph_range(joint).len();
            if *targets != expected || expected == 0 {
                return Err(ChannelError::MorphTargetCount { expected, found: *targets });
            }
        }
        let (found, per_entry) = keys.count();
        check_count(times_secs.len(), interpolation, per_entry, found)?;
        let timeline = self.timelines.index(times_secs, self.channels.last().map(|channel| channel.timeline));
        self.duration_secs = self.duration_secs.max(last_secs);
        self.channels.push(Channel { joint, interpolation, timeline, keys });
        Ok(())
    }

    /// Adds a channel for something other than a joint's transform, with [`PropertyTarget::width`] numbers per value.
    /// Otherwise like [`Self::channel`]. Visibility is never interpolated.
    pub fn property(
        &mut self,
        target: PropertyTarget,
        interpolation: Interpolation,
        times_secs: &[f32],
        values: Vec<f32>,
    ) -> Result<(), ChannelError> {
        let mut interpolation = interpolation;
        match target {
            PropertyTarget::Visibility(joint) => {
                self.check_joint(joint)?;
                interpolation = Interpolation::Step;
            }
            PropertyTarget::MorphWeight(joint, target) => {
                self.check_joint(joint)?;
                let expected = self.skeleton.morph_range(joint).len();
                if target >= expected {
                    return Err(ChannelError::MorphTargetCount { expected, found: target.saturating_add(1) });
                }
            }
            _ => {}
        }
        let last_secs = check_times(times_secs)?;
        check_count(times_secs.len(), interpolation, target.width(), values.len())?;
        let last = self.properties.last().map(|channel| channel.timeline);
        let timeline = self.property_timelines.index(times_secs, last);
        self.duration_secs = self.duration_secs.max(last_secs);
        self.properties.push(PropertyChannel { target, interpolation, timeline, values });
        Ok(())
    }

    fn check_joint(&self, joint: JointIndex) -> Result<(), ChannelError> {
        let count = self.skeleton.len();
        if joint.get() < count { Ok(()) } else { Err(ChannelError::NoSuchJoint { joint: joint.get(), count }) }
    }

    /// Finishes the clip. Its duration is 0 if it has no channels.
    pub fn build(self) -> Clip {
        let Self { skeleton, name, duration_secs, timelines, channels, property_timelines, properties } = self;
        let timelines = timelines.times_secs;
        let sampler = Sampler::new(&timelines, &channels, skeleton.rest());
        let properties = Properties::new(property_timelines.times_secs, properties);
        Clip { name, shared: Arc::new(Shared { duration_secs, timelines, channels, sampler, properties }) }
    }
}

fn check_count(keys: usize, interpolation: Interpolation, per_entry: usize, found: usize) -> Result<(), ChannelError> {
    let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    let expected = keys * per_key * per_entry;
    if expected == found { Ok(()) } else { Err(ChannelError::ValueCount { keys, expected, found }) }
}

/// Returns the last time.
fn check_times(times_secs: &[f32]) -> Result<f32, ChannelError> {
    let mut before_secs = None;
    for (key, &time_secs) in times_secs.iter().enumerate() {
        if !time_secs.is_finite() || time_secs < 0.0 {
            return Err(ChannelError::BadTime { key, time_secs });
        }
        if let Some(before_secs) = before_secs.filter(|&before| time_secs <= before) {
            return Err(ChannelError::TimesNotIncreasing { key, time_secs, before_secs });
        }
        before_secs = Some(time_secs);
    }
    before_secs.ok_or(ChannelError::NoKeys)
}

impl Clip {
    /// Assumed if the key times do not reveal the frame rate.
    pub const DEFAULT_FRAMES_PER_SEC: f64 = 30.0;

    /// The name given by the file; may be empty and need not be unique.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the clip under another name.
    pub fn with_name(self, name: String) -> Self {
        Self { name, ..self }
    }

    /// Whether the other is a clone of this clip, or both are of another; their names may differ.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.shared, &other.shared)
    }

    /// Whether both are clones of one clip, or both are missing.
    pub fn are_same(a: Option<&Self>, b: Option<&Self>) -> bool {
        match (a, b) {
            (Some(a), Some(b)) => a.is_same(b),
            (a, b) => a.is_none() && b.is_none(),
        }
    }

    /// Time of the last key of any channel, in seconds.
    pub fn duration_secs(&self) -> f32 {
        self.shared.duration_secs
    }

    /// Distinct lists of key times of [`Self::channels`], in strictly increasing seconds.
    pub fn timelines(&self) -> &[Vec<f32>] {
        &self.shared.timelines
    }

    /// Time of the first key of any joint's channel; 0 without channels.
    pub fn first_key_secs(&self) -> f32 {
        let first = self.timelines().iter().map(|times| times[0]).fold(f32::INFINITY, f32::min);
        if first.is_finite() { first } else { 0.0 }
    }

    /// All channels in the order they were added, including those that a later one overrides.
    pub fn channels(&self) -> &[Channel] {
        &self.shared.channels
    }

    /// The channels of materials, lights, cameras, visibility, expressions and single morph weights: one per target,
    /// sorted.
    pub fn properties(&self) -> &[PropertyChannel] {
        &self.shared.properties.channels
    }

    /// Distinct lists of key times of [`Self::properties`], in strictly increasing seconds.
    pub fn property_timelines(&self) -> &[Vec<f32>] {
        &self.shared.properties.timelines
    }

    /// Adds property channels of another clip, such as the source of a retarget: those for which `map` returns a
    /// target.
    pub fn with_properties_of(mut self, other: &Self, map: &dyn Fn(PropertyTarget) -> Option<PropertyTarget>) -> Self {
        if other.properties().iter().any(|channel| map(channel.target).is_some()) {
            let shared = Arc::make_mut(&mut self.shared);
            shared.properties.add_mapped(&other.shared.properties, map);
            shared.duration_secs = shared.duration_secs.max(other.shared.duration_secs);
        }
        self
    }

    /// The key times of all channels; a time may occur several times.
    pub fn key_times_secs(&self) -> impl Iterator<Item = f32> + '_ {
        self.shared.timelines.iter().chain(&self.shared.properties.timelines).flatten().copied()
    }

    /// Samples joints and morph weights at `time_secs` into `pose`. Properties without a channel keep their values, so
    /// start from the rest pose. Times outside the keys hold the first or the last value. `skeleton` is the one the
    /// clip was built for, and `pose` matches its size. Allocates only if the clip has more timelines than any clip
    /// sampled with this cursor before.
    pub fn sample(&self, skeleton: &Skeleton, time_secs: f32, cursor: &mut SampleCursor, pose: &mut Pose) {
        let Shared { timelines, channels, sampler, properties, .. } = &*self.shared;
        sampler.sample(timelines, channels, skeleton, time_secs, &mut cursor.segments, pose);
        properties.sample_weights(time_secs, &mut cursor.property_segments, |joint, target, weight| {
            pose.morph_weights[skeleton.morph_range(joint)][target] = weight;
        });
    }

    /// Samples everything that isn't part of a pose (materials, lights, cameras and visibility), replacing `out`. Times
    /// outside the keys hold the first or the last value. Allocates only if the clip has more of these than any clip
    /// sampled before.
    pub fn sample_properties(&self, time_secs: f32, cursor: &mut SampleCursor, out: &mut PropertyValues) {
        self.shared.properties.sample(time_secs, &mut cursor.property_segments, out);
    }

    /// Estimates the frame rate the keys were authored at; [`Clip::DEFAULT_FRAMES_PER_SEC`] if their times don't reveal
    /// it.
    pub fn frames_per_sec(&self) -> f64 {
        const COMMON: [f64; 9] = [Clip::DEFAULT_FRAMES_PER_SEC, 24.0, 25.0, 20.0, 60.0, 50.0, 48.0, 120.0, 100.0];
        const MAX_KEYS: usize = 4096;
        let on_frames = |rate: f64| {
            self.key_times_secs().take(MAX_KEYS).all(|time| {
                let frame = f64::from(time) * rate;
                (frame - frame.round()).abs() < 0.02
            })
        };
        let mut rates = COMMON.into_iter().chain(self.densest_rate());
        rates.find(|&rate| on_frames(rate)).unwrap_or(Self::DEFAULT_FRAMES_PER_SEC)
    }

    /// The rate at which the keys of the densest channel follow each other, such as 120.005 where a file rounded the length of a frame;
    /// `None` for so few keys that they needn't be frames.
    fn densest_rate(&self) -> Option<f64> {
        const MIN_KEYS: usize = 8;
        const MIN_RATE: f64 = 10.0;
        let times =
            self.shared.timelines.iter().max_by_key(|times| times.len()).filter(|times| times.len() >= MIN_KEYS)?;
        let length_secs = f64::from(times.last()? - times.first()?);
        let rate = (times.len() - 1) as f64 / length_secs;
        (rate.is_finite() && rate >= MIN_RATE).then_some(rate)
    }
}
