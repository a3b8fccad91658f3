//! Animation clips: channels of keys, sampled exactly as glTF 2.0 §3.11 and appendix C say. Nothing is resampled.
//!
//! Channels with the same key times share one timeline, so that the search for the segment is done once for all of
//! them; channels whose keys are all equal are written once and not searched at all.

use glam::{Quat, Vec3, Vec4};

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

    fn entries(&self) -> usize {
        match self {
            Self::Translation(values) | Self::Scale(values) => values.len(),
            Self::Rotation(values) => values.len(),
            Self::MorphWeights { values, targets } => values.len() / (*targets).max(1),
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
}

/// Where the last sample was found in each timeline: makes forward playback cheap. Any cursor gives the same result.
#[derive(Debug, Clone, Default)]
pub struct SampleCursor {
    segments: Vec<u32>,
}

#[derive(Debug)]
pub struct ClipBuilder<'a> {
    skeleton: &'a Skeleton,
    clip: Clip,
}

impl<'a> ClipBuilder<'a> {
    pub fn new(name: impl Into<String>, skeleton: &'a Skeleton) -> Self {
        let clip = Clip { name: name.into(), duration_secs: 0.0, timelines: Vec::new(), channels: Vec::new() };
        Self { skeleton, clip }
    }

    /// Adds a channel. `times_secs` are strictly increasing and not negative; `keys` has one entry per key, three for
    /// CUBICSPLINE. Rotations are normalised here, tangents are not.
    pub fn channel(
        &mut self,
        joint: JointIndex,
        interpolation: Interpolation,
        times_secs: &[f32],
        mut keys: Keys,
    ) -> Result<(), ChannelError> {
        if joint.get() >= self.skeleton.len() {
            return Err(ChannelError::NoSuchJoint { joint: joint.get(), count: self.skeleton.len() });
        }
        if times_secs.is_empty() {
            return Err(ChannelError::NoKeys);
        }
        for (key, &time_secs) in times_secs.iter().enumerate() {
            if !time_secs.is_finite() || time_secs < 0.0 {
                return Err(ChannelError::BadTime { key, time_secs });
            }
            if key > 0 && time_secs <= times_secs[key - 1] {
                return Err(ChannelError::TimesNotIncreasing { key, time_secs, before_secs: times_secs[key - 1] });
            }
        }
        let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let (expected, found) = (times_secs.len() * per_key, keys.entries());
        if expected != found {
            return Err(ChannelError::ValueCount { keys: times_secs.len(), expected, found });
        }
        match &mut keys {
            Keys::MorphWeights { targets, .. } => {
                let expected = self.skeleton.morph_range(joint).len();
                if *targets != expected || expected == 0 {
                    return Err(ChannelError::MorphTargetCount { expected, found: *targets });
                }
            }
            Keys::Rotation(values) => {
                for (entry, value) in values.iter_mut().enumerate() {
                    if per_key == 1 || entry % 3 == 1 {
                        *value = normalize_or_identity(*value);
                    }
                }
            }
            Keys::Translation(_) | Keys::Scale(_) => {}
        }
        let timeline = match self.clip.timelines.iter().position(|timeline| timeline == times_secs) {
            Some(index) => index,
            None => {
                self.clip.timelines.push(times_secs.to_vec());
                self.clip.timelines.len() - 1
            }
        } as u32;
        self.clip.duration_secs = self.clip.duration_secs.max(times_secs[times_secs.len() - 1]);
        self.clip.channels.push(Channel { joint, interpolation, timeline, keys });
        Ok(())
    }

    pub fn build(self) -> Clip {
        self.clip
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
    /// pose. Before the first key the first value holds, after the last key the last one.
    pub fn sample(&self, skeleton: &Skeleton, time_secs: f32, cursor: &mut SampleCursor, pose: &mut Pose) {
        cursor.segments.resize(self.timelines.len(), 0);
        for (segment, times) in cursor.segments.iter_mut().zip(&self.timelines) {
            *segment = find_segment(times, time_secs, *segment as usize) as u32;
        }
        for channel in &self.channels {
            let times = &self.timelines[channel.timeline as usize];
            let at = Segment::new(times, cursor.segments[channel.timeline as usize] as usize, time_secs);
            let local = &mut pose.locals[channel.joint.get()];
            match &channel.keys {
                Keys::Translation(values) => local.translation = at.vec3(values, channel.interpolation),
                Keys::Scale(values) => local.scale = at.vec3(values, channel.interpolation),
                Keys::Rotation(values) => local.rotation = at.quat(values, channel.interpolation),
                Keys::MorphWeights { values, targets } => {
                    let range = skeleton.morph_range(channel.joint);
                    at.weights(values, *targets, channel.interpolation, &mut pose.morph_weights[range]);
                }
            }
        }
    }
}

fn normalize_or_identity(value: Quat) -> Quat {
    let length = value.length();
    if length.is_finite() && length > 0.0 { value / length } else { Quat::IDENTITY }
}

/// Index of the last key at or before `time_secs` (0 before the first key), starting from a guess.
fn find_segment(times: &[f32], time_secs: f32, guess: usize) -> usize {
    let fits = |index: usize| {
        times.get(index).is_some_and(|&start| start <= time_secs)
            && times.get(index + 1).is_none_or(|&end| time_secs < end)
    };
    if fits(guess) {
        guess
    } else if fits(guess + 1) {
        guess + 1
    } else {
        times.partition_point(|&start| start <= time_secs).saturating_sub(1)
    }
}

/// Two neighbouring keys and where between them the time lies.
struct Segment {
    key: usize,
    /// The same as `key` outside the keys, where values hold.
    next: usize,
    length_secs: f32,
    /// 0 at `key`, 1 at `next`.
    factor: f32,
}

impl Segment {
    fn new(times: &[f32], key: usize, time_secs: f32) -> Self {
        let start = times[key];
        match times.get(key + 1) {
            Some(&end) if time_secs > start => {
                let length_secs = end - start;
                Self { key, next: key + 1, length_secs, factor: ((time_secs - start) / length_secs).clamp(0.0, 1.0) }
            }
            _ => Self { key, next: key, length_secs: 0.0, factor: 0.0 },
        }
    }

    /// Hermite basis of glTF 2.0 appendix C.4, the tangents' factors already multiplied by the segment's length.
    fn cubic_factors(&self) -> [f32; 4] {
        let (t, t2, t3) = (self.factor, self.factor * self.factor, self.factor * self.factor * self.factor);
        let length = self.length_secs;
        [2.0 * t3 - 3.0 * t2 + 1.0, length * (t3 - 2.0 * t2 + t), -2.0 * t3 + 3.0 * t2, length * (t3 - t2)]
    }

    fn vec3(&self, values: &[Vec3], interpolation: Interpolation) -> Vec3 {
        match interpolation {
            Interpolation::Step => values[self.key],
            Interpolation::Linear => values[self.key].lerp(values[self.next], self.factor),
            Interpolation::CubicSpline => {
                let [p0, m0, p1, m1] = self.cubic_factors();
                p0 * values[3 * self.key + 1]
                    + m0 * values[3 * self.key + 2]
                    + p1 * values[3 * self.next + 1]
                    + m1 * values[3 * self.next]
            }
        }
    }

    fn quat(&self, values: &[Quat], interpolation: Interpolation) -> Quat {
        match interpolation {
            Interpolation::Step => values[self.key],
            Interpolation::Linear => values[self.key].slerp(values[self.next], self.factor),
            Interpolation::CubicSpline => {
                let [p0, m0, p1, m1] = self.cubic_factors();
                let at = |index: usize| Vec4::from(values[index]);
                let sum = p0 * at(3 * self.key + 1)
                    + m0 * at(3 * self.key + 2)
                    + p1 * at(3 * self.next + 1)
                    + m1 * at(3 * self.next);
                normalize_or_identity(Quat::from_vec4(sum))
            }
        }
    }

    fn weights(&self, values: &[f32], targets: usize, interpolation: Interpolation, out: &mut [f32]) {
        let at = |entry: usize, target: usize| values[entry * targets + target];
        match interpolation {
            Interpolation::Step => out.copy_from_slice(&values[self.key * targets..(self.key + 1) * targets]),
            Interpolation::Linear => {
                for (target, weight) in out.iter_mut().enumerate() {
                    let (from, to) = (at(self.key, target), at(self.next, target));
                    *weight = from + (to - from) * self.factor;
                }
            }
            Interpolation::CubicSpline => {
                let [p0, m0, p1, m1] = self.cubic_factors();
                for (target, weight) in out.iter_mut().enumerate() {
                    *weight = p0 * at(3 * self.key + 1, target)
                        + m0 * at(3 * self.key + 2, target)
                        + p1 * at(3 * self.next + 1, target)
                        + m1 * at(3 * self.next, target);
                }
            }
        }
    }
}
