//! Building skeletons: rejected input and the resulting order.

use gaitway_character::anim::{Interpolation, Joint, JointIndex, Skeleton, SkeletonError, Transform, model_from_joint};
use glam::{Affine3A, Vec3};

use crate::random::Random;
use crate::skeletons::joint;

fn joints(parents: &[Option<usize>]) -> Vec<Joint> {
    let rest = |at: usize| Transform::from_translation(Vec3::new(at as f32, 1.0, 0.0));
    parents.iter().enumerate().map(|(at, &parent)| joint(&at.to_string(), parent, rest(at))).collect()
}

fn check_error(parents: &[Option<usize>], expected: SkeletonError) {
    assert_eq!(Skeleton::new(joints(parents)).unwrap_err(), expected, "{parents:?}");
}

#[test]
fn rejects_missing_parents() {
    check_error(&[Some(1)], SkeletonError::ParentOutOfRange { joint: 0, parent: 1, count: 1 });
    check_error(&[None, Some(usize::MAX)], SkeletonError::ParentOutOfRange { joint: 1, parent: usize::MAX, count: 2 });
}

#[test]
fn rejects_cycles() {
    check_error(&[Some(0)], SkeletonError::Cycle { joint: 0 });
    check_error(&[Some(1), Some(0)], SkeletonError::Cycle { joint: 0 });
    check_error(&[None, Some(3), Some(1), Some(2)], SkeletonError::Cycle { joint: 1 });
    // Joint 0 is only a descendant of the cycle.
    check_error(&[Some(1), Some(2), Some(1)], SkeletonError::Cycle { joint: 1 });
}

#[test]
fn a_skeleton_may_be_empty() {
    let skeleton = Skeleton::new(Vec::new()).unwrap();
    assert!(skeleton.is_empty());
    assert_eq!(skeleton.len(), 0);
}

#[test]
fn parents_come_first_and_siblings_stay_in_order() {
    // 4 is the parent of 2 (with children 0 and 3) and of 1; 5 is a root on its own.
    let skeleton = Skeleton::new(joints(&[Some(2), Some(4), Some(4), Some(2), None, None])).unwrap();
    let names: Vec<&str> = skeleton.joints().map(|joint| skeleton.name(joint)).collect();
    assert_eq!(names, ["4", "1", "2", "0", "3", "5"]);
    for joint in skeleton.joints() {
        assert!(skeleton.parent(joint).is_none_or(|parent| parent < joint));
        assert_eq!(skeleton.joint_of_source(skeleton.source_index(joint)), Some(joint));
        assert_eq!(skeleton.source_index(joint).to_string(), skeleton.name(joint));
    }
    assert_eq!(skeleton.joint_of_source(6), None);
    let children: Vec<JointIndex> = skeleton.children(JointIndex(2)).collect();
    assert_eq!(children, [JointIndex(3), JointIndex(4)]);
}

#[test]
fn finds_the_first_of_equal_names_in_source_order() {
    let mut list = joints(&[Some(1), None, None]);
    list[0].name = "twice".into();
    list[2].name = "twice".into();
    let skeleton = Skeleton::new(list).unwrap();
    assert_eq!(skeleton.find("twice").map(|joint| skeleton.source_index(joint)), Some(0));
    assert_eq!(skeleton.find("never"), None);
}

#[test]
fn morph_weights_of_meshes_are_concatenated() {
    let mut list = joints(&[Some(1), None]);
    list[0].morph_weights = vec![0.1, 0.2];
    list[1].morph_weights = vec![0.3];
    let skeleton = Skeleton::new(list).unwrap();
    assert_eq!(skeleton.rest().morph_weights, [0.3, 0.1, 0.2]);
    assert_eq!(skeleton.morph_range(JointIndex(0)), 0..1);
    assert_eq!(skeleton.morph_range(JointIndex(1)), 1..3);
}

#[test]
fn the_order_of_the_input_does_not_matter() {
    let parents = [None, Some(0), Some(1), Some(1), Some(3), None, Some(5)];
    let mut random = Random(3);
    let rests: Vec<Transform> = parents
        .iter()
        .map(|_| Transform { translation: random.vec3(), rotation: random.quat(), scale: random.vec3().abs() })
        .collect();
    // Positions of the joints of `parents` in the shuffled list.
    for shuffled in [[0, 1, 2, 3, 4, 5, 6], [6, 5, 4, 3, 2, 1, 0], [3, 6, 0, 5, 1, 4, 2]] {
        let mut list = vec![Joint::default(); parents.len()];
        for (at, parent) in parents.iter().enumerate() {
            list[shuffled[at]] = joint("", parent.map(|parent: usize| shuffled[parent]), rests[at]);
        }
        let skeleton = Skeleton::new(list).unwrap();
        let mut model = Vec::new();
        model_from_joint(&skeleton, skeleton.rest(), Affine3A::IDENTITY, &mut model);
        for at in 0..parents.len() {
            let mut expected = rests[at].to_affine();
            let mut above = parents[at];
            while let Some(parent) = above {
                expected = rests[parent].to_affine() * expected;
                above = parents[parent];
            }
            let found = model[skeleton.joint_of_source(shuffled[at]).unwrap().get()];
            assert!(found.abs_diff_eq(expected, 1e-5), "joint {at} of {shuffled:?}: {found:?}, expected {expected:?}");
        }
    }
}

#[test]
fn tangents_of_a_mirroring_scale_turn_round_with_it() {
    let scale = Vec3::new(-1.0, 1.0, 1.0);
    let armature = Joint { rest: Transform { scale, ..Transform::IDENTITY }, ..Joint::default() };
    let skeleton = Skeleton::new(vec![armature, Joint { parent: Some(0), ..Joint::default() }]).unwrap();
    let key = [Vec3::new(-0.5, -0.5, 2.0), scale, Vec3::new(0.25, -0.25, 3.0)];
    let check = |joint: u32, interpolation, expected: [Vec3; 3]| {
        let mut values = key;
        skeleton.reflection().change_scales(JointIndex(joint), interpolation, &mut values);
        assert_eq!(values, expected);
    };
    check(0, Interpolation::CubicSpline, [Vec3::new(0.5, -0.5, 2.0), Vec3::ONE, Vec3::new(-0.25, -0.25, 3.0)]);
    check(0, Interpolation::Linear, key.map(Vec3::abs));
    check(1, Interpolation::CubicSpline, key);
}
