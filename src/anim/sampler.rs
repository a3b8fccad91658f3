//! Samples clips as defined in glTF 2.0 §3.11 and appendix C, optimized for playback.
//!
//! Most channels of real clips are LINEAR, and many share their key times. Their values are stored here a second time,
//! key by key: a row holds the values of all channels of a timeline at one key, so one search and two adjacent rows
//! serve them all. Rotations in rows are normalized and in a consistent hemisphere. Constant channels are kept apart.
//! Everything else (STEP, CUBICSPLINE, morph weights) is read from the clip's own keys.

use glam::{Quat, Vec3, Vec3A, Vec4};

use super::channel::{Channel, Interpolation, Keys};
use super::{JointIndex, Pose, Skeleton};

#[derive(Debug, Clone, Default)]
pub(super) struct Sampler {
    constants: Constants,
    /// One per timeline of the clip.
    timelines: Vec<TimelineTracks>,
}

/// Values of the channels that never change.
#[derive(Debug, Clone, Default)]
struct Constants {
    translations: Vec<(JointIndex, Vec3)>,
    rotations: Vec<(JointIndex, Quat)>,
    scales: Vec<(JointIndex, Vec3)>,
}

/// The channels of one timeline.
#[derive(Debug, Clone, Default)]
struct TimelineTracks {
    translations: VectorTracks,
    scales: VectorTracks,
    rotations: RotationTracks,
    /// Indices of the clip's channels that are not in rows.
    others: Vec<u32>,
}

/// LINEAR channels: row `key` of `rows` has one value per joint of `joints`.
#[derive(Debug, Clone, Default)]
struct VectorTracks {
    joints: Vec<JointIndex>,
    rows: Vec<Vec3A>,
}

/// LINEAR channels in groups of four. Adjacent rows are at most a right angle apart (as 4-vectors), so the shortest arc
/// is the direct one.
#[derive(Debug, Clone, Default)]
struct RotationTracks {
    joints: Vec<JointIndex>,
    rows: Vec<[Quat; 4]>,
    /// Cosine of the angle to the next row minus 1, from -1 to 0, four channels to a vector.
    cosines: Vec<Vec4>,
}

/// A joint and its translations or scales, one per key.
type VectorKeys<'a> = (JointIndex, &'a [Vec3]);

impl Sampler {
    /// `channels` must be valid for `timelines`, which the builder ensures.
    pub(super) fn new(timelines: &[Vec<f32>], channels: &[Channel]) -> Self {
        let mut sampler =
            Self { constants: Constants::default(), timelines: vec![TimelineTracks::default(); timelines.len()] };
        let mut vectors: Vec<[Vec<VectorKeys>; 2]> = vec![Default::default(); timelines.len()];
        let mut rotations: Vec<Vec<(JointIndex, Vec<Quat>)>> = vec![Vec::new(); timelines.len()];
        for (index, channel) in last_of_each_property(channels) {
            let timeline = channel.timeline as usize;
            let keys = timelines[timeline].len();
            let joint = channel.joint;
            match &channel.keys {
                Keys::Translation(values) if let Some(value) = constant_vector(channel.interpolation, values) => {
                    sampler.constants.translations.push((joint, value));
                }
                Keys::Scale(values) if let Some(value) = constant_vector(channel.interpolation, values) => {
                    sampler.constants.scales.push((joint, value));
                }
                Keys::Translation(values) if channel.interpolation == Interpolation::Linear => {
                    vectors[timeline][0].push((joint, values));
                }
                Keys::Scale(values) if channel.interpolation == Interpolation::Linear => {
                    vectors[timeline][1].push((joint, values));
                }
                Keys::Rotation(values) if channel.interpolation == Interpolation::Linear => {
                    let values = continuous(values);
                    match values[1..].iter().all(|value| *value == values[0]) {
                        true => sampler.constants.rotations.push((joint, values[0])),
                        false => rotations[timeline].push((joint, values)),
                    }
                }
                Keys::Rotation(values) if keys == 1 => {
                    let value = if channel.interpolation == Interpolation::CubicSpline { values[1] } else { values[0] };
                    sampler.constants.rotations.push((joint, unit(value)));
                }
                _ => sampler.timelines[timeline].others.push(index as u32),
            }
        }
        for (at, tracks) in sampler.timelines.iter_mut().enumerate() {
            let keys = timelines[at].len();
            tracks.translations = VectorTracks::new(keys, &vectors[at][0]);
            tracks.scales = VectorTracks::new(keys, &vectors[at][1]);
            tracks.rotations = RotationTracks::new(keys, &rotations[at]);
        }
        sampler
    }

    /// `timelines` and `channels` are those the sampler was made from.
    pub(super) fn sample(
        &self,
        timelines: &[Vec<f32>],
        channels: &[Channel],
        skeleton: &Skeleton,
        time_secs: f32,
        segments: &mut Vec<u32>,
        pose: &mut Pose,
    ) {
        for &(joint, value) in &self.constants.translations {
            pose.locals[joint.get()].translation = value;
        }
        for &(joint, value) in &self.constants.rotations {
            pose.locals[joint.get()].rotation = value;
        }
        for &(joint, value) in &self.constants.scales {
            pose.locals[joint.get()].scale = value;
        }
        segments.resize(self.timelines.len(), 0);
        for ((tracks, times), segment) in self.timelines.iter().zip(timelines).zip(segments) {
            *segment = find_segment(times, time_secs, *segment as usize) as u32;
            let at = Segment::new(times, *segment as usize, time_secs);
            let locals = &mut pose.locals[..];
            tracks.translations.sample(&at, |joint, value| locals[joint.get()].translation = value);
            tracks.scales.sample(&at, |joint, value| locals[joint.get()].scale = value);
            tracks.rotations.sample(&at, |joint, value| locals[joint.get()].rotation = value);
            for &index in &tracks.others {
                sample_channel(&channels[index as usize], &at, skeleton, pose);
            }
        }
    }
}

/// Returns the channels with their indices, in order, without those that a later channel for the same property overrides.
fn last_of_each_property(channels: &[Channel]) -> Vec<(usize, &Channel)> {
    let mut seen = std::collections::HashSet::new();
    let new = |(_, channel): &(usize, &Channel)| seen.insert((channel.joint, channel.keys.property()));
    let mut kept: Vec<_> = channels.iter().enumerate().rev().filter(new).collect();
    kept.reverse();
    kept
}

/// Returns the value of a channel that never changes.
fn constant_vector(interpolation: Interpolation, values: &[Vec3]) -> Option<Vec3> {
    match interpolation {
        Interpolation::Step | Interpolation::Linear => {
            let first = *values.first()?;
            values.iter().all(|value| *value == first).then_some(first)
        }
        Interpolation::CubicSpline => {
            let first = *values.get(1)?;
            let flat = |entry: &[Vec3]| *entry == [Vec3::ZERO, first, Vec3::ZERO];
            (values.len() == 3 || values.chunks(3).all(flat)).then_some(first)
        }
    }
}

/// Normalizes rotations and flips each into the hemisphere of the one before it.
fn continuous(values: &[Quat]) -> Vec<Quat> {
    let mut values: Vec<Quat> = values.iter().map(|value| unit(*value)).collect();
    for key in 1..values.len() {
        if values[key - 1].dot(values[key]) < 0.0 {
            values[key] = -values[key];
        }
    }
    values
}

/// Normalizes a rotation. One that is normalized up to rounding is returned unchanged, a degenerate one becomes identity.
fn unit(value: Quat) -> Quat {
    let length_squared = value.length_squared();
    if (length_squared - 1.0).abs() < 1e-6 {
        return value;
    }
    let length = value.length();
    if length.is_finite() && length > 0.0 { value / length } else { Quat::IDENTITY }
}

impl VectorTracks {
    fn new(keys: usize, channels: &[(JointIndex, &[Vec3])]) -> Self {
        let row = |key: usize| channels.iter().map(move |(_, values)| Vec3A::from(values[key]));
        Self { joints: channels.iter().map(|(joint, _)| *joint).collect(), rows: (0..keys).flat_map(row).collect() }
    }

    #[inline(always)]
    fn sample(&self, at: &Segment, mut write: impl FnMut(JointIndex, Vec3)) {
        let [from, to] = [at.key, at.next].map(|key| &self.rows[key * self.joints.len()..][..self.joints.len()]);
        for ((&joint, &from), &to) in self.joints.iter().zip(from).zip(to) {
            write(joint, Vec3::from(from + (to - from) * at.factor));
        }
    }
}

/// Below this, [`arc_polynomial`] is not accurate enough: 26 degrees as 4-vectors, 52 as rotations.
const MIN_COSINE: f32 = -0.1;

impl RotationTracks {
    fn new(keys: usize, channels: &[(JointIndex, Vec<Quat>)]) -> Self {
        let value = |at: usize, key: usize| channels.get(at).map_or(Quat::IDENTITY, |(_, values)| values[key]);
        // In f64, because the cosine of a small angle is close to 1.
        let cosine = |at: usize, key: usize| {
            let next = (key + 1).min(keys - 1);
            let cos = value(at, key).as_dquat().normalize().dot(value(at, next).as_dquat().normalize());
            (cos - 1.0).clamp(-1.0, 0.0) as f32
        };
        let groups = || (0..channels.len()).step_by(4);
        let lanes = |at: usize| std::array::from_fn::<usize, 4, _>(|lane| at + lane);
        Self {
            joints: channels.iter().map(|(joint, _)| *joint).collect(),
            rows: (0..keys).flat_map(|key| groups().map(move |at| lanes(at).map(|at| value(at, key)))).collect(),
            cosines: (0..keys)
                .flat_map(|key| groups().map(move |at| Vec4::from(lanes(at).map(|at| cosine(at, key)))))
                .collect(),
        }
    }

    #[inline(always)]
    fn sample(&self, at: &Segment, mut write: impl FnMut(JointIndex, Quat)) {
        let groups = self.joints.len().div_ceil(4);
        let [from, to] = [at.key, at.next].map(|key| &self.rows[key * groups..][..groups]);
        let cosines = &self.cosines[at.key * groups..][..groups];
        let from_polynomial = arc_polynomial(1.0 - at.factor);
        let to_polynomial = arc_polynomial(at.factor);
        for (((joints, from), to), &cosines) in self.joints.chunks(4).zip(from).zip(to).zip(cosines) {
            let (from_weights, to_weights) = if cosines.cmplt(Vec4::splat(MIN_COSINE)).any() {
                (exact_weights(1.0 - at.factor, cosines), exact_weights(at.factor, cosines))
            } else {
                (evaluate(&from_polynomial, cosines), evaluate(&to_polynomial, cosines))
            };
            let (from_weights, to_weights) = (from_weights.to_array(), to_weights.to_array());
            for (lane, &joint) in joints.iter().enumerate() {
                write(joint, from[lane] * from_weights[lane] + to[lane] * to_weights[lane]);
            }
        }
    }
}

/// `sin(factor · ω) / sin(ω)`, the weight of one end of an arc of angle ω, as a polynomial in `cos ω - 1`, lowest first
/// (Eberly 2011, "A Fast and Accurate Algorithm for Computing SLERP"). The coefficients depend on the time only, so
/// all channels share them. Exact at factors 0 and 1; elsewhere within 1e-8 down to [`MIN_COSINE`].
fn arc_polynomial(factor: f32) -> [f32; 6] {
    let mut coefficients = [factor; 6];
    for i in 1..6 {
        let (u, v) = (1.0 / (i * (2 * i + 1)) as f32, i as f32 / (2 * i + 1) as f32);
        coefficients[i] = coefficients[i - 1] * (u * factor * factor - v);
    }
    coefficients
}

#[inline(always)]
fn evaluate(polynomial: &[f32; 6], at: Vec4) -> Vec4 {
    polynomial[..5]
        .iter()
        .rev()
        .fold(Vec4::splat(polynomial[5]), |sum, &coefficient| sum * at + Vec4::splat(coefficient))
}

/// The weights of [`arc_polynomial`], exact for any angle up to a right one, which adjacent keys never exceed.
#[cold]
fn exact_weights(factor: f32, cosines: Vec4) -> Vec4 {
    Vec4::from(cosines.to_array().map(|cosine| {
        let angle = (1.0 + cosine).acos();
        if angle > 0.0 { (factor * angle).sin() / angle.sin() } else { factor }
    }))
}

/// Samples STEP, CUBICSPLINE and morph-weight channels from the clip's own keys.
fn sample_channel(channel: &Channel, at: &Segment, skeleton: &Skeleton, pose: &mut Pose) {
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

/// Returns the index of the last key at or before `time_secs` (0 before the first key), trying a guess first.
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

/// Two adjacent keys and the position of the time between them.
struct Segment {
    key: usize,
    /// Equals `key` outside the keys, where values hold.
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

    /// Hermite basis of glTF 2.0 appendix C.4, with the segment's length multiplied into the tangent factors.
    fn cubic_factors(&self) -> [f32; 4] {
        let (t, t2, t3) = (self.factor, self.factor * self.factor, self.factor * self.factor * self.factor);
        let length = self.length_secs;
        [2.0 * t3 - 3.0 * t2 + 1.0, length * (t3 - 2.0 * t2 + t), -2.0 * t3 + 3.0 * t2, length * (t3 - t2)]
    }

    /// STEP or CUBICSPLINE; LINEAR channels are in the rows. At a factor of 0 the spline equals the key.
    fn vec3(&self, values: &[Vec3], interpolation: Interpolation) -> Vec3 {
        if interpolation != Interpolation::CubicSpline {
            return values[self.key];
        }
        if self.factor == 0.0 {
            return values[3 * self.key + 1];
        }
        let [p0, m0, p1, m1] = self.cubic_factors();
        p0 * values[3 * self.key + 1]
            + m0 * values[3 * self.key + 2]
            + p1 * values[3 * self.next + 1]
            + m1 * values[3 * self.next]
    }

    fn quat(&self, values: &[Quat], interpolation: Interpolation) -> Quat {
        if interpolation != Interpolation::CubicSpline {
            return unit(values[self.key]);
        }
        if self.factor == 0.0 {
            return unit(values[3 * self.key + 1]);
        }
        let [p0, m0, p1, m1] = self.cubic_factors();
        let at = |index: usize| Vec4::from(values[index]);
        let sum =
            p0 * at(3 * self.key + 1) + m0 * at(3 * self.key + 2) + p1 * at(3 * self.next + 1) + m1 * at(3 * self.next);
        unit(Quat::from_vec4(sum))
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
