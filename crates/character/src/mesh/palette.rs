//! The palette: one entry per skin joint, in the form its skinning mode reads.
//!
//! On the GPU it is an RGBA32F texture read with `textureLoad` in the vertex stage, on every back end: so there is no limit
//! on joints, and WebGL2 takes the same path as WebGPU. A mesh without a skin has a palette of one entry, its node.

use glam::{Affine3A, Mat3, Quat, Vec3, Vec4};
use serde::{Deserialize, Serialize};

use super::Skin;

/// How the influences of several joints are combined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SkinningMode {
    /// Linear blend skinning (glTF 2.0 §3.7.3.3).
    #[default]
    Linear,
    /// Each vertex follows its strongest influence only, which shows what blending is for.
    Rigid,
    /// Rigid transforms are blended as unit dual quaternions (Kavan, Collins, Žára, O'Sullivan 2008, "Geometric
    /// Skinning with Approximate Dual Quaternion Blending"). Scale and shear are factored out of each joint's matrix
    /// (`M = T·R·S`), blended linearly and applied first, as §4.2 of the paper suggests. With one influence the result
    /// equals `Linear` exactly.
    DualQuaternion,
}

/// Five RGBA texels in the layout of the palette texture, in the palette's target space.
///
/// `Linear`, `Rigid`: `[0..3]` are the rows of the 3×4 matrix; the rest is unused.
/// `DualQuaternion`: `[0]` the rotation x y z w, `[1]` the dual part (half translation times rotation), `[2..5]` the rows
/// of the 3×3 scale-and-shear matrix `S`, fourth components zero.
pub type PaletteEntry = [Vec4; 5];

/// Returns the entry of one joint, given its skinning matrix. Only `DualQuaternion` decomposes it.
pub fn palette_entry(world_from_bind: &Affine3A, mode: SkinningMode) -> PaletteEntry {
    match mode {
        SkinningMode::Linear | SkinningMode::Rigid => {
            let m = world_from_bind.matrix3.transpose();
            let t = world_from_bind.translation;
            [m.x_axis.extend(t.x), m.y_axis.extend(t.y), m.z_axis.extend(t.z), Vec4::ZERO, Vec4::ZERO]
        }
        SkinningMode::DualQuaternion => {
            let matrix = Mat3::from(world_from_bind.matrix3);
            let rotation = rotation_of(matrix);
            let stretch = (Mat3::from_quat(rotation.inverse()) * matrix).transpose();
            let t = Vec3::from(world_from_bind.translation);
            let dual = Quat::from_xyzw(0.5 * t.x, 0.5 * t.y, 0.5 * t.z, 0.0) * rotation;
            [
                rotation.into(),
                dual.into(),
                stretch.x_axis.extend(0.0),
                stretch.y_axis.extend(0.0),
                stretch.z_axis.extend(0.0),
            ]
        }
    }
}

/// Extracts the rotation by orthonormalizing the columns. A mirroring matrix is negated first, which leaves the
/// reflection in the remainder.
fn rotation_of(matrix: Mat3) -> Quat {
    let matrix = if matrix.determinant() < 0.0 { -matrix } else { matrix };
    let x = matrix.x_axis.normalize_or(Vec3::X);
    let y = (matrix.y_axis - x * x.dot(matrix.y_axis)).normalize_or(x.any_orthonormal_vector());
    Quat::from_mat3(&Mat3::from_cols(x, y, x.cross(y))).normalize()
}

/// Appends one palette entry per skin joint. `world_from_joint` has one entry per joint of the skeleton.
pub fn write_palette(skin: &Skin, world_from_joint: &[Affine3A], mode: SkinningMode, out: &mut Vec<PaletteEntry>) {
    match mode {
        SkinningMode::Linear | SkinningMode::Rigid => {
            let joints = skin.joints().iter().zip(skin.joint_from_bind_rows());
            out.extend(joints.map(|(joint, rows)| linear_entry(&world_from_joint[joint.get()], rows)));
        }
        SkinningMode::DualQuaternion => {
            let joints = skin.joints().iter().zip(skin.joint_from_bind());
            out.extend(joints.map(|(joint, joint_from_bind)| {
                palette_entry(&(world_from_joint[joint.get()] * *joint_from_bind), mode)
            }));
        }
    }
}

/// Multiplies a matrix by one given in rows, producing rows without a transposition.
#[inline]
fn linear_entry(world_from_joint: &Affine3A, [x, y, z]: &[Vec4; 3]) -> PaletteEntry {
    let Affine3A { matrix3, translation } = world_from_joint;
    let row = |a: f32, b: f32, c: f32, d: f32| {
        Vec4::splat(a) * *x + Vec4::splat(b) * *y + Vec4::splat(c) * *z + Vec4::splat(d) * Vec4::W
    };
    let (a, b, c, d) = (matrix3.x_axis, matrix3.y_axis, matrix3.z_axis, *translation);
    [row(a.x, b.x, c.x, d.x), row(a.y, b.y, c.y, d.y), row(a.z, b.z, c.z, d.z), Vec4::ZERO, Vec4::ZERO]
}
