//! Bounding boxes.

use gaitway_character::mesh::Bounds;
use glam::{Affine3A, Quat, Vec3};

fn check(bounds: Bounds, min: [f32; 3], max: [f32; 3]) {
    assert!(bounds.min.abs_diff_eq(min.into(), 1e-6) && bounds.max.abs_diff_eq(max.into(), 1e-6), "{bounds:?}");
}

#[test]
fn non_finite_points_are_ignored() {
    let points = [Vec3::NAN, Vec3::INFINITY, Vec3::new(1.0, f32::NEG_INFINITY, 0.0)];
    assert!(Bounds::of(points).is_empty());
    check(Bounds::of(points.into_iter().chain([Vec3::ONE])), [1.0; 3], [1.0; 3]);
}

#[test]
fn empty_bounds_stay_empty() {
    assert!(Bounds::default().is_empty());
    assert_eq!(Bounds::EMPTY.size(), Vec3::ZERO);
    assert_eq!(Bounds::EMPTY.diagonal(), 0.0);
    assert!(Bounds::EMPTY.transformed(&Affine3A::from_translation(Vec3::ONE)).is_empty());
    assert!(Bounds::EMPTY.union(Bounds::EMPTY).is_empty());
}

#[test]
fn bounds_enclose_their_points() {
    let bounds = Bounds::of([Vec3::new(1.0, -2.0, 3.0), Vec3::new(-1.0, 4.0, 3.0)]);
    check(bounds, [-1.0, -2.0, 3.0], [1.0, 4.0, 3.0]);
    assert!(!bounds.is_empty());
    assert_eq!(bounds.center(), Vec3::new(0.0, 1.0, 3.0));
    assert_eq!(bounds.size(), Vec3::new(2.0, 6.0, 0.0));
    assert_eq!(bounds.union(Bounds::EMPTY), bounds);
    check(bounds.union(Bounds::of([Vec3::ZERO])), [-1.0, -2.0, 0.0], [1.0, 4.0, 3.0]);
}

#[test]
fn corners_are_all_distinct() {
    let bounds = Bounds { min: Vec3::ZERO, max: Vec3::new(1.0, 2.0, 4.0) };
    let mut sums = bounds.corners().map(|corner| corner.element_sum());
    sums.sort_by(f32::total_cmp);
    assert_eq!(sums, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
}

#[test]
fn transformed_bounds_enclose_the_corners() {
    let bounds = Bounds { min: Vec3::ZERO, max: Vec3::new(2.0, 1.0, 1.0) };
    let turned = Affine3A::from_rotation_translation(Quat::from_rotation_z(90f32.to_radians()), Vec3::X);
    check(bounds.transformed(&turned), [0.0, 0.0, 0.0], [1.0, 2.0, 1.0]);
}
