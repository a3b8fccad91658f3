//! CPU morphing and skinning: the reference for the GPU and the output of `gaitway pose`.

use glam::{Mat3A, Mat4, Quat, Vec3, Vec3A, Vec4};

use super::{Geometry, PaletteEntry, SkinningMode};

/// Result of [`deform`], reused between calls.
#[derive(Debug, Clone, Default)]
pub struct DeformedVertices {
    /// One per vertex, in the palette's target space.
    pub positions: Vec<Vec3>,
    /// Unit length; empty if the geometry has none.
    pub normals: Vec<Vec3>,
}

/// Morphs, then skins all vertices of a primitive into the palette's target space. Missing `morph_weights` count as 0.
/// Without influences, every vertex follows the first palette entry.
///
/// Normals are transformed by the inverse transpose of the blended matrix (for dual quaternions: of the blended rotation
/// times the blended stretch).
pub fn deform(
    geometry: &Geometry,
    morph_weights: &[f32],
    palette: &[PaletteEntry],
    mode: SkinningMode,
    out: &mut DeformedVertices,
) {
    morph(geometry, morph_weights, out);
    let influences = &geometry.influences;
    // A mesh with joint attributes may be on a node without a skin: its palette has a single entry.
    if influences.is_empty() || palette.len() == 1 {
        let matrix = matrix_of(&palette[0], mode);
        return transform(out, |_| matrix);
    }
    match mode {
        SkinningMode::Rigid => {
            let strongest = |vertex: usize| influences.joints[vertex * influences.stride] as usize;
            transform(out, |vertex| matrix_of(&palette[strongest(vertex)], mode));
        }
        SkinningMode::Linear if palette.iter().flatten().all(|row| row.is_finite()) => {
            let (joints, weights) = (influences.joints.as_chunks::<4>().0, influences.weights.as_chunks::<4>().0);
            if influences.stride == 4 {
                return transform(out, |vertex| blend_4(joints[vertex], weights[vertex], palette));
            }
            let sets = influences.stride / 4;
            transform(out, |vertex| {
                let sets = vertex * sets..(vertex + 1) * sets;
                blend_sets(&joints[sets.clone()], &weights[sets], palette)
            });
        }
        SkinningMode::Linear => transform(out, |vertex| blend(influences.of_vertex(vertex), palette)),
        SkinningMode::DualQuaternion => {
            transform(out, |vertex| blend_dual_quaternions(influences.of_vertex(vertex), palette));
        }
    }
}

/// Like [`deform`] for a single vertex. Returns its morphed bind position and its skinned position. `scratch` is a
/// buffer.
pub fn deform_vertex(
    geometry: &Geometry,
    vertex: usize,
    morph_weights: &[f32],
    palette: &[PaletteEntry],
    mode: SkinningMode,
    scratch: &mut DeformedVertices,
) -> [Vec3; 2] {
    let mut bound = geometry.positions[vertex];
    for (target, &weight) in geometry.morph_targets.iter().zip(morph_weights).filter(|(_, weight)| **weight != 0.0) {
        bound += weight * target.positions.get(vertex).copied().unwrap_or_default();
    }
    scratch.positions.clear();
    scratch.positions.push(bound);
    scratch.normals.clear();
    let influences = &geometry.influences;
    let rows = match (influences.is_empty() || palette.len() == 1, mode) {
        (true, _) => matrix_of(&palette[0], mode),
        (false, SkinningMode::Rigid) => {
            matrix_of(&palette[influences.joints[vertex * influences.stride] as usize], mode)
        }
        (false, SkinningMode::Linear) => blend(influences.of_vertex(vertex), palette),
        (false, SkinningMode::DualQuaternion) => blend_dual_quaternions(influences.of_vertex(vertex), palette),
    };
    transform(scratch, |_| rows);
    [bound, scratch.positions[0]]
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

/// Blends all four matrices, even those with weight 0, so the palette must be finite.
#[inline(always)]
fn blend_4(joints: [u16; 4], weights: [f32; 4], palette: &[PaletteEntry]) -> Rows {
    let [a, b, c, d] = [
        &palette[joints[0] as usize],
        &palette[joints[1] as usize],
        &palette[joints[2] as usize],
        &palette[joints[3] as usize],
    ];
    let row = |row: usize| (weights[0] * a[row] + weights[1] * b[row]) + (weights[2] * c[row] + weights[3] * d[row]);
    [row(0), row(1), row(2)]
}

/// Blends several sets of four.
#[inline(always)]
fn blend_sets(joints: &[[u16; 4]], weights: &[[f32; 4]], palette: &[PaletteEntry]) -> Rows {
    let mut sum = [Vec4::ZERO; 3];
    for (joints, weights) in joints.iter().zip(weights) {
        // Strongest first: the remaining sets have no weight.
        if weights[0] == 0.0 {
            break;
        }
        let [x, y, z] = blend_4(*joints, *weights, palette);
        sum = [sum[0] + x, sum[1] + y, sum[2] + z];
    }
    sum
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
        // q and −q are the same rotation: flip all into the hemisphere of the first, or they would cancel out.
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

/// Transforms all vertices by their matrices, four at a time. Lanes are written out because mapping arrays with
/// closures would spill them to memory.
#[inline(always)]
fn transform(out: &mut DeformedVertices, matrix: impl Fn(usize) -> Rows) {
    let (positions, last_positions) = out.positions.as_chunks_mut::<4>();
    let (normals, last_normals) = out.normals.as_chunks_mut::<4>();
    for (at, positions) in positions.iter_mut().enumerate() {
        let first = 4 * at;
        let blended = Four::new(matrix(first), matrix(first + 1), matrix(first + 2), matrix(first + 3));
        *positions = blended.points(*positions);
        if let Some(normals) = normals.get_mut(at) {
            *normals = blended.normals(*normals);
        }
    }
    let first = 4 * positions.len();
    for (lane, position) in last_positions.iter_mut().enumerate() {
        let rows = matrix(first + lane);
        let blended = Four::new(rows, rows, rows, rows);
        *position = blended.points([*position; 4])[0];
        if let Some(normal) = last_normals.get_mut(lane) {
            *normal = blended.normals([*normal; 4])[0];
        }
    }
}

/// Matrices of four vertices, one per lane: three rows of x, y, z and translation.
struct Four {
    x: Mat4,
    y: Mat4,
    z: Mat4,
}

/// Four vectors as lanes of x, y and z.
#[derive(Clone, Copy)]
struct Lanes {
    x: Vec4,
    y: Vec4,
    z: Vec4,
}

impl Four {
    #[inline(always)]
    fn new(a: Rows, b: Rows, c: Rows, d: Rows) -> Self {
        Self {
            x: Mat4::from_cols(a[0], b[0], c[0], d[0]).transpose(),
            y: Mat4::from_cols(a[1], b[1], c[1], d[1]).transpose(),
            z: Mat4::from_cols(a[2], b[2], c[2], d[2]).transpose(),
        }
    }

    #[inline(always)]
    fn points(&self, points: [Vec3; 4]) -> [Vec3; 4] {
        let points = Lanes::new(points);
        let moved = |row: &Mat4| dot(linear(row), points) + row.w_axis;
        Lanes { x: moved(&self.x), y: moved(&self.y), z: moved(&self.z) }.vectors()
    }

    /// Uses the cofactor matrix, which is the inverse transpose times the determinant: it needs no division and handles
    /// zero scales.
    #[inline(always)]
    fn normals(&self, normals: [Vec3; 4]) -> [Vec3; 4] {
        let (x, y, z) = (linear(&self.x), linear(&self.y), linear(&self.z));
        let (cofactor_x, cofactor_y, cofactor_z) = (cross(y, z), cross(z, x), cross(x, y));
        let normals = Lanes::new(normals);
        let transformed =
            Lanes { x: dot(cofactor_x, normals), y: dot(cofactor_y, normals), z: dot(cofactor_z, normals) };
        let mirrored = dot(x, cofactor_x).cmplt(Vec4::ZERO);
        let scale = dot(transformed, transformed).sqrt().recip();
        let known = scale.is_finite_mask() & scale.cmpgt(Vec4::ZERO);
        let scale = Vec4::select(mirrored, -scale, scale);
        let unit = |part: Vec4| Vec4::select(known, part * scale, Vec4::ZERO);
        Lanes { x: unit(transformed.x), y: unit(transformed.y), z: unit(transformed.z) }.vectors()
    }
}

impl Lanes {
    #[inline(always)]
    fn new(vectors: [Vec3; 4]) -> Self {
        let [a, b, c, d] = vectors;
        let lanes = Mat4::from_cols(a.extend(0.0), b.extend(0.0), c.extend(0.0), d.extend(0.0)).transpose();
        Self { x: lanes.x_axis, y: lanes.y_axis, z: lanes.z_axis }
    }

    #[inline(always)]
    fn vectors(self) -> [Vec3; 4] {
        let vectors = Mat4::from_cols(self.x, self.y, self.z, Vec4::ZERO).transpose();
        let Mat4 { x_axis, y_axis, z_axis, w_axis } = vectors;
        [x_axis.truncate(), y_axis.truncate(), z_axis.truncate(), w_axis.truncate()]
    }
}

#[inline(always)]
fn linear(row: &Mat4) -> Lanes {
    Lanes { x: row.x_axis, y: row.y_axis, z: row.z_axis }
}

#[inline(always)]
fn dot(a: Lanes, b: Lanes) -> Vec4 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

#[inline(always)]
fn cross(a: Lanes, b: Lanes) -> Lanes {
    Lanes { x: a.y * b.z - b.y * a.z, y: a.z * b.x - b.z * a.x, z: a.x * b.y - b.x * a.y }
}
