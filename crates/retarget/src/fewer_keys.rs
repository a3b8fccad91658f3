//! Drops keys that interpolation restores. Each channel is thinned on its own, and the result is measured by what all of them
//! together do: where every joint is and how it is turned in model space, between keys as well. If that is too far off, since
//! errors add up along a limb, all channels are thinned less.

use std::collections::HashSet;

use gaitway_character::anim::{
    Channel, Clip, ClipBuilder, Interpolation, JointIndex, Keys, SampleCursor, Skeleton, Transform, model_from_joint,
};
use glam::{Affine3A, Mat3A, Vec3};

use crate::keys::limits::height_or_metre;
use crate::keys::resample::{fewest, union};
use crate::math::{angle_between, slerp, unit};

/// How far joints may be from where they were.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeyTolerance {
    /// Turn of a joint in model space.
    pub degrees: f64,
    /// Distance from its place, per metre of the body's height.
    pub millimetres_per_metre: f64,
}

impl Default for KeyTolerance {
    fn default() -> Self {
        Self { degrees: 0.01, millimetres_per_metre: 0.01 }
    }
}

/// A clip with fewer keys.
#[derive(Debug, Clone)]
pub struct Thinned {
    /// The clip.
    pub clip: Clip,
    /// Number of keys of all channels before.
    pub keys_before: usize,
    /// The same now.
    pub keys_after: usize,
    /// The largest errors that were measured.
    pub error: KeyTolerance,
}

/// How often channels are thinned less at most.
const MAX_ATTEMPTS: i32 = 8;
/// What interpolation may be off where no joint moves: weights, and factors of scale.
const MAX_FACTOR_ERROR: f32 = 1e-5;

/// Returns a clip with as few keys as keep all joints within the tolerance. Splines keep their keys; channels that hold still get a
/// single one, or none if that is the rest.
pub fn fewer_keys(skeleton: &Skeleton, clip: &Clip, tolerance: KeyTolerance) -> Thinned {
    let rest = world(skeleton, skeleton.rest().locals());
    let places = || rest.iter().map(|joint| Vec3::from(joint.translation));
    let extent = places().fold(Vec3::MIN, Vec3::max) - places().fold(Vec3::MAX, Vec3::min);
    let height = height_or_metre(f64::from(extent.max_element()));
    let keys_before = count(clip);
    for attempt in 1..=MAX_ATTEMPTS {
        let share = 0.5_f64.powi(attempt);
        let allowed = Allowed {
            turn: share * tolerance.degrees.to_radians(),
            metres: share * tolerance.millimetres_per_metre * 1e-3 * height,
        };
        let thinned = thin(skeleton, clip, &rest, allowed);
        let error = measure(skeleton, clip, &thinned, height);
        if error.degrees <= tolerance.degrees && error.millimetres_per_metre <= tolerance.millimetres_per_metre {
            return Thinned { keys_after: count(&thinned), clip: thinned, keys_before, error };
        }
    }
    let none = KeyTolerance { degrees: 0.0, millimetres_per_metre: 0.0 };
    Thinned { clip: clip.clone(), keys_before, keys_after: keys_before, error: none }
}

fn count(clip: &Clip) -> usize {
    clip.channels().iter().map(|channel| clip.timelines()[channel.timeline as usize].len()).sum()
}

/// What one channel may be off.
#[derive(Clone, Copy)]
struct Allowed {
    /// Radians.
    turn: f64,
    metres: f64,
}

fn thin(skeleton: &Skeleton, clip: &Clip, rest: &[Affine3A], allowed: Allowed) -> Clip {
    let last_secs = |channel: &Channel| clip.timelines()[channel.timeline as usize].last().copied();
    // One channel has to say how long the clip is.
    let longest = clip.channels().iter().position(|channel| last_secs(channel) == Some(clip.duration_secs()));
    let target = |channel: &Channel| (channel.joint, channel.keys.property());
    let mut seen = HashSet::new();
    let repeated: HashSet<_> = clip.channels().iter().map(target).filter(|&target| !seen.insert(target)).collect();
    let mut builder = ClipBuilder::new(clip.name(), skeleton);
    for (index, channel) in clip.channels().iter().enumerate() {
        let times_secs = &clip.timelines()[channel.timeline as usize];
        let (mut kept, last) = (kept(skeleton, channel, times_secs, rest, allowed), times_secs.len() - 1);
        if Some(index) == longest {
            kept.extend((kept.last() != Some(&last)).then_some(last));
        } else if kept.len() == 1 && is_at_rest(skeleton, channel) && !repeated.contains(&target(channel)) {
            continue;
        }
        let times: Vec<f32> = kept.iter().map(|&key| times_secs[key]).collect();
        // What one clip holds, another one for the same skeleton does as well.
        let _ = builder.channel(channel.joint, channel.interpolation, &times, chosen(channel, &kept));
    }
    builder.build().with_properties_of(clip, &Some)
}

/// The keys of a channel at these indices.
fn chosen(channel: &Channel, kept: &[usize]) -> Keys {
    let entries = if channel.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    fn pick<T: Copy>(values: &[T], width: usize, kept: &[usize]) -> Vec<T> {
        kept.iter().flat_map(|&key| values[key * width..(key + 1) * width].iter().copied()).collect()
    }
    match &channel.keys {
        Keys::Translation(values) => Keys::Translation(pick(values, entries, kept)),
        Keys::Rotation(values) => Keys::Rotation(pick(values, entries, kept)),
        Keys::Scale(values) => Keys::Scale(pick(values, entries, kept)),
        Keys::MorphWeights { values, targets } => {
            Keys::MorphWeights { values: pick(values, entries * targets, kept), targets: *targets }
        }
    }
}

/// Whether the first key of a channel is what its joint has at rest.
fn is_at_rest(skeleton: &Skeleton, channel: &Channel) -> bool {
    let rest = skeleton.rest().local(channel.joint);
    match &channel.keys {
        Keys::Translation(values) => values.first() == Some(&rest.translation),
        Keys::Rotation(values) => values.first() == Some(&rest.rotation),
        Keys::Scale(values) => values.first() == Some(&rest.scale),
        Keys::MorphWeights { values, targets } => {
            skeleton.rest().morph_weights.get(skeleton.morph_range(channel.joint)) == values.get(..*targets)
        }
    }
}

/// The keys of a channel from which interpolation restores the others.
fn kept(skeleton: &Skeleton, channel: &Channel, times_secs: &[f32], rest: &[Affine3A], allowed: Allowed) -> Vec<usize> {
    let factor =
        |from: usize, to: usize, key: usize| (times_secs[key] - times_secs[from]) / (times_secs[to] - times_secs[from]);
    // Metres per unit of the space that the joint is in.
    let scale =
        skeleton.parent(channel.joint).map_or(1.0, |parent| rest[parent.get()].matrix3.determinant().abs().cbrt());
    let place_error = allowed.metres as f32 / scale.max(f32::MIN_POSITIVE);
    let vectors = |values: &[Vec3], error: f32| {
        restoring(
            channel,
            times_secs.len(),
            |from, to, key| {
                let found = values[from].lerp(values[to], factor(from, to, key));
                found.distance(values[key]) <= error
            },
            |key, other| values[key] == values[other],
        )
    };
    match &channel.keys {
        Keys::Translation(values) => vectors(values, place_error),
        Keys::Scale(values) => vectors(values, MAX_FACTOR_ERROR),
        Keys::Rotation(values) => restoring(
            channel,
            times_secs.len(),
            |from, to, key| {
                let [from_turn, to_turn, turn] = [from, to, key].map(|key| unit(values[key].as_dquat()));
                let found = slerp(from_turn, to_turn, f64::from(factor(from, to, key)));
                angle_between(found, turn) <= allowed.turn
            },
            |key, other| values[key] == values[other],
        ),
        Keys::MorphWeights { values, targets } => {
            let of = |key: usize| &values[key * targets..(key + 1) * targets];
            restoring(
                channel,
                times_secs.len(),
                |from, to, key| {
                    let factor = factor(from, to, key);
                    let ends = of(from).iter().zip(of(to)).map(|(from, to)| from + factor * (to - from));
                    ends.zip(of(key)).all(|(found, expected)| (found - expected).abs() <= MAX_FACTOR_ERROR)
                },
                |key, other| of(key) == of(other),
            )
        }
    }
}

/// `is_restored(from, to, key)`: whether a key between two others is what a line between those has; `is_same`: whether two have
/// one value.
fn restoring(
    channel: &Channel,
    count: usize,
    is_restored: impl Fn(usize, usize, usize) -> bool,
    is_same: impl Fn(usize, usize) -> bool,
) -> Vec<usize> {
    match channel.interpolation {
        Interpolation::CubicSpline => (0..count).collect(),
        _ if (1..count).all(|key| is_same(key, 0)) => vec![0],
        Interpolation::Step => (0..count).filter(|&key| key == 0 || !is_same(key, key - 1)).collect(),
        Interpolation::Linear => fewest(count, |from, to| (from + 1..to).all(|key| is_restored(from, to, key))),
    }
}

fn world(skeleton: &Skeleton, locals: impl Iterator<Item = Transform>) -> Vec<Affine3A> {
    let mut pose = skeleton.rest().clone();
    locals.enumerate().for_each(|(joint, local)| pose.set_local(JointIndex(joint as u32), local));
    let mut world = Vec::new();
    model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut world);
    world
}

/// Compares the poses of two clips at all keys and between them.
fn measure(skeleton: &Skeleton, clip: &Clip, thinned: &Clip, height: f64) -> KeyTolerance {
    let times = union(clip.timelines().iter().map(Vec::as_slice));
    let between = times.windows(2).flat_map(|pair| [0.25, 0.5, 0.75].map(|part| pair[0] + part * (pair[1] - pair[0])));
    let mut cursors = [clip, thinned].map(|clip| (clip, SampleCursor::default(), skeleton.rest().clone(), Vec::new()));
    let mut error = KeyTolerance { degrees: 0.0, millimetres_per_metre: 0.0 };
    for time_secs in times.iter().copied().chain(between) {
        for (clip, cursor, pose, world) in &mut cursors {
            pose.copy_from(skeleton.rest());
            clip.sample(skeleton, time_secs, cursor, pose);
            model_from_joint(skeleton, pose, Affine3A::IDENTITY, world);
        }
        let [(.., before), (.., after)] = &cursors;
        for (before, after) in before.iter().zip(after) {
            let distance = f64::from(before.translation.distance(after.translation));
            error.millimetres_per_metre = error.millimetres_per_metre.max(1e3 * distance / height);
            error.degrees = error.degrees.max(turn_of(before, after).to_degrees());
        }
    }
    error
}

/// The angle in radians between two orientations, whose scales may differ: from how far apart their axes are, which also compares
/// two mirrored ones.
fn turn_of(one: &Affine3A, other: &Affine3A) -> f64 {
    let axes = |joint: &Affine3A| {
        let Mat3A { x_axis, y_axis, z_axis } = joint.matrix3;
        [x_axis, y_axis, z_axis].map(|axis| axis.as_dvec3().normalize_or_zero())
    };
    let apart: f64 = axes(one).iter().zip(axes(other)).map(|(one, other)| one.distance_squared(other)).sum();
    2.0 * (apart / 8.0).sqrt().min(1.0).asin()
}
