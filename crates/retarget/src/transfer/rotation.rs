//! The rotation law: a target joint turns away from its aligned rest as its source turns away from its own, both seen in the
//! common frame. With D the rotation away from the aligned rest `W*`, D of the target is D of the source, so
//!
//! `q_target = W*_t,parent⁻¹ · A · W*_t`, `A = D_a⁻¹ · D = W*_s,a · (source locals below a) · W*_s⁻¹`,
//!
//! where `a` is the source of the nearest mapped ancestor, whose D the target's parent moves with (the VRM Animation
//! specification's "How to transform human pose" is the special case in which every ancestor is mapped). Where at most one
//! of the locals moves, `q_target` is that rotation between two constants: a linear map of its keys and tangents, so these
//! are transformed and nothing is resampled.

use std::ops::Range;

use gaitway_character::anim::{JointIndex, Keys, Skeleton};
use gaitway_character::sort::sort_by;
use glam::{DQuat, DVec4, Quat};

use super::Transfer;
use super::turns::Turn;
use super::yaw::Yaw;
use crate::keys::channel::{NewChannel, continuous};
use crate::keys::limits::MAX_TURN;
use crate::keys::resample::{Curve, Resampled, resample, union};
use crate::keys::tracks::{SourceTracks, Track};
use crate::math::{angle_between, slerp, unit};
use crate::pose::{ancestry, is_within};

/// One local rotation of the source in the product.
#[derive(Debug, Clone, Copy)]
struct Factor {
    joint: JointIndex,
    inverted: bool,
}

/// The local rotation of one target joint as a function of time: `parent⁻¹ · yaw · left · factors · right` or, where a turn is
/// [shared](super::turns) along a chain, `parent⁻¹ · yaw · D_a⁻¹ · D · right`.
#[derive(Debug)]
pub struct RotationLaw<'a> {
    tracks: &'a SourceTracks<'a>,
    /// `W*_t,parent⁻¹`.
    inverse_parent: DQuat,
    /// `W*_s,a`.
    left: DQuat,
    factors: Vec<Factor>,
    shared: Option<SharedTurn>,
    /// `W*_s⁻¹ · W*_t`; `W*_t` for a shared turn.
    right: DQuat,
    /// Turning removed from the motion, in the common frame.
    pub yaw: Option<Yaw>,
}

/// A turn between those of several joints of the source.
#[derive(Debug)]
struct SharedTurn {
    /// Of the nearest ancestor that turns.
    above: Option<Turn>,
    own: Turn,
    /// The joints of both turns: where their locals are among the factors, and `W*_s⁻¹`. With an ancestor that turns, all begin at
    /// their common ancestor, whose own rotation cancels out.
    sources: Vec<(JointIndex, Range<usize>, DQuat)>,
}

impl<'a> RotationLaw<'a> {
    /// For a target joint that follows `turn`.
    pub fn new(transfer: &Transfer<'a>, joint: JointIndex, turn: Turn) -> Self {
        let (alignment, skeleton) = (transfer.alignment, transfer.target_skeleton);
        let rest_of = |joint: JointIndex| alignment.source.rotation(joint);
        let above = ancestry(skeleton, joint).skip(1).find_map(|joint| transfer.turns.of(joint));
        let target_rest = alignment.target.rotation(joint);
        let law = Self {
            tracks: transfer.tracks,
            inverse_parent: unit(alignment.target.parent_rotation(skeleton, joint).conjugate()),
            left: DQuat::IDENTITY,
            factors: Vec::new(),
            shared: None,
            right: unit(target_rest),
            yaw: None,
        };
        let source = turn.joint().filter(|_| above.is_none_or(|above| above.joint().is_some()));
        let Some(source) = source else { return law.with_shared(transfer, above, turn) };
        let above = above.and_then(Turn::joint);
        Self {
            left: unit(above.map_or(alignment.source.world_from_model, rest_of)),
            factors: factors(transfer.tracks.skeleton, above, source),
            right: unit(rest_of(source).conjugate() * target_rest),
            ..law
        }
    }

    fn with_shared(mut self, transfer: &Transfer, above: Option<Turn>, own: Turn) -> Self {
        let mut joints: Vec<JointIndex> = above.into_iter().chain([own]).flat_map(Turn::joints).collect();
        sort_by(&mut joints, Ord::cmp);
        joints.dedup();
        let (skeleton, rest) = (self.tracks.skeleton, &transfer.alignment.source);
        let is_common = |above: &JointIndex| joints.iter().all(|&joint| is_within(skeleton, joint, *above));
        let base = above.and_then(|_| ancestry(skeleton, *joints.first()?).find(is_common));
        if base.is_none() {
            self.left = rest.world_from_model;
        }
        let mut sources = Vec::new();
        for joint in joints {
            let start = self.factors.len();
            self.factors.extend(factors(skeleton, base, joint));
            sources.push((joint, start..self.factors.len(), unit(rest.rotation(joint).conjugate())));
        }
        self.shared = Some(SharedTurn { above, own, sources });
        self
    }

    fn track(&self, factor: Factor) -> &'a Track<'a, DQuat> {
        &self.tracks.rotations[factor.joint.get()]
    }

    fn factor_at(&self, factor: Factor, time_secs: f32) -> DQuat {
        let rotation = self.tracks.rotation(factor.joint, time_secs);
        if factor.inverted { rotation.conjugate() } else { rotation }
    }

    fn product(&self, start: DQuat, factors: &[Factor], time_secs: f32) -> DQuat {
        factors.iter().fold(start, |product, &factor| product * self.factor_at(factor, time_secs))
    }

    /// The local rotation at a time.
    pub fn at(&self, time_secs: f32) -> DQuat {
        let product = match &self.shared {
            None => self.product(self.left, &self.factors, time_secs),
            Some(SharedTurn { above, own, sources }) => {
                let from_rest = sources.iter().map(|(joint, factors, inverse_rest)| {
                    let product = self.product(self.left, &self.factors[factors.clone()], time_secs);
                    (*joint, unit(product * *inverse_rest))
                });
                let from_rest: Vec<(JointIndex, DQuat)> = from_rest.collect();
                let of = |joint: JointIndex| {
                    let found = from_rest.iter().find(|(other, _)| *other == joint);
                    found.map_or(DQuat::IDENTITY, |(_, turn)| *turn)
                };
                above.map_or(DQuat::IDENTITY, |above| above.at(of)).conjugate() * own.at(of)
            }
        };
        let turn = match &self.yaw {
            Some(yaw) => DQuat::from_rotation_y(yaw.at(time_secs)),
            None => DQuat::IDENTITY,
        };
        unit(self.inverse_parent * turn * product * self.right)
    }

    /// Whether any source joint in the product has a channel.
    fn has_channel(&self) -> bool {
        self.factors.iter().any(|factor| self.tracks.has_channel[factor.joint.get()])
    }

    /// Times at which anything in the product has a key, and those at which it jumps.
    pub fn times(&self) -> (Vec<f32>, Vec<f32>) {
        let timelines = self.factors.iter().map(|&factor| self.track(factor).times());
        let yaw = self.yaw.as_ref().map_or(&[][..], |yaw| &yaw.times);
        let jumps = self.factors.iter().map(|&factor| self.track(factor).jumps());
        (union(timelines.chain([yaw])), union(jumps))
    }

    /// The channel of the target joint, or None if it would only repeat the rest.
    pub fn channel(&self, joint: JointIndex, rest: DQuat) -> Option<NewChannel> {
        let moving: Vec<Factor> =
            self.factors.iter().copied().filter(|&factor| self.track(factor).is_moving()).collect();
        match moving[..] {
            _ if self.yaw.is_some() => Some(self.resampled(joint)),
            [] => {
                let rotation = self.at(0.0);
                let is_rest = !self.has_channel() && angle_between(rotation, rest) < 1e-6;
                (!is_rest).then(|| NewChannel::constant(joint, Keys::Rotation(vec![rotation.as_quat()])))
            }
            [factor] if self.shared.is_none() && self.tracks.has_own_keys(factor.joint) => {
                self.transformed(joint, factor)
            }
            _ => Some(self.resampled(joint)),
        }
    }

    /// The keys of the only moving factor between two constants. Tangents transform like values, since all of it is linear.
    fn transformed(&self, joint: JointIndex, moving: Factor) -> Option<NewChannel> {
        let Track::Keys { times, channel } = self.track(moving) else { return None };
        let Keys::Rotation(values) = &channel.keys else { return None };
        let at = self.factors.iter().position(|factor| factor.joint == moving.joint)?;
        let (before, after) = (&self.factors[..at], &self.factors[at + 1..]);
        let left = unit(self.product(self.inverse_parent * self.left, before, 0.0));
        let right = unit(self.product(DQuat::IDENTITY, after, 0.0) * self.right);
        let transform = |value: &Quat| {
            let value = value.as_dquat();
            let value = if moving.inverted { value.conjugate() } else { value };
            Quat::from_vec4(DVec4::from(left * value * right).as_vec4())
        };
        Some(NewChannel {
            joint,
            interpolation: channel.interpolation,
            times: times.to_vec(),
            keys: Keys::Rotation(values.iter().map(transform).collect()),
            resampled: false,
        })
    }

    fn resampled(&self, joint: JointIndex) -> NewChannel {
        let (times, jumps) = self.times();
        resampled_rotation(joint, &times, &jumps, |time| self.at(time))
    }
}

/// Returns a rotation as linear keys, at the given times and wherever else it needs them.
pub fn resampled_rotation(joint: JointIndex, times: &[f32], jumps: &[f32], at: impl Fn(f32) -> DQuat) -> NewChannel {
    let curve = Curve {
        value: at,
        error: |from: &DQuat, to: &DQuat, factor: f64, at: &DQuat| angle_between(slerp(*from, *to, factor), *at),
        tolerance: MAX_TURN,
    };
    let Resampled { times, values } = resample(times, jumps, curve);
    NewChannel::resampled(joint, times, continuous(values))
}

/// The locals that lead from joint `from` (or the model's origin) to joint `to`: up to their common ancestor inverted, then
/// down.
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
