//! Morphing and skinning on the CPU: the reference for the GPU's, and what `pose` prints.

use glam::{Mat3, Quat, Vec3, Vec4};

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
/// Normals go by the inverse transpose of the blended matrix (for dual quaternions: of the blended stretch, then the
/// blended rotation).
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
            Blend::weighted(geometry.influences.of_vertex(vertex), palette, mode)
        };
        out.positions.push(blend.point(position));
        if let Some(normal) = normal {
            out.normals.push(blend.normal(normal));
        }
    }
}

/// The blended transform of one vertex: `p' = rotation · (linear · p) + translation`.
struct Blend {
    linear: Mat3,
    rotation: Quat,
    translation: Vec3,
}

impl Blend {
    fn single(entry: &PaletteEntry, mode: SkinningMode) -> Self {
        match mode {
            SkinningMode::Linear | SkinningMode::Rigid => Self::from_rows(entry[0], entry[1], entry[2]),
            SkinningMode::DualQuaternion => Self::from_dual(entry[0], entry[1], [entry[2], entry[3], entry[4]]),
        }
    }

    fn weighted(influences: impl Iterator<Item = (u16, f32)>, palette: &[PaletteEntry], mode: SkinningMode) -> Self {
        let mut sum = [Vec4::ZERO; 5];
        let mut pivot = None;
        for (joint, weight) in influences {
            if weight == 0.0 {
                continue;
            }
            let entry = &palette[joint as usize];
            // q and −q are the same rotation: bring all to the hemisphere of the first, or they would cancel out.
            let mut sign = 1.0;
            if mode == SkinningMode::DualQuaternion {
                let pivot = *pivot.get_or_insert(entry[0]);
                if pivot.dot(entry[0]) < 0.0 {
                    sign = -1.0;
                }
            }
            sum[0] += sign * weight * entry[0];
            sum[1] += sign * weight * entry[1];
            for row in 2..5 {
                sum[row] += weight * entry[row];
            }
        }
        Self::single(&sum, mode)
    }

    fn from_rows(x: Vec4, y: Vec4, z: Vec4) -> Self {
        Self {
            linear: Mat3::from_cols(x.truncate(), y.truncate(), z.truncate()).transpose(),
            rotation: Quat::IDENTITY,
            translation: Vec3::new(x.w, y.w, z.w),
        }
    }

    fn from_dual(real: Vec4, dual: Vec4, [x, y, z]: [Vec4; 3]) -> Self {
        let length = real.length();
        if length == 0.0 {
            return Self::from_rows(x, y, z);
        }
        let (real, dual) = (real / length, dual / length);
        let (r, d) = (real.truncate(), dual.truncate());
        Self {
            linear: Mat3::from_cols(x.truncate(), y.truncate(), z.truncate()).transpose(),
            rotation: Quat::from_vec4(real),
            translation: 2.0 * (real.w * d - dual.w * r + r.cross(d)),
        }
    }

    fn point(&self, position: Vec3) -> Vec3 {
        self.rotation * (self.linear * position) + self.translation
    }

    fn normal(&self, normal: Vec3) -> Vec3 {
        // The cofactor matrix is the inverse transpose times the determinant: no division, and right for flat scales.
        let m = self.linear;
        let cofactor = Mat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
        let sign = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
        self.rotation * (sign * (cofactor * normal)).normalize_or_zero()
    }
}
