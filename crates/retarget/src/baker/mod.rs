//! Bakes a function of time into a clip: samples its poses until linear interpolation follows them, then keeps as few keys as hold
//! every joint close. Layers and pins are baked here; retargeting resamples single values with `keys` instead.

mod column;
mod times;

use gaitway_character::anim::{Clip, JointIndex, Pose, Property, PropertyTarget, SampleCursor, Skeleton};
use glam::{DQuat, DVec3};

use crate::budget::{added_poses, held_poses, sampled_rounds};
use crate::change::track::{Target, Track, Tracks};
use crate::keys::limits::{BETWEEN_KEYS, BETWEEN_SAMPLES, Limits};
use crate::keys::resample::{Curve, resample_adding};
use crate::pose::WorldPose;
use column::{Column, MAX_WEIGHT_ERROR, Replaced, Sample, Samples, columns, numbers, world};
use times::SampleTimes;

pub use times::timelines;

/// Factor on the limit of each channel that leaves a joint too far off, and the share at which to give up.
const CLOSER: f64 = 0.6;
const MIN_SHARE: f64 = 1e-3;

/// Collects what a function of time changes in a clip and when it has to be sampled, then bakes it.
///
/// The result has the clip's name and duration, and the keys of all channels that aren't [replaced](Self::replace). Those that are
/// get as few as hold every joint within 0.05° and 0.1 mm per metre of height, and weights and scales within 0.001.
#[derive(Debug)]
pub struct Baker<'a> {
    skeleton: &'a Skeleton,
    clip: &'a Clip,
    replaced: Replaced,
    times: SampleTimes,
}

impl<'a> Baker<'a> {
    /// Starts from a clip, which is sampled at its keys.
    pub fn new(skeleton: &'a Skeleton, clip: &'a Clip) -> Self {
        let replaced = vec![Default::default(); skeleton.len()];
        Self { skeleton, clip, replaced, times: SampleTimes::of(clip) }
    }

    /// Returns the duration of the clip.
    pub fn end_secs(&self) -> f32 {
        self.clip.duration_secs()
    }

    /// Returns how often something with keys at so many times may be repeated.
    pub fn max_repeats(&self, keys: usize) -> usize {
        sampled_rounds(keys, self.skeleton.len())
    }

    /// Replaces the channel of a joint's property.
    pub fn replace(&mut self, joint: JointIndex, property: Property) {
        self.replaced[joint.get()][property as usize] = true;
    }

    /// Replaces all channels of a joint.
    pub fn replace_all(&mut self, joint: JointIndex) {
        self.replaced[joint.get()] = [true; 4];
    }

    /// Samples at these times as well. Where they don't suffice, more are added.
    pub fn sample_at(&mut self, times: impl IntoIterator<Item = f32>) {
        self.times.times.extend(times);
    }

    /// Samples at these times and right before: each is the first one after a jump.
    pub fn jump_at(&mut self, times: impl IntoIterator<Item = f32>) {
        self.times.jumps.extend(times);
    }

    /// Limits the time between two samples, for functions that may bend and straighten again between two keys.
    pub fn sample_every(&mut self, max_step_secs: f32) {
        self.times.max_step_secs = self.times.max_step_secs.min(max_step_secs);
    }

    /// Bakes the function. `change` gets a time and the clip's pose there, and makes it the function's.
    pub fn bake(self, mut change: impl FnMut(f32, &mut Pose)) -> Clip {
        let Self { skeleton, clip, replaced, times } = self;
        if !replaced.as_flattened().contains(&true) {
            return clip.clone();
        }
        let limits = Limits::new(skeleton);
        let columns = columns(skeleton, &replaced, &limits);
        let mut cursor = SampleCursor::default();
        let value = |time| {
            let mut pose = skeleton.rest().clone();
            clip.sample(skeleton, time, &mut cursor, &mut pose);
            change(time, &mut pose);
            Sample { numbers: numbers(skeleton, &columns, &pose), pose }
        };
        let error = |from: &Sample, to: &Sample, factor: f64, at: &Sample| {
            largest_error(skeleton, &limits, &columns, [from, to], factor, at)
        };
        let (times, jumps) = times.finish(held_poses(skeleton.len()));
        let samples = resample_adding(
            &times,
            &jumps,
            Curve { value, error, tolerance: BETWEEN_SAMPLES },
            added_poses(skeleton.len(), times.len()),
        );
        let mut kept = Tracks::of(clip);
        kept.tracks.retain(|track| {
            property_of(track.target).is_none_or(|(joint, property)| !replaced[joint.get()][property as usize])
        });
        reduced(skeleton, clip.name(), &limits, &kept, &columns, &samples)
    }
}

/// Returns a clip of the kept tracks and as few keys of the columns as hold every joint close to the samples.
fn reduced(
    skeleton: &Skeleton,
    name: &str,
    limits: &Limits,
    kept: &Tracks,
    columns: &[Column],
    samples: &Samples,
) -> Clip {
    let mut shares = vec![1.0; columns.len()];
    let track = |column: &Column, share: f64| column.track(skeleton, samples, share * column.limit);
    let mut new: Vec<Option<Track>> = columns.iter().map(|column| track(column, 1.0)).collect();
    loop {
        let mut tracks = kept.clone();
        tracks.tracks.extend(new.iter().flatten().cloned());
        if tracks.tracks.is_empty() {
            // All joints rest. A clip is as long as its tracks, so it needs one.
            tracks.tracks.extend(columns.first().map(|column| column.with_keys(samples, &[0])));
        }
        let baked = tracks.build(name, skeleton);
        // The errors of a chain of joints add up, though seldom all in one direction.
        let is_off = is_off(skeleton, limits, &baked, samples);
        let is_loose = |(column, share): (&Column, f64)| {
            share > MIN_SHARE && property_of(column.target).is_some_and(|(joint, _)| is_off[joint.get()])
        };
        let loose: Vec<bool> = columns.iter().zip(shares.iter().copied()).map(is_loose).collect();
        if !loose.contains(&true) {
            return baked;
        }
        for (index, column) in columns.iter().enumerate().filter(|(index, _)| loose[*index]) {
            shares[index] *= CLOSER;
            new[index] = track(column, shares[index]);
        }
    }
}

/// Returns what a track animates in a pose. The weight of a single morph target is one of its mesh's.
fn property_of(target: Target) -> Option<(JointIndex, Property)> {
    match target {
        Target::Translation(joint) => Some((joint, Property::Translation)),
        Target::Rotation(joint) => Some((joint, Property::Rotation)),
        Target::Scale(joint) => Some((joint, Property::Scale)),
        Target::Weights(joint) | Target::Property(PropertyTarget::MorphWeight(joint, _)) => {
            Some((joint, Property::MorphWeights))
        }
        Target::Property(_) => None,
    }
}

/// Returns the largest error of any joint or number between two samples, as a share of its limit.
fn largest_error(
    skeleton: &Skeleton,
    limits: &Limits,
    columns: &[Column],
    ends: [&Sample; 2],
    factor: f64,
    at: &Sample,
) -> f64 {
    let expected = world(skeleton, &at.pose);
    let mut locals = expected.locals.clone();
    let mut error = 0.0_f64;
    let vector = |column: &Column| {
        let mut numbers = column.numbers(ends, factor);
        DVec3::from_array(std::array::from_fn(|_| numbers.next().unwrap_or_default()))
    };
    for column in columns {
        match column.target {
            Target::Translation(joint) => locals[joint.get()].translation = vector(column),
            Target::Rotation(joint) => locals[joint.get()].rotation = column.rotation(ends, factor),
            Target::Scale(joint) => locals[joint.get()].scale = vector(column),
            Target::Weights(_) | Target::Property(_) => {}
        }
        if let Target::Scale(_) | Target::Weights(_) = column.target {
            error = error.max(column.error(ends, factor, at) / MAX_WEIGHT_ERROR);
        }
    }
    let found = WorldPose::new(skeleton, locals, DQuat::IDENTITY);
    skeleton.joints().map(|joint| limits.share(&expected, &found, joint)).fold(error, f64::max)
}

/// Flags the joints whose error at any sample is too large, and their ancestors.
fn is_off(skeleton: &Skeleton, limits: &Limits, clip: &Clip, samples: &Samples) -> Vec<bool> {
    let mut is_off = vec![false; skeleton.len()];
    let mut pose = skeleton.rest().clone();
    let mut cursor = SampleCursor::default();
    for (&time, sample) in samples.times.iter().zip(&samples.values) {
        pose.copy_from(skeleton.rest());
        clip.sample(skeleton, time, &mut cursor, &mut pose);
        let (expected, found) = (world(skeleton, &sample.pose), world(skeleton, &pose));
        for joint in skeleton.joints() {
            is_off[joint.get()] |= limits.share(&expected, &found, joint) > BETWEEN_KEYS;
        }
    }
    // Children come after their parents.
    for joint in skeleton.joints().rev() {
        if let Some(parent) = skeleton.parent(joint) {
            is_off[parent.get()] |= is_off[joint.get()];
        }
    }
    is_off
}
