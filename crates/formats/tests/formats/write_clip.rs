//! Clips written alone as BVH and as VRM animations: read again, every joint is where it was.

use gaitway_character::anim::{
    Clip, ClipBuilder, Interpolation, Joint, JointIndex, Keys, PropertyTarget, PropertyValues, SampleCursor, Transform,
};
use gaitway_character::asset::{Asset, AssetParts, Humanoid, Slot};
use gaitway_character::avatar::{Avatar, Expression};
use gaitway_formats::{WriteError, write_bvh, write_vrma};
use glam::{Quat, Vec3};

use crate::read_back::{read_bvh, read_vrma, world};
use crate::skeletons::joint;

/// A scaled container, rotated rests, a joint in between that isn't written, equal names, and joints that are moved.
fn crooked() -> (Asset, Vec<JointIndex>) {
    let turned = |at: Vec3, turn: Quat| Transform { rotation: turn, ..Transform::from_translation(at) };
    let scaled = Transform { scale: Vec3::splat(0.01), rotation: Quat::from_rotation_x(-1.5), ..Transform::IDENTITY };
    let joints = vec![
        joint("armature", None, scaled),
        joint("hips", Some(0), turned(Vec3::new(0.0, 20.0, 90.0), Quat::from_rotation_z(0.4))),
        joint("between", Some(1), turned(Vec3::new(3.0, 10.0, 0.0), Quat::from_rotation_y(1.0))),
        joint("a bone", Some(2), turned(Vec3::new(0.0, 30.0, 0.0), Quat::from_rotation_x(2.0))),
        joint("a bone", Some(3), turned(Vec3::new(5.0, 30.0, 0.0), Quat::IDENTITY)),
        joint("", Some(1), turned(Vec3::new(-5.0, -40.0, 0.0), Quat::from_rotation_z(3.0))),
    ];
    let asset = crate::skeletons::asset(joints);
    (asset, [1, 3, 4, 5].map(JointIndex).to_vec())
}

fn moving(asset: &Asset, seconds: &[f32]) -> Clip {
    let mut builder = ClipBuilder::new("moving", &asset.skeleton);
    for joint in asset.skeleton.joints() {
        let rest = asset.skeleton.rest().local(joint);
        let turn = |secs: &f32| {
            rest.rotation * Quat::from_rotation_z(secs * (2.0 + joint.0 as f32)) * Quat::from_rotation_x(*secs)
        };
        let keys = Keys::Rotation(seconds.iter().map(turn).collect());
        builder.channel(joint, Interpolation::Linear, seconds, keys).expect("a channel");
        if joint.0 % 2 == 1 {
            let at = |secs: &f32| rest.translation + Vec3::new(10.0 * secs, 0.0, -secs);
            let keys = Keys::Translation(seconds.iter().map(at).collect());
            builder.channel(joint, Interpolation::Linear, seconds, keys).expect("a channel");
        }
    }
    builder.build()
}

#[test]
fn a_bvh_has_every_written_joint_where_the_clip_has_it() {
    let (asset, joints) = crooked();
    let seconds: Vec<f32> = (0..41).map(|frame| frame as f32 / 40.0).collect();
    let clip = moving(&asset, &seconds);
    let written = read_bvh(write_bvh(&asset, &asset.skeleton, &joints, &clip, 30.0).expect("is written"));
    let names: Vec<&str> = written.skeleton.joints().map(|joint| written.skeleton.name(joint)).collect();
    assert_eq!(names, ["hips", "a_bone", "a_bone_2", "joint_5"]);
    let again = &written.clips[0];
    assert_eq!(again.timelines()[0].len(), seconds.len(), "keys are frames");
    for &secs in &seconds {
        let (expected, found) = (world(&asset, &clip, secs), world(&written, again, secs));
        for (place, joint) in joints.iter().enumerate() {
            let off = expected[joint.get()].distance(found[place]);
            assert!(off < 2e-5, "{} at {secs}: {} instead of {}", names[place], found[place], expected[joint.get()]);
        }
    }
    let text = String::from_utf8(write_bvh(&asset, &asset.skeleton, &joints, &clip, 30.0).expect("is written"))
        .expect("UTF-8");
    assert_eq!(text.matches("CHANNELS 6").count(), 3, "the root, what is moved, and what hangs on a joint in between");
}

/// Angles run on instead of jumping from 180° to −180°, where other programs would interpolate through everything.
#[test]
fn angles_of_a_bvh_are_continuous() {
    let asset = crate::skeletons::asset(vec![joint("spin", None, Transform::IDENTITY)]);
    let seconds: Vec<f32> = (0..101).map(|frame| frame as f32 / 50.0).collect();
    let mut builder = ClipBuilder::new("spin", &asset.skeleton);
    let turns = seconds.iter().map(|secs| Quat::from_rotation_y(6.0 * secs) * Quat::from_rotation_x(0.5));
    builder
        .channel(JointIndex(0), Interpolation::Linear, &seconds, Keys::Rotation(turns.collect()))
        .expect("a channel");
    let bytes = write_bvh(&asset, &asset.skeleton, &[JointIndex(0)], &builder.build(), 30.0).expect("is written");
    let text = String::from_utf8(bytes).expect("UTF-8");
    let frames = text.lines().skip_while(|line| !line.starts_with("Frame Time")).skip(1);
    let angles: Vec<Vec<f32>> =
        frames.map(|line| line.split(' ').skip(3).map(|word| word.parse().expect("a number")).collect()).collect();
    assert_eq!(angles.len(), 101);
    for pair in angles.windows(2) {
        let step = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(step < 20.0, "{pair:?}");
    }
    let turned = angles.last().expect("frames").iter().map(|angle| angle.abs()).fold(0.0, f32::max);
    assert!(turned > 360.0, "{turned}");
}

#[test]
fn uneven_keys_are_sampled_at_the_rate_given() {
    let (asset, joints) = crooked();
    let clip = moving(&asset, &[0.0, 0.03, 0.5, 0.52]);
    let written = read_bvh(write_bvh(&asset, &asset.skeleton, &joints, &clip, 50.0).expect("is written"));
    assert_eq!(written.clips[0].timelines()[0].len(), 27);
    assert!((written.clips[0].duration_secs() - 0.52).abs() < 1e-6);
    let still = ClipBuilder::new("still", &asset.skeleton).build();
    let written = read_bvh(write_bvh(&asset, &asset.skeleton, &joints, &still, 50.0).expect("is written"));
    assert_eq!(written.clips[0].timelines()[0].len(), 1, "one frame");
    let error = write_bvh(&asset, &asset.skeleton, &[], &clip, 30.0).expect_err("no joints");
    assert!(matches!(error, WriteError::EmptyClip { .. }), "{error}");
}

#[test]
fn a_joint_scaled_to_nothing_is_written_without_rotation() {
    let (asset, joints) = crooked();
    let mut builder = ClipBuilder::new("hidden", &asset.skeleton);
    let sizes = Keys::Scale(vec![Vec3::ONE, Vec3::ZERO]);
    builder.channel(JointIndex(4), Interpolation::Linear, &[0.0, 0.5], sizes).expect("a channel");
    let written = read_bvh(write_bvh(&asset, &asset.skeleton, &joints, &builder.build(), 30.0).expect("is written"));
    assert!(world(&written, &written.clips[0], 0.5).iter().all(|at| at.is_finite()));
}

#[test]
fn an_endless_clip_is_refused() {
    let (asset, joints) = crooked();
    for end_secs in [1e9, 1e30] {
        let clip = moving(&asset, &[0.0, end_secs]);
        let error = write_bvh(&asset, &asset.skeleton, &joints, &clip, 30.0).expect_err("too many frames");
        assert!(matches!(error, WriteError::TooLong { .. }) && error.to_string().contains("1000000 frames"), "{error}");
    }
    // The more joints it has, the fewer frames. A root joins these.
    let hands = crate::skeletons::asset(vec![joint("hand", None, Transform::IDENTITY); 1000]);
    let all: Vec<JointIndex> = hands.skeleton.joints().collect();
    let clip = moving(&hands, &[0.0, 1e3]);
    let error = write_bvh(&hands, &hands.skeleton, &all, &clip, 30.0).expect_err("too many frames").to_string();
    assert!(error.contains("at most 12570 frames, found 30001"), "{error}");
}

/// A body in an A-pose that faces −Z, with rotated rests. Its arms hang by 45°.
fn body(declared: bool) -> (Asset, Humanoid) {
    use Slot::*;
    let turn = Quat::from_rotation_y(0.7) * Quat::from_rotation_z(-0.3);
    let bones: [(Slot, Option<usize>, Vec3); 9] = [
        (Hips, None, Vec3::new(0.1, 1.0, 0.2)),
        (Spine, Some(0), Vec3::new(0.0, 0.2, 0.0)),
        (Head, Some(1), Vec3::new(0.0, 0.4, 0.0)),
        (LeftUpperArm, Some(1), Vec3::new(-0.2, 0.3, 0.0)),
        (LeftLowerArm, Some(3), Vec3::new(-0.2, -0.2, 0.0)),
        (LeftHand, Some(4), Vec3::new(-0.2, -0.2, 0.0)),
        (LeftUpperLeg, Some(0), Vec3::new(-0.1, 0.0, 0.0)),
        (LeftLowerLeg, Some(6), Vec3::new(-0.1, -0.5, 0.0)),
        (LeftFoot, Some(7), Vec3::new(0.0, -0.5, 0.0)),
    ];
    // Every joint's rest has the same rotation in model space, so offsets are turned back.
    let at_rest = |&(slot, parent, offset): &(Slot, Option<usize>, Vec3)| {
        let inside = parent.is_some();
        let translation = if inside { turn.inverse() * offset } else { offset };
        let rotation = if inside { Quat::IDENTITY } else { turn };
        joint(slot.name(), parent, Transform { rotation, ..Transform::from_translation(translation) })
    };
    let mut joints: Vec<Joint> = bones.iter().map(at_rest).collect();
    joints.push(joint("tail", Some(0), Transform::from_translation(Vec3::Z)));
    let skeleton = gaitway_character::anim::Skeleton::new(joints).expect("a tree");
    let slots = Humanoid(bones.iter().map(|bone| (bone.0, skeleton.find(bone.0.name()).expect("a joint"))).collect());
    let expressions = vec![Expression::new("happy", "happy", true), Expression::new("wink", "wink", false)];
    let avatar = Avatar { expressions, ..Avatar::default() };
    let humanoid = declared.then(|| slots.clone());
    let parts = AssetParts { skeleton, humanoid, avatar, ..AssetParts::default() };
    (Asset::new(parts).expect("is valid"), slots)
}

#[test]
fn a_vrma_has_every_bone_where_the_clip_has_it_and_rests_in_a_t_pose() {
    let seconds: Vec<f32> = (0..13).map(|frame| frame as f32 / 12.0).collect();
    for declared in [false, true] {
        let (asset, slots) = body(declared);
        let mut builder = ClipBuilder::new("wave", &asset.skeleton);
        for &joint in slots.0.values() {
            let rest = asset.skeleton.rest().local(joint);
            let turn = |secs: &f32| rest.rotation * Quat::from_rotation_z(secs * (1.0 + joint.0 as f32));
            let keys = Keys::Rotation(seconds.iter().map(turn).collect());
            builder.channel(joint, Interpolation::Linear, &seconds, keys).expect("a channel");
        }
        let keys = Keys::Translation(vec![Vec3::ONE, Vec3::new(2.0, 1.0, -3.0)]);
        builder.channel(slots.0[&Slot::Hips], Interpolation::Step, &[0.0, 0.5], keys).expect("a channel");
        let clip = builder.build();
        let written = read_vrma(write_vrma(&asset, &slots, Some(Vec3::NEG_Z), &clip).expect("is written"));
        let bones = written.humanoid.as_ref().expect("declares its bones");
        assert_eq!(bones.0.len(), slots.0.len());
        // Declared humanoids of VRM 1.0 face +Z already.
        let turn = if declared { Quat::IDENTITY } else { Quat::from_rotation_y(std::f32::consts::PI) };
        let again = &written.clips[0];
        for secs in [0.0, 0.21, 0.5, 0.77, 1.0] {
            let (expected, found) = (world(&asset, &clip, secs), world(&written, again, secs));
            for (slot, joint) in &slots.0 {
                let expected = turn * expected[joint.get()];
                let found = found[bones.0[slot].get()];
                assert!(expected.distance(found) < 1e-5, "{slot:?} at {secs}: {found} instead of {expected}");
            }
        }
        let rest = world(&written, &ClipBuilder::new("", &written.skeleton).build(), 0.0);
        let direction = |from: Slot, to: Slot| (rest[bones.0[&to].get()] - rest[bones.0[&from].get()]).normalize();
        let arm = direction(Slot::LeftUpperArm, Slot::LeftHand);
        let leg = direction(Slot::LeftUpperLeg, Slot::LeftFoot);
        let expected = if declared { (Vec3::new(-1.0, -1.0, 0.0).normalize(), leg) } else { (Vec3::X, Vec3::NEG_Y) };
        assert!(arm.distance(expected.0) < 1e-5 && leg.distance(expected.1) < 1e-5, "{arm} {leg}");
        // The keys are the clip's, not sampled ones.
        let lengths: Vec<usize> =
            again.channels().iter().map(|channel| again.timelines()[channel.timeline as usize].len()).collect();
        assert!(lengths.iter().all(|&keys| keys == 13 || keys == 2), "{lengths:?}");
    }
}

/// Widely used players take the tangents of a spline for keys.
#[test]
fn splines_become_linear_keys_of_a_vrma() {
    let (asset, slots) = body(true);
    let (hips, arm) = (slots.0[&Slot::Hips], slots.0[&Slot::LeftUpperArm]);
    let (times, still) = ([0.0, 1.0], Quat::from_xyzw(0.0, 0.0, 0.0, 0.0));
    let rest = asset.skeleton.rest().local(arm).rotation;
    let turns = vec![still, rest, Quat::from_xyzw(2.0, 0.0, 0.0, 0.0), still, rest * Quat::from_rotation_x(1.5), still];
    let places = vec![Vec3::ZERO, Vec3::Y, Vec3::new(4.0, 0.0, 0.0), Vec3::ZERO, Vec3::new(0.0, 1.5, 0.0), Vec3::ZERO];
    let mut builder = ClipBuilder::new("swing", &asset.skeleton);
    let spline = Interpolation::CubicSpline;
    builder.channel(arm, spline, &times, Keys::Rotation(turns)).expect("a channel");
    builder.channel(hips, spline, &times, Keys::Translation(places)).expect("a channel");
    builder
        .property(PropertyTarget::Expression(0), spline, &times, vec![0.0, 0.0, 3.0, 0.0, 1.0, 0.0])
        .expect("a channel");
    let clip = builder.build();
    let written = read_vrma(write_vrma(&asset, &slots, None, &clip).expect("is written"));
    let again = &written.clips[0];
    let channels = again.channels().iter().map(|channel| channel.interpolation);
    let properties = again.properties().iter().map(|channel| channel.interpolation);
    assert!(channels.chain(properties).all(|interpolation| interpolation == Interpolation::Linear));
    let bones = written.humanoid.as_ref().expect("declares its bones");
    for secs in (0..=100).map(|step| step as f32 / 100.0) {
        let (expected, found) = (world(&asset, &clip, secs), world(&written, again, secs));
        for (slot, joint) in &slots.0 {
            let (expected, found) = (expected[joint.get()], found[bones.0[slot].get()]);
            assert!(expected.distance(found) < 1e-3, "{slot:?} at {secs}: {found} instead of {expected}");
        }
        let weight = |clip: &Clip| {
            let mut values = PropertyValues::default();
            clip.sample_properties(secs, &mut SampleCursor::default(), &mut values);
            values.get(PropertyTarget::Expression(0)).expect("a weight").x
        };
        assert!((weight(&clip) - weight(again)).abs() < 1e-3, "the weight at {secs}");
    }
}

#[test]
fn a_vrma_carries_the_weights_of_expressions() {
    let (asset, slots) = body(true);
    let mut builder = ClipBuilder::new("smile", &asset.skeleton);
    for (index, values) in [vec![0.0, 1.0], vec![0.5, 0.25]].into_iter().enumerate() {
        let target = PropertyTarget::Expression(index);
        builder.property(target, Interpolation::Linear, &[0.0, 2.0], values).expect("a channel");
    }
    let written = read_vrma(write_vrma(&asset, &slots, None, &builder.build()).expect("is written"));
    let names: Vec<(&str, bool)> =
        written.avatar.expressions.iter().map(|expression| (expression.name.as_str(), expression.is_preset)).collect();
    assert_eq!(names, [("happy", true), ("wink", false)]);
    let values: Vec<&[f32]> = written.clips[0].properties().iter().map(|channel| &*channel.values).collect();
    assert_eq!(values, [[0.0, 1.0], [0.5, 0.25]]);
}

#[test]
fn only_bodies_become_vrm_animations() {
    let (asset, _) = crooked();
    let clip = moving(&asset, &[0.0, 1.0]);
    let error = write_vrma(&asset, &Humanoid::default(), None, &clip).expect_err("nothing to write");
    assert!(matches!(error, WriteError::NoBody { .. }), "{error}");
}
