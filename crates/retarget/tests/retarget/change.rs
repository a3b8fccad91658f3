//! Laws of changed clips: at any time, and not only at keys.

use gaitway_character::anim::{
    Clip, ClipBuilder, Interpolation, Joint, JointIndex, Keys, PropertyTarget, SampleCursor, Skeleton, TimeRange,
    Transform, model_from_joint,
};
use gaitway_character::asset::{Asset, AssetParts, MeshInstance, Slot};
use gaitway_character::avatar::{Avatar, Expression};
use gaitway_character::mesh::{Mesh, Skin};
use gaitway_retarget::{ChangedClip, ClipChanges, Symmetry, change_clip, recognize};
use glam::{Affine3A, DQuat, DVec3, Quat, Vec3};

use crate::figure::{Figure, Rig, build};
use crate::laws::degrees;

pub const KINDS: [Interpolation; 3] = [Interpolation::Step, Interpolation::Linear, Interpolation::CubicSpline];
const NONE: ClipChanges = ClipChanges::NONE;

pub fn dancer(interpolation: Interpolation) -> Figure {
    let mut figure = build(&Rig { axes: 3, armature: true, ..Rig::default() });
    figure.dance(5, 60.0, interpolation);
    figure
}

fn symmetry(asset: &Asset) -> Symmetry {
    Symmetry::of(asset, &recognize(asset))
}

fn changed(figure: &Figure, clip: &Clip, changes: &ClipChanges) -> ChangedClip {
    change_clip(&figure.asset, clip, changes, || symmetry(&figure.asset))
}

/// Rotations and positions of all joints in model space agree.
fn check_same(figure: &Figure, one: (&Clip, f32), other: (&Clip, f32), tolerance: f64) {
    let (one, other) = (figure.world(one.0, one.1), figure.world(other.0, other.1));
    for (joint, (a, b)) in one.iter().zip(&other).enumerate() {
        assert!(a.1.distance(b.1) < tolerance, "joint {joint}: {} and {}", a.1, b.1);
        assert!(degrees(a.0, b.0).to_radians() < 10.0 * tolerance, "joint {joint}: {} apart", degrees(a.0, b.0));
    }
}

/// Between the keys of any channel.
pub fn times(clip: &Clip) -> impl Iterator<Item = f32> + use<> {
    let duration_secs = clip.duration_secs();
    (1..40).map(move |step| duration_secs * (step as f32 + 0.37) / 41.0)
}

fn key_count(clip: &Clip) -> usize {
    clip.channels().iter().map(|channel| clip.timelines()[channel.timeline as usize].len()).sum()
}

#[test]
fn mirrored_twice_is_the_clip() {
    let mirror = ClipChanges { mirror: true, ..NONE };
    for kind in KINDS {
        let figure = dancer(kind);
        let clip = &figure.asset.clips[0];
        let once = changed(&figure, clip, &mirror).clip;
        let twice = changed(&figure, &once, &mirror).clip;
        assert_eq!((key_count(&once), key_count(&twice)), (key_count(clip), key_count(clip)));
        for time in times(clip) {
            check_same(&figure, (clip, time), (&twice, time), 1e-6 * 1.7);
        }
    }
}

#[test]
fn a_mirrored_clip_is_seen_in_a_mirror() {
    for (axes, facing_degrees, arms_down_degrees) in [(3, 0.0, 0.0), (4, 90.0, 0.0), (5, 180.0, 50.0), (6, 0.0, 50.0)] {
        let across = DQuat::from_rotation_y(f64::to_radians(facing_degrees)) * DVec3::X;
        for kind in KINDS {
            let rig = Rig { axes, facing_degrees, arms_down_degrees, armature: true, ..Rig::default() };
            let mut figure = build(&rig);
            figure.dance(5, 60.0, kind);
            let clip = &figure.asset.clips[0];
            let mirrored = changed(&figure, clip, &ClipChanges { mirror: true, ..NONE }).clip;
            let moved = times(clip).map(|time| check_mirrored(&figure, across, [clip, &mirrored], time));
            assert!(moved.fold(0.0, f64::max) > 0.2, "the dance isn't symmetric");
        }
    }
}

/// Every joint is where the one on the other side was, across the plane between left and right, and turned as its mirror image.
/// Returns how far a joint has moved.
fn check_mirrored(figure: &Figure, across: DVec3, [clip, mirrored]: [&Clip; 2], time: f32) -> f64 {
    let reflect = |at: DVec3| at - 2.0 * across * at.dot(across);
    let rest = figure.world_of(figure.asset.skeleton.rest());
    let (before, after) = (figure.world(clip, time), figure.world(mirrored, time));
    let mut moved = 0.0_f64;
    for (&slot, &joint) in &figure.slots.0 {
        let Some(other) = figure.slots.joint(slot.mirrored()) else { continue };
        let (joint, other) = (joint.get(), other.get());
        let (expected, found) = (reflect(before[joint].1), after[other].1);
        assert!(expected.distance(found) < 1e-5, "{slot:?} at {time}: {found} instead of {expected}");
        let away = before[joint].0 * rest[joint].0.inverse();
        // The axis of a rotation is a pseudovector.
        let axis = -reflect(away.xyz());
        let expected = DQuat::from_xyzw(axis.x, axis.y, axis.z, away.w) * rest[other].0;
        assert!(degrees(expected, after[other].0) < 1e-3, "{slot:?} at {time}");
        moved = moved.max(before[other].1.distance(found));
    }
    moved
}

/// A fish has no body parts, only sides in its names.
#[test]
fn joints_that_are_no_body_parts_are_mirrored_by_the_sides_in_their_names() {
    let joint = |name: &str, parent, at: [f32; 3]| Joint {
        name: name.to_owned(),
        parent,
        rest: Transform { translation: at.into(), ..Transform::IDENTITY },
        ..Joint::default()
    };
    let joints = vec![
        joint("fish", None, [0.0, 1.0, 0.0]),
        joint("fin_l", Some(0), [0.3, 0.0, 0.1]),
        joint("fin_tip_l", Some(1), [0.4, 0.1, 0.0]),
        joint("fin_r", Some(0), [-0.3, 0.0, 0.1]),
        joint("fin_tip_r", Some(3), [-0.4, 0.1, 0.0]),
    ];
    let asset = Asset::from(Skeleton::new(joints).expect("a hierarchy"));
    let mut builder = ClipBuilder::new("flap", &asset.skeleton);
    let keys = [Quat::IDENTITY, Quat::from_rotation_z(0.7), Quat::from_rotation_x(0.4)];
    let fin = asset.skeleton.find("fin_l").expect("a joint");
    builder.channel(fin, Interpolation::Linear, &[0.0, 0.5, 1.0], Keys::Rotation(keys.to_vec())).expect("valid");
    let clip = builder.build();
    let mirrored = change_clip(&asset, &clip, &ClipChanges { mirror: true, ..NONE }, || symmetry(&asset)).clip;
    let places = |clip: &Clip, time: f32| {
        let (mut pose, mut world) = (asset.skeleton.rest().clone(), Vec::new());
        clip.sample(&asset.skeleton, time, &mut SampleCursor::default(), &mut pose);
        model_from_joint(&asset.skeleton, &pose, Affine3A::IDENTITY, &mut world);
        let place = |joint: JointIndex| Vec3::from(world[joint.get()].translation);
        asset.skeleton.joints().map(place).collect::<Vec<Vec3>>()
    };
    for time in times(&clip) {
        let (own, other) = (places(&clip, time), places(&mirrored, time));
        for (joint, opposite) in [(0, 0), (1, 3), (2, 4), (3, 1), (4, 2)] {
            let expected = own[joint] * Vec3::new(-1.0, 1.0, 1.0);
            assert!(expected.distance(other[opposite]) < 1e-6, "{joint} at {time}: {}, {expected}", other[opposite]);
        }
        assert!(own[2].distance(other[2]) > 1e-3);
    }
}

/// A mesh with six morph targets, four of which are of a side.
fn face() -> Asset {
    let names = ["browDown_L", "jawOpen", "browDown_R", "eyeBlinkLeft", "lonely_L", "eyeBlinkRight"];
    let mesh = Mesh { target_names: names.map(str::to_owned).to_vec(), ..Mesh::default() };
    let face = Joint { morph_weights: vec![0.0; names.len()], ..Joint::default() };
    let skeleton = Skeleton::new(vec![face]).expect("a joint");
    let instances = vec![MeshInstance::new(JointIndex(0), 0, None)];
    let parts = AssetParts { skeleton, meshes: vec![mesh], instances, ..AssetParts::default() };
    Asset::new(parts).expect("is valid")
}

#[test]
fn mirroring_swaps_morph_targets_named_for_a_side() {
    let asset = face();
    let mut builder = ClipBuilder::new("", &asset.skeleton);
    let values: Vec<f32> = (1..=12).map(|weight| weight as f32).collect();
    let keys = Keys::MorphWeights { values, targets: 6 };
    builder.channel(JointIndex(0), Interpolation::Linear, &[0.0, 1.0], keys).expect("valid");
    let mirror = ClipChanges { mirror: true, ..NONE };
    let clip = change_clip(&asset, &builder.build(), &mirror, || symmetry(&asset)).clip;
    let Keys::MorphWeights { values, .. } = &clip.channels()[0].keys else { panic!("weights become something else") };
    assert_eq!(values[..], [3.0, 2.0, 1.0, 6.0, 5.0, 4.0, 9.0, 8.0, 7.0, 12.0, 11.0, 10.0]);
}

/// As `KHR_animation_pointer` animates them.
#[test]
fn mirroring_swaps_single_morph_weights() {
    let (asset, joint) = (face(), JointIndex(0));
    let mut builder = ClipBuilder::new("", &asset.skeleton);
    for (target, weight) in [(0, 0.25), (1, 0.5), (5, 0.75)] {
        let target = PropertyTarget::MorphWeight(joint, target);
        builder.property(target, Interpolation::Linear, &[0.0], vec![weight]).expect("valid");
    }
    let mirror = ClipChanges { mirror: true, ..NONE };
    let clip = change_clip(&asset, &builder.build(), &mirror, || symmetry(&asset)).clip;
    let found: Vec<(PropertyTarget, f32)> =
        clip.properties().iter().map(|channel| (channel.target, channel.values[0])).collect();
    let expected = [(1, 0.5), (2, 0.25), (3, 0.75)];
    assert_eq!(found, expected.map(|(target, weight)| (PropertyTarget::MorphWeight(joint, target), weight)));
}

#[test]
fn mirroring_swaps_expressions_and_the_gaze() {
    let names = ["blinkLeft", "blinkRight", "happy"];
    let expressions = names.map(|name| Expression::new(name, name, true)).to_vec();
    let parts = AssetParts { avatar: Avatar { expressions, ..Avatar::default() }, ..AssetParts::default() };
    let asset = Asset::new(parts).expect("is valid");
    let mut builder = ClipBuilder::new("", &asset.skeleton);
    for (index, weight) in [(0, 0.25), (2, 0.5)] {
        builder
            .property(PropertyTarget::Expression(index), Interpolation::Linear, &[0.0], vec![weight])
            .expect("valid");
    }
    builder.property(PropertyTarget::LookAt, Interpolation::Linear, &[0.0], vec![10.0, 20.0]).expect("valid");
    let mirror = ClipChanges { mirror: true, ..NONE };
    let clip = change_clip(&asset, &builder.build(), &mirror, || symmetry(&asset)).clip;
    let found: Vec<(PropertyTarget, Vec<f32>)> =
        clip.properties().iter().map(|channel| (channel.target, channel.values.clone())).collect();
    let expected = [
        (PropertyTarget::Expression(1), vec![0.25]),
        (PropertyTarget::Expression(2), vec![0.5]),
        (PropertyTarget::LookAt, vec![-10.0, 20.0]),
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_trimmed_clip_is_a_part_of_the_clip() {
    for kind in KINDS {
        let figure = dancer(kind);
        let clip = &figure.asset.clips[0];
        let (start, end) = (0.31 * clip.duration_secs(), 0.74 * clip.duration_secs());
        let trim = Some(TimeRange { start_secs: start.into(), end_secs: end.into() });
        let part = changed(&figure, clip, &ClipChanges { trim, ..NONE }).clip;
        assert!((part.duration_secs() - (end - start)).abs() < 1e-6);
        for time in times(&part) {
            check_same(&figure, (clip, start + time), (&part, time), 1e-5);
        }
        let beyond = Some(TimeRange { start_secs: -1.0, end_secs: 99.0 });
        let all = changed(&figure, clip, &ClipChanges { trim: beyond, ..NONE }).clip;
        assert_eq!((key_count(&all), all.duration_secs()), (key_count(clip), clip.duration_secs()));
    }
}

#[test]
fn a_reversed_clip_runs_backwards_and_twice_forwards() {
    let reverse = ClipChanges { reverse: true, ..NONE };
    for kind in KINDS {
        let figure = dancer(kind);
        let clip = &figure.asset.clips[0];
        let once = changed(&figure, clip, &reverse).clip;
        let twice = changed(&figure, &once, &reverse).clip;
        assert_eq!(once.duration_secs(), clip.duration_secs());
        if kind != Interpolation::Step {
            assert_eq!(key_count(&once), key_count(clip));
        }
        for time in times(clip) {
            check_same(&figure, (clip, clip.duration_secs() - time), (&once, time), 1e-5);
            check_same(&figure, (clip, time), (&twice, time), 1e-5);
        }
    }
}

#[test]
fn speed_stretches_time() {
    for kind in KINDS {
        let figure = dancer(kind);
        let clip = &figure.asset.clips[0];
        let fast = changed(&figure, clip, &ClipChanges { speed: 1.7, ..NONE }).clip;
        assert!((fast.duration_secs() * 1.7 - clip.duration_secs()).abs() < 1e-5);
        assert_eq!(key_count(&fast), key_count(clip));
        for time in times(&fast) {
            check_same(&figure, (clip, time * 1.7), (&fast, time), 2e-5);
        }
    }
}

/// The body goes along with an arm that waves alone, whichever joints the skin has.
#[test]
fn a_clip_of_an_arm_is_turned_and_moved_with_its_body() {
    let mut figure = dancer(Interpolation::Linear);
    let arm = figure.joint(Slot::LeftUpperArm);
    let mut clip = ClipBuilder::new("wave", &figure.asset.skeleton);
    let keys = [Quat::IDENTITY, Quat::from_rotation_x(0.8)].to_vec();
    clip.channel(arm, Interpolation::Linear, &[0.0, 1.0], Keys::Rotation(keys)).expect("valid");
    let clip = clip.build();
    let joints: Vec<JointIndex> = figure.slots.0.values().copied().collect();
    let skin =
        Skin::new(String::new(), joints.clone(), vec![Affine3A::IDENTITY; joints.len()], figure.asset.skeleton.len());
    let parts = std::mem::take(&mut figure.asset).into_parts();
    figure.asset = Asset::new(AssetParts { skins: vec![skin.expect("valid")], ..parts }).expect("valid");
    let changes = ClipChanges { offset: [1.5, -0.5], turn_degrees: 70.0, ..NONE };
    let placed = changed(&figure, &clip, &changes).clip;
    let turn = DQuat::from_rotation_y(70_f64.to_radians());
    let hips = figure.joint(Slot::Hips).get();
    let start = figure.world(&clip, 0.0)[hips].1;
    for time in [0.0, 0.3, 1.0] {
        let (before, after) = (figure.world(&clip, time), figure.world(&placed, time));
        for joint in joints.iter().map(|joint| joint.get()) {
            let expected = start + turn * (before[joint].1 - start) + DVec3::new(1.5, 0.0, -0.5);
            assert!(expected.distance(after[joint].1) < 1e-5, "{} instead of {expected}", after[joint].1);
        }
    }
}

#[test]
fn a_path_is_turned_and_moved_as_a_whole() {
    for kind in KINDS {
        let figure = dancer(kind);
        let clip = &figure.asset.clips[0];
        let changes = ClipChanges { offset: [1.5, -0.5], turn_degrees: 70.0, ..NONE };
        let placed = changed(&figure, clip, &changes).clip;
        let hips = figure.slots.joint(Slot::Hips).expect("hips").get();
        let start = figure.world(clip, 0.0)[hips].1;
        let turn = DQuat::from_rotation_y(70_f64.to_radians());
        for time in times(clip) {
            let (before, after) = (figure.world(clip, time), figure.world(&placed, time));
            for joint in figure.slots.0.values().map(|joint| joint.get()) {
                let expected = start + turn * (before[joint].1 - start) + DVec3::new(1.5, 0.0, -0.5);
                assert!(expected.distance(after[joint].1) < 1e-5, "{} instead of {expected}", after[joint].1);
                assert!(degrees(turn * before[joint].0, after[joint].0) < 1e-3);
            }
        }
    }
}

#[test]
fn a_loop_meets_itself_and_leaves_the_middle_alone() {
    for kind in [Interpolation::Linear, Interpolation::CubicSpline] {
        let figure = dancer(kind);
        let clip = &figure.asset.clips[0];
        let secs = 0.2 * clip.duration_secs();
        let ChangedClip { clip: looped, seam } =
            changed(&figure, clip, &ClipChanges { loop_secs: Some(secs.into()), ..NONE });
        let seam = seam.expect("is measured");
        assert!(seam.degrees_max > 1.0, "{seam:?}");
        let end = looped.duration_secs();
        assert_eq!(end, clip.duration_secs());
        let hips = figure.slots.joint(Slot::Hips).expect("hips").get();
        let (first, last) = (figure.world(&looped, 0.0), figure.world(&looped, end));
        let travel = last[hips].1 - first[hips].1;
        assert!(travel.y.abs() < 1e-5, "{travel}");
        assert!((DVec3::new(travel.x, 0.0, travel.z).length() - seam.travel_metres).abs() < 1e-4, "{travel} {seam:?}");
        for time in times(clip).filter(|&time| time > secs && time < end - secs) {
            check_same(&figure, (clip, time), (&looped, time), 1e-5);
        }
        let again = changed(&figure, &looped, &ClipChanges { loop_secs: Some(0.1), ..NONE }).seam.expect("is measured");
        assert!(again.degrees_max < 0.1 && again.metres < 1e-5, "{again:?}");
    }
}

/// A joint that turns by 30° and a root that stays: the ends meet at 15°, and nothing jumps on the way.
#[test]
fn a_seam_is_measured_and_shared() {
    let joints = vec![
        Joint { name: "root".to_owned(), rest: Transform::from_translation(Vec3::Y), ..Joint::default() },
        Joint { name: "arm".to_owned(), parent: Some(0), ..Joint::default() },
    ];
    let asset = crate::skeletons::asset(joints);
    let mut builder = ClipBuilder::new("", &asset.skeleton);
    let turn = |angle: f32| Quat::from_rotation_z(angle.to_radians());
    let keys = Keys::Rotation(vec![turn(0.0), turn(30.0)]);
    builder.channel(JointIndex(1), Interpolation::Linear, &[0.0, 2.0], keys).expect("valid");
    let keys = Keys::Translation(vec![Vec3::Y, Vec3::new(0.03, 1.04, 0.0)]);
    builder.channel(JointIndex(0), Interpolation::Linear, &[0.0, 2.0], keys).expect("valid");
    let clip = builder.build();
    let changes = ClipChanges { loop_secs: Some(0.5), ..NONE };
    let ChangedClip { clip: looped, seam } = change_clip(&asset, &clip, &changes, || symmetry(&asset));
    let seam = seam.expect("is measured");
    assert!((seam.degrees_max - 30.0).abs() < 1e-3 && (seam.metres - 0.05).abs() < 1e-6, "{seam:?}");
    assert_eq!(seam.travel_metres, 0.0);
    let at = |time: f32| {
        let mut pose = asset.skeleton.rest().clone();
        looped.sample(&asset.skeleton, time, &mut SampleCursor::default(), &mut pose);
        (pose.local(JointIndex(0)).translation, pose.local(JointIndex(1)).rotation)
    };
    let ((start, first), (end, last)) = (at(0.0), at(2.0));
    assert!(start.distance(end) < 1e-6 && first.angle_between(last) < 1e-3);
    assert!((first.angle_between(turn(15.0))) < 1e-3);
    for step in 0..200 {
        let (before, after) = (at(step as f32 * 0.01).1, at((step + 1) as f32 * 0.01).1);
        assert!(before.angle_between(after).to_degrees() < 0.7, "{step}");
    }
}

/// What counts as travel depends on the height of the character; its root may lie on the ground.
#[test]
fn drift_of_a_root_on_the_ground_is_not_travel() {
    let joints = vec![
        Joint { name: "root".to_owned(), ..Joint::default() },
        Joint {
            name: "head".to_owned(),
            parent: Some(0),
            rest: Transform::from_translation(2.0 * Vec3::Y),
            ..Joint::default()
        },
        // Not a part of the character.
        Joint { name: "lamp".to_owned(), rest: Transform::from_translation(9.0 * Vec3::Y), ..Joint::default() },
    ];
    let asset = crate::skeletons::asset(joints);
    for (metres, text) in [
        (0.25, "0.0° and 25.0 cm apart"),
        (0.35, "0.0° and 0.0 cm apart, not counting 0.35 m of travel"),
        (-0.35, "0.0° and 0.0 cm apart, not counting 0.35 m of travel"),
    ] {
        let mut builder = ClipBuilder::new("", &asset.skeleton);
        let keys = Keys::Translation(vec![Vec3::ZERO, Vec3::X * metres]);
        builder.channel(JointIndex(0), Interpolation::Linear, &[0.0, 1.0], keys).expect("valid");
        let changes = ClipChanges { loop_secs: Some(0.2), ..NONE };
        let seam = change_clip(&asset, &builder.build(), &changes, || unreachable!("isn't mirrored")).seam;
        assert_eq!(seam.expect("is measured").to_string(), text);
    }
}

#[test]
fn numbers_out_of_range_are_clamped() {
    let wild = ClipChanges {
        speed: f64::NAN,
        loop_secs: Some(1e9),
        offset: [f64::INFINITY, -1e9],
        turn_degrees: 1e9,
        trim: Some(TimeRange { start_secs: f64::NAN, end_secs: 1.0 }),
        ..NONE
    };
    let clamped = ClipChanges { loop_secs: Some(10.0), offset: [0.0, -1000.0], turn_degrees: 360.0, ..NONE };
    assert_eq!(wild.clone().clamped(), clamped);
    let reversed = Some(TimeRange { start_secs: 5.0, end_secs: 1.0 });
    assert_eq!(ClipChanges { trim: reversed, ..NONE }.clamped(), NONE, "it would keep nothing");
    let figure = dancer(Interpolation::Linear);
    let clip = changed(&figure, &figure.asset.clips[0], &wild).clip;
    assert!(figure.world(&clip, 0.5).iter().all(|(turn, at)| turn.is_finite() && at.is_finite()));
    let empty = ClipBuilder::new("", &figure.asset.skeleton).build();
    let all = ClipChanges { mirror: true, reverse: true, speed: 2.0, trim: None, ..clamped };
    assert_eq!(changed(&figure, &empty, &all).clip.duration_secs(), 0.0);
}
