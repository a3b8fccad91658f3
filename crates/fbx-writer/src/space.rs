//! From glTF's metres with Y up to the file's unit and axes.
//!
//! A change of axes turns the local transforms of all joints, so that no joint above them has to. A change of unit scales
//! translations and meshes. Some programs also take the scale of a joint above the skeleton as that of every bone: where it is even
//! and at rest, it moves into what is below in the same way, as a unit of that joint's own.

use std::ops::RangeInclusive;

use gaitway_character::anim::{Interpolation, Keys, Skeleton, Transform};
use gaitway_character::asset::Asset;
use glam::{Affine3A, DMat4, DQuat, DVec3, Mat4, Vec3};

/// Difference between scales that counts as none.
const SAME_SCALE: f32 = 1e-5;
/// Beyond these, a scale stays where it is.
const UNITS: RangeInclusive<f64> = 1e-9..=1e9;

/// A local transform in the file's space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Local {
    pub translation: DVec3,
    pub rotation: DQuat,
    pub scale: DVec3,
}

impl Local {
    pub const IDENTITY: Local = Local { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE };

    pub fn matrix(&self) -> DMat4 {
        DMat4::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }

    /// Returns the parts of a matrix; none if it is sheared, flat or not finite.
    pub fn of(matrix: &DMat4) -> Option<Local> {
        let determinant = matrix.determinant();
        if !matrix.is_finite() || determinant == 0.0 {
            return None;
        }
        let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
        let local = Local { translation, rotation: rotation.normalize(), scale };
        let size = scale.abs().max_element().max(f64::MIN_POSITIVE);
        (rotation.is_finite() && local.matrix().abs_diff_eq(*matrix, 1e-5 * size.max(translation.abs().max_element())))
            .then_some(local)
    }
}

/// The file's unit and axes.
#[derive(Debug)]
pub struct Space {
    /// Units per metre.
    pub unit: f64,
    /// Whether Z points up and -Y to the front, else Y and +Z.
    pub is_z_up: bool,
    /// Units of each joint's own space per glTF unit of it.
    of_joints: Vec<f64>,
    /// The same of its parent's.
    of_parents: Vec<f64>,
}

impl Space {
    /// `is_flat` moves even scales of joints into what is below them.
    pub fn new(asset: &Asset, unit: f64, is_z_up: bool, is_flat: bool) -> Space {
        let skeleton = &asset.skeleton;
        let is_scaled = animated_scales(asset);
        let (mut of_joints, mut of_parents) = (Vec::with_capacity(skeleton.len()), Vec::with_capacity(skeleton.len()));
        for joint in skeleton.joints() {
            let above = skeleton.parent(joint).map_or(unit, |parent| of_joints[parent.get()]);
            let scale = skeleton.rest().local(joint).scale;
            let even = is_even(scale.to_array()) && scale.x > 0.0 && scale.x.is_normal() && !is_scaled[joint.get()];
            let own = Some(above * f64::from(scale.x)).filter(|own| is_flat && even && UNITS.contains(own));
            of_parents.push(above);
            of_joints.push(own.unwrap_or(above));
        }
        Space { unit, is_z_up, of_joints, of_parents }
    }

    /// Units of a joint's own space per glTF unit of it.
    pub fn of_joint(&self, joint: usize) -> f64 {
        self.of_joints[joint]
    }

    /// Turns a vector into the file's axes.
    pub fn turned(&self, v: DVec3) -> DVec3 {
        if self.is_z_up { DVec3::new(v.x, -v.z, v.y) } else { v }
    }

    pub fn rotation(&self, q: DQuat) -> DQuat {
        if self.is_z_up { DQuat::from_xyzw(q.x, -q.z, q.y, q.w) } else { q }
    }

    /// The rotation of a change of axes itself, for what has axes of its own.
    pub fn axes(&self) -> DQuat {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        if self.is_z_up { DQuat::from_xyzw(half, 0.0, 0.0, half) } else { DQuat::IDENTITY }
    }

    pub fn translation(&self, joint: usize, translation: DVec3) -> DVec3 {
        self.turned(translation) * self.of_parents[joint]
    }

    pub fn scale(&self, joint: usize, scale: DVec3) -> DVec3 {
        let scale = if self.is_z_up { DVec3::new(scale.x, scale.z, scale.y) } else { scale };
        scale * (self.of_parents[joint] / self.of_joints[joint])
    }

    pub fn local(&self, joint: usize, local: &Transform) -> Local {
        Local {
            translation: self.translation(joint, local.translation.as_dvec3()),
            rotation: self.rotation(local.rotation.as_dquat()),
            scale: self.scale(joint, local.scale.as_dvec3()),
        }
    }

    /// Converts a matrix between two spaces that have `from` and `to` units per glTF unit.
    pub fn matrix(&self, matrix: &Affine3A, from: f64, to: f64) -> DMat4 {
        let matrix = Mat4::from(*matrix).as_dmat4();
        let axes = DMat4::from_quat(self.axes());
        axes * DMat4::from_scale(DVec3::splat(to))
            * matrix
            * DMat4::from_scale(DVec3::splat(1.0 / from))
            * axes.transpose()
    }
}

/// The joints whose scale a clip changes.
fn animated_scales(asset: &Asset) -> Vec<bool> {
    let skeleton: &Skeleton = &asset.skeleton;
    let mut animated = vec![false; skeleton.len()];
    for channel in asset.clips.iter().flat_map(|clip| clip.channels()) {
        if let Keys::Scale(scales) = &channel.keys {
            let rest = skeleton.rest().local(channel.joint).scale;
            let is_rest = |scale: &Vec3| (*scale - rest).abs().max_element() <= SAME_SCALE * rest.abs().max_element();
            // Tangents of a constant scale are zero.
            let is_tangent = |scale: &Vec3| *scale == Vec3::ZERO;
            let is_cubic = channel.interpolation == Interpolation::CubicSpline;
            animated[channel.joint.get()] |=
                !scales.iter().all(|scale| is_rest(scale) || (is_cubic && is_tangent(scale)));
        }
    }
    animated
}

fn is_even([x, y, z]: [f32; 3]) -> bool {
    (x - y).abs() <= SAME_SCALE * x.abs() && (x - z).abs() <= SAME_SCALE * x.abs()
}
