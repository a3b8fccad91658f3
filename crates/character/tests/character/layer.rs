//! Layers of poses: exact at both ends, the same as double precision in between, and only where the mask is.

use gaitway_character::anim::{
    ClipBuilder, Interpolation, Joint, JointIndex, JointMask, Keys, Pose, SampleCursor, Skeleton, Transform,
};
use glam::{DQuat, DVec3, Quat, Vec3};

use crate::random::Random;

const JOINTS: usize = 10;
const WEIGHTS: [f32; 5] = [0.01, 0.25, 0.5, 0.8, 0.99];

/// A chain, with morph targets on the fourth joint.
fn skeleton() -> Skeleton {
    let joint = |at: usize| Joint {
        name: format!("joint {at}"),
        parent: at.checked_sub(1),
        morph_weights: if at == 3 { vec![0.0; 3] } else { Vec::new() },
        ..Joint::default()
    };
    Skeleton::new((0..JOINTS).map(joint).collect()).expect("a chain")
}

/// A pose between two keys, so that its rotations are not normalized, as they are during playback.
fn pose(skeleton: &Skeleton, seed: u64) -> Pose {
    let mut random = Random(seed);
    let mut clip = ClipBuilder::new("", skeleton);
    for joint in skeleton.joints() {
        let from = random.quat();
        let to = (from * Quat::from_scaled_axis(random.vec3())).normalize();
        let mut add = |keys| clip.channel(joint, Interpolation::Linear, &[0.0, 1.0], keys).expect("two keys");
        add(Keys::Rotation(vec![from, to]));
        add(Keys::Translation(vec![random.vec3(), random.vec3()]));
        add(Keys::Scale(vec![random.vec3() + 2.0, random.vec3() + 2.0]));
    }
    let values = (0..6).map(|_| random.f32()).collect();
    let weights = Keys::MorphWeights { values, targets: 3 };
    clip.channel(JointIndex(3), Interpolation::Linear, &[0.0, 1.0], weights).expect("two keys");
    let mut pose = skeleton.rest().clone();
    clip.build().sample(skeleton, 0.4, &mut SampleCursor::default(), &mut pose);
    pose
}

fn all(skeleton: &Skeleton) -> JointMask {
    JointMask::new(skeleton, &[true; JOINTS])
}

fn overridden(base: &Pose, layer: &Pose, weight: f32, mask: &JointMask) -> Pose {
    let mut pose = base.clone();
    pose.override_with(layer, weight, mask);
    pose
}

fn added(base: &Pose, layer: &Pose, reference: &Pose, weight: f32, mask: &JointMask) -> Pose {
    let mut pose = base.clone();
    pose.add_layer(layer, reference, weight, mask);
    pose
}

fn shorter_lerp(from: DQuat, to: DQuat, weight: f64) -> DQuat {
    let to = if from.dot(to) < 0.0 { -to } else { to };
    (from * (1.0 - weight) + to * weight).normalize()
}

fn check_close(found: Transform, turn: DQuat, place: DVec3, scale: DVec3, about: &str) {
    let turn_error = (found.rotation.as_dquat().normalize().dot(turn).abs() - 1.0).abs();
    assert!(turn_error < 1e-6, "{about}: {} instead of {turn}", found.rotation);
    assert!(found.translation.as_dvec3().abs_diff_eq(place, 2e-6), "{about}: {} not {place}", found.translation);
    assert!(found.scale.as_dvec3().abs_diff_eq(scale, 1e-5), "{about}: {} not {scale}", found.scale);
}

#[test]
fn both_ends_of_the_weight_are_exact() {
    let skeleton = skeleton();
    let mask = all(&skeleton);
    for seed in 0..20 {
        let (base, layer, reference) =
            (pose(&skeleton, seed), pose(&skeleton, seed + 100), pose(&skeleton, seed + 200));
        assert_eq!(overridden(&base, &layer, 0.0, &mask), base);
        assert_eq!(overridden(&base, &layer, 1.0, &mask), layer);
        assert_eq!(added(&base, &layer, &reference, 0.0, &mask), base);
    }
}

#[test]
fn adding_no_difference_changes_nothing() {
    let skeleton = skeleton();
    let mask = all(&skeleton);
    for seed in 0..20 {
        let (base, layer) = (pose(&skeleton, seed), pose(&skeleton, seed + 100));
        for weight in WEIGHTS.into_iter().chain([1.0]) {
            assert_eq!(added(&base, &layer, &layer, weight, &mask), base, "{weight}");
        }
    }
}

/// What a layer adds to its own reference leads to the layer.
#[test]
fn a_difference_added_to_its_reference_is_the_layer() {
    let skeleton = skeleton();
    for seed in 0..20 {
        let (layer, reference) = (pose(&skeleton, seed), pose(&skeleton, seed + 100));
        let sum = added(&reference, &layer, &reference, 1.0, &all(&skeleton));
        for (found, expected) in sum.locals().zip(layer.locals()) {
            let Transform { translation, rotation, scale } = expected;
            check_close(found, rotation.as_dquat(), translation.as_dvec3(), scale.as_dvec3(), "the sum");
        }
        assert!(sum.morph_weights.iter().zip(&layer.morph_weights).all(|(a, b)| (a - b).abs() < 1e-6));
    }
}

#[test]
fn blending_matches_double_precision() {
    let skeleton = skeleton();
    for seed in 0..20 {
        let (base, layer) = (pose(&skeleton, seed), pose(&skeleton, seed + 100));
        for weight in WEIGHTS {
            let found = overridden(&base, &layer, weight, &all(&skeleton));
            let w = f64::from(weight);
            for joint in skeleton.joints() {
                let (from, to) = (base.local(joint), layer.local(joint));
                let turn = shorter_lerp(from.rotation.as_dquat(), to.rotation.as_dquat(), w);
                let place = from.translation.as_dvec3().lerp(to.translation.as_dvec3(), w);
                let scale = from.scale.as_dvec3().lerp(to.scale.as_dvec3(), w);
                check_close(found.local(joint), turn, place, scale, "an override");
            }
        }
    }
}

#[test]
fn adding_matches_double_precision() {
    let skeleton = skeleton();
    for seed in 0..20 {
        let (base, layer, reference) =
            (pose(&skeleton, seed), pose(&skeleton, seed + 100), pose(&skeleton, seed + 200));
        for weight in WEIGHTS.into_iter().chain([1.0]) {
            let found = added(&base, &layer, &reference, weight, &all(&skeleton));
            let w = f64::from(weight);
            for joint in skeleton.joints() {
                let [own, to, from] = [&base, &layer, &reference].map(|pose| pose.local(joint));
                let turn = to.rotation.as_dquat() * from.rotation.as_dquat().conjugate();
                let turn = shorter_lerp(DQuat::IDENTITY, turn, w) * own.rotation.as_dquat();
                let place = own.translation.as_dvec3() + (to.translation - from.translation).as_dvec3() * w;
                let ratio = to.scale.as_dvec3() / from.scale.as_dvec3();
                let scale = own.scale.as_dvec3() * DVec3::ONE.lerp(ratio, w);
                check_close(found.local(joint), turn.normalize(), place, scale, "a sum");
            }
        }
    }
}

/// A rotation and its negative are the same, so no blend may go the long way around.
#[test]
fn the_shorter_arc_is_taken() {
    let skeleton = skeleton();
    let (mut base, mut layer) = (skeleton.rest().clone(), skeleton.rest().clone());
    let joint = JointIndex(0);
    base.set_rotation(joint, Quat::from_rotation_y(0.2));
    layer.set_rotation(joint, -Quat::from_rotation_y(0.6));
    let turned = |pose: &Pose| pose.local(joint).rotation;
    let near = |found: Quat, angle: f32| found.angle_between(Quat::from_rotation_y(angle)) < 1e-3;
    assert!(near(turned(&overridden(&base, &layer, 0.5, &all(&skeleton))), 0.4));
    assert!(near(turned(&added(&base, &layer, skeleton.rest(), 0.5, &all(&skeleton))), 0.5));
}

#[test]
fn complementary_masks_make_up_the_whole() {
    let skeleton = skeleton();
    let odd: Vec<bool> = (0..JOINTS).map(|joint| joint % 2 == 1).collect();
    let even: Vec<bool> = odd.iter().map(|odd| !odd).collect();
    let [odd_mask, even_mask] = [&odd, &even].map(|included| JointMask::new(&skeleton, included));
    for seed in 0..10 {
        let (base, layer, reference) =
            (pose(&skeleton, seed), pose(&skeleton, seed + 100), pose(&skeleton, seed + 200));
        for weight in [0.0, 0.3, 1.0] {
            let half = overridden(&base, &layer, weight, &odd_mask);
            for (joint, odd) in skeleton.joints().zip(&odd) {
                if !odd {
                    assert_eq!(half.local(joint), base.local(joint));
                }
            }
            // The morph targets belong to an odd joint.
            assert_eq!(overridden(&base, &layer, weight, &even_mask).morph_weights, base.morph_weights);
            let whole = overridden(&base, &layer, weight, &all(&skeleton));
            assert_eq!(overridden(&half, &layer, weight, &even_mask), whole);
            let half = added(&base, &layer, &reference, weight, &odd_mask);
            let whole = added(&base, &layer, &reference, weight, &all(&skeleton));
            assert_eq!(added(&half, &layer, &reference, weight, &even_mask), whole);
        }
    }
}

/// A joint that is hidden by a scale of 0 stays finite.
#[test]
fn a_scale_of_zero_has_no_ratio() {
    let skeleton = skeleton();
    let mut reference = skeleton.rest().clone();
    for zero in [0.0, 1e-12, -1e-12] {
        reference.set_scale(JointIndex(0), Vec3::splat(zero));
        let sum = added(skeleton.rest(), skeleton.rest(), &reference, 0.5, &all(&skeleton));
        assert_eq!(sum.local(JointIndex(0)).scale, Vec3::ONE);
    }
}
