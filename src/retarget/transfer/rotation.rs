//! The rotation law: a target joint turns away from its aligned rest as its source turns away from its own, both seen in the
//! common frame. With D the rotation away from the aligned rest `W*`, D of the target is D of the source, so
//!
//! `q_target = W*_t,parent⁻¹ · A · W*_t`, `A = D_a⁻¹ · D = W*_s,a · (source locals below a) · W*_s⁻¹`,
//!
//! where `a` is the nearest mapped ancestor, whose D the target's parent moves with (the VRM Animation specification's
//! "How to transform human pose" is the special case in which every ancestor is mapped). Where at most one of the locals
//! moves, `q_target` is a constant, that rotation, a constant: a linear map of its keys and tangents, so these are
//! transformed and nothing is resampled.

use glam::{DQuat, DVec4, Quat, Vec3};

use crate::anim::{Interpolation, JointIndex, Keys, Skeleton};
use crate::retarget::align::rest::{ancestry, unit};
use crate::retarget::align::swing::Alignment;
use crate::retarget::keys::resample::{Resampled, resample, union};
use crate::retarget::keys::track::{Motion, Track, angle_between, rotation_at, slerp};
use crate::retarget::map::ResolvedMap;

/// Where keys had to be put anew, straight interpolation is nearer than this.
pub const TOLERANCE_RADIANS: f64 = 0.05 * std::f64::consts::PI / 180.0;

/// One local rotation of the source in the product.
#[derive(Debug, Clone, Copy)]
struct Factor {
    joint: JointIndex,
    inverted: bool,
}

/// The local rotation of one target joint, as a function of time.
#[derive(Debug)]
pub struct RotationLaw<'a> {
    motion: &'a Motion<'a>,
    left: DQuat,
    factors: Vec<Factor>,
    right: DQuat,
    /// Turns in the common frame, applied after the motion, radians about +Y: travel that is taken out.
    pub yaw: Option<Yaw>,
    /// `W*_t,parent⁻¹`; `left` without it is what comes after `yaw`.
    parent: DQuat,
}

/// What is taken out of a turn about +Y.
#[derive(Debug, Clone)]
pub struct Yaw {
    /// Times and angles, straight in between; angles are not wrapped.
    pub times: Vec<f32>,
    pub radians: Vec<f64>,
}

impl Yaw {
    pub fn at(&self, time_secs: f32) -> f64 {
        let from = self.times.partition_point(|&start| start <= time_secs).saturating_sub(1);
        match self.times.get(from + 1) {
            Some(&end) if time_secs > self.times[from] => {
                let factor = f64::from(time_secs - self.times[from]) / f64::from(end - self.times[from]);
                self.radians[from] + factor * (self.radians[from + 1] - self.radians[from])
            }
            _ => self.radians.get(from).copied().unwrap_or(0.0),
        }
    }
}

/// A channel to be written: values for the target joint at times of its own.
#[derive(Debug, Clone)]
pub struct NewChannel {
    pub joint: JointIndex,
    pub interpolation: Interpolation,
    pub times: Vec<f32>,
    pub keys: Keys,
    /// Not the source's keys, but keys put anew.
    pub resampled: bool,
}

impl NewChannel {
    /// Repeats the last value at a later time.
    pub fn hold_until(&mut self, time_secs: f32) {
        fn hold<T: Copy>(values: &mut Vec<T>, spline: bool, zero: T) {
            let Some(&value) = (if spline { values.iter().nth_back(1) } else { values.last() }) else { return };
            if let Some(out) = values.last_mut().filter(|_| spline) {
                *out = zero;
                values.extend([zero, value, zero]);
            } else {
                values.push(value);
            }
        }
        let spline = self.interpolation == Interpolation::CubicSpline;
        match &mut self.keys {
            Keys::Translation(values) | Keys::Scale(values) => hold(values, spline, Vec3::ZERO),
            Keys::Rotation(values) => hold(values, spline, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
            Keys::MorphWeights { .. } => return,
        }
        self.times.push(time_secs);
    }
}

impl<'a> RotationLaw<'a> {
    /// For pair `index` of the map.
    pub fn new(
        map: &ResolvedMap,
        index: usize,
        alignment: &Alignment,
        target_skeleton: &Skeleton,
        motion: &'a Motion<'a>,
    ) -> Self {
        let pair = &map.pairs[index];
        let above = ancestry(target_skeleton, pair.target).skip(1).find_map(|joint| map.source_of(joint));
        let parent = target_skeleton.parent(pair.target);
        let parent = parent.map_or(alignment.target_turn, |parent| alignment.target.rotations[parent.get()]);
        let start = above.map_or(alignment.source_turn, |above| alignment.source.rotations[above.get()]);
        let right =
            alignment.source.rotations[pair.source.get()].conjugate() * alignment.target.rotations[pair.target.get()];
        Self {
            motion,
            left: unit(start),
            factors: factors(motion.skeleton, above, pair.source),
            right: unit(right),
            yaw: None,
            parent: unit(parent.conjugate()),
        }
    }

    fn track(&self, factor: Factor) -> &'a Track<'a, DQuat> {
        &self.motion.rotations[factor.joint.get()]
    }

    /// The local rotation at a time.
    pub fn at(&self, time_secs: f32) -> DQuat {
        let product = self.factors.iter().fold(self.left, |product, &factor| {
            let rotation = rotation_at(self.track(factor), time_secs);
            product * if factor.inverted { rotation.conjugate() } else { rotation }
        });
        let turn = match &self.yaw {
            Some(yaw) => DQuat::from_rotation_y(yaw.at(time_secs)),
            None => DQuat::IDENTITY,
        };
        unit(self.parent * turn * product * self.right)
    }

    /// Whether any source joint in the product has a channel.
    pub fn has_channel(&self) -> bool {
        self.factors.iter().any(|factor| self.motion.has_channel[factor.joint.get()])
    }

    /// Times at which something in the product has a key, and those at which it jumps.
    pub fn times(&self) -> (Vec<f32>, Vec<f32>) {
        let timelines = self.factors.iter().map(|&factor| self.track(factor).times());
        let yaw = self.yaw.as_ref().map_or(&[][..], |yaw| &yaw.times);
        let steps = self.factors.iter().filter_map(|&factor| match self.track(factor) {
            Track::Keys { times, channel } if channel.interpolation == Interpolation::Step => Some(*times),
            _ => None,
        });
        (union(timelines.chain([yaw])), union(steps))
    }

    /// The channel of a target joint; none where the rest says the same.
    pub fn channel(&self, joint: JointIndex, rest: DQuat) -> Option<NewChannel> {
        let moving: Vec<Factor> = self.factors.iter().copied().filter(|&factor| self.track(factor).moves()).collect();
        match moving[..] {
            _ if self.yaw.is_some() => Some(self.resampled(joint)),
            [] => {
                let rotation = self.at(0.0);
                let says_nothing = !self.has_channel() && angle_between(rotation, rest) < 1e-6;
                (!says_nothing).then(|| NewChannel {
                    joint,
                    interpolation: Interpolation::Step,
                    times: vec![0.0],
                    keys: Keys::Rotation(vec![rotation.as_quat()]),
                    resampled: false,
                })
            }
            [factor] => self.transformed(joint, factor),
            _ => Some(self.resampled(joint)),
        }
    }

    /// The keys of the one factor that moves, between two constants. Tangents are mapped as values are; all of it is linear.
    fn transformed(&self, joint: JointIndex, moving: Factor) -> Option<NewChannel> {
        let Track::Keys { times, channel } = self.track(moving) else { return None };
        let Keys::Rotation(values) = &channel.keys else { return None };
        let (mut left, mut right, mut passed) = (self.parent * self.left, DQuat::IDENTITY, false);
        for &factor in &self.factors {
            if factor.joint == moving.joint {
                passed = true;
                continue;
            }
            let rotation = rotation_at(self.track(factor), 0.0);
            let rotation = if factor.inverted { rotation.conjugate() } else { rotation };
            match passed {
                false => left *= rotation,
                true => right *= rotation,
            }
        }
        let (left, right) = (unit(left), unit(right * self.right));
        let between = |value: &Quat| {
            let value = value.as_dquat();
            let value = if moving.inverted { value.conjugate() } else { value };
            Quat::from_vec4(DVec4::from(left * value * right).as_vec4())
        };
        Some(NewChannel {
            joint,
            interpolation: channel.interpolation,
            times: times.to_vec(),
            keys: Keys::Rotation(values.iter().map(between).collect()),
            resampled: false,
        })
    }

    fn resampled(&self, joint: JointIndex) -> NewChannel {
        let (times, jumps) = self.times();
        let Resampled { times, values } =
            resample(&times, &jumps, TOLERANCE_RADIANS, |time| self.at(time), slerp, angle_between);
        let mut values: Vec<Quat> = values.into_iter().map(DQuat::as_quat).collect();
        for key in 1..values.len() {
            if values[key - 1].dot(values[key]) < 0.0 {
                values[key] = -values[key];
            }
        }
        NewChannel { joint, interpolation: Interpolation::Linear, times, keys: Keys::Rotation(values), resampled: true }
    }
}

/// The locals that lead from joint `from` (from the root when there is none) to joint `to`: up to their common ancestor
/// inverted, then down.
fn factors(skeleton: &Skeleton, from: Option<JointIndex>, to: JointIndex) -> Vec<Factor> {
    let mut down: Vec<JointIndex> = ancestry(skeleton, to).collect();
    let mut up: Vec<JointIndex> = from.map(|from| ancestry(skeleton, from).collect()).unwrap_or_default();
    while let (Some(a), Some(b)) = (up.last(), down.last())
        && a == b
    {
        up.pop();
        down.pop();
    }
    let up = up.into_iter().map(|joint| Factor { joint, inverted: true });
    up.chain(down.into_iter().rev().map(|joint| Factor { joint, inverted: false })).collect()
}
