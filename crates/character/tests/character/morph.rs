//! CPU morphing.

use gaitway_character::mesh::{DeformedVertices, Geometry, MorphTarget, SkinningMode, deform, palette_entry};
use glam::{Affine3A, Vec3};

/// Two vertices. Target 0 moves positions and normals, target 1 only positions, target 2 nothing.
fn geometry() -> Geometry {
    let target = |positions: Vec<Vec3>, normals| MorphTarget { positions, normals, tangents: Vec::new() };
    Geometry {
        positions: vec![Vec3::ZERO, Vec3::X],
        normals: vec![Vec3::Y, Vec3::Y],
        morph_targets: vec![
            target(vec![Vec3::Y, 2.0 * Vec3::Y], vec![Vec3::X, -Vec3::Y]),
            target(vec![Vec3::Z, Vec3::ZERO], Vec::new()),
            MorphTarget::default(),
        ],
        ..Geometry::default()
    }
}

#[track_caller]
fn check(geometry: &Geometry, weights: &[f32], positions: [Vec3; 2], normals: [Vec3; 2]) {
    let palette = [palette_entry(&Affine3A::IDENTITY, SkinningMode::Linear)];
    let mut found = DeformedVertices::default();
    deform(geometry, weights, &palette, SkinningMode::Linear, &mut found);
    for vertex in 0..2 {
        assert!(found.positions[vertex].abs_diff_eq(positions[vertex], 1e-6), "{weights:?}: {found:?}");
        assert!(found.normals[vertex].abs_diff_eq(normals[vertex], 1e-6), "{weights:?}: {found:?}");
    }
}

#[test]
fn missing_weights_are_zero_and_extra_ones_are_ignored() {
    let bound = [Vec3::ZERO, Vec3::X];
    check(&geometry(), &[], bound, [Vec3::Y; 2]);
    check(&geometry(), &[0.0], bound, [Vec3::Y; 2]);
    check(&geometry(), &[0.0, 0.0, 0.0, 9.0], bound, [Vec3::Y; 2]);
}

#[test]
fn targets_add_up() {
    check(&geometry(), &[0.0, 1.0], [Vec3::Z, Vec3::X], [Vec3::Y; 2]);
    let tilted = Vec3::new(0.5, 1.0, 0.0).normalize();
    check(&geometry(), &[0.5, 2.0, 1.0], [Vec3::new(0.0, 0.5, 2.0), Vec3::new(1.0, 1.0, 0.0)], [tilted, Vec3::Y]);
}

#[test]
fn weights_may_be_negative_or_above_one() {
    check(
        &geometry(),
        &[-1.0],
        [-Vec3::Y, Vec3::new(1.0, -2.0, 0.0)],
        [Vec3::new(-1.0, 1.0, 0.0).normalize(), Vec3::Y],
    );
    check(&geometry(), &[0.0, 3.0], [3.0 * Vec3::Z, Vec3::X], [Vec3::Y; 2]);
}

#[test]
fn a_vanishing_normal_becomes_zero() {
    check(&geometry(), &[1.0], [Vec3::Y, Vec3::new(1.0, 2.0, 0.0)], [Vec3::new(1.0, 1.0, 0.0).normalize(), Vec3::ZERO]);
}

#[test]
fn morphing_comes_before_skinning() {
    let palette = [palette_entry(&Affine3A::from_scale(Vec3::splat(10.0)), SkinningMode::Linear)];
    let mut found = DeformedVertices::default();
    deform(&geometry(), &[1.0], &palette, SkinningMode::Linear, &mut found);
    assert_eq!(found.positions, [10.0 * Vec3::Y, Vec3::new(10.0, 20.0, 0.0)]);
}
