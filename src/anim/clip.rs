//! Animation clips: channels of keys as they were given, over one skeleton. Nothing is resampled. How they are read at a
//! time is `sampler`'s matter.

use std::collections::HashMap;

use glam::{Quat, Vec3};

use super::sampler::Sampler;
use super::{JointIndex, Pose, Skeleton};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Interpolation {
    Step,
    Linear,
    /// Hermite splines: three values per key (in-tangent, value, out-tangent), tangents per second.
    CubicSpline,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Property {
    Translation,
    Rotation,
    Scale,
    MorphWeights,
}

/// Key values of one channel. CUBICSPLINE has three entries per key: in-tangent, value, out-tangent.
#[derive(Debug, Clone, PartialEq)]
pub enum Keys {
    Translation(Vec<Vec3>),
    Rotation(Vec<Quat>),
    Scale(Vec<Vec3>),
    /// Per entry one weight for each morph target, targets fastest.
    MorphWeights {
        values: Vec<f32>,
        targets: usize,
    },
}

impl Keys {
    pub fn property(&self) -> Property {
        match self {
            Self::Translation(_) => Property::Translation,
            Self::Rotation(_) => Property::Rotation,
            Self::Scale(_) => Property::Scale,
            Self::MorphWeights { .. } => Property::MorphWeights,
        }
    }

    /// How many values there are, and how many of them make one entry.
    fn count(&self) -> (usize, usize) {
        match self {
            Self::Translation(values) | Self::Scale(values) => (values.len(), 1),
            Self::Rotation(values) => (values.len(), 1),
            Self::MorphWeights { values, targets } => (values.len(), *targets),
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    pub joint: JointIndex,
    pub interpolation: Interpolation,
    /// Index into [`Clip::timelines`].
    pub timeline: u32,
    pub keys: Keys,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChannelError {
    #[error("there are no keys")]
    NoKeys,
    #[error("key {key} is at {time_secs} s, which is not after the key before it ({before_secs} s)")]
    TimesNotIncreasing { key: usize, time_secs: f32, before_secs: f32 },
    #[error("key {key} has a time that is not a number of seconds from 0 up: {time_secs}")]
    BadTime { key: usize, time_secs: f32 },
    #[error("{expected} values were expected for {keys} keys, found {found}")]
    ValueCount { keys: usize, expected: usize, found: usize },
    #[error("joint {joint} is not one of the {count} joints")]
    NoSuchJoint { joint: usize, count: usize },
    #[error("the mesh on this joint has {expected} morph targets, the keys have {found}")]
    MorphTargetCount { expected: usize, found: usize },
}

/// A named set of channels over one skeleton. Immutable once built.
#[derive(Debug, Clone)]
pub struct Clip {
    name: String,
    duration_secs: f32,
    timelines: Vec<Vec<f32>>,
    channels: Vec<Channel>,
    sampler: Sampler,
}

/// Where the last sample was found in each timeline: makes forward playback cheap. Any cursor gives the same result.
#[derive(Debug, Clone, Default)]
pub struct SampleCursor {
    pub(super) segments: Vec<u32>,
}

#[derive(Debug)]
pub struct ClipBuilder<'a> {
    skeleton: &'a Skeleton,
    name: String,
    duration_secs: f32,
    timelines: Vec<Vec<f32>>,
    /// The timeline with these times, as bits.
    timeline_of: HashMap<Vec<u32>, u32>,
    channels: Vec<Channel>,
}

impl<'a> ClipBuilder<'a> {
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

    /// Adds a channel. `times_secs` are strictly increasing and not negative; `keys` has one entry per key, three for
    /// CUBICSPLINE. Rotations need not be of unit length: they are made so where they are read. Of several channels for
    /// one property of a joint the last counts.
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
        let Some(&last_secs) = times_secs.last() else { return Err(ChannelError::NoKeys) };
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
        let bits: Vec<u32> = times_secs.iter().map(|time_secs| time_secs.to_bits()).collect();
        let timeline = *self.timeline_of.entry(bits).or_insert_with(|| {
            self.timelines.push(times_secs.to_vec());
            self.timelines.len() as u32 - 1
        });
        self.duration_secs = self.duration_secs.max(last_secs);
        self.channels.push(Channel { joint, interpolation, timeline, keys });
        Ok(())
    }

    pub fn build(self) -> Clip {
        let Self { name, duration_secs, timelines, channels, .. } = self;
        let sampler = Sampler::new(&timelines, &channels);
        Clip { name, duration_secs, timelines, channels, sampler }
    }
}

impl Clip {
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Time of the last key of any channel, in seconds.
    pub fn duration_secs(&self) -> f32 {
        self.duration_secs
    }

    /// Distinct lists of key times, in seconds, strictly increasing.
    pub fn timelines(&self) -> &[Vec<f32>] {
        &self.timelines
    }

    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Writes the values at `time_secs` into `pose`; what no channel drives is left as it is, so start from the rest
    /// pose. Before the first key the first value holds, after the last key the last one. `skeleton` is the one the clip
    /// was built for and `pose` has its size. Allocates only when a cursor meets a clip with more timelines than any before.
    pub fn sample(&self, skeleton: &Skeleton, time_secs: f32, cursor: &mut SampleCursor, pose: &mut Pose) {
        self.sampler.sample(self, skeleton, time_secs, &mut cursor.segments, pose);
    }
}
