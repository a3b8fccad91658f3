//! Building clips and sampling them, against glTF 2.0 §3.11 and appendix C.

use gaitway_character::anim::{
    Channel, ChannelError, Clip, ClipBuilder, Interpolation, JointIndex, Keys, Pose, SampleCursor,
};
use glam::{DQuat, DVec4, Quat, Vec3};

use crate::build::{chain, one_channel, one_joint};
use crate::random::Random;

use Interpolation::{CubicSpline, Linear, Step};

fn sample(clip: &Clip, time_secs: f32) -> Pose {
    let skeleton = one_joint();
    let mut pose = skeleton.rest().clone();
    clip.sample(&skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
    pose
}

fn same_rotation(a: Quat, b: Quat, tolerance: f32) -> bool {
    let b = if a.dot(b) < 0.0 { -b } else { b };
    (a - b).length() <= tolerance
}

#[track_caller]
fn check_error(joint: u32, interpolation: Interpolation, times_secs: &[f32], keys: Keys, expected: ChannelError) {
    let skeleton = one_joint();
    let mut builder = ClipBuilder::new("clip", &skeleton);
    let error = builder.channel(JointIndex(joint), interpolation, times_secs, keys).unwrap_err();
    assert_eq!(error.to_string(), expected.to_string());
    assert!(builder.build().channels().is_empty(), "a rejected channel must leave nothing behind");
}

fn zeros(count: usize) -> Keys {
    Keys::Translation(vec![Vec3::ZERO; count])
}

#[test]
fn rejects_times_that_do_not_increase() {
    let not_after = |key, time_secs, before_secs| ChannelError::TimesNotIncreasing { key, time_secs, before_secs };
    check_error(0, Linear, &[], zeros(0), ChannelError::NoKeys);
    check_error(0, Linear, &[0.0, 0.0], zeros(2), not_after(1, 0.0, 0.0));
    check_error(0, Linear, &[0.0, 2.0, 1.0], zeros(3), not_after(2, 1.0, 2.0));
    check_error(0, Step, &[-0.5], zeros(1), ChannelError::BadTime { key: 0, time_secs: -0.5 });
    check_error(0, Step, &[0.0, f32::NAN], zeros(2), ChannelError::BadTime { key: 1, time_secs: f32::NAN });
    check_error(0, Step, &[f32::INFINITY], zeros(1), ChannelError::BadTime { key: 0, time_secs: f32::INFINITY });
}

#[test]
fn rejects_keys_that_do_not_match_the_times() {
    let count = |keys, expected, found| ChannelError::ValueCount { keys, expected, found };
    check_error(0, Linear, &[0.0, 1.0], zeros(1), count(2, 2, 1));
    check_error(0, Linear, &[0.0], zeros(2), count(1, 1, 2));
    check_error(0, CubicSpline, &[0.0, 1.0], zeros(2), count(2, 6, 2));
    let no_such = ChannelError::NoSuchJoint { joint: 1, count: 1 };
    check_error(1, Linear, &[0.0], zeros(1), no_such);
    let weights = |values: usize, targets| Keys::MorphWeights { values: vec![0.0; values], targets };
    let targets = |found| ChannelError::MorphTargetCount { expected: 2, found };
    check_error(0, Linear, &[0.0], weights(3, 3), targets(3));
    check_error(0, Linear, &[0.0], weights(1, 1), targets(1));
    check_error(0, Linear, &[0.0, 1.0], weights(2, 2), count(2, 4, 2));
    check_error(0, CubicSpline, &[0.0], weights(2, 2), count(1, 6, 2));
    // Entries must be complete, without leftover weights.
    check_error(0, Linear, &[0.0, 1.0], weights(3, 2), count(2, 4, 3));
    check_error(0, Linear, &[0.0], weights(3, 2), count(1, 2, 3));
}

#[test]
fn keys_are_kept_as_given() {
    let skeleton = one_joint();
    let times = [0.5, 1.0];
    let rotations = vec![Quat::from_xyzw(0.0, 0.0, 0.0, 2.0), Quat::from_xyzw(0.0, -0.6, 0.0, -0.8)];
    let mut builder = ClipBuilder::new("walk", &skeleton);
    builder.channel(JointIndex(0), Linear, &times, Keys::Rotation(rotations.clone())).unwrap();
    builder.channel(JointIndex(0), Step, &times, zeros(2)).unwrap();
    let clip = builder.build();
    assert_eq!((clip.name(), clip.duration_secs()), ("walk", 1.0));
    assert_eq!(clip.timelines(), [times.to_vec()], "equal times share a timeline");
    let channel = |interpolation, keys| Channel { joint: JointIndex(0), interpolation, timeline: 0, keys };
    assert_eq!(clip.channels(), [channel(Linear, Keys::Rotation(rotations)), channel(Step, zeros(2))]);
}

#[test]
fn sampling_at_a_key_gives_exactly_that_key() {
    let mut random = Random(11);
    let count = 9;
    let times: Vec<f32> = (0..count).map(|key| 0.1 + 0.3 * key as f32).collect();
    let vectors: Vec<Vec3> = times.iter().map(|_| random.vec3()).collect();
    let rotations: Vec<Quat> = times.iter().map(|_| random.quat()).collect();
    let weights: Vec<f32> = (0..2 * count).map(|_| random.f32()).collect();
    for interpolation in [Step, Linear, CubicSpline] {
        let entry =
            |key: usize| if interpolation == CubicSpline { vec![usize::MAX, key, usize::MAX] } else { vec![key] };
        let entries: Vec<usize> = (0..count).flat_map(entry).collect();
        let vectors_of = entries.iter().map(|&key| vectors.get(key).copied().unwrap_or(Vec3::ONE)).collect::<Vec<_>>();
        let rotations_of = entries.iter().map(|&key| rotations.get(key).copied().unwrap_or(Quat::IDENTITY)).collect();
        let weights_of = entries.iter().flat_map(|&key| {
            let key = key.min(count);
            [0, 1].map(|target| weights.get(2 * key + target).copied().unwrap_or(0.5))
        });
        let skeleton = one_joint();
        let mut builder = ClipBuilder::new("", &skeleton);
        let weights_of = Keys::MorphWeights { values: weights_of.collect(), targets: 2 };
        for keys in [Keys::Translation(vectors_of.clone()), Keys::Scale(vectors_of), Keys::Rotation(rotations_of)] {
            builder.channel(JointIndex(0), interpolation, &times, keys).unwrap();
        }
        builder.channel(JointIndex(0), interpolation, &times, weights_of).unwrap();
        let clip = builder.build();
        for key in 0..count {
            let pose = sample(&clip, times[key]);
            assert_eq!(pose.local(JointIndex(0)).translation, vectors[key], "{interpolation:?}, key {key}");
            assert_eq!(pose.local(JointIndex(0)).scale, vectors[key], "{interpolation:?}, key {key}");
            assert!(
                same_rotation(pose.local(JointIndex(0)).rotation, rotations[key], 1.2e-7),
                "{interpolation:?}, key {key}"
            );
            assert_eq!(pose.morph_weights, weights[2 * key..2 * key + 2], "{interpolation:?}, key {key}");
        }
    }
}

#[test]
fn the_nearest_key_holds_outside_the_keys() {
    let skeleton = one_joint();
    let values = vec![Vec3::X, Vec3::Y, Vec3::Z];
    for interpolation in [Step, Linear, CubicSpline] {
        let keys = match interpolation {
            CubicSpline => values.iter().flat_map(|&value| [Vec3::ONE, value, Vec3::ONE]).collect(),
            _ => values.clone(),
        };
        let clip = one_channel(&skeleton, interpolation, &[1.0, 2.0, 3.0], Keys::Translation(keys));
        for (time, expected) in
            [(-1e9, Vec3::X), (0.0, Vec3::X), (0.999, Vec3::X), (3.0, Vec3::Z), (3.001, Vec3::Z), (1e30, Vec3::Z)]
        {
            assert_eq!(sample(&clip, time).local(JointIndex(0)).translation, expected, "{interpolation:?} at {time}");
        }
    }
}

#[test]
fn nan_gives_a_key() {
    let clip = one_channel(&one_joint(), Linear, &[0.0, 1.0], Keys::Translation(vec![Vec3::X, Vec3::Y]));
    assert_eq!(sample(&clip, f32::NAN).local(JointIndex(0)).translation, Vec3::X);
}

#[test]
fn a_single_key_holds_at_every_time() {
    let skeleton = one_joint();
    for interpolation in [Step, Linear, CubicSpline] {
        let rotation = Quat::from_rotation_x(1.0);
        let keys = match interpolation {
            CubicSpline => vec![Quat::from_xyzw(9.0, 9.0, 9.0, 9.0), rotation, Quat::from_xyzw(-9.0, 3.0, 0.0, 1.0)],
            _ => vec![rotation],
        };
        let clip = one_channel(&skeleton, interpolation, &[0.5], Keys::Rotation(keys));
        for time in [-1.0, 0.0, 0.5, 2.0] {
            assert!(
                same_rotation(sample(&clip, time).local(JointIndex(0)).rotation, rotation, 1.2e-7),
                "{interpolation:?} {time}"
            );
        }
    }
}

#[test]
fn step_keeps_a_value_until_the_next_key() {
    let keys = Keys::Translation(vec![Vec3::X, Vec3::Y, Vec3::Z]);
    let clip = one_channel(&one_joint(), Step, &[0.0, 1.0, 2.0], keys);
    for (time, expected) in [(0.0, Vec3::X), (0.999_99, Vec3::X), (1.0, Vec3::Y), (1.999_99, Vec3::Y), (2.0, Vec3::Z)] {
        assert_eq!(sample(&clip, time).local(JointIndex(0)).translation, expected, "at {time}");
    }
}

#[test]
fn linear_interpolates_linearly() {
    let keys = Keys::Scale(vec![Vec3::ZERO, Vec3::new(2.0, 4.0, -8.0), Vec3::ONE]);
    let clip = one_channel(&one_joint(), Linear, &[1.0, 3.0, 4.0], keys);
    let halfway = sample(&clip, 1.5).local(JointIndex(0)).scale;
    assert!(halfway.abs_diff_eq(Vec3::new(0.5, 1.0, -2.0), 1e-6), "{halfway}");
}

/// Slerp as defined in appendix C.3, in f64.
fn slerp(from: Quat, to: Quat, factor: f64) -> DQuat {
    let (from, to) = (from.as_dquat().normalize(), to.as_dquat().normalize());
    let cos = from.dot(to);
    let angle = cos.abs().min(1.0).acos();
    if angle < 1e-9 {
        return from;
    }
    let sign = cos.signum();
    from * (((1.0 - factor) * angle).sin() / angle.sin()) + to * (sign * (factor * angle).sin() / angle.sin())
}

#[test]
fn rotations_follow_the_shortest_arc_at_constant_speed() {
    let mut random = Random(5);
    for round in 0..400 {
        let from = random.quat();
        // Small and large angles, and the negated quaternion of the same rotation.
        let angle = [1e-4, 0.01, 0.3, 0.8, 1.1, 2.0, 3.0, 3.1][round % 8];
        let to = Quat::from_axis_angle(random.vec3().normalize(), angle) * from;
        let to = if round % 3 == 0 { -to } else { to };
        let clip = one_channel(&one_joint(), Linear, &[0.0, 1.0], Keys::Rotation(vec![from, to]));
        for step in 0..=10 {
            let factor = step as f32 / 10.0;
            let found = sample(&clip, factor).local(JointIndex(0)).rotation;
            let expected = slerp(from, to, f64::from(factor)).as_quat();
            assert!(
                same_rotation(found, expected, 1e-6),
                "{found} for {from} to {to} at {factor}, expected {expected}"
            );
            assert!((found.length() - 1.0).abs() < 1e-6, "{found} is {} long", found.length());
        }
    }
}

#[test]
fn rotations_that_share_a_timeline_are_independent() {
    for count in [1, 2, 3, 4, 5, 8, 11] {
        let skeleton = chain(count);
        let mut random = Random(count as u64);
        let times = [0.0, 0.5, 0.75, 2.0];
        let keys: Vec<Vec<Quat>> = (0..count)
            .map(|joint| {
                let mut at = random.quat();
                let keys = times.map(|_| {
                    at = Quat::from_axis_angle(random.vec3().normalize(), 0.3 * joint as f32) * at;
                    at
                });
                keys.to_vec()
            })
            .collect();
        let mut builder = ClipBuilder::new("", &skeleton);
        for (joint, keys) in skeleton.joints().zip(&keys) {
            builder.channel(joint, Linear, &times, Keys::Rotation(keys.clone())).unwrap();
        }
        let clip = builder.build();
        let mut cursor = SampleCursor::default();
        let mut pose = skeleton.rest().clone();
        for step in 0..40 {
            let time = step as f32 * 0.05;
            clip.sample(&skeleton, time, &mut cursor, &mut pose);
            let segment = times.iter().rposition(|&start| start <= time).unwrap().min(2);
            let factor = f64::from(time - times[segment]) / f64::from(times[segment + 1] - times[segment]);
            for (joint, (keys, local)) in keys.iter().zip(pose.locals()).enumerate() {
                let expected = slerp(keys[segment], keys[segment + 1], factor).as_quat();
                let found = local.rotation;
                assert!(
                    same_rotation(found, expected, 1e-6),
                    "joint {joint} of {count} at {time}: {found}, {expected}"
                );
            }
        }
    }
}

#[test]
fn rotation_keys_need_not_be_normalized() {
    let keys = vec![Quat::from_xyzw(0.0, 0.0, 0.0, 3.0), Quat::from_xyzw(0.0, 0.5, 0.0, 0.5)];
    let clip = one_channel(&one_joint(), Linear, &[0.0, 1.0], Keys::Rotation(keys));
    for (time, degrees) in [(0.0, 0.0), (0.5, 45.0), (1.0, 90.0)] {
        let expected = Quat::from_rotation_y(f32::to_radians(degrees));
        assert!(same_rotation(sample(&clip, time).local(JointIndex(0)).rotation, expected, 1e-6), "at {time}");
    }
    let zero = vec![Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0)];
    for interpolation in [Step, Linear] {
        let clip = one_channel(&one_joint(), interpolation, &[0.0, 1.0], Keys::Rotation(zero.clone()));
        for time in [0.0, 0.5, 1.0] {
            assert_eq!(
                sample(&clip, time).local(JointIndex(0)).rotation,
                Quat::IDENTITY,
                "{interpolation:?} at {time}"
            );
        }
    }
}

/// Hermite spline of appendix C.4 in f64; tangents per second.
fn hermite(from: f64, out_tangent: f64, in_tangent: f64, to: f64, length_secs: f64, t: f64) -> f64 {
    let (t2, t3) = (t * t, t * t * t);
    (2.0 * t3 - 3.0 * t2 + 1.0) * from
        + length_secs * (t3 - 2.0 * t2 + t) * out_tangent
        + (-2.0 * t3 + 3.0 * t2) * to
        + length_secs * (t3 - t2) * in_tangent
}

#[test]
fn cubic_splines_match_appendix_c() {
    let mut random = Random(21);
    let times = [0.25, 0.75, 2.25];
    let vectors: Vec<Vec3> = (0..9).map(|_| random.vec3()).collect();
    let rotations: Vec<Quat> = (0..9)
        .map(|entry| if entry % 3 == 1 { random.quat() } else { Quat::from_vec4(random.vec3().extend(0.3)) })
        .collect();
    let weights: Vec<f32> = (0..18).map(|_| random.f32()).collect();
    let skeleton = one_joint();
    let mut builder = ClipBuilder::new("", &skeleton);
    for keys in [
        Keys::Translation(vectors.clone()),
        Keys::Scale(vectors.iter().map(|value| -2.0 * *value).collect()),
        Keys::Rotation(rotations.clone()),
        Keys::MorphWeights { values: weights.clone(), targets: 2 },
    ] {
        builder.channel(JointIndex(0), CubicSpline, &times, keys).unwrap();
    }
    let clip = builder.build();
    for step in 0..=40 {
        let time = 0.25 + step as f32 * 0.05;
        let segment = usize::from(time >= times[1]);
        let length = f64::from(times[segment + 1] - times[segment]);
        let t = (f64::from(time) - f64::from(times[segment])) / length;
        let at = |value: &dyn Fn(usize) -> f32| {
            let value = |entry| f64::from(value(entry));
            let (from, to) = (3 * segment, 3 * segment + 3);
            hermite(value(from + 1), value(from + 2), value(to), value(to + 1), length, t)
        };
        let pose = sample(&clip, time);
        for axis in [0, 1, 2] {
            let expected = at(&|entry| vectors[entry][axis]);
            assert!(
                (f64::from(pose.local(JointIndex(0)).translation[axis]) - expected).abs() < 2e-6,
                "translation at {time}"
            );
            assert!(
                (f64::from(pose.local(JointIndex(0)).scale[axis]) + 2.0 * expected).abs() < 4e-6,
                "scale at {time}"
            );
        }
        let expected = DVec4::from_array([0, 1, 2, 3].map(|axis| at(&|entry| rotations[entry].to_array()[axis])));
        let expected = DQuat::from_vec4(expected.normalize()).as_quat();
        assert!((pose.local(JointIndex(0)).rotation - expected).length() < 2e-6, "rotation at {time}");
        for target in 0..2 {
            let expected = at(&|entry| weights[2 * entry + target]);
            assert!((f64::from(pose.morph_weights[target]) - expected).abs() < 2e-6, "weight at {time}");
        }
    }
}

#[test]
fn a_flat_spline_with_tangents_is_not_flat() {
    let keys = [-1.0, 0.0, 1.0, -1.0, 0.0, 1.0].map(|x| Vec3::X * x).to_vec();
    let clip = one_channel(&one_joint(), CubicSpline, &[0.0, 1.0], Keys::Translation(keys));
    let found = sample(&clip, 0.5).local(JointIndex(0)).translation.x;
    assert!((found - 0.25).abs() < 1e-6, "{found}");
}

#[test]
fn morph_weights_interpolate_linearly_and_in_steps() {
    let keys = Keys::MorphWeights { values: vec![0.0, 1.0, 1.0, 0.5], targets: 2 };
    let clip = one_channel(&one_joint(), Linear, &[0.0, 2.0], keys.clone());
    assert_eq!(sample(&clip, 0.5).morph_weights, [0.25, 0.875]);
    let clip = one_channel(&one_joint(), Step, &[0.0, 2.0], keys);
    assert_eq!(sample(&clip, 1.99).morph_weights, [0.0, 1.0]);
}

#[test]
fn properties_without_a_channel_are_left_alone() {
    let skeleton = chain(3);
    let clip = one_channel(&skeleton, Linear, &[0.0, 1.0], Keys::Scale(vec![Vec3::ONE, Vec3::splat(3.0)]));
    let mut pose = skeleton.rest().clone();
    clip.sample(&skeleton, 0.5, &mut SampleCursor::default(), &mut pose);
    assert_eq!(pose.local(JointIndex(0)).scale, Vec3::splat(2.0));
    pose.set_scale(JointIndex(0), Vec3::ONE);
    assert_eq!(&pose, skeleton.rest());
}

#[test]
fn the_last_channel_of_a_property_wins() {
    let skeleton = one_joint();
    let same = || Keys::Translation(vec![Vec3::X; 2]);
    let moving = || Keys::Translation(vec![Vec3::ZERO, 2.0 * Vec3::Y]);
    let cubic = || Keys::Translation(vec![Vec3::ZERO, Vec3::Z, Vec3::ZERO, Vec3::ZERO, Vec3::Z, Vec3::ZERO]);
    for (first, second, expected) in [
        ((Linear, same()), (Linear, moving()), Vec3::Y),
        ((Linear, moving()), (Linear, same()), Vec3::X),
        ((CubicSpline, cubic()), (Linear, moving()), Vec3::Y),
        ((Linear, moving()), (CubicSpline, cubic()), Vec3::Z),
    ] {
        let mut builder = ClipBuilder::new("", &skeleton);
        builder.channel(JointIndex(0), first.0, &[0.0, 1.0], first.1).unwrap();
        builder.channel(JointIndex(0), second.0, &[0.0, 1.0], second.1).unwrap();
        assert_eq!(sample(&builder.build(), 0.5).local(JointIndex(0)).translation, expected);
    }
}

/// Channels of all kinds on uneven timelines.
fn busy() -> (gaitway_character::anim::Skeleton, Clip) {
    let skeleton = chain(13);
    let mut random = Random(31);
    let timelines = [vec![0.0, 0.1, 0.5, 0.6, 3.0], vec![0.2], (0..90).map(|key| key as f32 / 30.0).collect()];
    let mut builder = ClipBuilder::new("", &skeleton);
    for joint in skeleton.joints() {
        for (at, interpolation) in [Step, Linear, CubicSpline].into_iter().enumerate() {
            let times = &timelines[(joint.get() + at) % 3];
            let entries = times.len() * if interpolation == CubicSpline { 3 } else { 1 };
            let keys = match (joint.get() + 2 * at) % 3 {
                0 => Keys::Translation((0..entries).map(|_| random.vec3()).collect()),
                1 => Keys::Rotation((0..entries).map(|_| random.quat()).collect()),
                _ => Keys::Scale((0..entries).map(|_| random.vec3()).collect()),
            };
            builder.channel(joint, interpolation, times, keys).unwrap();
        }
    }
    let clip = builder.build();
    (skeleton, clip)
}

#[test]
fn the_cursor_does_not_affect_the_result() {
    let (skeleton, clip) = busy();
    let mut random = Random(8);
    let mut used = SampleCursor::default();
    let (mut with_used, mut with_fresh) = (skeleton.rest().clone(), skeleton.rest().clone());
    for step in 0..500 {
        // Forwards, backwards, then random times.
        let time = match step {
            0..200 => step as f32 * 0.02,
            200..300 => (300 - step) as f32 * 0.04,
            _ => 5.0 * random.f32() - 1.0,
        };
        clip.sample(&skeleton, time, &mut used, &mut with_used);
        clip.sample(&skeleton, time, &mut SampleCursor::default(), &mut with_fresh);
        assert_eq!(with_used, with_fresh, "at {time}");
    }
}

#[test]
fn a_cursor_can_be_shared_between_clips() {
    let (skeleton, clip) = busy();
    let short = one_channel(&skeleton, Linear, &[0.0, 1.0], zeros(2));
    let mut cursor = SampleCursor::default();
    let (mut pose, mut expected) = (skeleton.rest().clone(), skeleton.rest().clone());
    for time in [2.9, 0.05, 1.0] {
        clip.sample(&skeleton, 2.95, &mut cursor, &mut pose);
        pose.copy_from(skeleton.rest());
        expected.copy_from(skeleton.rest());
        short.sample(&skeleton, time, &mut cursor, &mut pose);
        short.sample(&skeleton, time, &mut SampleCursor::default(), &mut expected);
        assert_eq!(pose, expected);
    }
}

/// A file may round the length of a frame; few keys needn't be frames.
#[test]
fn the_frame_rate_is_that_of_the_densest_channel() {
    let rate = |count: usize, frame_secs: f32| {
        let skeleton = one_joint();
        let mut builder = ClipBuilder::new("", &skeleton);
        for times in [vec![0.0], (0..count).map(|frame| frame as f32 * frame_secs).collect()] {
            let keys = Keys::Scale(vec![Vec3::ONE; times.len()]);
            builder.channel(JointIndex(0), Linear, &times, keys).unwrap();
        }
        builder.build().frames_per_sec()
    };
    assert_eq!(rate(150, 1.0 / 120.0), 120.0);
    assert_eq!(rate(90, 0.05), 20.0);
    assert!((rate(150, 0.008_33) - 120.05).abs() < 0.01, "{}", rate(150, 0.008_33));
    assert_eq!(rate(5, 0.313), Clip::DEFAULT_FRAMES_PER_SEC);
    assert_eq!(rate(20, 0.313), Clip::DEFAULT_FRAMES_PER_SEC);
}
