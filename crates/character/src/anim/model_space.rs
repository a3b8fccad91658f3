//! The way from a pose, whose transforms are local, to model space.

use glam::Affine3A;

use super::joint::JointIndex;
use super::kernels;
use super::pose::Pose;
use super::skeleton::Skeleton;

/// Computes the transform of every joint. `pose` belongs to this skeleton; `out` gets one entry per joint.
/// `world_from_model` is applied to root joints; identity gives model space.
pub fn model_from_joint(skeleton: &Skeleton, pose: &Pose, world_from_model: Affine3A, out: &mut Vec<Affine3A>) {
    debug_assert_eq!(skeleton.len(), pose.len());
    out.resize(skeleton.len(), Affine3A::IDENTITY);
    kernels::model_from_joint(&pose.groups, skeleton.by_depth(), world_from_model, out);
}

/// Returns one joint's transform in model space. For many joints, [`model_from_joint`] is cheaper.
pub fn model_from_single_joint(skeleton: &Skeleton, pose: &Pose, joint: JointIndex) -> Affine3A {
    let mut model_from_joint = pose.local(joint).to_affine();
    let mut ancestor = skeleton.parent(joint);
    while let Some(joint) = ancestor {
        model_from_joint = pose.local(joint).to_affine() * model_from_joint;
        ancestor = skeleton.parent(joint);
    }
    model_from_joint
}
