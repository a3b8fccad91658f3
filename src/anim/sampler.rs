//! Reading a clip at a time, exactly as glTF 2.0 §3.11 and appendix C say, and quickly.
//!
//! Most channels of real clips are LINEAR and many share their key times. Those lie here a second time, key by key: one row
//! holds the values of all of a timeline's channels at one key, so that one search and two neighbouring rows serve them all.
//! Rotations are already of unit length there and on one side of the sphere, and channels that never change are apart.
//! The rest (STEP, CUBICSPLINE, morph weights) is read from the clip's own keys.

use glam::{Quat, Vec3, Vec3A, Vec4};

use super::clip::{Channel, Clip, Interpolation, Keys};
use super::{JointIndex, Pose, Skeleton};

#[derive(Debug, Clone, Default)]
pub(super) struct Sampler {
    still: Still,
    /// One for each of the clip's timelines.
    timelines: Vec<TimelineTracks>,
}

/// What is the same at every time.
#[derive(Debug, Clone, Default)]
struct Still {
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
    /// Places in the clip's list of channels.
    others: Vec<u32>,
}

/// LINEAR channels: row `key` of `rows` has one value for each of `joints`.
#[derive(Debug, Clone, Default)]
struct VectorTracks {
    joints: Vec<JointIndex>,
    rows: Vec<Vec3A>,
}

/// LINEAR channels, in groups of four. Neighbouring rows are at most a right angle apart (as 4-vectors), so that the short
/// way is the straight one.
#[derive(Debug, Clone, Default)]
struct RotationTracks {
    joints: Vec<JointIndex>,
    rows: Vec<[Quat; 4]>,
    /// Cosine of the angle to the next row less 1, from -1 to 0; four channels a vector.
    turns: Vec<Vec4>,
}

/// A joint with its translations or scales, one per key.
type VectorKeys<'a> = (JointIndex, &'a [Vec3]);

impl Sampler {
    /// `channels` are valid for `timelines`, as the builder made sure.
    pub(super) fn new(timelines: &[Vec<f32>], channels: &[Channel]) -> Self {
        let mut sampler = Self { still: Still::default(), timelines: vec![TimelineTracks::default(); timelines.len()] };
        let mut vectors: Vec<[Vec<VectorKeys>; 2]> = vec![Default::default(); timelines.len()];
        let mut rotations: Vec<Vec<(JointIndex, Vec<Quat>)>> = vec![Vec::new(); timelines.len()];
        for (index, channel) in last_of_each_property(channels) {
            let timeline = channel.timeline as usize;
            let keys = timelines[timeline].len();
            let joint = channel.joint;
            match &channel.keys {
                Keys::Translation(values) if let Some(value) = still_vector(channel.interpolation, values) => {
                    sampler.still.translations.push((joint, value));
                }
                Keys::Scale(values) if let Some(value) = still_vector(channel.interpolation, values) => {
                    sampler.still.scales.push((joint, value));
                }
                Keys::Translation(values) if channel.interpolation == Interpolation::Linear => {
                    vectors[timeline][0].push((joint, values));
                }
                Keys::Scale(values) if channel.interpolation == Interpolation::Linear => {
                    vectors[timeline][1].push((joint, values));
                }
                Keys::Rotation(values) if channel.interpolation == Interpolation::Linear => {
                    let values = one_sided(values);
                    match values[1..].iter().all(|value| *value == values[0]) {
                        true => sampler.still.rotations.push((joint, values[0])),
                        false => rotations[timeline].push((joint, values)),
                    }
                }
                Keys::Rotation(values) if keys == 1 => {
                    let value = if channel.interpolation == Interpolation::CubicSpline { values[1] } else { values[0] };
                    sampler.still.rotations.push((joint, unit(value)));
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

    pub(super) fn sample(
        &self,
        clip: &Clip,
        skeleton: &Skeleton,
        time_secs: f32,
        segments: &mut Vec<u32>,
        pose: &mut Pose,
    ) {
        for &(joint, value) in &self.still.translations {
            pose.locals[joint.get()].translation = value;
        }
        for &(joint, value) in &self.still.rotations {
            pose.locals[joint.get()].rotation = value;
        }
        for &(joint, value) in &self.still.scales {
            pose.locals[joint.get()].scale = value;
        }
        segments.resize(self.timelines.len(), 0);
        for ((tracks, times), segment) in self.timelines.iter().zip(clip.timelines()).zip(segments) {
            *segment = find_segment(times, time_secs, *segment as usize) as u32;
            let at = Segment::new(times, *segment as usize, time_secs);
            let locals = &mut pose.locals[..];
            tracks.translations.sample(&at, |joint, value| locals[joint.get()].translation = value);
            tracks.scales.sample(&at, |joint, value| locals[joint.get()].scale = value);
            tracks.rotations.sample(&at, |joint, value| locals[joint.get()].rotation = value);
            for &index in &tracks.others {
                sample_channel(&clip.channels()[index as usize], &at, skeleton, pose);
            }
        }
    }
}

/// Channels in their order, with their places, without those that a later one for the same property overrides.
fn last_of_each_property(channels: &[Channel]) -> Vec<(usize, &Channel)> {
    let mut seen = std::collections::HashSet::new();
    let new = |(_, channel): &(usize, &Channel)| seen.insert((channel.joint, channel.keys.property()));
    let mut kept: Vec<_> = channels.iter().enumerate().rev().filter(new).collect();
    kept.reverse();
    kept
}

/// The value that a channel has at every time, if it has.
fn still_vector(interpolation: Interpolation, values: &[Vec3]) -> Option<Vec3> {
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

/// Unit rotations, each on the same side of the sphere as the one before it.
fn one_sided(values: &[Quat]) -> Vec<Quat> {
    let mut values: Vec<Quat> = values.iter().map(|value| unit(*value)).collect();
    for key in 1..values.len() {
        if values[key - 1].dot(values[key]) < 0.0 {
            values[key] = -values[key];
        }
    }
    values
}

/// A rotation of unit length; one that is so up to rounding stays as it is, one without a direction is none.
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

/// Below this, [`arc_polynomial`] is not good enough: 26 degrees as 4-vectors, 52 as rotations.
const LEAST_TURN: f32 = -0.1;

impl RotationTracks {
    fn new(keys: usize, channels: &[(JointIndex, Vec<Quat>)]) -> Self {
        let value = |at: usize, key: usize| channels.get(at).map_or(Quat::IDENTITY, |(_, values)| values[key]);
        // In f64: the cosine of a small angle is close to 1.
        let turn = |at: usize, key: usize| {
            let next = (key + 1).min(keys - 1);
            let cos = value(at, key).as_dquat().normalize().dot(value(at, next).as_dquat().normalize());
            (cos - 1.0).clamp(-1.0, 0.0) as f32
        };
        let groups = || (0..channels.len()).step_by(4);
        let lanes = |at: usize| std::array::from_fn::<usize, 4, _>(|lane| at + lane);
        Self {
            joints: channels.iter().map(|(joint, _)| *joint).collect(),
            rows: (0..keys).flat_map(|key| groups().map(move |at| lanes(at).map(|at| value(at, key)))).collect(),
            turns: (0..keys)
                .flat_map(|key| groups().map(move |at| Vec4::from(lanes(at).map(|at| turn(at, key)))))
                .collect(),
        }
    }

    #[inline(always)]
    fn sample(&self, at: &Segment, mut write: impl FnMut(JointIndex, Quat)) {
        let groups = self.joints.len().div_ceil(4);
        let [from, to] = [at.key, at.next].map(|key| &self.rows[key * groups..][..groups]);
        let turns = &self.turns[at.key * groups..][..groups];
        let from_polynomial = arc_polynomial(1.0 - at.factor);
        let to_polynomial = arc_polynomial(at.factor);
        for (((joints, from), to), &turns) in self.joints.chunks(4).zip(from).zip(to).zip(turns) {
            let (from_weights, to_weights) = if turns.cmplt(Vec4::splat(LEAST_TURN)).any() {
                (exact_weights(1.0 - at.factor, turns), exact_weights(at.factor, turns))
            } else {
                (evaluate(&from_polynomial, turns), evaluate(&to_polynomial, turns))
            };
            let (from_weights, to_weights) = (from_weights.to_array(), to_weights.to_array());
            for (lane, &joint) in joints.iter().enumerate() {
                write(joint, from[lane] * from_weights[lane] + to[lane] * to_weights[lane]);
            }
        }
    }
}

/// `sin(factor · ω) / sin(ω)`, the weight of one end of an arc of angle ω, as a polynomial in `cos ω - 1`, lowest first
/// (Eberly 2011, "A Fast and Accurate Algorithm for Computing SLERP"). The coefficients hang on the time alone, so they are
/// made once for all channels. Exact at factors 0 and 1; elsewhere within 1e-8 down to [`LEAST_TURN`].
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

/// The same for any angle up to a right one, which neighbouring keys never exceed.
#[cold]
fn exact_weights(factor: f32, turns: Vec4) -> Vec4 {
    Vec4::from(turns.to_array().map(|turn| {
        let angle = (1.0 + turn).acos();
        if angle > 0.0 { (factor * angle).sin() / angle.sin() } else { factor }
    }))
}

/// STEP, CUBICSPLINE and morph weights, from the clip's own keys.
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

    /// LINEAR ones are in the rows; where the keys hold, the spline is the key as well.
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
