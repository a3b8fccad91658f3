//! The pose that a body's rotations are measured from, here and in other programs. The rest pose of the nodes is often a moment of
//! some clip; the pose in which the mesh was bound is not.

use std::collections::BTreeMap;

use glam::{Affine3A, DAffine3, DQuat, DVec3};

use super::{Asset, AssetParts};
use crate::anim::{JointIndex, Pose, Skeleton, Transform, nearest_rotation};

impl Asset {
    /// Returns the rest pose with the rotations of the [reference transforms](AssetParts::reference_transforms). Joints keep their
    /// offsets, since clips only give those that change.
    pub fn reference_pose(&self) -> Pose {
        let mut pose = self.skeleton.rest().clone();
        for (joint, bound) in self.skeleton.joints().zip(self.reference_transforms()) {
            if let Some(rotation) = bound.rotation {
                pose.set_rotation(joint, rotation.as_quat());
            }
        }
        pose
    }
}

/// A joint's local transform in the bind pose, as far as it is known.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BoundTransform {
    /// The joint's translation; `None` also if the rest pose has nearly the same.
    pub translation: Option<DVec3>,
    /// The joint's rotation, even if the rest pose has the same.
    pub rotation: Option<DQuat>,
}

/// As a share of the longest offset. Inverse bind matrices are less exact than rest poses, and smaller differences are invisible.
const TRANSLATION_TOLERANCE: f64 = 1e-3;

impl AssetParts {
    /// Returns each joint's local transform in the reference pose where that isn't the rest pose: the one in the bind pose where a
    /// skin covers the joint. A declared humanoid is its own reference: VRM says so.
    pub fn reference_transforms(&self) -> Vec<BoundTransform> {
        match self.humanoid {
            Some(_) => vec![BoundTransform::default(); self.skeleton.len()],
            None => self.bind_transforms(),
        }
    }

    /// Returns each joint's local transform in the bind pose. It is taken relative to the nearest ancestor in the same skin, or to
    /// the skin's largest branch, because bind space may have other units and another up axis. Unknown for the root of that branch,
    /// and if a matrix is singular.
    pub fn bind_transforms(&self) -> Vec<BoundTransform> {
        let mut locals: Vec<Option<DAffine3>> = vec![None; self.skeleton.len()];
        let mut bind_from_joint: Vec<Option<DAffine3>> = vec![None; self.skeleton.len()];
        for skin in &self.skins {
            // Equal matrices are no bind pose: the vertices are relative to their joints.
            if skin.joint_from_bind().windows(2).all(|pair| pair[0] == pair[1]) {
                continue;
            }
            bind_from_joint.fill(None);
            for (joint, joint_from_bind) in skin.joints().iter().zip(skin.joint_from_bind()) {
                bind_from_joint[joint.get()] = inverse(joint_from_bind);
            }
            let model_from_bind = model_from_bind(&self.skeleton, &bind_from_joint);
            for &joint in skin.joints() {
                let local = &mut locals[joint.get()];
                *local = local.or_else(|| bind_local(&self.skeleton, &bind_from_joint, joint, model_from_bind));
            }
        }
        let rest = self.skeleton.rest();
        let offsets = self.skeleton.joints().map(|joint| rest.local(joint).translation.length());
        let tolerance = TRANSLATION_TOLERANCE * f64::from(offsets.fold(0.0, f32::max));
        let bound = |(joint, local): (JointIndex, Option<DAffine3>)| {
            let at_rest = rest.local(joint).translation.as_dvec3();
            let is_elsewhere = |at: &DVec3| at.is_finite() && at.distance(at_rest) > tolerance;
            BoundTransform {
                translation: local.map(|local| local.translation).filter(is_elsewhere),
                rotation: local.and_then(|local| nearest_rotation(&local.matrix3)),
            }
        };
        self.skeleton.joints().zip(locals).map(bound).collect()
    }
}

/// Local transform of a joint in the bind pose; the nodes between it and its nearest bound ancestor are at rest.
fn bind_local(
    skeleton: &Skeleton,
    bind_from_joint: &[Option<DAffine3>],
    joint: JointIndex,
    model_from_bind: Option<(JointIndex, DAffine3)>,
) -> Option<DAffine3> {
    let bind = bind_from_joint[joint.get()]?;
    let mut bound_from_parent = DAffine3::IDENTITY;
    for ancestor in ancestors(skeleton, joint) {
        if let Some(ancestor_bind) = bind_from_joint[ancestor.get()] {
            return Some((ancestor_bind * bound_from_parent).inverse() * bind);
        }
        bound_from_parent = affine(&skeleton.rest().local(ancestor)) * bound_from_parent;
    }
    // In a branch of its own, as feet hang beside the body for inverse kinematics.
    let (root, model_from_bind) = model_from_bind?;
    (joint != root).then(|| bound_from_parent.inverse() * model_from_bind * bind)
}

/// Returns the root of a skin's largest branch, and where the bind space is if that root is at rest; `None` if the skin has no
/// other branch.
fn model_from_bind(skeleton: &Skeleton, bind_from_joint: &[Option<DAffine3>]) -> Option<(JointIndex, DAffine3)> {
    // By joint: the topmost bound joint at or above it.
    let mut roots: Vec<Option<JointIndex>> = Vec::with_capacity(skeleton.len());
    let mut sizes: BTreeMap<JointIndex, usize> = BTreeMap::new();
    for (joint, bind) in skeleton.joints().zip(bind_from_joint) {
        let above = skeleton.parent(joint).and_then(|parent| roots[parent.get()]);
        let root = above.or(bind.map(|_| joint));
        if let (Some(root), Some(_)) = (root, bind) {
            *sizes.entry(root).or_default() += 1;
        }
        roots.push(root);
    }
    let (&root, _) = sizes.iter().rev().max_by_key(|(_, size)| **size).filter(|_| sizes.len() > 1)?;
    let model_from_root = ancestors(skeleton, root)
        .fold(affine(&skeleton.rest().local(root)), |below, joint| affine(&skeleton.rest().local(joint)) * below);
    Some((root, model_from_root * bind_from_joint[root.get()]?.inverse()))
}

/// The joints above a joint, its parent first.
fn ancestors(skeleton: &Skeleton, joint: JointIndex) -> impl Iterator<Item = JointIndex> + '_ {
    std::iter::successors(skeleton.parent(joint), |&joint| skeleton.parent(joint))
}

fn affine(local: &Transform) -> DAffine3 {
    let rotation = local.rotation.as_dquat().normalize();
    DAffine3::from_scale_rotation_translation(local.scale.as_dvec3(), rotation, local.translation.as_dvec3())
}

fn inverse(joint_from_bind: &Affine3A) -> Option<DAffine3> {
    let columns = joint_from_bind.to_cols_array().map(f64::from);
    let matrix = DAffine3::from_cols_array(&columns);
    let inverse = matrix.inverse();
    (matrix.matrix3.determinant().abs() > 1e-30 && inverse.is_finite()).then_some(inverse)
}
