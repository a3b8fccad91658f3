//! Local transforms and model space.

use gaitway_character::anim::{Pose, Transform, model_from_joint};
use glam::{Affine3A, DAffine3, Mat4, Quat, Vec3};

use crate::build::chain;
use crate::random::Random;

/// Decomposes and recomposes the matrix.
fn check_matrix(matrix: Mat4) {
    let found = Mat4::from(Transform::from_matrix(&matrix).to_affine());
    assert!(found.abs_diff_eq(matrix, 1e-5), "{found} from {matrix}");
}

#[test]
fn a_matrix_without_shear_survives_decomposition() {
    let mut random = Random(1);
    for _ in 0..100 {
        let scale = random.vec3().abs() + 0.1;
        check_matrix(Mat4::from_scale_rotation_translation(scale, random.quat(), random.vec3()));
    }
}

#[test]
fn a_mirroring_matrix_survives_decomposition() {
    let rotation = Quat::from_rotation_y(0.4);
    for mirror in [Vec3::new(-1.0, 1.0, 1.0), Vec3::new(1.0, -2.0, 1.0), Vec3::new(1.0, 1.0, -3.0), -Vec3::ONE] {
        check_matrix(Mat4::from_scale_rotation_translation(mirror, rotation, Vec3::X));
    }
}

#[test]
fn a_flattened_matrix_keeps_its_rotation() {
    let rotation = Quat::from_euler(glam::EulerRot::XYZ, 0.3, 1.2, -0.7);
    for flat in [Vec3::new(0.0, 1.0, 2.0), Vec3::new(1.0, 0.0, 2.0), Vec3::new(1.0, 2.0, 0.0)] {
        let matrix = Mat4::from_scale_rotation_translation(flat, rotation, Vec3::X);
        let transform = Transform::from_matrix(&matrix);
        assert!(transform.rotation.angle_between(rotation) < 1e-3, "{transform:?}, expected {rotation}");
        check_matrix(matrix);
    }
    for line in Vec3::AXES {
        check_matrix(Mat4::from_scale_rotation_translation(line, rotation, Vec3::X));
    }
}

#[test]
fn a_singular_matrix_decomposes_to_finite_values() {
    for matrix in [Mat4::ZERO, Mat4::from_scale(Vec3::new(0.0, 1.0, 1.0)), Mat4::from_scale(Vec3::new(0.0, 0.0, 1.0))] {
        let transform = Transform::from_matrix(&matrix);
        assert!(transform.is_finite(), "{transform:?} from {matrix}");
        assert!(transform.rotation.is_normalized(), "{transform:?} from {matrix}");
    }
}

#[test]
fn a_transform_is_translation_times_rotation_times_scale() {
    let mut random = Random(2);
    for _ in 0..100 {
        let transform = Transform { translation: random.vec3(), rotation: random.quat(), scale: 2.0 * random.vec3() };
        let point = random.vec3();
        let expected = transform.rotation * (transform.scale * point) + transform.translation;
        let found = transform.to_affine().transform_point3(point);
        assert!(found.abs_diff_eq(expected, 2e-6), "{found} from {transform:?}, expected {expected}");
    }
}

#[test]
fn model_space_is_the_product_down_the_chain() {
    let skeleton = chain(40);
    let mut random = Random(4);
    let locals: Vec<Transform> = (0..40)
        .map(|_| Transform { translation: random.vec3(), rotation: random.quat(), scale: 1.0 + 0.2 * random.vec3() })
        .collect();
    let (mut pose, mut model) = (skeleton.rest().clone(), Vec::new());
    for (joint, &local) in skeleton.joints().zip(&locals) {
        pose.set_local(joint, local);
    }
    model_from_joint(&skeleton, &pose, Affine3A::IDENTITY, &mut model);
    let mut expected = DAffine3::IDENTITY;
    for (joint, local) in locals.iter().enumerate() {
        expected *= DAffine3::from_scale_rotation_translation(
            local.scale.as_dvec3(),
            local.rotation.as_dquat().normalize(),
            local.translation.as_dvec3(),
        );
        let size = expected.translation.length() + expected.matrix3.x_axis.length();
        let off = (model[joint].translation.as_dvec3() - expected.translation).length() / size;
        assert!(off < 1e-5, "joint {joint} is off by {off} of {size}");
        for (found, expected) in [
            (model[joint].matrix3.x_axis, expected.matrix3.x_axis),
            (model[joint].matrix3.y_axis, expected.matrix3.y_axis),
            (model[joint].matrix3.z_axis, expected.matrix3.z_axis),
        ] {
            let off = (found.as_dvec3() - expected).length() / size;
            assert!(off < 1e-5, "an axis of joint {joint} is off by {off} of {size}");
        }
    }
}

#[test]
fn the_model_transform_applies_to_roots_only() {
    let skeleton = chain(3);
    let placed = Affine3A::from_rotation_translation(Quat::from_rotation_x(1.0), Vec3::new(1.0, 2.0, 3.0));
    let (mut model, mut world) = (vec![Affine3A::IDENTITY; 9], Vec::new());
    model_from_joint(&skeleton, skeleton.rest(), Affine3A::IDENTITY, &mut model);
    model_from_joint(&skeleton, skeleton.rest(), placed, &mut world);
    assert_eq!(model.len(), 3);
    for (model, world) in model.iter().zip(&world) {
        assert!(world.abs_diff_eq(placed * *model, 1e-6));
    }
}

#[test]
fn copying_a_pose_makes_it_equal() {
    let rest = chain(3).rest().clone();
    for mut pose in [Pose::default(), chain(9).rest().clone()] {
        pose.copy_from(&rest);
        assert_eq!(pose, rest);
    }
}
