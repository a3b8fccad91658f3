//! Node constraints: a joint's rotation follows another joint (`VRMC_node_constraint-1.0`).

use glam::{Quat, Vec3};

use super::model_from_parent;
use crate::anim::{JointIndex, Pose, Skeleton, model_from_single_joint};

/// Makes a joint's rotation follow another joint. Replaces the rotation from the clip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constraint {
    /// The constrained joint.
    pub joint: JointIndex,
    /// The joint to follow.
    pub source: JointIndex,
    /// 0 leaves the joint at rest, 1 follows completely.
    pub weight: f32,
    /// How to follow the source.
    pub kind: ConstraintKind,
}

/// What a constraint transfers from its source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ConstraintKind {
    /// The source's rotation relative to its rest, about this axis of the joint only. A unit vector.
    Roll(Vec3),
    /// The direction to the source; this axis of the joint is aimed along it. A unit vector.
    Aim(Vec3),
    /// The source's rotation relative to its rest.
    Rotation,
}

impl Constraint {
    /// Rotates the joint. Everything that the constraint depends on must already be final in the pose.
    pub fn apply(&self, skeleton: &Skeleton, pose: &mut Pose) {
        let rest = skeleton.rest().local(self.joint).rotation;
        let full = match self.kind {
            ConstraintKind::Rotation => rest * self.source_delta(skeleton, pose),
            ConstraintKind::Roll(axis) => {
                // The source's rotation in the joint's rest space, then only its twist about the axis.
                let source_rest = skeleton.rest().local(self.source).rotation;
                let joint_from_source = rest.conjugate() * source_rest;
                let delta = joint_from_source * self.source_delta(skeleton, pose) * joint_from_source.conjugate();
                rest * Quat::from_rotation_arc((delta * axis).normalize_or(axis), axis) * delta
            }
            ConstraintKind::Aim(axis) => self.aimed_rotation(axis, rest, skeleton, pose).unwrap_or(rest),
        };
        pose.set_rotation(self.joint, rest.slerp(full.normalize(), self.weight));
    }

    /// Returns the source's rotation relative to its rest, in its own space.
    fn source_delta(&self, skeleton: &Skeleton, pose: &Pose) -> Quat {
        skeleton.rest().local(self.source).rotation.conjugate() * pose.local(self.source).rotation
    }

    /// Returns `None` if the joint and the source are at the same position.
    fn aimed_rotation(&self, axis: Vec3, rest: Quat, skeleton: &Skeleton, pose: &Pose) -> Option<Quat> {
        let model_from_joint = model_from_single_joint(skeleton, pose, self.joint);
        let model_from_source = model_from_single_joint(skeleton, pose, self.source);
        let to_source = Vec3::from(model_from_source.translation - model_from_joint.translation).try_normalize()?;
        let goal = model_from_parent(skeleton, pose, self.joint).conjugate() * to_source;
        let swing = Quat::from_rotation_arc((rest * axis).normalize(), goal.try_normalize()?);
        swing.is_finite().then(|| swing * rest)
    }

    /// Whether `other` must be applied first because it moves the source or, for an aim constraint, an ancestor of the
    /// joint. `subtree_ends` has, for each joint, the index after its last descendant.
    fn depends_on(&self, other: &Self, subtree_ends: &[u32]) -> bool {
        let is_moved = |joint: JointIndex| (other.joint.0..subtree_ends[other.joint.get()]).contains(&joint.0);
        let depends_on_ancestors = matches!(self.kind, ConstraintKind::Aim(_)) && self.joint != other.joint;
        is_moved(self.source) || depends_on_ancestors && is_moved(self.joint)
    }
}

/// Sorts the constraints so that each comes after those it depends on. Also returns the constraints that can't be
/// sorted because they depend on a cycle.
pub fn sort_constraints(skeleton: &Skeleton, constraints: Vec<Constraint>) -> (Vec<Constraint>, Vec<Constraint>) {
    // Joints are stored depth first, so every subtree is a range.
    let mut subtree_ends: Vec<u32> = (1..=skeleton.len() as u32).collect();
    for joint in skeleton.joints().rev() {
        if let Some(parent) = skeleton.parent(joint) {
            subtree_ends[parent.get()] = subtree_ends[parent.get()].max(subtree_ends[joint.get()]);
        }
    }
    let (mut sorted, mut remaining) = (Vec::with_capacity(constraints.len()), constraints);
    loop {
        let is_ready = |one: &Constraint| !remaining.iter().any(|other| one.depends_on(other, &subtree_ends));
        let (ready, blocked): (Vec<_>, Vec<_>) = remaining.iter().copied().partition(is_ready);
        remaining = blocked;
        if ready.is_empty() {
            return (sorted, remaining);
        }
        sorted.extend(ready);
    }
}
