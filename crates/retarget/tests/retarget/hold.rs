//! Laws of clips in which some values hold still: at any time, and not only at keys.

use gaitway_character::anim::{
    Clip, ClipBuilder, Interpolation, Joint, JointIndex, Keys, Pose, PropertyTarget, PropertyValues, SampleCursor,
    Skeleton,
};
use gaitway_character::asset::Slot;
use gaitway_retarget::{HeldValues, hold_values};
use glam::Quat;

use crate::change::{KINDS, dancer, times};

fn sampled(skeleton: &Skeleton, clip: &Clip, time_secs: f32) -> (Pose, PropertyValues) {
    let (mut pose, mut properties) = (skeleton.rest().clone(), PropertyValues::default());
    let mut cursor = SampleCursor::default();
    clip.sample(skeleton, time_secs, &mut cursor, &mut pose);
    clip.sample_properties(time_secs, &mut cursor, &mut properties);
    (pose, properties)
}

#[test]
fn held_joints_stand_still_and_the_others_move_as_before() {
    let turn = Quat::from_rotation_x(0.7);
    for kind in KINDS {
        let figure = dancer(kind);
        let (skeleton, clip) = (&figure.asset.skeleton, &figure.asset.clips[0]);
        let arm = figure.joint(Slot::LeftUpperArm);
        let held = HeldValues { rotations: vec![(arm, turn)], ..HeldValues::default() };
        let still = hold_values(skeleton, clip, &held);
        assert_eq!((still.name(), still.duration_secs()), (clip.name(), clip.duration_secs()));
        let mut moves = false;
        for time_secs in times(clip) {
            let (before, after) = (sampled(skeleton, clip, time_secs).0, sampled(skeleton, &still, time_secs).0);
            for joint in skeleton.joints() {
                let (before, after) = (before.local(joint), after.local(joint));
                if joint == arm {
                    assert!(after.rotation.angle_between(turn) < 1e-5, "at {time_secs}");
                    moves |= before.rotation.angle_between(turn) > 0.1;
                    assert_eq!((after.translation, after.scale), (before.translation, before.scale));
                } else {
                    assert_eq!(after, before, "{} at {time_secs}", skeleton.name(joint));
                }
            }
        }
        assert!(moves, "the arm moves in the clip");
    }
}

/// The only channel there is becomes one of a single value.
#[test]
fn a_clip_stays_as_long_as_it_is() {
    let skeleton = Skeleton::new(vec![Joint::default()]).expect("valid");
    let mut builder = ClipBuilder::new("nod", &skeleton);
    let keys = vec![Quat::IDENTITY, Quat::from_rotation_x(1.0)];
    builder.channel(JointIndex(0), Interpolation::Linear, &[0.0, 1.5], Keys::Rotation(keys)).expect("valid");
    let held = HeldValues { rotations: vec![(JointIndex(0), Quat::IDENTITY)], ..HeldValues::default() };
    assert_eq!(hold_values(&skeleton, &builder.build(), &held).duration_secs(), 1.5);
}

/// Of three weights, the second is held: in a channel of all of them, where one has a channel of its own, and where none has one.
#[test]
fn held_weights_stand_still_and_the_others_move_as_before() {
    let face = Joint { morph_weights: vec![0.1, 0.2, 0.3], ..Joint::default() };
    let skeleton = Skeleton::new(vec![Joint::default(), face]).expect("valid");
    let of_all = |kind: Interpolation| {
        let entries = if kind == Interpolation::CubicSpline { 9 } else { 3 };
        let values = (0..3 * entries).map(|index| 0.05 * index as f32).collect();
        Keys::MorphWeights { values, targets: 3 }
    };
    let mut clips = vec![ClipBuilder::new("", &skeleton).build()];
    for (kind, has_own) in KINDS.into_iter().flat_map(|kind| [(kind, false), (kind, true)]) {
        let mut builder = ClipBuilder::new("", &skeleton);
        builder.channel(JointIndex(1), kind, &[0.0, 0.6, 1.0], of_all(kind)).expect("valid");
        for target in (1..3).filter(|_| has_own) {
            let target = PropertyTarget::MorphWeight(JointIndex(1), target);
            builder.property(target, Interpolation::Linear, &[0.0, 1.0], vec![0.0, 1.0]).expect("valid");
        }
        builder
            .property(PropertyTarget::Expression(4), Interpolation::Linear, &[0.0, 1.0], vec![0.0, 1.0])
            .expect("valid");
        clips.push(builder.build());
    }
    let held = HeldValues { morph_weights: vec![(1, 0.9)], expressions: vec![(4, 0.6)], ..HeldValues::default() };
    for clip in &clips {
        let still = hold_values(&skeleton, clip, &held);
        for step in 0..21 {
            let time_secs = 0.05 * step as f32;
            let (before, (after, properties)) =
                (sampled(&skeleton, clip, time_secs).0, sampled(&skeleton, &still, time_secs));
            let expected = [before.morph_weights[0], 0.9, before.morph_weights[2]];
            for (weight, expected) in after.morph_weights.iter().zip(expected) {
                assert!(
                    (weight - expected).abs() < 1e-6,
                    "{:?} instead of {expected} at {time_secs}",
                    after.morph_weights
                );
            }
            assert_eq!(properties.get(PropertyTarget::Expression(4)).map(|value| value.x), Some(0.6));
        }
    }
}
