//! Morphing and skinning cases for both the CPU and the GPU. Expected results are computed here in f64 from the
//! definitions; only the data types come from `gaitway_character::mesh`.

use std::f64::consts::TAU;

use gaitway_character::mesh::{Geometry, Influences, MorphTarget, SkinningMode};
use glam::{Affine3A, DAffine3, DMat3, DQuat, DVec3, DVec4, Mat3, Quat, Vec3};

use crate::random::Random;

/// One geometry in one pose.
pub struct Case {
    pub name: &'static str,
    pub geometry: Geometry,
    /// One matrix per skin joint; the palette is made of these.
    pub world_from_bind: Vec<Affine3A>,
    /// One per morph target.
    pub morph_weights: Vec<f32>,
    pub mode: SkinningMode,
}

/// Tolerance of positions relative to the case's largest coordinate.
#[allow(dead_code)]
pub const POSITION_TOLERANCE: f64 = 2e-6;
/// Tolerance of normals.
#[allow(dead_code)]
pub const NORMAL_TOLERANCE: f64 = 1e-5;

pub fn cases() -> Vec<Case> {
    use SkinningMode::{DualQuaternion, Linear, Rigid};
    let mut cases = Vec::new();
    let mut add = |name, geometry: Geometry, world_from_bind: Vec<Affine3A>, morph_weights: &[f32], mode| {
        cases.push(Case { name, geometry, world_from_bind, morph_weights: morph_weights.to_vec(), mode });
    };
    add("not skinned", tube(0), vec![joint(0.3, Vec3::ONE)], &[], Linear);
    add("not skinned, mirrored", tube(0), vec![joint(0.3, Vec3::new(-1.0, 1.0, 1.0))], &[], Linear);
    add("one influence, non-uniform scale", one_influence(), vec![joint(1.1, Vec3::new(0.5, 2.0, 3.0))], &[], Linear);
    add("linear, a bend", tube(2), bend(80.0), &[], Linear);
    add("linear, a twist", tube(2), twist(170.0), &[], Linear);
    add("linear, 4 influences, scaled and sheared", scattered(4, 9), many(9), &[], Linear);
    add("linear, 13 influences", scattered(13, 20), many(20), &[], Linear);
    add("linear, 16 influences", scattered(16, 20), many(20), &[], Linear);
    add("rigid, a bend", tube(2), bend(80.0), &[], Rigid);
    add("rigid, 16 influences", scattered(16, 20), many(20), &[], Rigid);
    add("dual quaternion, at rest", tube(2), vec![Affine3A::IDENTITY; 2], &[], DualQuaternion);
    add("dual quaternion, a bend", tube(2), bend(80.0), &[], DualQuaternion);
    add("dual quaternion, a twist", tube(2), twist(170.0), &[], DualQuaternion);
    add("dual quaternion, a twist past half a turn", tube(2), twist(200.0), &[], DualQuaternion);
    add(
        "dual quaternion, one influence, mirrored and scaled",
        one_influence(),
        vec![joint(2.0, Vec3::new(-0.5, 2.0, 3.0))],
        &[],
        DualQuaternion,
    );
    add("dual quaternion, 4 influences, scaled", scattered(4, 9), many(9), &[], DualQuaternion);
    add("dual quaternion, 13 influences", scattered(13, 20), rigid(20), &[], DualQuaternion);
    add("dual quaternion, 16 influences", scattered(16, 20), rigid(20), &[], DualQuaternion);
    add("morphed", morphing(tube(0)), vec![Affine3A::IDENTITY], &[0.75, -0.5], Linear);
    add("morphed, a weight of zero", morphing(tube(0)), vec![Affine3A::IDENTITY], &[0.0, 1.0], Linear);
    add("morphed and bent", morphing(tube(2)), bend(60.0), &[0.25, 1.0], Linear);
    add("morphed and twisted by dual quaternions", morphing(tube(2)), twist(120.0), &[0.25, 1.0], DualQuaternion);
    cases
}

/// Computes positions and unit normals of all vertices.
pub fn expected(case: &Case) -> (Vec<DVec3>, Vec<DVec3>) {
    let geometry = &case.geometry;
    let mut positions = Vec::new();
    let mut normals = Vec::new();
    for vertex in 0..geometry.positions.len() {
        let mut position = geometry.positions[vertex].as_dvec3();
        let mut normal = geometry.normals[vertex].as_dvec3();
        for (target, &weight) in geometry.morph_targets.iter().zip(&case.morph_weights) {
            position += f64::from(weight) * target.positions[vertex].as_dvec3();
            normal += f64::from(weight) * target.normals.get(vertex).map_or(DVec3::ZERO, |delta| delta.as_dvec3());
        }
        let stride = geometry.influences.stride;
        let mut influences: Vec<(DAffine3, f64)> = (vertex * stride..(vertex + 1) * stride)
            .map(|at| (geometry.influences.joints[at] as usize, f64::from(geometry.influences.weights[at])))
            .filter(|&(_, weight)| weight != 0.0)
            .map(|(joint, weight)| (affine(&case.world_from_bind[joint]), weight))
            .collect();
        if stride == 0 {
            influences.push((affine(&case.world_from_bind[0]), 1.0));
        }
        let blended = match case.mode {
            SkinningMode::Rigid => influences[0].0,
            SkinningMode::Linear => linear_blend(&influences),
            SkinningMode::DualQuaternion => dual_quaternion_blend(&influences),
        };
        positions.push(blended.transform_point3(position));
        normals.push((blended.matrix3.inverse().transpose() * normal).normalize());
    }
    (positions, normals)
}

fn affine(from: &Affine3A) -> DAffine3 {
    let columns = from.to_cols_array().map(f64::from);
    DAffine3::from_cols_array(&columns)
}

fn linear_blend(influences: &[(DAffine3, f64)]) -> DAffine3 {
    let mut matrix3 = DMat3::ZERO;
    let mut translation = DVec3::ZERO;
    for (matrix, weight) in influences {
        matrix3 += matrix.matrix3 * *weight;
        translation += matrix.translation * *weight;
    }
    DAffine3 { matrix3, translation }
}

/// Kavan et al. 2008: `M = T·R·S`. The `S` are blended linearly and applied first, the rigid `T·R` as dual quaternions
/// `r + ε·½·t·r` in the hemisphere of the first, then normalized.
fn dual_quaternion_blend(influences: &[(DAffine3, f64)]) -> DAffine3 {
    let mut stretch = DMat3::ZERO;
    let mut real = DVec4::ZERO;
    let mut dual = DVec4::ZERO;
    let mut first: Option<DVec4> = None;
    for (matrix, weight) in influences {
        let rotation = gram_schmidt(matrix.matrix3);
        stretch += rotation.transpose() * matrix.matrix3 * *weight;
        let r = DVec4::from(DQuat::from_mat3(&rotation).normalize());
        let t = 0.5 * matrix.translation;
        let half = DVec4::from(DQuat::from_xyzw(t.x, t.y, t.z, 0.0) * DQuat::from_vec4(r));
        let sign = if first.get_or_insert(r).dot(r) < 0.0 { -1.0 } else { 1.0 };
        real += sign * weight * r;
        dual += sign * weight * half;
    }
    let length = real.length();
    let rotation = DQuat::from_vec4(real / length);
    // 2 · dual · conjugate(real): its vector part is the translation.
    let twice = DQuat::from_vec4(2.0 * dual / length) * rotation.conjugate();
    DAffine3 { matrix3: DMat3::from_quat(rotation) * stretch, translation: DVec3::new(twice.x, twice.y, twice.z) }
}

/// Extracts the rotation as the palette defines it: Gram-Schmidt on the columns, of the negated matrix if it mirrors.
fn gram_schmidt(matrix: DMat3) -> DMat3 {
    let matrix = if matrix.determinant() < 0.0 { -matrix } else { matrix };
    let x = matrix.x_axis.normalize();
    let y = (matrix.y_axis - x * x.dot(matrix.y_axis)).normalize();
    DMat3::from_cols(x, y, x.cross(y))
}

pub const TUBE_SIDES: usize = 12;
pub const TUBE_RINGS: usize = 9;
pub const TUBE_RADIUS: f32 = 0.2;

/// An upright tube, 1 m high. With 2 `joints` the weights blend from joint 0 at the bottom to joint 1 at the top; with
/// 0 it is not skinned.
pub fn tube(joints: usize) -> Geometry {
    let mut geometry = Geometry::default();
    for ring in 0..TUBE_RINGS {
        let height = ring as f32 / (TUBE_RINGS - 1) as f32;
        for side in 0..TUBE_SIDES {
            let (sin, cos) = (TAU * side as f64 / TUBE_SIDES as f64).sin_cos();
            let normal = Vec3::new(cos as f32, 0.0, sin as f32);
            geometry.positions.push(TUBE_RADIUS * normal + Vec3::Y * height);
            geometry.normals.push(normal);
            if joints == 2 {
                // Strongest first.
                let (near, far, weight) = if height <= 0.5 { (0, 1, height) } else { (1, 0, 1.0 - height) };
                let far = if weight == 0.0 { 0 } else { far };
                geometry.influences.joints.extend([near, far, 0, 0]);
                geometry.influences.weights.extend([1.0 - weight, weight, 0.0, 0.0]);
            }
        }
    }
    for ring in 0..TUBE_RINGS - 1 {
        for side in 0..TUBE_SIDES {
            let [a, b] = [side, (side + 1) % TUBE_SIDES].map(|side| (ring * TUBE_SIDES + side) as u32);
            let [c, d] = [a + TUBE_SIDES as u32, b + TUBE_SIDES as u32];
            geometry.indices.extend([a, c, b, b, c, d]);
        }
    }
    geometry.influences.stride = if joints == 0 { 0 } else { 4 };
    geometry.file_vertices = geometry.positions.len();
    geometry
}

/// The tube, rigidly on joint 0.
pub fn one_influence() -> Geometry {
    let mut geometry = tube(0);
    let vertices = geometry.positions.len();
    geometry.influences =
        Influences { stride: 4, joints: [0; 4].repeat(vertices), weights: [1.0, 0.0, 0.0, 0.0].repeat(vertices) };
    geometry
}

/// The tube with `influences` different joints of `joints` on each vertex, strongest first, summing to 1.
pub fn scattered(influences: usize, joints: usize) -> Geometry {
    let mut geometry = tube(0);
    let stride = influences.next_multiple_of(4);
    let mut random = Random(7);
    geometry.influences.stride = stride;
    for _ in 0..geometry.positions.len() {
        let start = (random.f32() * joints as f32) as usize;
        let mut weights: Vec<f32> = (0..influences).map(|_| 0.05 + random.f32()).collect();
        let sum: f32 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= sum);
        weights.sort_by(|a, b| b.total_cmp(a));
        weights.resize(stride, 0.0);
        let joint = |at: usize| if at < influences { ((start + at) % joints) as u16 } else { 0 };
        geometry.influences.joints.extend((0..stride).map(joint));
        geometry.influences.weights.extend(weights);
    }
    geometry
}

/// Adds two targets: one inflates the tube and tilts its normals, one shifts it without changing normals.
pub fn morphing(mut geometry: Geometry) -> Geometry {
    let swell = MorphTarget {
        positions: geometry.normals.iter().map(|normal| 0.3 * *normal).collect(),
        normals: geometry.normals.iter().map(|normal| Vec3::new(0.0, 0.4 * normal.x, 0.0)).collect(),
        tangents: Vec::new(),
    };
    let shift = MorphTarget {
        positions: geometry.positions.iter().map(|position| Vec3::new(0.5 * position.y, 0.1, 0.0)).collect(),
        ..MorphTarget::default()
    };
    geometry.morph_targets = vec![swell, shift];
    geometry
}

/// Rotates the upper joint about Z at the tube's middle.
pub fn bend(angle_degrees: f32) -> Vec<Affine3A> {
    vec![Affine3A::IDENTITY, about_middle(Quat::from_rotation_z(angle_degrees.to_radians()))]
}

/// Rotates the upper joint about the tube's axis.
pub fn twist(angle_degrees: f32) -> Vec<Affine3A> {
    vec![Affine3A::IDENTITY, about_middle(Quat::from_rotation_y(angle_degrees.to_radians()))]
}

fn about_middle(rotation: Quat) -> Affine3A {
    let middle = Vec3::Y * 0.5;
    Affine3A::from_translation(middle) * Affine3A::from_quat(rotation) * Affine3A::from_translation(-middle)
}

fn joint(seed: f32, scale: Vec3) -> Affine3A {
    let rotation = Quat::from_euler(glam::EulerRot::YXZ, seed, 0.7 * seed, -0.4 * seed);
    Affine3A::from_scale_rotation_translation(scale, rotation, Vec3::new(seed, -0.5 * seed, 0.2))
}

/// Rotated, translated, non-uniformly scaled and slightly sheared.
fn many(count: usize) -> Vec<Affine3A> {
    let shear = Affine3A::from_mat3(Mat3::from_cols(Vec3::X, Vec3::new(0.2, 1.0, 0.0), Vec3::new(0.0, -0.1, 1.0)));
    (0..count)
        .map(|at| {
            let part = at as f32 / count as f32;
            joint(0.9 * part, Vec3::new(1.0 + part, 1.0 - 0.5 * part, 1.2)) * shear
        })
        .collect()
}

/// Rotated and translated only.
fn rigid(count: usize) -> Vec<Affine3A> {
    (0..count).map(|at| joint(1.5 * at as f32 / count as f32 - 0.7, Vec3::ONE)).collect()
}
