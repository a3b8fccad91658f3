//! What is set manually and overrides the clip: rotations of joints, morph weights, expressions.

use glam::{EulerRot, Quat};

use super::ViewerState;
use crate::anim::{Clip, JointIndex, Pose};
use crate::library::Model;
use crate::retarget::{HeldValues, hold_values};

/// Returns a manually posed joint's local rotation: from its rest rotation about its own X, then its new Y, then its new Z.
pub fn manual_rotation(rest: Quat, degrees: [f32; 3]) -> Quat {
    let [x, y, z] = degrees.map(f32::to_radians);
    (rest * Quat::from_euler(EulerRot::XYZ, x, y, z)).normalize()
}

/// Returns the angles of [`manual_rotation`] for a local rotation.
pub fn manual_degrees(rest: Quat, rotation: Quat) -> [f32; 3] {
    let (x, y, z) = (rest.conjugate() * rotation).normalize().to_euler(EulerRot::XYZ);
    [x, y, z].map(f32::to_degrees)
}

/// The rotations of manually posed joints that the model has.
fn rotations(model: &Model, state: &ViewerState) -> impl Iterator<Item = (JointIndex, Quat)> {
    let skeleton = &model.asset.skeleton;
    state.edits.pose.iter().filter_map(|(&joint, &degrees)| {
        let joint = skeleton.joint_of_source(joint)?;
        Some((joint, manual_rotation(skeleton.rest().local(joint).rotation, degrees)))
    })
}

/// Applies the rotations of manually posed joints.
pub(super) fn pose_joints(model: &Model, state: &ViewerState, pose: &mut Pose) {
    for (joint, rotation) in rotations(model, state) {
        pose.set_rotation(joint, rotation);
    }
}

/// Returns what is set manually, without what the model lacks.
pub fn manual_values(model: &Model, state: &ViewerState) -> HeldValues {
    let weights = model.asset.skeleton.rest().morph_weights.len();
    let expressions = state.edits.expressions.iter();
    HeldValues {
        rotations: rotations(model, state).collect(),
        morph_weights: state
            .edits
            .morph
            .iter()
            .map(|(&index, &weight)| (index, weight))
            .filter(|&(index, _)| index < weights)
            .collect(),
        expressions: expressions
            .filter_map(|(name, &weight)| Some((model.asset.avatar.expression(name)?, weight)))
            .collect(),
    }
}

/// Returns a clip with what is set manually in it; `None` if that is nothing.
pub fn clip_with_manual_values(model: &Model, state: &ViewerState, clip: &Clip) -> Option<Clip> {
    let held = manual_values(model, state);
    (!held.is_empty()).then(|| hold_values(&model.asset.skeleton, clip, &held))
}
