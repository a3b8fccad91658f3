//! Skins and their palettes.

use gaitway_character::anim::{JointIndex, model_from_joint};
use gaitway_character::mesh::{Skin, SkinError, SkinningMode, palette_entry, write_palette};
use glam::{Affine3A, Mat3, Quat, Vec3, Vec4};

use crate::build::chain;
use crate::random::Random;

#[track_caller]
fn check_error(joints: Vec<u32>, matrices: Vec<Affine3A>, expected: SkinError) {
    let joints = joints.into_iter().map(JointIndex).collect();
    assert_eq!(Skin::new(String::new(), joints, matrices, 3).unwrap_err(), expected);
}

#[test]
fn rejects_invalid_skins() {
    let one = Affine3A::IDENTITY;
    check_error(vec![], vec![], SkinError::NoJoints);
    check_error(vec![0, 1], vec![one], SkinError::MatrixCount { joints: 2, matrices: 1 });
    check_error(vec![0, 3], vec![one; 2], SkinError::NoSuchJoint { joint: 3, count: 3 });
    check_error(vec![0, 1], vec![one, Affine3A::from_translation(Vec3::NAN)], SkinError::NotFinite { joint: 1 });
    check_error(vec![0; 65_536], vec![one; 65_536], SkinError::TooManyJoints { joints: 65_536 });
    assert!(Skin::new(String::new(), vec![JointIndex(0); 65_535], vec![one; 65_535], 1).is_ok());
}

#[test]
fn a_skin_bound_at_its_rest_has_a_palette_of_identities() {
    let skeleton = chain(20);
    let mut world = Vec::new();
    model_from_joint(&skeleton, skeleton.rest(), Affine3A::IDENTITY, &mut world);
    let inverse = world.iter().map(|matrix| matrix.inverse()).collect();
    let skin = Skin::new("skin".into(), skeleton.joints().collect(), inverse, skeleton.len()).unwrap();
    let mut palette = Vec::new();
    write_palette(&skin, &world, SkinningMode::Linear, &mut palette);
    assert_eq!(palette.len(), 20);
    for entry in &palette {
        for (row, axis) in entry.iter().zip([Vec4::X, Vec4::Y, Vec4::Z]) {
            assert!(row.abs_diff_eq(axis, 1e-5), "{row}");
        }
    }
}

#[test]
fn the_palette_follows_the_order_of_the_skin_and_is_appended() {
    let skeleton = chain(3);
    let world: Vec<Affine3A> = (0..3).map(|x| Affine3A::from_translation(Vec3::X * x as f32)).collect();
    let up = Affine3A::from_translation(Vec3::Y);
    let skin = Skin::new(String::new(), vec![JointIndex(2), JointIndex(0)], vec![up; 2], skeleton.len()).unwrap();
    let mut palette = vec![[Vec4::ONE; 5]];
    write_palette(&skin, &world, SkinningMode::Rigid, &mut palette);
    assert_eq!(palette.len(), 3);
    assert_eq!(palette[0], [Vec4::ONE; 5]);
    let translations = [1, 2].map(|at: usize| [palette[at][0].w, palette[at][1].w, palette[at][2].w]);
    assert_eq!(translations, [[2.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
}

#[test]
fn an_entry_contains_the_rows_of_its_matrix() {
    let matrix = Affine3A::from_cols_array(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0, 11.0, 12.0, 13.0]);
    let rows = [Vec4::new(1.0, 4.0, 7.0, 11.0), Vec4::new(2.0, 5.0, 8.0, 12.0), Vec4::new(3.0, 6.0, 10.0, 13.0)];
    for mode in [SkinningMode::Linear, SkinningMode::Rigid] {
        let entry = palette_entry(&matrix, mode);
        assert_eq!(entry[..3], rows);
    }
}

#[test]
fn a_dual_quaternion_entry_recomposes_to_its_matrix() {
    let mut random = Random(9);
    for round in 0..300 {
        let scale = 0.3 + random.vec3().abs();
        // Half of them mirrored, a third with shear.
        let scale = if round % 2 == 0 { scale } else { scale * Vec3::new(-1.0, 1.0, 1.0) };
        let mut matrix = Affine3A::from_scale_rotation_translation(scale, random.quat(), 2.0 * random.vec3());
        if round % 3 == 0 {
            matrix *= Affine3A::from_mat3(Mat3::from_cols(Vec3::X, Vec3::new(0.3, 1.0, 0.0), Vec3::Z));
        }
        let [real, dual, x, y, z] = palette_entry(&matrix, SkinningMode::DualQuaternion);
        assert!((real.length() - 1.0).abs() < 1e-6, "the rotation is {} long", real.length());
        assert!(real.dot(dual).abs() < 1e-6, "the parts of a unit dual quaternion are at right angles");
        assert_eq!([x.w, y.w, z.w], [0.0; 3]);
        let stretch = Mat3::from_cols(x.truncate(), y.truncate(), z.truncate()).transpose();
        let rotation = Quat::from_vec4(real);
        let translation = Quat::from_vec4(2.0 * dual) * rotation.conjugate();
        let again = Mat3::from_quat(rotation) * stretch;
        assert!(again.abs_diff_eq(Mat3::from(matrix.matrix3), 1e-5), "{again} from {matrix:?}");
        assert!(translation.xyz().abs_diff_eq(matrix.translation.into(), 1e-5), "{translation} from {matrix:?}");
    }
}

#[test]
fn a_singular_matrix_still_gives_a_unit_rotation() {
    for scale in [Vec3::ZERO, Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0, 0.0, 1.0), Vec3::new(1.0, 1.0, 0.0)] {
        let matrix = Affine3A::from_scale(scale);
        let entry = palette_entry(&matrix, SkinningMode::DualQuaternion);
        assert!((entry[0].length() - 1.0).abs() < 1e-6 && entry.iter().all(|row| row.is_finite()), "{entry:?}");
    }
}
