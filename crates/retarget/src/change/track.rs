//! A clip's channels as plain numbers, so that changes treat joints, morph weights and properties alike.

use std::collections::HashSet;

use gaitway_character::anim::{Channel, Clip, ClipBuilder, Interpolation, JointIndex, Keys, PropertyTarget, Skeleton};
use glam::{DQuat, Quat, Vec3};

use crate::math::{slerp, unit};

/// What a track animates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Target {
    Translation(JointIndex),
    Rotation(JointIndex),
    Scale(JointIndex),
    Weights(JointIndex),
    Property(PropertyTarget),
}

/// The keys of one channel.
#[derive(Debug, Clone)]
pub struct Track {
    pub target: Target,
    pub interpolation: Interpolation,
    pub times: Vec<f32>,
    /// Numbers per entry.
    pub width: usize,
    /// One entry per key, three for splines: in-tangent, value, out-tangent.
    pub values: Vec<f32>,
}

/// All channels of a clip, without those that a later one overrides.
#[derive(Debug, Clone)]
pub struct Tracks {
    pub tracks: Vec<Track>,
    pub duration_secs: f32,
}

impl Tracks {
    pub fn of(clip: &Clip) -> Self {
        let mut found = Self { tracks: Vec::new(), duration_secs: clip.duration_secs() };
        let mut seen = HashSet::new();
        let mut is_new = |channel: &&Channel| seen.insert((channel.joint, channel.keys.property()));
        let mut channels: Vec<&Channel> = clip.channels().iter().rev().filter(|channel| is_new(channel)).collect();
        channels.reverse();
        for channel in channels {
            let joint = channel.joint;
            let flat = |values: &[Vec3]| values.iter().flat_map(|value| value.to_array()).collect();
            let (target, width, values) = match &channel.keys {
                Keys::Translation(values) => (Target::Translation(joint), 3, flat(values)),
                Keys::Scale(values) => (Target::Scale(joint), 3, flat(values)),
                Keys::Rotation(values) => {
                    (Target::Rotation(joint), 4, values.iter().flat_map(|value| value.to_array()).collect())
                }
                Keys::MorphWeights { values, targets } => (Target::Weights(joint), *targets, values.clone()),
            };
            let times = clip.timelines()[channel.timeline as usize].clone();
            found.tracks.push(Track { target, interpolation: channel.interpolation, times, width, values });
        }
        for channel in clip.properties() {
            let times = clip.property_timelines()[channel.timeline as usize].clone();
            found.tracks.push(Track {
                target: Target::Property(channel.target),
                interpolation: channel.interpolation,
                times,
                width: channel.target.width(),
                values: channel.values.clone(),
            });
        }
        found
    }

    /// Builds a clip of `duration_secs`: a clip ends with its last key, so if all are earlier, the last value of a track is
    /// repeated.
    pub fn build(mut self, name: &str, skeleton: &Skeleton) -> Clip {
        let last = self.tracks.iter().filter_map(|track| track.times.last().copied()).fold(0.0, f32::max);
        if last < self.duration_secs
            && let Some(track) = self.tracks.first_mut()
        {
            track.hold_until(self.duration_secs);
        }
        let mut builder = ClipBuilder::new(name, skeleton);
        for track in self.tracks {
            let Track { target, interpolation, times, width, values } = track;
            let vectors = || values.as_chunks::<3>().0.iter().copied().map(Vec3::from_array).collect();
            let (joint, keys) = match target {
                Target::Property(target) => {
                    let added = builder.property(target, interpolation, &times, values);
                    debug_assert!(added.is_ok(), "{added:?}");
                    continue;
                }
                Target::Translation(joint) => (joint, Keys::Translation(vectors())),
                Target::Scale(joint) => (joint, Keys::Scale(vectors())),
                Target::Rotation(joint) => {
                    let values = values.as_chunks::<4>().0.iter().copied().map(Quat::from_array);
                    (joint, Keys::Rotation(values.collect()))
                }
                Target::Weights(joint) => (joint, Keys::MorphWeights { values, targets: width }),
            };
            let added = builder.channel(joint, interpolation, &times, keys);
            debug_assert!(added.is_ok(), "{added:?}");
        }
        builder.build()
    }

    /// Adds a track, instead of the one of its target if there is one.
    pub fn replace(&mut self, track: Track) {
        self.tracks.retain(|other| other.target != track.target);
        self.tracks.push(track);
    }

    /// Adds a track that holds the rest value, unless there is one for this target.
    pub fn ensure(&mut self, target: Target, rest: &[f32]) {
        if self.find(target).is_none() {
            self.tracks.push(Track::constant(target, rest));
        }
    }

    pub fn find(&self, target: Target) -> Option<&Track> {
        self.tracks.iter().find(|track| track.target == target)
    }
}

impl Track {
    pub fn constant(target: Target, value: &[f32]) -> Self {
        let (interpolation, times) = (Interpolation::Linear, vec![0.0]);
        Self { target, interpolation, times, width: value.len(), values: value.to_vec() }
    }

    pub fn is_spline(&self) -> bool {
        self.interpolation == Interpolation::CubicSpline
    }

    pub fn is_rotation(&self) -> bool {
        matches!(self.target, Target::Rotation(_))
    }

    /// Numbers per key.
    pub fn stride(&self) -> usize {
        if self.is_spline() { 3 * self.width } else { self.width }
    }

    /// The value of a key, without its tangents.
    pub fn value(&self, key: usize) -> &[f32] {
        let start = key * self.stride() + if self.is_spline() { self.width } else { 0 };
        &self.values[start..start + self.width]
    }

    pub fn last_value(&self) -> &[f32] {
        self.value(self.times.len() - 1)
    }

    /// Repeats the last value at a later time.
    pub fn hold_until(&mut self, time_secs: f32) {
        if self.times.last().is_some_and(|&last| last < time_secs) {
            let key = self.key_at(time_secs);
            self.times.push(time_secs);
            self.values.extend(key);
        }
    }

    /// Returns the entries of a key that could be inserted at a time without changing the curve.
    pub fn key_at(&self, time_secs: f32) -> Vec<f32> {
        let width = self.width;
        let next = self.times.partition_point(|&time| time <= time_secs);
        let held = |key: usize| {
            let value = self.value(key).to_vec();
            if !self.is_spline() {
                return value;
            }
            [vec![0.0; width], value, vec![0.0; width]].concat()
        };
        if next == 0 {
            return held(0);
        }
        let key = next - 1;
        if self.times[key] == time_secs {
            return self.values[key * self.stride()..next * self.stride()].to_vec();
        }
        if next == self.times.len() {
            return held(key);
        }
        let (start, end) = (f64::from(self.times[key]), f64::from(self.times[next]));
        let part = (f64::from(time_secs) - start) / (end - start);
        match self.interpolation {
            Interpolation::Step => held(key),
            Interpolation::Linear if self.is_rotation() => {
                let [from, to] = [key, next].map(|key| rotation(self.value(key)));
                slerp(from, to, part).as_quat().to_array().to_vec()
            }
            Interpolation::Linear => {
                let ends = self.value(key).iter().zip(self.value(next));
                ends.map(|(a, b)| (f64::from(*a) + (f64::from(*b) - f64::from(*a)) * part) as f32).collect()
            }
            Interpolation::CubicSpline => self.split(key, part, end - start),
        }
    }

    /// Returns the key that splits a segment of a spline; either part of a cubic is a cubic.
    fn split(&self, key: usize, part: f64, secs: f64) -> Vec<f32> {
        let width = self.width;
        let number = |at: usize| f64::from(self.values[at]);
        let (start, end) = (key * 3 * width, (key + 1) * 3 * width);
        let (mut value, mut tangent) = (Vec::new(), Vec::new());
        for axis in 0..width {
            let (from, out) = (number(start + width + axis), number(start + 2 * width + axis) * secs);
            let (into, to) = (number(end + axis) * secs, number(end + width + axis));
            let (t, t2, t3) = (part, part * part, part * part * part);
            let at = (2.0 * t3 - 3.0 * t2 + 1.0) * from
                + (t3 - 2.0 * t2 + t) * out
                + (3.0 * t2 - 2.0 * t3) * to
                + (t3 - t2) * into;
            let slope =
                (6.0 * t2 - 6.0 * t) * (from - to) + (3.0 * t2 - 4.0 * t + 1.0) * out + (3.0 * t2 - 2.0 * t) * into;
            value.push(at as f32);
            tangent.push((slope / secs) as f32);
        }
        [tangent.clone(), value, tangent].concat()
    }

    /// Inserts a key between two others without changing the curve.
    pub fn insert(&mut self, time_secs: f32) {
        let at = self.times.partition_point(|&time| time < time_secs);
        if self.times.get(at) == Some(&time_secs) {
            return;
        }
        let key = self.key_at(time_secs);
        self.times.insert(at, time_secs);
        let start = at * self.stride();
        self.values.splice(start..start, key);
    }

    /// Applies a linear map to every value and tangent. `affine` is added to values only.
    pub fn map(&mut self, mut linear: impl FnMut(&mut [f32]), affine: &[f32]) {
        let (width, is_spline) = (self.width, self.is_spline());
        for (index, entry) in self.values.chunks_exact_mut(width).enumerate() {
            linear(entry);
            if !is_spline || index % 3 == 1 {
                entry.iter_mut().zip(affine).for_each(|(number, offset)| *number += offset);
            }
        }
    }
}

/// Returns the rotation of a key, normalized.
pub fn rotation(value: &[f32]) -> DQuat {
    unit(Quat::from_slice(value).as_dquat())
}
