//! Animation clips: keyframe channels for one skeleton, stored exactly as loaded. Sampling lives in `sampler`.

use std::collections::HashMap;

use super::channel::{Channel, ChannelError, Interpolation, Keys};
use super::sampler::Sampler;
use super::{JointIndex, Pose, Skeleton};

/// A named set of channels for one skeleton. Immutable once built.
#[derive(Debug, Clone)]
pub struct Clip {
    name: String,
    duration_secs: f32,
    timelines: Vec<Vec<f32>>,
    channels: Vec<Channel>,
    sampler: Sampler,
}

/// How a clip is asked for.
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
}

/// Builds a [`Clip`]. Each channel is validated when it is added.
#[derive(Debug)]
pub struct ClipBuilder<'a> {
    skeleton: &'a Skeleton,
    name: String,
    duration_secs: f32,
    timelines: Vec<Vec<f32>>,
    /// Timelines by the bit patterns of their times.
    timeline_of: HashMap<Vec<u32>, u32>,
    channels: Vec<Channel>,
}

impl<'a> ClipBuilder<'a> {
    /// Starts a clip without channels. The name may be empty.
    pub fn new(name: impl Into<String>, skeleton: &'a Skeleton) -> Self {
        Self {
            skeleton,
            name: name.into(),
            duration_secs: 0.0,
            timelines: Vec::new(),
            timeline_of: HashMap::new(),
            channels: Vec::new(),
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
        if joint.get() >= self.skeleton.len() {
            return Err(ChannelError::NoSuchJoint { joint: joint.get(), count: self.skeleton.len() });
        }
        let last_secs = check_times(times_secs)?;
        if let Keys::MorphWeights { targets, .. } = &keys {
            let expected = self.skeleton.morph_range(joint).len();
            if *targets != expected || expected == 0 {
                return Err(ChannelError::MorphTargetCount { expected, found: *targets });
            }
        }
        let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let (found, per_entry) = keys.count();
        let expected = times_secs.len() * per_key * per_entry;
        if expected != found {
            return Err(ChannelError::ValueCount { keys: times_secs.len(), expected, found });
        }
        let timeline = self.timeline(times_secs);
        self.duration_secs = self.duration_secs.max(last_secs);
        self.channels.push(Channel { joint, interpolation, timeline, keys });
        Ok(())
    }

    /// Returns the timeline with these times, after adding it if there is none.
    fn timeline(&mut self, times_secs: &[f32]) -> u32 {
        let bits = times_secs.iter().map(|time_secs| time_secs.to_bits());
        // Most channels have the times of the one before.
        if let Some(last) = self.channels.last().map(|channel| channel.timeline)
            && bits.clone().eq(self.timelines[last as usize].iter().map(|time_secs| time_secs.to_bits()))
        {
            return last;
        }
        *self.timeline_of.entry(bits.collect()).or_insert_with(|| {
            self.timelines.push(times_secs.to_vec());
            self.timelines.len() as u32 - 1
        })
    }

    /// Finishes the clip. Its duration is 0 if it has no channels.
    pub fn build(self) -> Clip {
        let Self { skeleton, name, duration_secs, timelines, channels, .. } = self;
        let sampler = Sampler::new(&timelines, &channels, skeleton.rest());
        Clip { name, duration_secs, timelines, channels, sampler }
    }
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

    /// Time of the last key of any channel, in seconds.
    pub fn duration_secs(&self) -> f32 {
        self.duration_secs
    }

    /// Distinct lists of key times, in strictly increasing seconds.
    pub fn timelines(&self) -> &[Vec<f32>] {
        &self.timelines
    }

    /// All channels in the order they were added, including those that a later one overrides.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Samples the clip at `time_secs` into `pose`, leaving properties without a channel alone: start from the rest pose.
    /// Times outside the keys hold the first or the last value. `skeleton` is the one the clip was built for, and `pose`
    /// has its size. Allocates only if the clip has more timelines than any clip sampled with this cursor before.
    pub fn sample(&self, skeleton: &Skeleton, time_secs: f32, cursor: &mut SampleCursor, pose: &mut Pose) {
        self.sampler.sample(&self.timelines, &self.channels, skeleton, time_secs, &mut cursor.segments, pose);
    }

    /// Estimates the frame rate the keys were authored at; [`Clip::DEFAULT_FRAMES_PER_SEC`] if their times do not tell.
    pub fn frames_per_sec(&self) -> f64 {
        const COMMON: [f64; 8] = [Clip::DEFAULT_FRAMES_PER_SEC, 24.0, 25.0, 60.0, 50.0, 48.0, 120.0, 100.0];
        const MAX_KEYS: usize = 4096;
        let on_frames = |rate: f64| {
            self.timelines.iter().flatten().take(MAX_KEYS).all(|&time| {
                let frame = f64::from(time) * rate;
                (frame - frame.round()).abs() < 0.02
            })
        };
        COMMON.into_iter().find(|&rate| on_frames(rate)).unwrap_or(Self::DEFAULT_FRAMES_PER_SEC)
    }
}
