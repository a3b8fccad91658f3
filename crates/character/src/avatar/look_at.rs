//! Gaze (`VRMC_vrm-1.0`, lookAt.md; `firstPerson` of VRM 0.x): the direction from the head to a target, limited and
//! scaled, becomes rotations of the eye joints or weights of expressions.

use glam::{EulerRot, Quat, Vec3};

use super::model_from_parent;
use crate::anim::{JointIndex, Pose, Skeleton, model_from_single_joint};

/// How an avatar's eyes follow a target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LookAt {
    /// The head.
    pub head: JointIndex,
    /// The point between the eyes, in the head's space.
    pub offset: Vec3,
    /// Whether the model faces −Z at rest, as VRM 0.x does, instead of +Z.
    pub faces_minus_z: bool,
    /// Limits and scales of the gaze direction.
    pub maps: RangeMaps,
    /// What moves the eyes.
    pub kind: LookAtKind,
}

/// What the gaze direction is applied to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LookAtKind {
    /// The left and the right eye.
    Bones([Option<JointIndex>; 2]),
    /// Indices of the expressions `lookLeft`, `lookRight`, `lookUp`, `lookDown`.
    Expressions([Option<usize>; 4]),
}

/// Limits and scales of angles as `[input_max, output]`: 0 to `input_max` degrees map linearly to 0 to `output`, which
/// is in degrees for bones and a weight for expressions. Larger angles are clamped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeMaps {
    /// Towards the nose.
    pub inner: [f32; 2],
    /// Away from the nose. Expressions use it for both sides.
    pub outer: [f32; 2],
    /// Downwards.
    pub down: [f32; 2],
    /// Upwards.
    pub up: [f32; 2],
}

/// Negative angles map to 0.
fn map_angle([input_max, output]: [f32; 2], degrees: f32) -> f32 {
    output * (degrees / input_max.max(0.01)).clamp(0.0, 1.0)
}

impl LookAt {
    /// Returns the joints it refers to.
    pub fn joints(&self) -> impl Iterator<Item = JointIndex> + use<> {
        let eyes = if let LookAtKind::Bones(eyes) = self.kind { eyes } else { [None; 2] };
        std::iter::once(self.head).chain(eyes.into_iter().flatten())
    }

    /// Looks in a direction, as returned by [`Self::direction`]: rotates the eyes from their rest, or sets the weights
    /// of expressions.
    pub fn apply(&self, [yaw, pitch]: [f32; 2], skeleton: &Skeleton, pose: &mut Pose, weights: &mut [f32]) {
        match self.kind {
            LookAtKind::Bones(eyes) => {
                for (eye, is_left) in eyes.into_iter().zip([true, false]) {
                    if let Some(eye) = eye {
                        pose.set_rotation(eye, self.eye_rotation(eye, is_left, yaw, pitch, skeleton));
                    }
                }
            }
            LookAtKind::Expressions(expressions) => {
                let RangeMaps { outer, up, down, .. } = self.maps;
                let values =
                    [map_angle(outer, yaw), map_angle(outer, -yaw), map_angle(up, -pitch), map_angle(down, pitch)];
                for (expression, value) in expressions.into_iter().zip(values) {
                    if let Some(weight) = expression.and_then(|index| weights.get_mut(index)) {
                        *weight = value;
                    }
                }
            }
        }
    }

    /// Returns the direction to a point in model space, relative to the face: yaw, positive to the character's left,
    /// and pitch, positive down, in degrees. `None` if the point is between the eyes.
    pub fn direction(&self, target: Vec3, skeleton: &Skeleton, pose: &Pose) -> Option<[f32; 2]> {
        let rotation_of = |pose| model_from_single_joint(skeleton, pose, self.head).to_scale_rotation_translation().1;
        let eyes = model_from_single_joint(skeleton, pose, self.head).transform_point3(self.offset);
        let rest_from_current = rotation_of(skeleton.rest()) * rotation_of(pose).conjugate();
        let mut to_target = rest_from_current * (target - eyes).try_normalize()?;
        if self.faces_minus_z {
            (to_target.x, to_target.z) = (-to_target.x, -to_target.z);
        }
        let yaw = to_target.x.atan2(to_target.z);
        let pitch = -to_target.y.clamp(-1.0, 1.0).asin();
        (yaw.is_finite() && pitch.is_finite()).then(|| [yaw.to_degrees(), pitch.to_degrees()])
    }

    fn eye_rotation(&self, eye: JointIndex, is_left: bool, yaw: f32, pitch: f32, skeleton: &Skeleton) -> Quat {
        let RangeMaps { inner, outer, down, up } = self.maps;
        let (to_left, to_right) = if is_left { (outer, inner) } else { (inner, outer) };
        let yaw = map_angle(to_left, yaw) - map_angle(to_right, -yaw);
        let pitch = map_angle(down, pitch) - map_angle(up, -pitch);
        let pitch = if self.faces_minus_z { -pitch } else { pitch };
        let gaze = Quat::from_euler(EulerRot::YXZ, yaw.to_radians(), pitch.to_radians(), 0.0);
        let rest = skeleton.rest();
        let model_from_parent = model_from_parent(skeleton, rest, eye);
        model_from_parent.conjugate() * gaze * model_from_parent * rest.local(eye).rotation
    }
}
