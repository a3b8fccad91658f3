//! Node constraints: a joint's rotation follows another joint (`VRMC_node_constraint-1.0`).

use glam::{Quat, Vec3};

use crate::anim::{JointIndex, Pose, Skeleton, model_from_one};

/// A joint whose rotation depends on another joint. Replaces the rotation from the clip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constraint {
    /// The joint that is turned.
    pub joint: JointIndex,
    /// The joint that it follows.
    pub source: JointIndex,
    /// 0 leaves the joint at rest, 1 follows completely.
    pub weight: f32,
    /// What it follows.
    pub kind: ConstraintKind,
}

/// What a constraint transfers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ConstraintKind {
    /// The source's rotation from its rest about this axis of the joint; a unit vector.
    Roll(Vec3),
    /// The direction to the source: this axis of the joint points there; a unit vector.
    Aim(Vec3),
    /// The source's whole rotation from its rest.
    Rotation,
}

impl Constraint {
    /// Turns the joint. Expects a pose in which everything the constraint depends on is final.
    pub fn apply(&self, skeleton: &Skeleton, pose: &mut Pose) {
        let rest = skeleton.rest().local(self.joint).rotation;
        let turned = match self.kind {
            ConstraintKind::Rotation => rest * self.source_turn(skeleton, pose),
            ConstraintKind::Roll(axis) => {
                // The turn in the joint's own space at rest, and what of it keeps the axis.
                let source_rest = skeleton.rest().local(self.source).rotation;
                let to_joint = rest.conjugate() * source_rest;
                let turn = to_joint * self.source_turn(skeleton, pose) * to_joint.conjugate();
                rest * Quat::from_rotation_arc((turn * axis).normalize_or(axis), axis) * turn
            }
            ConstraintKind::Aim(axis) => self.aimed(axis, rest, skeleton, pose).unwrap_or(rest),
        };
        pose.set_rotation(self.joint, rest.slerp(turned.normalize(), self.weight));
    }

    /// The source's rotation from its rest, in its own space.
    fn source_turn(&self, skeleton: &Skeleton, pose: &Pose) -> Quat {
        skeleton.rest().local(self.source).rotation.conjugate() * pose.local(self.source).rotation
    }

    /// `None` if the joint is where the source is.
    fn aimed(&self, axis: Vec3, rest: Quat, skeleton: &Skeleton, pose: &Pose) -> Option<Quat> {
        let model_from_joint = model_from_one(skeleton, pose, self.joint);
        let model_from_source = model_from_one(skeleton, pose, self.source);
        let to_source = Vec3::from(model_from_source.translation - model_from_joint.translation).try_normalize()?;
        let model_from_parent = match skeleton.parent(self.joint) {
            Some(parent) => model_from_one(skeleton, pose, parent).to_scale_rotation_translation().1,
            None => Quat::IDENTITY,
        };
        let goal = model_from_parent.conjugate() * to_source;
        let turn = Quat::from_rotation_arc((rest * axis).normalize(), goal.try_normalize()?);
        turn.is_finite().then(|| turn * rest)
    }

    /// Whether `other` must be applied first: it turns what this one depends on. `subtree_ends`: the joint after the
    /// last one below each joint.
    fn depends_on(&self, other: &Self, subtree_ends: &[u32]) -> bool {
        let is_turned = |joint: JointIndex| (other.joint.0..subtree_ends[other.joint.get()]).contains(&joint.0);
        let aims_from = |joint| matches!(self.kind, ConstraintKind::Aim(_)) && joint != other.joint && is_turned(joint);
        is_turned(self.source) || aims_from(self.joint)
    }
}

/// Returns the constraints sorted so that each comes after those it depends on, then the ones in a cycle, which have no
/// such order.
pub fn in_order(skeleton: &Skeleton, constraints: Vec<Constraint>) -> (Vec<Constraint>, Vec<Constraint>) {
    // Joints are sorted depth first.
    let mut subtree_ends: Vec<u32> = (1..=skeleton.len() as u32).collect();
    for joint in skeleton.joints().rev() {
        if let Some(parent) = skeleton.parent(joint) {
            subtree_ends[parent.get()] = subtree_ends[parent.get()].max(subtree_ends[joint.get()]);
        }
    }
    let (mut sorted, mut left) = (Vec::with_capacity(constraints.len()), constraints);
    loop {
        let is_free = |one: &Constraint| !left.iter().any(|other| one.depends_on(other, &subtree_ends));
        let (free, bound): (Vec<_>, Vec<_>) = left.iter().copied().partition(is_free);
        left = bound;
        if free.is_empty() {
            return (sorted, left);
        }
        sorted.extend(free);
    }
}
