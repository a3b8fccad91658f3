//! Eyes that look at a point (`VRMC_vrm-1.0`, lookAt.md; `firstPerson` of VRM 0.x): the direction from the head,
//! limited and scaled, as rotations of the eyes or as weights of expressions.

use glam::{EulerRot, Quat, Vec3};

use crate::anim::{JointIndex, Pose, Skeleton, model_from_one};

/// How the eyes of an avatar turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LookAt {
    /// The head.
    pub head: JointIndex,
    /// The point between the eyes, in the head's space.
    pub offset: Vec3,
    /// Whether the model faces −Z at rest, as VRM 0.x does, instead of +Z.
    pub faces_minus_z: bool,
    /// From the direction to what the eyes do.
    pub maps: RangeMaps,
    /// What turns.
    pub kind: LookAtKind,
}

/// What a direction is applied to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LookAtKind {
    /// The left and the right eye.
    Bones([Option<JointIndex>; 2]),
    /// Indices of the expressions `lookLeft`, `lookRight`, `lookUp`, `lookDown`.
    Expressions([Option<usize>; 4]),
}

/// Limits and scales of angles: `[input_max, output]`, the input in degrees. Angles up to the input's maximum give a
/// proportional output: degrees for bones, weights for expressions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RangeMaps {
    /// Towards the nose.
    pub inner: [f32; 2],
    /// Away from the nose; both sides of expressions.
    pub outer: [f32; 2],
    /// Downwards.
    pub down: [f32; 2],
    /// Upwards.
    pub up: [f32; 2],
}

fn mapped([input_max, output]: [f32; 2], degrees: f32) -> f32 {
    output * (degrees / input_max.max(0.01)).clamp(0.0, 1.0)
}

impl LookAt {
    /// The joints it refers to.
    pub fn joints(&self) -> impl Iterator<Item = JointIndex> + use<> {
        let eyes = if let LookAtKind::Bones(eyes) = self.kind { eyes } else { [None; 2] };
        std::iter::once(self.head).chain(eyes.into_iter().flatten())
    }

    /// Looks in a direction (see [`Self::direction`]): turns the eyes from their rest, or sets the weights of
    /// expressions.
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
                let values = [mapped(outer, yaw), mapped(outer, -yaw), mapped(up, -pitch), mapped(down, pitch)];
                for (expression, value) in expressions.into_iter().zip(values) {
                    if let Some(weight) = expression.and_then(|index| weights.get_mut(index)) {
                        *weight = value;
                    }
                }
            }
        }
    }

    /// Returns yaw (positive to the character's left) and pitch (positive down) of a point in model space, relative to
    /// the face, in degrees.
    pub fn direction(&self, target: Vec3, skeleton: &Skeleton, pose: &Pose) -> Option<[f32; 2]> {
        let rotation_of = |pose| model_from_one(skeleton, pose, self.head).to_scale_rotation_translation().1;
        let eyes = model_from_one(skeleton, pose, self.head).transform_point3(self.offset);
        let rest_from_now = rotation_of(skeleton.rest()) * rotation_of(pose).conjugate();
        let mut to_target = rest_from_now * (target - eyes).try_normalize()?;
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
        let yaw = mapped(to_left, yaw) - mapped(to_right, -yaw);
        let pitch = mapped(down, pitch) - mapped(up, -pitch);
        let pitch = if self.faces_minus_z { -pitch } else { pitch };
        let turn = Quat::from_euler(EulerRot::YXZ, yaw.to_radians(), pitch.to_radians(), 0.0);
        let rest = skeleton.rest();
        let model_from_parent = match skeleton.parent(eye) {
            Some(parent) => model_from_one(skeleton, rest, parent).to_scale_rotation_translation().1,
            None => Quat::IDENTITY,
        };
        model_from_parent.conjugate() * turn * model_from_parent * rest.local(eye).rotation
    }
}
