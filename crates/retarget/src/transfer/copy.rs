//! Translations of joints other than the hips, scales of all joints, and morph weights: copied between equal skeletons,
//! converted on request and between creatures, otherwise left out so that limbs keep their lengths.

use gaitway_character::anim::{Channel, Interpolation, JointIndex, Keys, Property, Skeleton};
use glam::{DQuat, DVec3, Vec3};

use super::Transfer;
use super::root_motion::keeps_everything;
use crate::keys::channel::NewChannel;
use crate::map::{Keep, Pair, ResolvedMap};
use crate::math::angle_between;
use crate::pose::{Local, ancestry, is_within, locals_of};

/// Rests closer than this are equal, as a share of the skeleton's size and in radians.
const REST_TOLERANCE: f64 = 1e-4;

/// Which channels are carried over besides rotations and the hips' path.
#[derive(Debug, Clone, Copy)]
pub struct CopyPolicy {
    pub is_same_skeleton: bool,
    pub translations: bool,
    pub scales: bool,
    /// Whether the joints on the way to the hips move as their sources do. Otherwise the hips' path holds all that they do.
    pub path: bool,
}

impl CopyPolicy {
    pub fn new(transfer: &Transfer) -> Self {
        let is_same_skeleton = is_same_skeleton(transfer.map, transfer.target_skeleton, transfer.tracks.skeleton);
        let keeps = |choice| match choice {
            Keep::Keep => true,
            Keep::Drop => false,
            Keep::Auto => is_same_skeleton,
        };
        let (translations, scales) = (keeps(transfer.map.translations), keeps(transfer.map.scales));
        let path = translations && is_same_skeleton && follows_path(transfer);
        Self { is_same_skeleton, translations, scales, path }
    }
}

/// Whether the options leave the path alone, and all that carries the source's hips has a joint that follows it.
fn follows_path(transfer: &Transfer) -> bool {
    let Some(hips) = transfer.hips_pair() else { return true };
    let mut is_followed = vec![false; transfer.tracks.skeleton.len()];
    transfer.map.pairs.iter().for_each(|pair| is_followed[pair.source.get()] = true);
    let mut above = ancestry(transfer.tracks.skeleton, hips.source);
    keeps_everything(transfer.map) && above.all(|joint| !transfer.tracks.is_moving(joint) || is_followed[joint.get()])
}

/// Whether the joints of every pair have the same name, the same parent's name and the same rest.
fn is_same_skeleton(map: &ResolvedMap, target: &Skeleton, source: &Skeleton) -> bool {
    let (targets, sources) = (locals_of(target.rest()), locals_of(source.rest()));
    let size = targets.iter().map(|local| local.translation.length()).fold(0.0, f64::max).max(1e-12);
    let parent_name =
        |skeleton: &Skeleton, joint| skeleton.parent(joint).map(|parent| skeleton.name(parent).to_owned());
    let is_same = |pair: &Pair| {
        let (a, b) = (targets[pair.target.get()], sources[pair.source.get()]);
        let parent_is_mapped = target.parent(pair.target).is_some_and(|parent| map.source_of(parent).is_some());
        target.name(pair.target) == source.name(pair.source)
            && (!parent_is_mapped || parent_name(target, pair.target) == parent_name(source, pair.source))
            && a.translation.distance(b.translation) < REST_TOLERANCE * size
            && angle_between(a.rotation, b.rotation) < REST_TOLERANCE
            && a.scale.abs_diff_eq(b.scale, REST_TOLERANCE * a.scale.abs().max_element())
    };
    !map.pairs.is_empty() && map.pairs.iter().all(is_same)
}

/// Returns the translations, scales and morph weights that the policy carries over.
pub fn copied_channels(transfer: &Transfer, policy: CopyPolicy) -> Vec<NewChannel> {
    let Transfer { map, tracks, target_skeleton, .. } = *transfer;
    let rests = Rests { source: locals_of(tracks.skeleton.rest()), target: locals_of(target_skeleton.rest()) };
    let is_on_path =
        |joint: JointIndex| transfer.hips_pair().is_some_and(|hips| is_within(target_skeleton, hips.target, joint));
    // A creature's motion is in its translations as well: bodies hop, and feet hang beside their legs.
    let is_creature = transfer.hips.is_some() && transfer.alignment.pair_of_slot.is_empty();
    let carries = |pair: &Pair| {
        is_creature && map.translations == Keep::Auto && tracks.translations[pair.source.get()].is_moving()
    };
    let mut by_joint: Vec<Vec<&Channel>> = vec![Vec::new(); tracks.skeleton.len()];
    tracks.clip.channels().iter().for_each(|channel| by_joint[channel.joint.get()].push(channel));
    let mut channels = Vec::new();
    for pair in &map.pairs {
        let is_same_name = target_skeleton.name(pair.target) == tracks.skeleton.name(pair.source);
        let morphs = if is_same_name { target_skeleton.morph_range(pair.target).len() } else { 0 };
        for channel in &by_joint[pair.source.get()] {
            let property = channel.keys.property();
            let is_wanted = match property {
                Property::Translation if is_on_path(pair.target) => policy.translations && policy.path,
                Property::Translation => policy.translations || carries(pair),
                Property::Scale => policy.scales,
                Property::MorphWeights => morphs > 0,
                Property::Rotation => false,
            };
            if is_wanted && !tracks.is_muted(channel) {
                let conversion = Conversion::new(transfer, policy, &rests, pair);
                channels.extend(conversion.channel(transfer, channel, morphs));
            }
        }
    }
    channels
}

/// The rests of the nodes on both sides.
struct Rests {
    source: Vec<Local>,
    target: Vec<Local>,
}

/// How a source joint's displacement from its rest becomes the target's: turned into the target's parent, in its units.
struct Conversion<'a> {
    pair: &'a Pair,
    turn: DQuat,
    factor: f64,
    source_rest: Local,
    target_rest: Local,
    /// Keys of an equal skeleton are copied bit by bit.
    is_same_skeleton: bool,
}

impl<'a> Conversion<'a> {
    fn new(transfer: &Transfer, policy: CopyPolicy, rests: &Rests, pair: &'a Pair) -> Self {
        let (source, target) = (transfer.tracks.skeleton, transfer.target_skeleton);
        let source_parent = transfer.alignment.source.parent_rotation(source, pair.source);
        let target_parent = transfer.alignment.target.parent_rotation(target, pair.target);
        let hips_scale = transfer.scale();
        let factor = hips_scale * scale_above(source, &rests.source, pair.source)
            / scale_above(target, &rests.target, pair.target);
        Self {
            pair,
            turn: target_parent.conjugate() * source_parent,
            factor: if factor.is_finite() { factor } else { 1.0 },
            source_rest: rests.source[pair.source.get()],
            target_rest: rests.target[pair.target.get()],
            is_same_skeleton: policy.is_same_skeleton,
        }
    }

    /// Converts one of the source joint's channels. None for rotations, and for morph weights if the target joint has a
    /// different number of morph targets than `morphs`.
    fn channel(&self, transfer: &Transfer, channel: &Channel, morphs: usize) -> Option<NewChannel> {
        let is_spline = channel.interpolation == Interpolation::CubicSpline;
        let keys = match &channel.keys {
            Keys::Translation(values) => {
                let displacement = |by: DVec3| self.turn * by * self.factor;
                let value = |value| self.target_rest.translation + displacement(value - self.source_rest.translation);
                Keys::Translation(self.convert(values, is_spline, value, displacement))
            }
            Keys::Scale(values) => {
                let ratio = self.target_rest.scale / self.source_rest.scale;
                let ratio = if ratio.is_finite() { ratio } else { DVec3::ONE };
                Keys::Scale(self.convert(values, is_spline, |value| value * ratio, |tangent| tangent * ratio))
            }
            Keys::MorphWeights { targets, .. } if *targets == morphs => channel.keys.clone(),
            Keys::Rotation(_) | Keys::MorphWeights { .. } => return None,
        };
        Some(NewChannel {
            joint: self.pair.target,
            interpolation: channel.interpolation,
            times: transfer.tracks.clip.timelines()[channel.timeline as usize].clone(),
            keys,
            resampled: false,
        })
    }

    fn convert(
        &self,
        values: &[Vec3],
        is_spline: bool,
        value: impl Fn(DVec3) -> DVec3,
        tangent: impl Fn(DVec3) -> DVec3,
    ) -> Vec<Vec3> {
        if self.is_same_skeleton {
            return values.to_vec();
        }
        // A spline's entries are in-tangent, value, out-tangent.
        let convert = |(at, entry): (usize, &Vec3)| match is_spline && at % 3 != 1 {
            true => tangent(entry.as_dvec3()).as_vec3(),
            false => value(entry.as_dvec3()).as_vec3(),
        };
        values.iter().enumerate().map(convert).collect()
    }
}

/// Product of the scales above a joint, as one number.
fn scale_above(skeleton: &Skeleton, locals: &[Local], joint: JointIndex) -> f64 {
    let scales = ancestry(skeleton, joint).skip(1).map(|joint| locals[joint.get()].scale);
    let volume: f64 = scales.map(|scale| scale.x * scale.y * scale.z).product();
    volume.abs().cbrt()
}
