//! What is set manually and overrides the clip: rotations of joints, morph weights, expressions.
//!
//! Rotations are Euler angles from the rest pose, so that sliders show what was set and links stay short. Exported clips
//! hold all of it still, before pins are baked in.

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

/// The morph weights that are set manually and that the model has.
fn morph_weights(model: &Model, state: &ViewerState) -> impl Iterator<Item = (usize, f32)> {
    let count = model.asset.skeleton.rest().morph_weights.len();
    state.edits.morph.range(..count).map(|(&index, &weight)| (index, weight))
}

/// The same for weights of expressions.
fn expressions(model: &Model, state: &ViewerState) -> impl Iterator<Item = (usize, f32)> {
    state.edits.expressions.iter().filter_map(|(name, &weight)| Some((model.asset.avatar.expression(name)?, weight)))
}

/// Whether anything that the model has is set manually.
pub fn has_manual_values(model: &Model, state: &ViewerState) -> bool {
    rotations(model, state).next().is_some()
        || morph_weights(model, state).next().is_some()
        || expressions(model, state).next().is_some()
}

/// Returns a clip with what is set manually in it; `None` if that is nothing.
pub fn clip_with_manual_values(model: &Model, state: &ViewerState, clip: &Clip) -> Option<Clip> {
    has_manual_values(model, state).then(|| {
        let held = HeldValues {
            rotations: rotations(model, state).collect(),
            morph_weights: morph_weights(model, state).collect(),
            expressions: expressions(model, state).collect(),
        };
        hold_values(&model.asset.skeleton, clip, &held)
    })
}
