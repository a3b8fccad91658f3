//! Bakes poses into a clip: samples them densely enough, then keeps as few keys as hold every joint close to them.

use glam::{DQuat, DVec3};

use crate::anim::{Clip, Interpolation, JointIndex, Pose, PropertyTarget, SampleCursor, Skeleton};
use crate::retarget::change::track::{Target, Track, Tracks, rotation};
use crate::retarget::keys::limits::{BETWEEN_KEYS, BETWEEN_SAMPLES, Limits, MAX_TURN, ROUNDING};
use crate::retarget::keys::resample::{Curve, Resampled, fewest, resample};
use crate::retarget::math::{angle_between, slerp};
use crate::retarget::pose::{WorldPose, ancestry, locals_of};

/// Largest error of morph weights, and of scales that move no joint.
const MAX_WEIGHT_ERROR: f64 = 1e-3;
/// Factor on the limit of each channel that leaves a joint too far off, and the share at which to give up.
const CLOSER: f64 = 0.6;
const MIN_SHARE: f64 = 1e-3;

/// Poses over time.
pub struct Poses<'a> {
    pub skeleton: &'a Skeleton,
    /// The joints that get new channels, one flag per joint.
    pub included: &'a [bool],
    /// Times to sample at, ascending; more are added where they don't suffice.
    pub times: Vec<f32>,
    /// Those of `times` at which the pose jumps, ascending.
    pub jumps: Vec<f32>,
    pub pose_at: &'a mut dyn FnMut(f32, &mut Pose),
}

/// Where a new channel's numbers are within [`Sample::numbers`].
struct Column {
    target: Target,
    start: usize,
    width: usize,
    /// The error allowed, if joints don't add up theirs.
    limit: f64,
}

/// A pose, and all new channels in it.
struct Sample {
    pose: Pose,
    numbers: Vec<f32>,
}

type Samples = Resampled<Sample>;

/// Returns the clip with the channels of the included joints replaced by the poses.
pub fn bake(clip: &Clip, poses: Poses<'_>) -> Clip {
    let Poses { skeleton, included, times, jumps, pose_at } = poses;
    let limits = Limits::new(skeleton);
    let columns = columns(skeleton, included, &limits);
    let value = |time| {
        let mut pose = skeleton.rest().clone();
        pose_at(time, &mut pose);
        Sample { numbers: numbers(skeleton, &columns, &pose), pose }
    };
    let error = |from: &Sample, to: &Sample, factor: f64, at: &Sample| {
        largest_error(skeleton, &limits, &columns, [from, to], factor, at)
    };
    let samples = resample(&times, &jumps, Curve { value, error, tolerance: BETWEEN_SAMPLES });
    let mut kept = Tracks::of(clip);
    kept.tracks.retain(|track| !joint_of(track.target).is_some_and(|joint| included[joint.get()]));
    let mut shares = vec![1.0; columns.len()];
    let track = |column: &Column, share: f64| column.track(skeleton, &samples, share * column.limit);
    let mut new: Vec<Option<Track>> = columns.iter().map(|column| track(column, 1.0)).collect();
    loop {
        let mut tracks = kept.clone();
        tracks.tracks.extend(new.iter().flatten().cloned());
        if tracks.tracks.is_empty() {
            // All joints rest. A clip is as long as its tracks, so it needs one.
            tracks.tracks.extend(columns.first().map(|column| column.with_keys(&samples, &[0])));
        }
        let baked = tracks.build(clip.name(), skeleton);
        // The errors of a chain of joints add up, though seldom all in one direction.
        let is_off = is_off(skeleton, &limits, &baked, &samples);
        let is_loose = |(column, share): &(&Column, f64)| {
            *share > MIN_SHARE && joint_of(column.target).is_some_and(|joint| is_off[joint.get()])
        };
        let loose: Vec<bool> = columns.iter().zip(shares.iter().copied()).map(|pair| is_loose(&pair)).collect();
        if !loose.contains(&true) {
            return baked;
        }
        for (index, column) in columns.iter().enumerate().filter(|(index, _)| loose[*index]) {
            shares[index] *= CLOSER;
            new[index] = track(column, shares[index]);
        }
    }
}

fn joint_of(target: Target) -> Option<JointIndex> {
    match target {
        Target::Translation(joint) | Target::Rotation(joint) | Target::Scale(joint) | Target::Weights(joint) => {
            Some(joint)
        }
        Target::Property(PropertyTarget::MorphWeight(joint, _)) => Some(joint),
        Target::Property(_) => None,
    }
}

fn world(skeleton: &Skeleton, pose: &Pose) -> WorldPose {
    WorldPose::new(skeleton, locals_of(pose), DQuat::IDENTITY)
}

fn columns(skeleton: &Skeleton, included: &[bool], limits: &Limits) -> Vec<Column> {
    let rest = world(skeleton, skeleton.rest());
    // Distance to the farthest joint below each.
    let mut reach = vec![0.0_f64; skeleton.len()];
    for joint in skeleton.joints() {
        for ancestor in ancestry(skeleton, joint).skip(1) {
            let far = &mut reach[ancestor.get()];
            *far = far.max(rest.position(ancestor).distance(rest.position(joint)));
        }
    }
    let mut columns = Vec::new();
    let mut start = 0;
    let mut push = |target, width, limit| {
        columns.push(Column { target, start, width, limit });
        start += width;
    };
    for joint in skeleton.joints().filter(|joint| included[joint.get()]) {
        let scale = rest.parent_frame(skeleton, joint).matrix3.determinant().abs().cbrt();
        let per_reach = limits.offset(reach[joint.get()]) / reach[joint.get()];
        push(Target::Translation(joint), 3, limits.offset(0.0) / if scale > 0.0 { scale } else { 1.0 });
        push(Target::Rotation(joint), 4, MAX_TURN.min(per_reach));
        push(Target::Scale(joint), 3, MAX_WEIGHT_ERROR.min(per_reach));
        let weights = skeleton.morph_range(joint).len();
        if weights > 0 {
            push(Target::Weights(joint), weights, MAX_WEIGHT_ERROR);
        }
    }
    columns
}

fn numbers(skeleton: &Skeleton, columns: &[Column], pose: &Pose) -> Vec<f32> {
    let mut numbers = Vec::with_capacity(columns.last().map_or(0, |last| last.start + last.width));
    for column in columns {
        match column.target {
            Target::Translation(joint) => numbers.extend(pose.local(joint).translation.to_array()),
            Target::Rotation(joint) => numbers.extend(pose.local(joint).rotation.to_array()),
            Target::Scale(joint) => numbers.extend(pose.local(joint).scale.to_array()),
            Target::Weights(joint) => numbers.extend(&pose.morph_weights[skeleton.morph_range(joint)]),
            Target::Property(_) => {}
        }
    }
    numbers
}

impl Column {
    fn of<'a>(&self, sample: &'a Sample) -> &'a [f32] {
        &sample.numbers[self.start..self.start + self.width]
    }

    /// Returns the channel with as few keys as stay within the limit, each as far from the one before as it can be. `None` if
    /// it would only hold the rest.
    fn track(&self, skeleton: &Skeleton, samples: &Samples, limit: f64) -> Option<Track> {
        let Resampled { times, values } = samples;
        let changes = |&at: &usize| at == 0 || self.of(&values[at]) != self.of(&values[at - 1]);
        let changes: Vec<usize> = (0..times.len()).filter(changes).collect();
        if let [first] = changes[..] {
            let rest = numbers(skeleton, &[Self { start: 0, ..*self }], skeleton.rest());
            return (rest != self.of(&values[first])).then(|| self.with_keys(samples, &changes));
        }
        if changes[1..].iter().all(|&at| times[at - 1].next_up() == times[at]) {
            return Some(Track { interpolation: Interpolation::Step, ..self.with_keys(samples, &changes) });
        }
        let is_close = |from: usize, to: usize, at: usize| {
            let factor = f64::from(times[at] - times[from]) / f64::from(times[to] - times[from]);
            self.error([&values[from], &values[to]], factor, &values[at]) <= limit.max(self.rounding(&values[at]))
        };
        let keys = fewest(times.len(), |from, to| (from + 1..to).all(|at| is_close(from, to, at)));
        Some(self.with_keys(samples, &keys))
    }

    /// Returns the channel with the values of these samples.
    fn with_keys(&self, samples: &Samples, keys: &[usize]) -> Track {
        Track {
            target: self.target,
            interpolation: Interpolation::Linear,
            times: keys.iter().map(|&key| samples.times[key]).collect(),
            width: self.width,
            values: keys.iter().flat_map(|&key| self.of(&samples.values[key])).copied().collect(),
        }
    }

    /// Interpolates a rotation.
    fn rotation(&self, ends: [&Sample; 2], factor: f64) -> DQuat {
        let [from, to] = ends.map(|sample| rotation(self.of(sample)));
        slerp(from, to, factor)
    }

    /// Interpolates numbers.
    fn numbers(&self, ends: [&Sample; 2], factor: f64) -> impl Iterator<Item = f64> {
        let [from, to] = ends.map(|sample| self.of(sample).iter().copied().map(f64::from));
        from.zip(to).map(move |(from, to)| from + (to - from) * factor)
    }

    /// Returns the part of an error that more keys don't reduce.
    fn rounding(&self, sample: &Sample) -> f64 {
        let Target::Translation(_) = self.target else { return 0.0 };
        let squares = self.of(sample).iter().map(|&part| f64::from(part).powi(2));
        // Half of what joints are allowed.
        0.5 * ROUNDING * squares.sum::<f64>().sqrt()
    }

    /// How far a value is from the one between two others, in radians for rotations.
    fn error(&self, ends: [&Sample; 2], factor: f64, at: &Sample) -> f64 {
        if let Target::Rotation(_) = self.target {
            return angle_between(self.rotation(ends, factor), rotation(self.of(at)));
        }
        let parts = self.numbers(ends, factor).zip(self.of(at)).map(|(found, &exact)| found - f64::from(exact));
        parts.map(|part| part * part).sum::<f64>().sqrt()
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
