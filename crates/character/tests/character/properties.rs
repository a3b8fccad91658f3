//! Property channels: what clips animate besides joints.

use gaitway_character::anim::Interpolation::{CubicSpline, Linear, Step};
use gaitway_character::anim::{
    ChannelError, Clip, ClipBuilder, Interpolation, JointIndex, Keys, LightProperty, MaterialProperty, PropertyTarget,
    PropertyValues, SampleCursor,
};
use glam::{Vec3, Vec4};

use crate::build::one_joint;

const METALLIC: PropertyTarget = PropertyTarget::Material(3, MaterialProperty::Metallic);
const COLOR: PropertyTarget = PropertyTarget::Light(0, LightProperty::Color);
const VISIBLE: PropertyTarget = PropertyTarget::Visibility(JointIndex(0));

fn clip(channels: &[(PropertyTarget, Interpolation, &[f32], &[f32])]) -> Clip {
    let skeleton = one_joint();
    let mut builder = ClipBuilder::new("clip", &skeleton);
    for &(target, interpolation, times_secs, values) in channels {
        builder.property(target, interpolation, times_secs, values.to_vec()).expect("valid keys");
    }
    builder.build()
}

fn at(clip: &Clip, time_secs: f32) -> PropertyValues {
    let mut values = PropertyValues::default();
    clip.sample_properties(time_secs, &mut SampleCursor::default(), &mut values);
    values
}

#[track_caller]
fn check(target: PropertyTarget, values: &[f32], expected: ChannelError) {
    let skeleton = one_joint();
    let mut builder = ClipBuilder::new("clip", &skeleton);
    assert_eq!(builder.property(target, Linear, &[0.0, 1.0], values.to_vec()), Err(expected));
    assert!(builder.build().properties().is_empty(), "a rejected channel must leave nothing behind");
}

#[test]
fn invalid_channels_are_rejected() {
    check(METALLIC, &[0.0; 3], ChannelError::ValueCount { keys: 2, expected: 2, found: 3 });
    check(COLOR, &[0.0; 2], ChannelError::ValueCount { keys: 2, expected: 6, found: 2 });
    let nowhere = ChannelError::NoSuchJoint { joint: 1, count: 1 };
    check(PropertyTarget::Visibility(JointIndex(1)), &[0.0; 2], nowhere.clone());
    check(PropertyTarget::MorphWeight(JointIndex(1), 0), &[0.0; 2], nowhere);
    let weight = PropertyTarget::MorphWeight(JointIndex(0), 2);
    check(weight, &[0.0; 2], ChannelError::MorphTargetCount { expected: 2, found: 3 });
    let skeleton = one_joint();
    let mut builder = ClipBuilder::new("clip", &skeleton);
    let backwards = builder.property(METALLIC, Step, &[1.0, 0.5], vec![0.0; 2]);
    assert!(matches!(backwards, Err(ChannelError::TimesNotIncreasing { key: 1, .. })));
}

#[test]
fn values_hold_outside_the_keys_and_follow_them_between() {
    let colors = [0.0, 1.0, 2.0, 4.0, 5.0, 6.0];
    let clip = clip(&[(COLOR, Linear, &[1.0, 3.0], &colors), (METALLIC, Step, &[0.0, 2.0], &[0.25, 0.75])]);
    assert_eq!(clip.duration_secs(), 3.0);
    let color = |time_secs| at(&clip, time_secs).get(COLOR);
    assert_eq!(color(0.0), Some(Vec4::new(0.0, 1.0, 2.0, 0.0)));
    assert_eq!(color(1.5), Some(Vec4::new(1.0, 2.0, 3.0, 0.0)));
    assert_eq!(color(9.0), Some(Vec4::new(4.0, 5.0, 6.0, 0.0)));
    assert_eq!(at(&clip, 1.99).get(METALLIC).map(|value| value.x), Some(0.25));
    assert_eq!(at(&clip, 2.0).get(METALLIC).map(|value| value.x), Some(0.75));
    assert_eq!(at(&clip, 2.0).get(VISIBLE), None);
}

#[test]
fn splines_have_the_tangents_of_their_keys() {
    // From 0 to 1 in 2 s, leaving at 3 per second and arriving at −1.
    let clip = clip(&[(METALLIC, CubicSpline, &[0.0, 2.0], &[9.0, 0.0, 3.0, -1.0, 1.0, 9.0])]);
    let value = |time_secs| at(&clip, time_secs).get(METALLIC).unwrap().x;
    assert_eq!((value(0.0), value(2.0)), (0.0, 1.0));
    assert!((value(1.0) - (0.5 + 2.0 * (0.125 * 3.0 + 0.125))).abs() < 1e-6);
    let slope = |from: f32, to: f32| (value(to) - value(from)) / (to - from);
    assert!((slope(0.0, 1e-3) - 3.0).abs() < 0.01 && (slope(1.999, 2.0) + 1.0).abs() < 0.01);
}

#[test]
fn visibility_is_never_interpolated() {
    let clip = clip(&[(VISIBLE, Linear, &[0.0, 1.0], &[1.0, 0.0])]);
    assert_eq!(clip.properties()[0].interpolation, Step);
    assert_eq!(at(&clip, 0.99).get(VISIBLE).map(|value| value.x), Some(1.0));
}

#[test]
fn of_several_channels_for_one_target_the_last_wins() {
    let clip =
        clip(&[(METALLIC, Step, &[0.0], &[0.1]), (COLOR, Step, &[0.0], &[1.0; 3]), (METALLIC, Step, &[0.0], &[0.2])]);
    assert_eq!(clip.properties().len(), 2);
    assert_eq!(at(&clip, 0.0).get(METALLIC).map(|value| value.x), Some(0.2));
}

#[test]
fn single_weights_are_part_of_the_pose() {
    let skeleton = one_joint();
    let joint = JointIndex(0);
    let mut builder = ClipBuilder::new("clip", &skeleton);
    builder.property(PropertyTarget::MorphWeight(joint, 1), Linear, &[0.0, 1.0], vec![0.0, 1.0]).unwrap();
    builder.channel(joint, Linear, &[0.0, 1.0], Keys::Translation(vec![Vec3::ZERO, Vec3::X])).unwrap();
    let clip = builder.build();
    let mut pose = skeleton.rest().clone();
    clip.sample(&skeleton, 0.75, &mut SampleCursor::default(), &mut pose);
    assert_eq!((&pose.morph_weights[..], pose.local(joint).translation.x), (&[0.25, 0.75][..], 0.75));
    assert_eq!(at(&clip, 0.75), PropertyValues::default());
}

#[test]
fn a_cursor_of_another_clip_changes_nothing() {
    let times: Vec<f32> = (0..50).map(|key| key as f32 * 0.1).collect();
    let long = clip(&[(METALLIC, Linear, &times, &times), (COLOR, Step, &[0.0], &[1.0; 3])]);
    let short = clip(&[(METALLIC, Linear, &[0.0, 1.0], &[0.0, 1.0])]);
    let (mut cursor, mut values) = (SampleCursor::default(), PropertyValues::default());
    for time_secs in [4.33, 0.2, 2.71, 0.0] {
        for clip in [&long, &short] {
            clip.sample_properties(time_secs, &mut cursor, &mut values);
            assert_eq!(values, at(clip, time_secs));
        }
    }
}
