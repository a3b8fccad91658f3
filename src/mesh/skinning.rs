//! Morphing and skinning on the CPU: the reference for the GPU's, and what `pose` prints.

use glam::{Mat3A, Mat4, Quat, Vec3, Vec3A, Vec4};

use super::{Geometry, PaletteEntry, SkinningMode};

/// Result of [`deform`], reused between calls.
#[derive(Debug, Clone, Default)]
pub struct DeformedVertices {
    pub positions: Vec<Vec3>,
    /// Unit length; empty when the geometry's are.
    pub normals: Vec<Vec3>,
}

/// Morphs, then skins all vertices of a geometry, in the space the palette was made for. `morph_weights` has one entry
/// per target or is shorter (missing ones are 0). A geometry without influences follows the first palette entry.
///
/// Normals go by the inverse transpose of the blended matrix (for dual quaternions: of the blended rotation times the
/// blended stretch).
pub fn deform(
    geometry: &Geometry,
    morph_weights: &[f32],
    palette: &[PaletteEntry],
    mode: SkinningMode,
    out: &mut DeformedVertices,
) {
    out.positions.clear();
    out.normals.clear();
    let active = || geometry.morph_targets.iter().zip(morph_weights).filter(|(_, weight)| **weight != 0.0);
    for vertex in 0..geometry.positions.len() {
        let mut position = geometry.positions[vertex];
        let mut normal = geometry.normals.get(vertex).copied();
        for (target, &weight) in active() {
            if let Some(&delta) = target.positions.get(vertex) {
                position += weight * delta;
            }
            if let (Some(normal), Some(&delta)) = (&mut normal, target.normals.get(vertex)) {
                *normal += weight * delta;
            }
        }
        // One entry serves all vertices: a mesh with joint attributes may hang on a node without a skin.
        let blend = if geometry.influences.is_empty() || palette.len() == 1 {
            Blend::single(&palette[0], mode)
        } else if mode == SkinningMode::Rigid {
            let joint = geometry.influences.joints[vertex * geometry.influences.stride];
            Blend::single(&palette[joint as usize], mode)
        } else {
            let influences = geometry.influences.of_vertex(vertex);
            match mode {
                SkinningMode::DualQuaternion => Blend::dual_quaternion(influences, palette),
                SkinningMode::Linear | SkinningMode::Rigid => Blend::linear(influences, palette),
            }
        };
        out.positions.push(blend.point(position));
        if let Some(normal) = normal {
            out.normals.push(blend.normal(normal));
        }
    }
}

/// The blended transform of one vertex: `p' = linear · p + translation`.
struct Blend {
    linear: Mat3A,
    translation: Vec3A,
}

impl Blend {
    fn single(entry: &PaletteEntry, mode: SkinningMode) -> Self {
        match mode {
            SkinningMode::Linear | SkinningMode::Rigid => Self::from_rows(entry[0], entry[1], entry[2]),
            SkinningMode::DualQuaternion => Self::from_dual(entry),
        }
    }

    fn linear(influences: impl Iterator<Item = (u16, f32)>, palette: &[PaletteEntry]) -> Self {
        let (mut x, mut y, mut z) = (Vec4::ZERO, Vec4::ZERO, Vec4::ZERO);
        for (joint, weight) in influences.filter(|(_, weight)| *weight != 0.0) {
            let entry = &palette[joint as usize];
            x += weight * entry[0];
            y += weight * entry[1];
            z += weight * entry[2];
        }
        Self::from_rows(x, y, z)
    }

    fn dual_quaternion(influences: impl Iterator<Item = (u16, f32)>, palette: &[PaletteEntry]) -> Self {
        let mut sum = [Vec4::ZERO; 5];
        let mut pivot = None;
        for (joint, weight) in influences.filter(|(_, weight)| *weight != 0.0) {
            let entry = &palette[joint as usize];
            // q and −q are the same rotation: bring all to the hemisphere of the first, or they would cancel out.
            let pivot = *pivot.get_or_insert(entry[0]);
            let signed = if pivot.dot(entry[0]) < 0.0 { -weight } else { weight };
            for (part, factor) in [signed, signed, weight, weight, weight].into_iter().enumerate() {
                sum[part] += factor * entry[part];
            }
        }
        Self::from_dual(&sum)
    }

    fn from_rows(x: Vec4, y: Vec4, z: Vec4) -> Self {
        let columns = Mat4::from_cols(x, y, z, Vec4::W).transpose();
        let [x, y, z, translation] =
            [columns.x_axis, columns.y_axis, columns.z_axis, columns.w_axis].map(Vec3A::from_vec4);
        Self { linear: Mat3A::from_cols(x, y, z), translation }
    }

    fn from_dual(&[real, dual, x, y, z]: &PaletteEntry) -> Self {
        let stretch = Self::from_rows(x, y, z).linear;
        let length = real.length();
        if length == 0.0 {
            return Self { linear: stretch, translation: Vec3A::ZERO };
        }
        let (real, dual) = (real / length, dual / length);
        let (r, d) = (Vec3A::from_vec4(real), Vec3A::from_vec4(dual));
        Self {
            linear: Mat3A::from_quat(Quat::from_vec4(real)) * stretch,
            translation: 2.0 * (real.w * d - dual.w * r + r.cross(d)),
        }
    }

    fn point(&self, position: Vec3) -> Vec3 {
        (self.linear * Vec3A::from(position) + self.translation).into()
    }

    fn normal(&self, normal: Vec3) -> Vec3 {
        // The cofactor matrix is the inverse transpose times the determinant: no division, and right for flat scales.
        let Mat3A { x_axis, y_axis, z_axis } = self.linear;
        let cofactor = Mat3A::from_cols(y_axis.cross(z_axis), z_axis.cross(x_axis), x_axis.cross(y_axis));
        let sign = if x_axis.dot(cofactor.x_axis) < 0.0 { -1.0 } else { 1.0 };
        (sign * (cofactor * Vec3A::from(normal))).normalize_or_zero().into()
    }
}
