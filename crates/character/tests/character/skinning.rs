//! CPU skinning: the cases shared with the GPU, and laws.

use gaitway_character::mesh::{
    DeformedVertices, Geometry, Influences, PaletteEntry, SkinningMode, deform, palette_entry,
};
use glam::{Affine3A, Mat3, Quat, Vec3, Vec4};

use crate::random::Random;
use crate::skinning_cases::{
    Case, NORMAL_TOLERANCE, POSITION_TOLERANCE, TUBE_RADIUS, bend, cases, expected, one_influence, scattered, tube,
    twist,
};

use SkinningMode::{DualQuaternion, Linear, Rigid};

fn palette(matrices: &[Affine3A], mode: SkinningMode) -> Vec<PaletteEntry> {
    matrices.iter().map(|matrix| palette_entry(matrix, mode)).collect()
}

fn deformed(geometry: &Geometry, matrices: &[Affine3A], mode: SkinningMode) -> DeformedVertices {
    let mut out = DeformedVertices::default();
    deform(geometry, &[], &palette(matrices, mode), mode, &mut out);
    out
}

fn check(case: &Case) {
    let mut found = DeformedVertices::default();
    deform(&case.geometry, &case.morph_weights, &palette(&case.world_from_bind, case.mode), case.mode, &mut found);
    let (positions, normals) = expected(case);
    let size = positions.iter().fold(0.0, |size, position| position.abs().max_element().max(size));
    assert_eq!((found.positions.len(), found.normals.len()), (positions.len(), normals.len()), "{}", case.name);
    for vertex in 0..positions.len() {
        let off = (found.positions[vertex].as_dvec3() - positions[vertex]).length() / size;
        assert!(off < POSITION_TOLERANCE, "{}: vertex {vertex} is off by {off} of the size", case.name);
        let off = (found.normals[vertex].as_dvec3() - normals[vertex]).length();
        assert!(off < NORMAL_TOLERANCE, "{}: the normal of vertex {vertex} is off by {off}", case.name);
    }
}

#[test]
fn every_case_matches_the_definition() {
    cases().iter().for_each(check);
}

#[test]
fn the_rest_pose_gives_the_bind_positions() {
    for geometry in [tube(0), tube(2), scattered(13, 20), scattered(16, 20)] {
        for mode in [Linear, Rigid, DualQuaternion] {
            let found = deformed(&geometry, &[Affine3A::IDENTITY; 20], mode);
            for vertex in 0..geometry.positions.len() {
                assert!(found.positions[vertex].abs_diff_eq(geometry.positions[vertex], 1e-6), "{mode:?} {vertex}");
                assert!(found.normals[vertex].abs_diff_eq(geometry.normals[vertex], 1e-6), "{mode:?} {vertex}");
            }
        }
    }
}

#[test]
fn all_modes_agree_on_one_influence() {
    let geometry = one_influence();
    let mut random = Random(13);
    for round in 0..100 {
        let scale = 0.3 + random.vec3().abs();
        let mirror = [Vec3::ONE, Vec3::new(-1.0, 1.0, 1.0), Vec3::new(1.0, 1.0, -1.0), -Vec3::ONE][round % 4];
        let matrix = Affine3A::from_scale_rotation_translation(scale * mirror, random.quat(), random.vec3());
        let linear = deformed(&geometry, &[matrix, Affine3A::IDENTITY], Linear);
        for mode in [Rigid, DualQuaternion] {
            let found = deformed(&geometry, &[matrix, Affine3A::IDENTITY], mode);
            for vertex in 0..geometry.positions.len() {
                let (found_at, linear_at) = (found.positions[vertex], linear.positions[vertex]);
                assert!(found_at.abs_diff_eq(linear_at, 3e-6), "{mode:?} {round}: {found_at}, linear {linear_at}");
                let (found_at, linear_at) = (found.normals[vertex], linear.normals[vertex]);
                assert!(found_at.abs_diff_eq(linear_at, 1e-5), "{mode:?} {round}: {found_at}, linear {linear_at}");
            }
        }
    }
}

#[test]
fn the_sign_of_a_dual_quaternion_does_not_matter() {
    let geometry = scattered(16, 20);
    let mut random = Random(17);
    let matrices: Vec<Affine3A> =
        (0..20).map(|_| Affine3A::from_rotation_translation(random.quat(), random.vec3())).collect();
    let plain = palette(&matrices, DualQuaternion);
    let mut before = DeformedVertices::default();
    deform(&geometry, &[], &plain, DualQuaternion, &mut before);
    for _ in 0..20 {
        let mut negated = plain.clone();
        for entry in negated.iter_mut().filter(|_| random.f32() < 0.5) {
            entry[0] = -entry[0];
            entry[1] = -entry[1];
        }
        assert_ne!(negated, plain);
        let mut after = DeformedVertices::default();
        deform(&geometry, &[], &negated, DualQuaternion, &mut after);
        for vertex in 0..geometry.positions.len() {
            assert!(after.positions[vertex].abs_diff_eq(before.positions[vertex], 1e-6), "vertex {vertex}");
            assert!(after.normals[vertex].abs_diff_eq(before.normals[vertex], 1e-6), "vertex {vertex}");
        }
    }
}

/// The smallest distance from the tube's axis of any vertex.
fn radius(mode: SkinningMode, twist_degrees: f32) -> f32 {
    let found = deformed(&tube(2), &twist(twist_degrees), mode);
    found.positions.iter().map(|position| position.x.hypot(position.z)).fold(f32::INFINITY, f32::min)
}

#[test]
fn dual_quaternions_keep_the_radius_of_a_twist_below_half_a_turn() {
    for degrees in [-179.0, -90.0, 1.0, 45.0, 90.0, 135.0, 170.0, 179.0] {
        let found = radius(DualQuaternion, degrees);
        assert!((found - TUBE_RADIUS).abs() < 1e-6, "{degrees}°: {found}");
    }
    // Linear blending collapses the tube like a candy wrapper, by the cosine of half the angle.
    let collapsed = radius(Linear, 120.0);
    assert!((collapsed - 0.5 * TUBE_RADIUS).abs() < 1e-6, "{collapsed}");
}

#[test]
fn rigid_breaks_the_tube_in_two() {
    let found = deformed(&tube(2), &bend(90.0), Rigid);
    for (found, bound) in found.positions.iter().zip(&tube(2).positions) {
        let joint = usize::from(bound.y > 0.5);
        assert!(found.abs_diff_eq(bend(90.0)[joint].transform_point3(*bound), 1e-6));
    }
}

#[test]
fn a_single_entry_applies_to_all_vertices() {
    let moved = [Affine3A::from_translation(Vec3::X)];
    for mode in [Linear, Rigid, DualQuaternion] {
        let found = deformed(&scattered(8, 20), &moved, mode);
        for (found, bound) in found.positions.iter().zip(&tube(0).positions) {
            assert!(found.abs_diff_eq(*bound + Vec3::X, 1e-6));
        }
    }
}

#[test]
fn absent_normals_stay_absent() {
    let mut geometry = tube(2);
    geometry.normals.clear();
    assert!(deformed(&geometry, &bend(90.0), Linear).normals.is_empty());
}

#[test]
fn zero_scales_give_finite_normals() {
    for scale in [Vec3::new(1.0, 0.0, 1.0), Vec3::new(0.0, 0.0, 1.0), Vec3::ZERO] {
        for mode in [Linear, Rigid, DualQuaternion] {
            let found = deformed(&one_influence(), &[Affine3A::from_scale(scale), Affine3A::IDENTITY], mode);
            assert!(found.normals.iter().chain(&found.positions).all(|value| value.is_finite()), "{scale} {mode:?}");
        }
    }
}

#[test]
fn results_are_replaced() {
    let mut out = DeformedVertices::default();
    for geometry in [scattered(16, 20), tube(2)] {
        deform(&geometry, &[], &palette(&[Affine3A::IDENTITY; 20], Linear), Linear, &mut out);
        assert_eq!(out.positions.len(), geometry.positions.len());
        assert_eq!(out.normals.len(), geometry.normals.len());
    }
}

/// Compares deformed normals with those of the deformed surface, by central differences: samples of an ellipsoid whose
/// vertices all have the same influences, each with four neighbours on the surface and one above it.
fn check_normals(matrices: &[Affine3A], weights: &[f32], mode: SkinningMode) {
    const STEP: f32 = 5e-3;
    let radii = Vec3::new(1.0, 0.6, 0.8);
    let surface = |u: f32, v: f32| radii * Vec3::new(u.cos() * v.cos(), v.sin(), u.sin() * v.cos());
    let normal = |u: f32, v: f32| (surface(u, v) / (radii * radii)).normalize();
    let mut geometry = Geometry::default();
    for patch in 0..60 {
        let (u, v) = (patch as f32 * 0.37, (patch as f32 * 0.11).sin());
        let above = surface(u, v) + STEP * normal(u, v);
        let around = [(u, v), (u + STEP, v), (u - STEP, v), (u, v + STEP), (u, v - STEP)];
        geometry.positions.extend(around.map(|(u, v)| surface(u, v)).into_iter().chain([above]));
        geometry.normals.extend([normal(u, v); 6]);
    }
    let vertices = geometry.positions.len();
    let joints: Vec<u16> = (0..weights.len() as u16).collect();
    geometry.influences =
        Influences { stride: weights.len(), joints: joints.repeat(vertices), weights: weights.repeat(vertices) };
    let found = deformed(&geometry, matrices, mode);
    for (positions, normals) in found.positions.chunks(6).zip(found.normals.chunks(6)) {
        let across = (positions[1] - positions[2]).cross(positions[3] - positions[4]).normalize();
        let out = positions[5] - positions[0];
        let expected = across * across.dot(out).signum();
        assert!((normals[0].length() - 1.0).abs() < 1e-5);
        let off = normals[0].angle_between(expected);
        assert!(off < 2e-3, "{mode:?} {weights:?}: off by {off} radians");
    }
}

#[test]
fn normals_match_the_deformed_surface() {
    let mut random = Random(19);
    let shear = Affine3A::from_mat3(Mat3::from_cols(Vec3::X, Vec3::new(0.5, 1.0, 0.2), Vec3::new(0.0, 0.3, 1.0)));
    for mirror in [1.0, -1.0] {
        let matrices: Vec<Affine3A> = (0..4)
            .map(|_| {
                let scale = Vec3::new(mirror * (0.6 + random.f32()), 0.6 + random.f32(), 0.6 + random.f32());
                let rotation = Quat::from_scaled_axis(0.5 * random.vec3());
                Affine3A::from_scale_rotation_translation(scale, rotation, random.vec3()) * shear
            })
            .collect();
        for mode in [Linear, Rigid, DualQuaternion] {
            check_normals(&matrices, &[1.0, 0.0, 0.0, 0.0], mode);
            check_normals(&matrices, &[0.4, 0.3, 0.2, 0.1], mode);
        }
    }
}

#[test]
fn unused_influences_are_ignored() {
    let mut geometry = tube(2);
    for (joint, weight) in geometry.influences.joints.iter_mut().zip(&geometry.influences.weights) {
        if *weight == 0.0 {
            *joint = 2;
        }
    }
    let mut matrices = bend(90.0);
    matrices.push(Affine3A::from_scale(Vec3::splat(f32::INFINITY)));
    for mode in [Linear, DualQuaternion] {
        let mut palette = palette(&matrices[..2], mode);
        palette.push([Vec4::INFINITY; 5]);
        let mut out = DeformedVertices::default();
        deform(&geometry, &[], &palette, mode, &mut out);
        assert!(out.positions.iter().all(|position| position.is_finite()), "{mode:?}");
    }
}
