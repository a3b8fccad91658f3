//! Laws of pins on figures made in code: with any axes, with joints between those of a limb, and with a scaled armature.

use std::collections::BTreeMap;

use gaitway_character::anim::{
    Clip, Interpolation, JointIndex, Keys, Pose, SampleCursor, Skeleton, Transform, model_from_single_joint,
};
use gaitway_character::asset::{AssetParts, Slot};
use gaitway_character::avatar::{Avatar, LookAt, LookAtKind, RangeMaps};
use gaitway_retarget::{Pin, PinGoal, PinTimes, Pinning, Recognized, recognize};
use glam::{Affine3A, DMat3, DQuat, DVec3, Quat, Vec3};

use crate::data_folder::data_folder;
use crate::figure::{Figure, Rig, build};
use crate::laws::degrees;
use crate::random::Random;
use crate::real::read;
use crate::skeletons::{asset, joint};

/// The slots of each limb, and the axis about which it bends in the T-pose.
const LIMBS: [([Slot; 3], DVec3); 4] = [
    ([Slot::LeftUpperArm, Slot::LeftLowerArm, Slot::LeftHand], DVec3::NEG_Y),
    ([Slot::RightUpperArm, Slot::RightLowerArm, Slot::RightHand], DVec3::Y),
    ([Slot::LeftUpperLeg, Slot::LeftLowerLeg, Slot::LeftFoot], DVec3::X),
    ([Slot::RightUpperLeg, Slot::RightLowerLeg, Slot::RightFoot], DVec3::X),
];

/// Height of the highest joint.
const HEIGHT: f64 = 1.6;

fn figures() -> Vec<(Figure, Recognized)> {
    let doubled = vec![Slot::LeftLowerArm, Slot::RightHand, Slot::RightFoot, Slot::Head];
    let rigs = [
        Rig::default(),
        Rig { axes: 3, armature: true, ..Rig::default() },
        Rig { axes: 4, doubled, arms_down_degrees: 40.0, ..Rig::default() },
    ];
    let dancing = rigs.iter().map(|rig| {
        let mut figure = build(rig);
        figure.dance(11, 50.0, Interpolation::Linear);
        let body = recognize(&figure.asset);
        assert_eq!(body.joint(Slot::LeftHand), figure.slots.joint(Slot::LeftHand));
        (figure, body)
    });
    dancing.collect()
}

fn times() -> impl Iterator<Item = f32> {
    (0..30).map(|step| 1.5 * (step as f32 + 0.37) / 31.0)
}

fn pin(goal: PinGoal) -> Pin {
    Pin { goal, times: None }
}

/// The figure's own clip at a time, with the pins.
fn posed((figure, body): &(Figure, Recognized), time_secs: f32, pins: &[(Slot, Pin)]) -> Pose {
    let skeleton = &figure.asset.skeleton;
    let mut pose = skeleton.rest().clone();
    figure.asset.clips[0].sample(skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
    let pins: BTreeMap<usize, Pin> =
        pins.iter().map(|&(slot, pin)| (skeleton.source_index(figure.joint(slot)), pin)).collect();
    pinning(figure, body, &pins).apply(f64::from(time_secs), &mut pose);
    pose
}

fn pinning<'a>(figure: &'a Figure, body: &'a Recognized, pins: &'a BTreeMap<usize, Pin>) -> Pinning<'a> {
    Pinning { asset: &figure.asset, body, pins, world_from_model: Affine3A::IDENTITY, eye: None }
}

/// Positions of a limb's joints, and how far it is bent: the sine, negative if backwards.
fn limb(figure: &Figure, pose: &Pose, (slots, hinge): ([Slot; 3], DVec3)) -> ([DVec3; 3], f64) {
    let world = figure.world_of(pose);
    let at = slots.map(|slot| world[figure.joint(slot).get()].1);
    let rest = figure.world_of(figure.asset.skeleton.rest());
    let upper = figure.joint(slots[0]).get();
    // The rest is the T-pose but for lowered arms, which bend about the same axis of the upper arm.
    let lowered = rest[upper].0 * figure.t_pose[&slots[0]].conjugate();
    let now = world[upper].0 * rest[upper].0.conjugate() * lowered * hinge;
    let bend = (at[1] - at[0]).normalize().cross((at[2] - at[1]).normalize());
    (at, bend.dot(now))
}

fn check_same(figure: &Figure, one: &Pose, other: &Pose, tolerance: f64) {
    for (joint, (a, b)) in figure.world_of(one).iter().zip(figure.world_of(other)).enumerate() {
        assert!(a.1.distance(b.1) < tolerance, "joint {joint}: {} and {}", a.1, b.1);
        assert!(degrees(a.0, b.0).to_radians() < tolerance, "joint {joint}: {}° apart", degrees(a.0, b.0));
    }
}

#[test]
fn a_pin_where_the_joint_is_changes_nothing() {
    let mut checked = 0;
    for figure in &figures() {
        for time in times() {
            let before = posed(figure, time, &[]);
            for one in LIMBS {
                let (at, bend) = limb(&figure.0, &before, one);
                // A limb that bends backwards has to be turned round.
                if bend >= 0.0 {
                    let after = posed(figure, time, &[(one.0[2], pin(PinGoal::Point(at[2].as_vec3())))]);
                    check_same(&figure.0, &before, &after, 1e-5);
                    checked += 1;
                }
            }
        }
    }
    assert!(checked > 100, "{checked}");
}

/// Wherever the goal is: around the shoulder or hip, too near, or out of reach.
#[test]
fn limbs_reach_their_goals_straighten_and_never_bend_backwards() {
    let mut random = Random(5);
    let (mut reached, mut straight, mut backwards) = (0, 0, 0);
    for figure in &figures() {
        for time in times() {
            let before = posed(figure, time, &[]);
            for one in LIMBS {
                let ([start, middle, end], bend) = limb(&figure.0, &before, one);
                backwards += usize::from(bend < -0.1);
                let (upper, lower) = (start.distance(middle), middle.distance(end));
                let far = (upper + lower) * [0.3, 0.8, 0.9999, 1.0001, 1.5][random.below(5)];
                let goal = start + far * (random.rotation(180.0) * DVec3::Y);
                let after = posed(figure, time, &[(one.0[2], pin(PinGoal::Point(goal.as_vec3())))]);
                let (at, bend) = limb(&figure.0, &after, one);
                assert!(at[0].distance(start) < 1e-6, "the body stays");
                assert!(bend > -1e-5, "{:?} at {time} bends backwards: {bend}", one.0);
                if far < upper + lower {
                    assert!(at[2].distance(goal) < 1e-4 * HEIGHT, "{:?} is {} away", one.0, at[2].distance(goal));
                    reached += 1;
                } else {
                    let towards = (goal - start).normalize();
                    let nearest = start + (upper + lower) * towards;
                    assert!(
                        at[2].distance(nearest) < 1e-4 * HEIGHT,
                        "{:?} isn't straight: {}",
                        one.0,
                        at[2].distance(nearest)
                    );
                    straight += 1;
                }
                let (before, after) = (figure.0.world_of(&before), figure.0.world_of(&after));
                let hand = figure.0.joint(one.0[2]).get();
                assert!(degrees(before[hand].0, after[hand].0) < 1e-3, "the end keeps its direction");
            }
        }
    }
    assert!(reached > 150 && straight > 100 && backwards > 20, "{reached} {straight} {backwards}");
}

/// Right-hand rotation by Rodrigues' formula.
fn rotation(axis: DVec3, sin: f64, cos: f64) -> DMat3 {
    let cross = DMat3::from_cols(
        DVec3::new(0.0, axis.z, -axis.y),
        DVec3::new(-axis.z, 0.0, axis.x),
        DVec3::new(axis.y, -axis.x, 0.0),
    );
    DMat3::IDENTITY + sin * cross + (1.0 - cos) * cross * cross
}

/// Another implementation: the interior angle of the triangle, and matrices instead of quaternions.
#[test]
fn positions_are_those_of_the_triangle() {
    let mut random = Random(8);
    let mut checked = 0;
    for figure in &figures() {
        for time in times() {
            let before = posed(figure, time, &[]);
            for one in LIMBS {
                let ([start, middle, end], bend) = limb(&figure.0, &before, one);
                let (a, b) = (middle - start, end - middle);
                let normal = a.normalize().cross(b.normalize());
                if bend < 0.0 || normal.length() < 0.18 {
                    continue;
                }
                let distance = (a.length() + b.length()) * (0.4 + 0.5 * random.f64());
                let towards = random.rotation(180.0) * DVec3::Z;
                let cos =
                    (a.length_squared() + b.length_squared() - distance * distance) / (2.0 * a.length() * b.length());
                if cos.abs() > 1.0 {
                    continue;
                }
                // The lower bone leaves the upper one's line by the exterior angle.
                let lower = rotation(normal.normalize(), (1.0 - cos * cos).sqrt(), -cos) * (b.length() * a.normalize());
                let line = (a + lower).normalize();
                let axis = line.cross(towards);
                let swing = rotation(axis.normalize(), axis.length(), line.dot(towards));
                let expected = [start, start + swing * a, start + swing * (a + lower)];
                let goal = start + distance * towards;
                let after = posed(figure, time, &[(one.0[2], pin(PinGoal::Point(goal.as_vec3())))]);
                let (found, _) = limb(&figure.0, &after, one);
                for (expected, found) in expected.iter().zip(found) {
                    assert!(expected.distance(found) < 2e-6 * HEIGHT, "{:?}: {found} instead of {expected}", one.0);
                }
                let upper = figure.0.joint(one.0[0]).get();
                let turned = DQuat::from_mat3(&swing) * figure.0.world_of(&before)[upper].0;
                assert!(degrees(turned, figure.0.world_of(&after)[upper].0) < 1e-3);
                checked += 1;
            }
        }
    }
    assert!(checked > 50, "{checked}");
}

#[test]
fn a_pin_is_blended_in_and_out() {
    let goal = PinGoal::Point(Vec3::new(0.3, 1.2, 0.4));
    let during = PinTimes { start_secs: 0.6, end_secs: 0.9, blend_secs: 0.3 };
    let (always, during) = (pin(goal), Pin { goal, times: Some(during) });
    for figure in &figures() {
        let pinned = |time, pin| posed(figure, time, &[(Slot::LeftHand, pin)]);
        for time in [0.0, 0.29, 1.21, 1.5] {
            assert_eq!(pinned(time, during), posed(figure, time, &[]), "the clip itself at {time}");
        }
        for time in [0.6, 0.7, 0.9] {
            assert_eq!(pinned(time, during), pinned(time, always), "pinned at {time}");
        }
        let hand = figure.0.joint(Slot::LeftHand).get();
        let at = |time| figure.0.world_of(&pinned(time, during))[hand].1;
        let between = at(0.45);
        assert!(between.distance(figure.0.world_of(&posed(figure, 0.45, &[]))[hand].1) > 0.01);
        for step in 0..600 {
            let (before, after) = (at(step as f32 / 400.0), at((step + 1) as f32 / 400.0));
            assert!(before.distance(after) < 0.03, "a jump by {} m at {step}", before.distance(after));
        }
    }
    let jump = Pin { goal, times: Some(PinTimes { start_secs: 0.6, end_secs: 0.9, blend_secs: 0.0 }) };
    assert_eq!([0.59, 0.6, 0.9, 0.91].map(|time| jump.weight(time)), [0.0, 1.0, 1.0, 0.0]);
}

#[test]
fn a_hand_holds_on_to_another_joint() {
    let mut reached = 0;
    for figure in &figures() {
        let skeleton = &figure.0.asset.skeleton;
        let number = |slot| skeleton.source_index(figure.0.joint(slot));
        // Offsets are in the space of the other joint, which an armature scales.
        let offset = if skeleton.name(JointIndex(0)) == "Armature" { 10.0 } else { 0.1 } * Vec3::new(1.0, -0.5, 0.25);
        let pins = [
            (Slot::LeftHand, pin(PinGoal::Joint(number(Slot::RightHand), offset))),
            (Slot::RightHand, pin(PinGoal::Point(Vec3::new(0.25, 1.7, 0.6)))),
        ];
        for time in times() {
            let pose = posed(figure, time, &pins);
            let world = figure.0.world_of(&pose);
            let (turn, at) = world[figure.0.joint(Slot::RightHand).get()];
            let metres = if offset.length() > 1.0 { 0.01 } else { 1.0 };
            let goal = at + turn * (metres * offset.as_dvec3());
            let upper = LIMBS[0].0.map(|slot| world[figure.0.joint(slot).get()].1);
            let length = upper[0].distance(upper[1]) + upper[1].distance(upper[2]);
            let far = upper[0].distance(goal);
            reached += usize::from(far < length);
            let nearest = upper[0] + far.min(length) / far * (goal - upper[0]);
            assert!(upper[2].distance(nearest) < 1e-4 * HEIGHT, "{}", upper[2].distance(nearest));
        }
        let body = &figure.1;
        let pins = BTreeMap::new();
        let allows = |slot, goal| pinning(&figure.0, body, &pins).allows(number(slot), goal);
        assert!(!allows(Slot::LeftHand, PinGoal::Joint(number(Slot::LeftLowerArm), offset)), "part of the arm");
        assert!(
            !allows(Slot::Hips, PinGoal::Point(Vec3::ZERO)) || skeleton.parent(figure.0.joint(Slot::Hips)).is_some()
        );
        assert!(!allows(Slot::LeftHand, PinGoal::Joint(9999, offset)));
    }
    assert!(reached > 5, "{reached}");
}

#[test]
fn a_head_looks_at_its_goal() {
    let mut random = Random(3);
    for (mut figure, body) in figures() {
        for offset in [Vec3::ZERO, Vec3::new(0.0, 0.06, 0.09)] {
            let head = figure.joint(Slot::Head);
            let scale = if figure.asset.skeleton.name(JointIndex(0)) == "Armature" { 100.0 } else { 1.0 };
            let maps = [1.0, 1.0];
            let look_at = LookAt {
                head,
                // In the head's own axes.
                offset: scale * (figure.t_pose[&Slot::Head].conjugate() * offset.as_dvec3()).as_vec3(),
                faces_minus_z: false,
                maps: RangeMaps { inner: maps, outer: maps, down: maps, up: maps },
                kind: LookAtKind::Bones([None; 2]),
            };
            let parts = figure.asset.into_parts();
            let avatar = Avatar { look_at: Some(look_at), ..Avatar::default() };
            figure.asset = gaitway_character::asset::Asset::new(AssetParts { avatar, ..parts }).expect("is valid");
            let both = (figure, body.clone());
            for time in times() {
                let goal = (DVec3::Y + (0.8 + 3.0 * random.f64()) * (random.rotation(180.0) * DVec3::Z)).as_vec3();
                let pose = posed(&both, time, &[(Slot::Head, pin(PinGoal::Look(goal)))]);
                let (turn, at) = both.0.world_of(&pose)[head.get()];
                let away = turn * both.0.t_pose[&Slot::Head].conjugate();
                let eyes = at + away * offset.as_dvec3();
                let wanted = (goal.as_dvec3() - eyes).normalize();
                let off = wanted.angle_between(away * DVec3::Z).to_degrees();
                assert!(off < 0.1, "{off}° off at {time}");
            }
            figure = both.0;
        }
    }
}

/// A joint with two ancestors will do, also below a mirrored parent. A straight limb bends to one side.
#[test]
fn any_two_bones_are_a_limb() {
    let bone = |name, parent| joint(name, parent, Transform::from_translation(Vec3::Y));
    let mirrored =
        Transform { scale: Vec3::new(-1.0, 1.0, 1.0), rotation: Quat::from_rotation_x(0.4), ..Transform::IDENTITY };
    for top in [Transform::IDENTITY, mirrored] {
        let asset = asset(vec![joint("top", None, top), bone("a", Some(0)), bone("b", Some(1)), bone("c", Some(2))]);
        let skeleton: &Skeleton = &asset.skeleton;
        let goal = Vec3::new(0.4, 2.0, 0.3);
        let pins = BTreeMap::from([(3, pin(PinGoal::Point(goal)))]);
        let body = recognize(&asset);
        let pinning =
            Pinning { asset: &asset, body: &body, pins: &pins, world_from_model: Affine3A::IDENTITY, eye: None };
        let mut pose = skeleton.rest().clone();
        pinning.apply(0.0, &mut pose);
        let end = model_from_single_joint(skeleton, &pose, JointIndex(3)).translation;
        assert!(Vec3::from(end).distance(goal) < 1e-5, "{end}");
        assert!(!pinning.allows(1, PinGoal::Point(goal)) && pinning.allows(1, PinGoal::Look(goal)));
        assert!(pinning.allows(2, PinGoal::Point(goal)), "two bones from the root");
    }
}

/// A robot whose feet are children of the root, beside its legs: they are moved, and their legs reach for them. Nothing else moves.
#[test]
fn a_foot_beside_its_leg_is_moved_along() {
    let Some(folder) = data_folder() else { return };
    let asset = read(&folder, "threejs/RobotExpressive.glb");
    let (skeleton, body) = (&asset.skeleton, recognize(&asset));
    let clip = asset.clips.iter().find(|clip| clip.name() == "Walking").expect("a walk");
    let [upper, lower, foot] = ["UpperLeg.L", "LowerLeg.L", "Foot.L"].map(|name| skeleton.find(name).expect(name));
    let number = skeleton.source_index(foot);
    let sampled = |clip: &Clip, time_secs: f32| {
        let mut pose = skeleton.rest().clone();
        clip.sample(skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
        pose
    };
    let at = |pose: &Pose, joint| Vec3::from(model_from_single_joint(skeleton, pose, joint).translation);
    let goal = at(&sampled(clip, 0.1), foot) + Vec3::new(0.1, 0.1, 0.0);
    let pins = BTreeMap::from([(number, pin(PinGoal::Point(goal)))]);
    let pinning = Pinning { asset: &asset, body: &body, pins: &pins, world_from_model: Affine3A::IDENTITY, eye: None };
    let root = skeleton.source_index(skeleton.parent(foot).expect("a root"));
    assert!(!pinning.allows(number, PinGoal::Joint(number, Vec3::ZERO)), "it moves along with itself");
    assert!(pinning.allows(number, PinGoal::Joint(root, Vec3::ZERO)), "the root doesn't");
    let baked = pinning.bake(clip, f64::from(clip.duration_secs()));
    for step in 0..40 {
        let time = clip.duration_secs() * (step as f32 + 0.37) / 41.0;
        let before = sampled(clip, time);
        let mut after = before.clone();
        pinning.apply(f64::from(time), &mut after);
        for joint in skeleton.joints().filter(|joint| ![upper, lower, foot].contains(joint)) {
            assert_eq!(before.local(joint), after.local(joint), "{}", skeleton.name(joint));
        }
        let shin = |pose: &Pose| at(pose, lower).distance(at(pose, foot));
        assert!((shin(&before) - shin(&after)).abs() < 1e-4, "{} and {} at {time}", shin(&before), shin(&after));
        let reach = at(&before, upper).distance(at(&before, lower)) + shin(&before);
        let off = at(&after, foot).distance(goal);
        let away = (at(&before, upper).distance(goal) - reach).max(0.0);
        assert!(off < away + 1e-4, "{off} off at {time}, {away} out of reach");
        let found = sampled(&baked, time);
        for joint in skeleton.joints() {
            assert!(at(&found, joint).distance(at(&after, joint)) < 1e-3, "{} at {time}", skeleton.name(joint));
        }
    }
}

fn key_count(clip: &Clip, joint: JointIndex) -> usize {
    let is_turned = |channel: &&gaitway_character::anim::Channel| {
        channel.joint == joint && matches!(channel.keys, Keys::Rotation(_))
    };
    let channels = clip.channels().iter().filter(is_turned);
    channels.map(|channel| clip.timelines()[channel.timeline as usize].len()).sum()
}

/// How many of a limb's keys could each be left out alone without being off by half of what is allowed, and the number of keys.
fn droppable(both: &(Figure, Recognized), baked: &Clip, pins: &[(Slot, Pin)], limb: [Slot; 3]) -> (usize, usize) {
    let skeleton = &both.0.asset.skeleton;
    let joints = limb.map(|slot| both.0.joint(slot));
    let sampled = |time_secs: f32| {
        let mut pose = skeleton.rest().clone();
        baked.sample(skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
        joints.map(|joint| pose.local(joint).rotation)
    };
    let is_end = |channel: &&gaitway_character::anim::Channel| channel.joint == joints[2];
    let channel = baked.channels().iter().find(is_end).expect("is animated");
    let times = &baked.timelines()[channel.timeline as usize];
    let is_droppable = |from: f32, to: f32| {
        let (before, after) = (sampled(from), sampled(to));
        (1..16).all(|part| {
            let share = part as f32 / 16.0;
            let exact = posed(both, from + share * (to - from), pins);
            let mut pose = exact.clone();
            for ((joint, before), after) in joints.into_iter().zip(before).zip(after) {
                pose.set_rotation(joint, before.slerp(after, share));
            }
            let (exact, found) = (both.0.world_of(&exact), both.0.world_of(&pose));
            exact.iter().zip(found).all(|(a, b)| degrees(a.0, b.0) < 0.02 && a.1.distance(b.1) < 0.4e-4 * HEIGHT)
        })
    };
    (times.windows(3).filter(|keys| is_droppable(keys[0], keys[2])).count(), times.len())
}

#[test]
fn baked_pins_look_the_same_with_few_keys() {
    let during = PinTimes { start_secs: 0.4, end_secs: 0.9, blend_secs: 0.2 };
    for kind in [Interpolation::Step, Interpolation::Linear, Interpolation::CubicSpline] {
        for (mut figure, body) in figures() {
            figure.dance(5, 40.0, kind);
            let number = |slot| figure.asset.skeleton.source_index(figure.joint(slot));
            let pins = [
                (Slot::LeftHand, Pin { goal: PinGoal::Point(Vec3::new(0.3, 1.4, 0.5)), times: Some(during) }),
                (Slot::RightHand, pin(PinGoal::Joint(number(Slot::Head), Vec3::ZERO))),
                (
                    Slot::LeftFoot,
                    Pin { goal: PinGoal::Point(Vec3::ZERO), times: Some(PinTimes { blend_secs: 0.0, ..during }) },
                ),
                (Slot::Head, pin(PinGoal::Look(Vec3::new(0.5, 1.0, 3.0)))),
            ];
            let clip = &figure.asset.clips[0];
            let by_number = pins.iter().map(|&(slot, pin)| (number(slot), pin)).collect();
            let baked = pinning(&figure, &body, &by_number).bake(clip, f64::from(clip.duration_secs()));
            assert_eq!(baked.duration_secs(), clip.duration_secs());
            let both = (figure, body);
            for step in 0..400 {
                let time = 1.5 * (step as f32 + 0.37) / 401.0;
                let expected = both.0.world_of(&posed(&both, time, &pins));
                for (joint, (a, b)) in expected.iter().zip(both.0.world(&baked, time)).enumerate() {
                    let (off, away) = (degrees(a.0, b.0), a.1.distance(b.1));
                    assert!(
                        off < 0.05 && away < 1e-4 * HEIGHT,
                        "{kind:?}: joint {joint} is {off}°, {away} m off at {time}"
                    );
                }
            }
            let (droppable, keys) = droppable(&both, &baked, &pins, LIMBS[0].0);
            assert!(keys >= 4 && 10 * droppable <= keys, "{kind:?}: {droppable} of {keys} keys");
            let hips = both.0.joint(Slot::Hips);
            assert_eq!(key_count(&baked, hips), key_count(&both.0.asset.clips[0], hips), "others keep their keys");
        }
    }
}

/// A figure whose hips are at these heights, and nothing else moves.
fn standing(times: &[f32], heights: &[f32]) -> Figure {
    let mut figure = build(&Rig::default());
    let mut clip = gaitway_character::anim::ClipBuilder::new("standing", &figure.asset.skeleton);
    let keys = Keys::Translation(heights.iter().map(|height| height * Vec3::Y).collect());
    clip.channel(figure.joint(Slot::Hips), Interpolation::Linear, times, keys).expect("valid");
    let clip = clip.build();
    figure.set_clip(clip);
    figure
}

/// Damaged files have keys at any times.
#[test]
fn an_endless_clip_is_baked_in_no_time() {
    let figure = standing(&[0.0, 1.0, 4e9], &[1.0, 1.2, 1.0]);
    let body = recognize(&figure.asset);
    let hand = figure.joint(Slot::LeftHand);
    let pins =
        BTreeMap::from([(figure.asset.skeleton.source_index(hand), pin(PinGoal::Point(Vec3::new(0.3, 1.2, 0.3))))]);
    let baked = pinning(&figure, &body, &pins).bake(&figure.asset.clips[0], 4e9);
    assert!((2..10_000).contains(&key_count(&baked, hand)));
    let held = figure.world(&baked, 0.7)[hand.get()].1;
    assert!(held.distance(DVec3::new(0.3, 1.2, 0.3)) < 1e-4, "{held}");
}

/// A body that stands still needs no second key.
#[test]
fn what_stays_in_place_has_one_key() {
    let figure = standing(&[0.0, 2.0], &[1.0, 1.0]);
    let body = recognize(&figure.asset);
    let hand = figure.joint(Slot::LeftHand);
    let pins =
        BTreeMap::from([(figure.asset.skeleton.source_index(hand), pin(PinGoal::Point(Vec3::new(0.3, 1.2, 0.3))))]);
    let baked = pinning(&figure, &body, &pins).bake(&figure.asset.clips[0], 2.0);
    assert_eq!((key_count(&baked, hand), baked.duration_secs()), (1, 2.0));
    // Twice as long as one round: the times of the pin are repeated.
    let times = Some(PinTimes { start_secs: 0.0, end_secs: 0.25, blend_secs: 0.0 });
    let pins = pins.into_iter().map(|(joint, pin)| (joint, Pin { times, ..pin })).collect();
    let baked = pinning(&figure, &body, &pins).bake(&figure.asset.clips[0], 1.0);
    let at = |time| figure.world(&baked, time)[hand.get()].1;
    assert!(at(0.2).distance(at(1.2)) < 1e-4 && at(0.5).distance(at(1.5)) < 1e-4);
    assert!(at(0.2).distance(at(0.5)) > 0.1);
}
