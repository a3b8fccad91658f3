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
    morph(geometry, morph_weights, out);
    let influences = &geometry.influences;
    // One entry serves all vertices: a mesh with joint attributes may hang on a node without a skin.
    if influences.is_empty() || palette.len() == 1 {
        let matrix = matrix_of(&palette[0], mode);
        return transform(out, |_| matrix);
    }
    match mode {
        SkinningMode::Rigid => {
            let strongest = |vertex: usize| influences.joints[vertex * influences.stride] as usize;
            transform(out, |vertex| matrix_of(&palette[strongest(vertex)], mode));
        }
        SkinningMode::Linear if influences.stride == 4 && palette.iter().flatten().all(|row| row.is_finite()) => {
            let (joints, weights) = (influences.joints.as_chunks::<4>().0, influences.weights.as_chunks::<4>().0);
            transform(out, |vertex| blend_4(joints[vertex], weights[vertex], palette));
        }
        SkinningMode::Linear => transform(out, |vertex| blend(influences.of_vertex(vertex), palette)),
        SkinningMode::DualQuaternion => {
            transform(out, |vertex| blend_dual_quaternions(influences.of_vertex(vertex), palette));
        }
    }
}

/// The rows of a 3×4 matrix.
type Rows = [Vec4; 3];

fn morph(geometry: &Geometry, weights: &[f32], out: &mut DeformedVertices) {
    out.positions.clone_from(&geometry.positions);
    out.normals.clone_from(&geometry.normals);
    for (target, &weight) in geometry.morph_targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
        for (position, &delta) in out.positions.iter_mut().zip(&target.positions) {
            *position += weight * delta;
        }
        for (normal, &delta) in out.normals.iter_mut().zip(&target.normals) {
            *normal += weight * delta;
        }
    }
}

fn matrix_of(entry: &PaletteEntry, mode: SkinningMode) -> Rows {
    match mode {
        SkinningMode::Linear | SkinningMode::Rigid => [entry[0], entry[1], entry[2]],
        SkinningMode::DualQuaternion => matrix_of_dual(entry),
    }
}

/// All four at once, those of weight 0 as well: the palette must be finite.
#[inline(always)]
fn blend_4(joints: [u16; 4], weights: [f32; 4], palette: &[PaletteEntry]) -> Rows {
    let entries = joints.map(|joint| &palette[joint as usize]);
    std::array::from_fn(|row| {
        let part = |at: usize| weights[at] * entries[at][row];
        (part(0) + part(1)) + (part(2) + part(3))
    })
}

fn blend(influences: impl Iterator<Item = (u16, f32)>, palette: &[PaletteEntry]) -> Rows {
    let mut sum = [Vec4::ZERO; 3];
    for (joint, weight) in influences.filter(|(_, weight)| *weight != 0.0) {
        let entry = &palette[joint as usize];
        for (sum, &row) in sum.iter_mut().zip(entry) {
            *sum += weight * row;
        }
    }
    sum
}

fn blend_dual_quaternions(influences: impl Iterator<Item = (u16, f32)>, palette: &[PaletteEntry]) -> Rows {
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
    matrix_of_dual(&sum)
}

fn matrix_of_dual(&[real, dual, x, y, z]: &PaletteEntry) -> Rows {
    let length = real.length();
    if length == 0.0 {
        return [x, y, z];
    }
    let (real, dual) = (real / length, dual / length);
    let (r, d) = (Vec3A::from_vec4(real), Vec3A::from_vec4(dual));
    let translation = 2.0 * (real.w * d - dual.w * r + r.cross(d));
    let rotation = Mat3A::from_quat(Quat::from_vec4(real)).transpose();
    let row = |rotation: Vec3A, translation: f32| {
        let stretched = rotation.x * x + rotation.y * y + rotation.z * z;
        Vec3A::from_vec4(stretched).extend(translation)
    };
    [row(rotation.x_axis, translation.x), row(rotation.y_axis, translation.y), row(rotation.z_axis, translation.z)]
}

/// Moves all vertices, four at a time: `matrix` gives the matrix of a vertex.
#[inline(always)]
fn transform(out: &mut DeformedVertices, matrix: impl Fn(usize) -> Rows) {
    let (positions, last_positions) = out.positions.as_chunks_mut::<4>();
    let (normals, last_normals) = out.normals.as_chunks_mut::<4>();
    for (at, positions) in positions.iter_mut().enumerate() {
        let blended = Four::new([0, 1, 2, 3].map(|lane| matrix(4 * at + lane)));
        *positions = blended.points(*positions);
        if let Some(normals) = normals.get_mut(at) {
            *normals = blended.normals(*normals);
        }
    }
    let first = 4 * positions.len();
    for (lane, position) in last_positions.iter_mut().enumerate() {
        let blended = Four::new([matrix(first + lane); 4]);
        *position = blended.points([*position; 4])[0];
        if let Some(normal) = last_normals.get_mut(lane) {
            *normal = blended.normals([*normal; 4])[0];
        }
    }
}

/// Matrices of four vertices: one lane each.
struct Four {
    /// The 3×3 part by rows and columns.
    linear: [Lanes; 3],
    translation: Lanes,
}

/// x, y and z of four vectors.
type Lanes = [Vec4; 3];

impl Four {
    #[inline(always)]
    fn new(matrices: [Rows; 4]) -> Self {
        let [x, y, z] = [0, 1, 2].map(|row| {
            let [a, b, c, d] = matrices.map(|rows| rows[row]);
            Mat4::from_cols(a, b, c, d).transpose()
        });
        let linear = [x, y, z].map(|row| [row.x_axis, row.y_axis, row.z_axis]);
        Self { linear, translation: [x.w_axis, y.w_axis, z.w_axis] }
    }

    #[inline(always)]
    fn points(&self, points: [Vec3; 4]) -> [Vec3; 4] {
        let points = lanes(points);
        unlanes([0, 1, 2].map(|row| dot(self.linear[row], points) + self.translation[row]))
    }

    /// By the cofactor matrix, which is the inverse transpose times the determinant: no division, and right for flat scales.
    #[inline(always)]
    fn normals(&self, normals: [Vec3; 4]) -> [Vec3; 4] {
        let [x, y, z] = self.linear;
        let cofactor = [cross(y, z), cross(z, x), cross(x, y)];
        let normals = lanes(normals);
        let turned = cofactor.map(|row| dot(row, normals));
        let mirrored = dot(x, cofactor[0]).cmplt(Vec4::ZERO);
        let scale = dot(turned, turned).sqrt().recip();
        let known = scale.is_finite_mask() & scale.cmpgt(Vec4::ZERO);
        let scale = Vec4::select(mirrored, -scale, scale);
        unlanes(turned.map(|part| Vec4::select(known, part * scale, Vec4::ZERO)))
    }
}

#[inline(always)]
fn dot(a: Lanes, b: Lanes) -> Vec4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: Lanes, b: Lanes) -> Lanes {
    [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
}

#[inline(always)]
fn lanes(vectors: [Vec3; 4]) -> Lanes {
    let [a, b, c, d] = vectors.map(|vector| vector.extend(0.0));
    let transposed = Mat4::from_cols(a, b, c, d).transpose();
    [transposed.x_axis, transposed.y_axis, transposed.z_axis]
}

#[inline(always)]
fn unlanes([x, y, z]: Lanes) -> [Vec3; 4] {
    let vectors = Mat4::from_cols(x, y, z, Vec4::ZERO).transpose();
    [vectors.x_axis, vectors.y_axis, vectors.z_axis, vectors.w_axis].map(Vec4::truncate)
}
