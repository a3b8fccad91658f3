//! Translation, rotation and scale of a joint relative to its parent.

use glam::{Affine3A, Mat3, Mat4, Quat, Vec3};
use serde::{Deserialize, Serialize};

/// A local transform: `parent_from_joint = T · R · S`. Translation in the parent's units, rotation a unit quaternion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Transform {
    /// Position of the joint's origin in its parent's space.
    pub translation: Vec3,
    /// Orientation relative to the parent.
    pub rotation: Quat,
    /// Factors along the joint's own axes; negative ones mirror.
    pub scale: Vec3,
}

impl Transform {
    /// No translation or rotation, scale 1.
    pub const IDENTITY: Self = Self { translation: Vec3::ZERO, rotation: Quat::IDENTITY, scale: Vec3::ONE };

    /// A translation without rotation, scale 1.
    pub fn from_translation(translation: Vec3) -> Self {
        Self { translation, ..Self::IDENTITY }
    }

    /// Decomposes a matrix as required by glTF 2.0 §3.5.3; a mirroring one gets a negative X scale. Sheared matrices have no exact
    /// decomposition: the result keeps their column lengths.
    pub fn from_matrix(matrix: &Mat4) -> Self {
        let (x, y, z) = (matrix.x_axis.truncate(), matrix.y_axis.truncate(), matrix.z_axis.truncate());
        let mirrored = if matrix.determinant() < 0.0 { -1.0 } else { 1.0 };
        let scale = Vec3::new(x.length() * mirrored, y.length(), z.length());
        let axis = |column: Vec3, length: f32| (length != 0.0).then(|| column / length);
        let rotation = Quat::from_mat3(&basis([axis(x, scale.x), axis(y, scale.y), axis(z, scale.z)]));
        let rotation =
            if rotation.is_finite() && rotation.length_squared() > 0.0 { rotation.normalize() } else { Quat::IDENTITY };
        Self { translation: matrix.w_axis.truncate(), rotation, scale }
    }

    /// Whether the scale is positive on all axes. Only then is the rotation the joint's whole orientation.
    pub fn is_upright(&self) -> bool {
        self.scale.min_element() > 0.0
    }

    /// Returns the matrix `parent_from_joint`.
    pub fn to_affine(&self) -> Affine3A {
        Affine3A::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }

    /// Whether no component is infinite or NaN.
    pub fn is_finite(&self) -> bool {
        self.translation.is_finite() && self.rotation.is_finite() && self.scale.is_finite()
    }
}

/// The axes of a rotation. Those that a scale of zero has erased follow from the others.
fn basis(mut axes: [Option<Vec3>; 3]) -> Mat3 {
    for at in 0..3 {
        let erased = || match [axes[(at + 1) % 3], axes[(at + 2) % 3]] {
            [Some(next), Some(last)] => next.cross(last).normalize_or_zero(),
            [Some(one), None] | [None, Some(one)] => one.any_orthonormal_vector(),
            [None, None] => Vec3::AXES[at],
        };
        axes[at] = Some(axes[at].unwrap_or_else(erased));
    }
    let [x, y, z] = axes.map(Option::unwrap_or_default);
    Mat3::from_cols(x, y, z)
}

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}
