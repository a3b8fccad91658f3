//! The numbers of one new channel in all samples, and the keys that it keeps of them.

use gaitway_character::anim::{Interpolation, Pose, Property, Skeleton};
use glam::DQuat;

use crate::change::track::{Target, Track, rotation};
use crate::keys::limits::{Limits, MAX_TURN, ROUNDING};
use crate::keys::resample::{Resampled, fewest};
use crate::math::{angle_between, slerp};
use crate::pose::{WorldPose, ancestry, locals_of};

/// Largest error of morph weights, and of scales that move no joint.
pub const MAX_WEIGHT_ERROR: f64 = 1e-3;

/// A pose, and all new channels in it.
pub struct Sample {
    pub pose: Pose,
    pub numbers: Vec<f32>,
}

/// The poses that keys are chosen from.
pub type Samples = Resampled<Sample>;

/// Where a new channel's numbers are within [`Sample::numbers`].
pub struct Column {
    pub target: Target,
    start: usize,
    width: usize,
    /// The error allowed, if joints don't add up theirs.
    pub limit: f64,
}

/// The properties of each joint that get new channels: a flag for each, by its discriminant.
pub type Replaced = Vec<[bool; PROPERTIES.len()]>;

/// All properties, by their discriminants.
const PROPERTIES: [Property; 4] = [Property::Translation, Property::Rotation, Property::Scale, Property::MorphWeights];

/// Returns a pose with the positions and rotations of its joints.
pub fn world(skeleton: &Skeleton, pose: &Pose) -> WorldPose {
    WorldPose::new(skeleton, locals_of(pose), DQuat::IDENTITY)
}

/// Returns the columns of the replaced properties, in the order of joints.
pub fn columns(skeleton: &Skeleton, replaced: &Replaced, limits: &Limits) -> Vec<Column> {
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
    for joint in skeleton.joints() {
        let scale = rest.parent_frame(skeleton, joint).matrix3.determinant().abs().cbrt();
        let per_reach = limits.offset(reach[joint.get()]) / reach[joint.get()];
        let is_replaced = |property: &Property| replaced[joint.get()][*property as usize];
        for property in PROPERTIES.into_iter().filter(is_replaced) {
            let (target, width, limit) = match property {
                Property::Translation => {
                    (Target::Translation(joint), 3, limits.offset(0.0) / if scale > 0.0 { scale } else { 1.0 })
                }
                Property::Rotation => (Target::Rotation(joint), 4, MAX_TURN.min(per_reach)),
                Property::Scale => (Target::Scale(joint), 3, MAX_WEIGHT_ERROR.min(per_reach)),
                Property::MorphWeights => (Target::Weights(joint), skeleton.morph_range(joint).len(), MAX_WEIGHT_ERROR),
            };
            if width > 0 {
                columns.push(Column { target, start, width, limit });
                start += width;
            }
        }
    }
    columns
}

/// Returns the numbers of all columns in a pose.
pub fn numbers(skeleton: &Skeleton, columns: &[Column], pose: &Pose) -> Vec<f32> {
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
    pub fn track(&self, skeleton: &Skeleton, samples: &Samples, limit: f64) -> Option<Track> {
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
        // Converted only once, since each is compared many times.
        let turns: Vec<DQuat> = match self.target {
            Target::Rotation(_) => values.iter().map(|sample| rotation(self.of(sample))).collect(),
            _ => Vec::new(),
        };
        let is_close = |from: usize, to: usize, at: usize| {
            let factor = f64::from(times[at] - times[from]) / f64::from(times[to] - times[from]);
            if let Target::Rotation(_) = self.target {
                return angle_between(slerp(turns[from], turns[to], factor), turns[at]) <= limit;
            }
            self.error([&values[from], &values[to]], factor, &values[at]) <= limit.max(self.rounding(&values[at]))
        };
        let keys = fewest(times.len(), |from, to| (from + 1..to).all(|at| is_close(from, to, at)));
        Some(self.with_keys(samples, &keys))
    }

    /// Returns the channel with the values of these samples.
    pub fn with_keys(&self, samples: &Samples, keys: &[usize]) -> Track {
        Track {
            target: self.target,
            interpolation: Interpolation::Linear,
            times: keys.iter().map(|&key| samples.times[key]).collect(),
            width: self.width,
            values: keys.iter().flat_map(|&key| self.of(&samples.values[key])).copied().collect(),
        }
    }

    /// Interpolates a rotation.
    pub fn rotation(&self, ends: [&Sample; 2], factor: f64) -> DQuat {
        let [from, to] = ends.map(|sample| rotation(self.of(sample)));
        slerp(from, to, factor)
    }

    /// Interpolates numbers.
    pub fn numbers(&self, ends: [&Sample; 2], factor: f64) -> impl Iterator<Item = f64> {
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

    /// Returns how far numbers other than rotations are from the ones interpolated between two others.
    pub fn error(&self, ends: [&Sample; 2], factor: f64, at: &Sample) -> f64 {
        let parts = self.numbers(ends, factor).zip(self.of(at)).map(|(found, &exact)| found - f64::from(exact));
        parts.map(|part| part * part).sum::<f64>().sqrt()
    }
}
