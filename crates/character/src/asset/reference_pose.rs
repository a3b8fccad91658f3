//! The pose that a body's rotations are measured from, here and in other programs. The rest pose of the nodes is often a moment of
//! some clip; the pose in which the mesh was bound is not.

use glam::{Affine3A, DAffine3, DQuat};

use super::{Asset, AssetParts};
use crate::anim::{JointIndex, Pose, Skeleton, Transform, nearest_rotation};

impl Asset {
    /// Returns the rest pose with the [reference rotations](AssetParts::reference_rotations).
    pub fn reference_pose(&self) -> Pose {
        let mut pose = self.skeleton.rest().clone();
        for (joint, rotation) in self.skeleton.joints().zip(self.reference_rotations()) {
            if let Some(rotation) = rotation {
                pose.set_rotation(joint, rotation.as_quat());
            }
        }
        pose
    }
}

impl AssetParts {
    /// Returns each joint's local rotation in the reference pose where that isn't the rest pose: the one in the bind pose where a
    /// skin covers the joint. A declared humanoid is its own reference: VRM says so.
    pub fn reference_rotations(&self) -> Vec<Option<DQuat>> {
        if self.humanoid.is_some() { vec![None; self.skeleton.len()] } else { self.bind_rotations() }
    }

    /// Returns each joint's local rotation in the bind pose. It is taken relative to the nearest ancestor in the same skin, because
    /// bind space may have other units and another up axis. `None` without such an ancestor and if a matrix is singular.
    pub fn bind_rotations(&self) -> Vec<Option<DQuat>> {
        let mut rotations = vec![None; self.skeleton.len()];
        let mut bind_from_joint: Vec<Option<DAffine3>> = vec![None; self.skeleton.len()];
        for skin in &self.skins {
            bind_from_joint.fill(None);
            for (joint, joint_from_bind) in skin.joints().iter().zip(skin.joint_from_bind()) {
                bind_from_joint[joint.get()] = inverse(joint_from_bind);
            }
            for &joint in skin.joints() {
                let rotation = &mut rotations[joint.get()];
                *rotation = rotation.or_else(|| bind_rotation(&self.skeleton, &bind_from_joint, joint));
            }
        }
        rotations
    }
}

/// Local rotation of a joint in the bind pose; the nodes between it and its nearest bound ancestor are at rest.
fn bind_rotation(skeleton: &Skeleton, bind_from_joint: &[Option<DAffine3>], joint: JointIndex) -> Option<DQuat> {
    let bind = bind_from_joint[joint.get()]?;
    let mut bound_from_parent = DAffine3::IDENTITY;
    for ancestor in std::iter::successors(skeleton.parent(joint), |&joint| skeleton.parent(joint)) {
        if let Some(ancestor_bind) = bind_from_joint[ancestor.get()] {
            return nearest_rotation(&((ancestor_bind * bound_from_parent).inverse() * bind).matrix3);
        }
        bound_from_parent = affine(&skeleton.rest().local(ancestor)) * bound_from_parent;
    }
    None
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
