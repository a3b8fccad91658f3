//! Translations and scales of joints other than the hips, and morph weights: copied where the two skeletons are the same,
//! on demand carried over, else left out, so that limbs keep their lengths.

use glam::{DQuat, DVec3, Vec3};

use crate::anim::{Channel, Clip, Interpolation, JointIndex, Keys, Skeleton};
use crate::retarget::align::rest::{Local, ancestry, node_locals};
use crate::retarget::align::swing::Alignment;
use crate::retarget::keys::track::angle_between;
use crate::retarget::map::{Pair, ResolvedMap};
use crate::retarget::transfer::rotation::NewChannel;

/// Two rests that are nearer than this, as a share of the skeleton's size and in radians, are the same.
const SAME: f64 = 1e-4;

/// Whether every mapped pair has one name, one parent's name and one rest.
pub fn same_skeleton(map: &ResolvedMap, target: &Skeleton, source: &Skeleton) -> bool {
    let (targets, sources) = (node_locals(target), node_locals(source));
    let size = targets.iter().map(|local| local.translation.length()).fold(0.0, f64::max).max(1e-12);
    let parent_name =
        |skeleton: &Skeleton, joint| skeleton.parent(joint).map(|parent| skeleton.name(parent).to_owned());
    let same = |pair: &Pair| {
        let (a, b) = (targets[pair.target.get()], sources[pair.source.get()]);
        let mapped_parent = target.parent(pair.target).is_some_and(|parent| map.source_of(parent).is_some());
        target.name(pair.target) == source.name(pair.source)
            && (!mapped_parent || parent_name(target, pair.target) == parent_name(source, pair.source))
            && a.translation.distance(b.translation) < SAME * size
            && angle_between(a.rotation, b.rotation) < SAME
            && a.scale.abs_diff_eq(b.scale, SAME * a.scale.abs().max_element())
    };
    !map.pairs.is_empty() && map.pairs.iter().all(same)
}

/// How a source joint's displacement from its rest becomes the target's: turned into the target's parent, in its units.
pub struct Carry<'a> {
    pair: &'a Pair,
    turn: DQuat,
    factor: f64,
    source_rest: Local,
    target_rest: Local,
    /// Nothing to turn or scale: keys are copied bit by bit.
    same: bool,
}

impl<'a> Carry<'a> {
    /// `hips_scale` is target units per source unit in the common frame; the locals are those of the nodes' rests.
    pub fn new(
        pair: &'a Pair,
        same: bool,
        hips_scale: f64,
        alignment: &Alignment,
        [(source, source_locals), (target, target_locals)]: [(&Skeleton, &[Local]); 2],
    ) -> Self {
        let above = |skeleton: &Skeleton, joint, rotations: &[DQuat], turn| {
            skeleton.parent(joint).map_or(turn, |parent: JointIndex| rotations[parent.get()])
        };
        let source_above = above(source, pair.source, &alignment.source.rotations, alignment.source_turn);
        let target_above = above(target, pair.target, &alignment.target.rotations, alignment.target_turn);
        let factor = hips_scale * scale_above(source, source_locals, pair.source)
            / scale_above(target, target_locals, pair.target);
        Self {
            pair,
            turn: target_above.conjugate() * source_above,
            factor: if factor.is_finite() { factor } else { 1.0 },
            source_rest: source_locals[pair.source.get()],
            target_rest: target_locals[pair.target.get()],
            same,
        }
    }

    /// The keys of one of the source joint's channels, for the target joint; none for rotations, and for morph weights
    /// when `targets`, the number that the target joint has, is another.
    pub fn channel(&self, clip: &Clip, channel: &Channel, targets: usize) -> Option<NewChannel> {
        let spline = channel.interpolation == Interpolation::CubicSpline;
        // Of a spline's entries the middle one of three is a value, the others are tangents.
        let map = |values: &[Vec3], value: &dyn Fn(DVec3) -> DVec3, tangent: &dyn Fn(DVec3) -> DVec3| -> Vec<Vec3> {
            let one = |(at, entry): (usize, &Vec3)| match (self.same, spline && at % 3 != 1) {
                (true, _) => *entry,
                (false, true) => tangent(entry.as_dvec3()).as_vec3(),
                (false, false) => value(entry.as_dvec3()).as_vec3(),
            };
            values.iter().enumerate().map(one).collect()
        };
        let keys = match &channel.keys {
            Keys::Translation(values) => {
                let moved = |by: DVec3| self.turn * by * self.factor;
                let value = |value| self.target_rest.translation + moved(value - self.source_rest.translation);
                Keys::Translation(map(values, &value, &moved))
            }
            Keys::Scale(values) => {
                let share = self.target_rest.scale / self.source_rest.scale;
                let share = if share.is_finite() { share } else { DVec3::ONE };
                Keys::Scale(map(values, &|value| value * share, &|tangent| tangent * share))
            }
            Keys::MorphWeights { targets: found, .. } if *found == targets => channel.keys.clone(),
            Keys::Rotation(_) | Keys::MorphWeights { .. } => return None,
        };
        Some(NewChannel {
            joint: self.pair.target,
            interpolation: channel.interpolation,
            times: clip.timelines()[channel.timeline as usize].clone(),
            keys,
            resampled: false,
        })
    }
}

/// The product of the scales above a joint, as one number.
fn scale_above(skeleton: &Skeleton, locals: &[Local], joint: JointIndex) -> f64 {
    let scales = ancestry(skeleton, joint).skip(1).map(|joint| locals[joint.get()].scale);
    let volume: f64 = scales.map(|scale| scale.x * scale.y * scale.z).product();
    volume.abs().cbrt()
}
