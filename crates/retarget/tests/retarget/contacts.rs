//! Contacts of the body with itself and the ground, on figures with bodies of boxes.

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, JointIndex, Keys, SampleCursor, model_from_joint};
use gaitway_character::asset::{Asset, AssetParts, MeshInstance, Slot};
use gaitway_character::mesh::{Geometry, Mesh};
use gaitway_retarget::{Contacts, Feet, Figures, ResolvedMap, Retargeted, Retargeting};
use glam::{Affine3A, DQuat, DVec3, Quat, Vec3, Vec3A};

use crate::data_folder::data_folder;
use crate::figure::{Figure, Rig, build};
use crate::laws::{body, degrees, map};
use crate::people::{load_one, measured, proposed};

/// Boxes by slot: from and to, relative to the joint in the T-pose.
fn boxes(belly: f32, hand: f32) -> [(Slot, [Vec3; 2]); 9] {
    let arm = |length: f32, radius: f32| [Vec3::new(0.0, -radius, -radius), Vec3::new(length, radius, radius)];
    let mirrored = |[from, to]: [Vec3; 2]| [from * Vec3::new(-1.0, 1.0, 1.0), to * Vec3::new(-1.0, 1.0, 1.0)];
    [
        (Slot::Hips, [Vec3::new(-0.15, -0.1, -0.1), Vec3::new(0.15, 0.1, belly)]),
        (Slot::Spine, [Vec3::new(-0.14, 0.0, -0.1), Vec3::new(0.14, 0.15, belly)]),
        (Slot::Chest, [Vec3::new(-0.15, 0.0, -0.1), Vec3::new(0.15, 0.25, 0.1)]),
        (Slot::LeftUpperArm, arm(0.28, 0.04)),
        (Slot::LeftLowerArm, arm(0.26, 0.03)),
        (Slot::LeftHand, arm(0.17, hand)),
        (Slot::RightUpperArm, mirrored(arm(0.28, 0.04))),
        (Slot::RightLowerArm, mirrored(arm(0.26, 0.03))),
        (Slot::RightHand, mirrored(arm(0.17, hand))),
    ]
}

/// The surface of a box as points, five by five by five.
fn points([from, to]: [Vec3; 2]) -> Vec<Vec3> {
    let share = |at: usize| at as f32 / 4.0;
    let all = (0..125).map(|at| [at % 5, at / 5 % 5, at / 25]);
    let surface = all.filter(|at| at.iter().any(|&part| part == 0 || part == 4));
    surface.map(|[x, y, z]| from + (to - from) * Vec3::new(share(x), share(y), share(z))).collect()
}

/// A figure with rigid boxes on its joints, which are not turned at rest.
pub fn with_boxes(rig: &Rig, belly: f32) -> Figure {
    with_hands(rig, belly, 0.02)
}

/// The same with hands of a given half width.
fn with_hands(rig: &Rig, belly: f32, hand: f32) -> Figure {
    dressed(rig, &boxes(belly, hand))
}

/// A figure with legs of boxes, of a given half width.
fn with_legs(radius: f32) -> Figure {
    let leg = |length: f32| [Vec3::new(-radius, -length, -radius), Vec3::new(radius, 0.0, radius)];
    let foot = [Vec3::new(-radius, -0.08, -0.06), Vec3::new(radius, 0.02, 0.18)];
    let left = [(Slot::LeftUpperLeg, leg(0.45)), (Slot::LeftLowerLeg, leg(0.42)), (Slot::LeftFoot, foot)];
    let right = [(Slot::RightUpperLeg, leg(0.45)), (Slot::RightLowerLeg, leg(0.42)), (Slot::RightFoot, foot)];
    dressed(&Rig::default(), &[&boxes(0.1, 0.02)[..], &left, &right].concat())
}

/// A figure with rigid boxes: from and to, relative to the joint in the T-pose.
pub fn dressed(rig: &Rig, boxes: &[(Slot, [Vec3; 2])]) -> Figure {
    let mut figure = build(rig);
    let size = rig.size as f32;
    let mut meshes = Vec::new();
    let mut instances = Vec::new();
    for &(slot, corners) in boxes {
        let positions = points(corners.map(|corner| size * corner));
        let geometry = Geometry { positions, indices: vec![0, 1, 2], ..Geometry::default() };
        instances.push(MeshInstance::new(figure.joint(slot), meshes.len(), None));
        meshes.push(Mesh { primitives: vec![geometry], ..Mesh::default() });
    }
    let parts = std::mem::take(&mut figure.asset).into_parts();
    figure.asset = Asset::new(AssetParts { meshes, instances, ..parts }).unwrap();
    figure
}

/// The left hand goes to a belly of boxes and away again, twice: the upper arm hangs down and forwards, the forearm turns inwards.
fn hand_to_belly(figure: Figure) -> Figure {
    hand_inwards(figure, 0.5)
}

/// The same with the upper arm forwards by an angle in radians.
fn hand_inwards(mut figure: Figure, forwards: f32) -> Figure {
    let mut clip = ClipBuilder::new("belly", &figure.asset.skeleton);
    let times: Vec<f32> = (0..=120).map(|frame| frame as f32 / 30.0).collect();
    let inwards = |time: &f32| 0.2 + 1.37 * (0.5 - 0.5 * (std::f32::consts::PI * time).cos());
    let hang = |time: &f32| {
        Quat::from_rotation_x(-forwards) * Quat::from_rotation_y(-inwards(time)) * Quat::from_rotation_z(-1.5)
    };
    let keys = [times.iter().map(hang).collect(), vec![Quat::from_rotation_y(-1.57); times.len()]];
    for (slot, keys) in [Slot::LeftUpperArm, Slot::LeftLowerArm].into_iter().zip(keys) {
        clip.channel(figure.joint(slot), Interpolation::Linear, &times, Keys::Rotation(keys)).unwrap();
    }
    let clip = clip.build();
    figure.set_clip(clip);
    figure
}

/// Straight arms go forwards until the palms meet, one second in, stay for half a second and open again.
fn clap(mut figure: Figure) -> Figure {
    let mut clip = ClipBuilder::new("clap", &figure.asset.skeleton);
    let meet = 90.0 + (0.18_f32 / 0.625).asin().to_degrees();
    for (slot, side) in [(Slot::LeftUpperArm, -1.0), (Slot::RightUpperArm, 1.0)] {
        let keys = [40.0, meet, meet, 40.0].map(|degrees| Quat::from_rotation_y(side * degrees.to_radians())).to_vec();
        clip.channel(figure.joint(slot), Interpolation::Linear, &[0.0, 1.0, 1.5, 2.5], Keys::Rotation(keys)).unwrap();
    }
    let clip = clip.build();
    figure.set_clip(clip);
    figure
}

/// Bends down by an angle in one second, keeps the hands down for one and a half, and straightens up. The arms hang with bent
/// elbows.
fn bend_down(mut figure: Figure, degrees: f32) -> Figure {
    let mut clip = ClipBuilder::new("bend", &figure.asset.skeleton);
    let times = [0.0, 1.0, 2.5, 3.5];
    let bent = Quat::from_rotation_x(degrees.to_radians());
    let mut turn = |slot: Slot, up: Quat, down: Quat| {
        let keys = Keys::Rotation(vec![up, down, down, up]);
        clip.channel(figure.joint(slot), Interpolation::Linear, &times, keys).unwrap();
    };
    turn(Slot::Hips, Quat::IDENTITY, bent);
    turn(Slot::LeftUpperLeg, Quat::IDENTITY, bent.inverse());
    turn(Slot::RightUpperLeg, Quat::IDENTITY, bent.inverse());
    let elbow = Quat::from_rotation_x(40.0_f32.to_radians());
    let arms = [
        (-1.0, [Slot::LeftUpperArm, Slot::LeftLowerArm, Slot::LeftHand]),
        (1.0, [Slot::RightUpperArm, Slot::RightLowerArm, Slot::RightHand]),
    ];
    for (side, [upper, lower, hand]) in arms {
        let hang = Quat::from_rotation_z(side * std::f32::consts::FRAC_PI_2);
        let local = |turn: Quat| hang.inverse() * turn * hang;
        turn(upper, elbow.inverse() * hang, bent.inverse() * elbow.inverse() * hang);
        turn(lower, local(elbow * elbow), local(elbow * elbow));
        turn(hand, local(elbow.inverse()), local(elbow.inverse()));
    }
    // The legs hang below the hips' joint, which is turned.
    let rest = figure.asset.skeleton.rest().local(figure.joint(Slot::Hips)).translation;
    let legs = Vec3::new(0.0, -0.05, 0.0) * rest.y;
    let down = rest + legs - bent * legs;
    let keys = Keys::Translation(vec![rest, down, down, rest]);
    clip.channel(figure.joint(Slot::Hips), Interpolation::Linear, &times, keys).unwrap();
    let clip = clip.build();
    figure.set_clip(clip);
    figure
}

/// Lifts the right foot, brings it to the left leg for half a second and back: thigh and shin bend alike, so the shin is behind the
/// knee.
fn legs_together(mut figure: Figure) -> Figure {
    let mut clip = ClipBuilder::new("together", &figure.asset.skeleton);
    let bend = |share: f32| Quat::from_rotation_x(share * 25.0_f32.to_radians());
    let inwards = Quat::from_rotation_z(8.0_f32.to_radians());
    let turns = [
        (Slot::RightUpperLeg, [bend(-1.0), inwards * bend(-1.0)]),
        (Slot::RightLowerLeg, [bend(2.0); 2]),
        (Slot::RightFoot, [bend(-1.0); 2]),
    ];
    for (slot, [up, together]) in turns {
        let keys = vec![Quat::IDENTITY, up, together, together, up, Quat::IDENTITY];
        let times = [0.0, 0.5, 1.0, 1.5, 2.0, 2.5];
        clip.channel(figure.joint(slot), Interpolation::Linear, &times, Keys::Rotation(keys)).unwrap();
    }
    let clip = clip.build();
    figure.set_clip(clip);
    figure
}

fn hands_to_the_ground(figure: Figure) -> Figure {
    bend_down(figure, 134.5)
}

/// How high the left fingertips are above the ground, where the toes rest, as a share of the height of a figure of boxes.
fn fingertips(model: &Figure, clip: &Clip, time: f32) -> f64 {
    let rest = model.world_of(model.asset.skeleton.rest());
    let place = |world: &[(DQuat, DVec3)], slot: Slot| world[model.joint(slot).get()];
    let upper_arm = place(&rest, Slot::LeftLowerArm).1.distance(place(&rest, Slot::LeftUpperArm).1);
    let height = place(&rest, Slot::Head).1.y - place(&rest, Slot::LeftToes).1.y;
    let world = model.world(clip, time);
    let (turn, wrist) = place(&world, Slot::LeftHand);
    let tips = wrist + turn * DVec3::X * (0.17 / 0.28 * upper_arm);
    (tips.y - place(&rest, Slot::LeftToes).1.y) / height
}

pub fn retarget(model: &Figure, motion: &Figure, contacts: Contacts) -> (Retargeted, Figures) {
    let map = ResolvedMap { contacts, ..map(model, motion) };
    let pair = Retargeting::new(body(model), body(motion), 0, &map).unwrap();
    let done = pair.bake().unwrap();
    let figures = pair.figures(&done);
    (done, figures)
}

pub fn keys_of(clip: &Clip, joint: JointIndex) -> Vec<Keys> {
    clip.channels().iter().filter(|channel| channel.joint == joint).map(|channel| channel.keys.clone()).collect()
}

#[test]
fn a_hand_stays_out_of_a_larger_belly_and_keeps_touching_it() {
    let motion = hand_to_belly(with_boxes(&Rig::default(), 0.1));
    let model = with_boxes(&Rig::default(), 0.22);
    let (off, before) = retarget(&model, &motion, Contacts::Off);
    let (keep, after) = retarget(&model, &motion, Contacts::Keep);
    let shares = [&before, &after].map(|figures| figures.self_penetration_share.unwrap());
    assert!(shares[0] > 0.02 && shares[1] < 0.4 * shares[0], "{shares:?}");
    let errors = [&before, &after].map(|figures| figures.contact_error_metres_mean.unwrap());
    assert!(errors[0] > 0.05 && errors[1] < 0.5 * errors[0], "{errors:?}");
    // Nothing else changes: not the trunk, nor the direction of a hand.
    for slot in [Slot::Hips, Slot::Spine, Slot::Chest, Slot::Head, Slot::LeftUpperLeg, Slot::LeftLowerLeg] {
        let joint = model.joint(slot);
        assert!(keys_of(&off.clip, joint) == keys_of(&keep.clip, joint), "{slot:?}");
    }
    for time in [0.0, 0.4, 1.0, 1.7, 2.6] {
        let [before, after] = [&off.clip, &keep.clip].map(|clip| model.world(clip, time));
        let hand = model.joint(Slot::LeftHand).get();
        assert!(degrees(before[hand].0, after[hand].0) < 1.0, "at {time} s");
    }
    assert!(keep.unplanted.is_some());
}

#[test]
fn a_leg_stays_out_of_the_one_that_stands() {
    let motion = legs_together(with_legs(0.035));
    let model = with_legs(0.075);
    let (off, before) = retarget(&model, &motion, Contacts::Off);
    let (keep, after) = retarget(&model, &motion, Contacts::Keep);
    let shares = [&before, &after].map(|figures| figures.self_penetration_share.unwrap());
    assert!(shares[0] > 0.01 && shares[1] < 0.3 * shares[0], "{shares:?}");
    let feet =
        |time: f32, slot: Slot| [&off.clip, &keep.clip].map(|clip| model.world(clip, time)[model.joint(slot).get()]);
    for frame in 0..=50 {
        let [before, after] = feet(0.05 * frame as f32, Slot::LeftFoot);
        assert!(before.1.distance(after.1) < 1e-6, "it stands");
    }
    let [before, after] = feet(1.25, Slot::RightFoot);
    let moved = after.1 - before.1;
    assert!(moved.x < -0.03 && moved.y.abs() < 0.01 && degrees(before.0, after.0) < 0.1, "{moved}");
    // Legs as thin as the source's keep their clip.
    let clips = [Contacts::Off, Contacts::Keep].map(|contacts| retarget(&motion, &motion, contacts).0.clip);
    for joint in motion.asset.skeleton.joints() {
        assert!(keys_of(&clips[0], joint) == keys_of(&clips[1], joint), "{joint:?}");
    }
}

/// As with a source that has no hands.
#[test]
fn an_arm_whose_hand_is_not_mapped_stays_out_of_the_belly() {
    let motion = hand_to_belly(with_boxes(&Rig::default(), 0.1));
    let model = with_boxes(&Rig::default(), 0.22);
    let mut map = map(&model, &motion);
    let hands = [Slot::LeftHand, Slot::RightHand].map(|slot| model.joint(slot));
    map.pairs.retain(|pair| !hands.contains(&pair.target));
    let shares = [Contacts::Off, Contacts::Keep].map(|contacts| {
        let map = ResolvedMap { contacts, ..map.clone() };
        let pair = Retargeting::new(body(&model), body(&motion), 0, &map).unwrap();
        pair.figures(&pair.bake().unwrap()).self_penetration_share.unwrap()
    });
    assert!(shares[0] > 0.02 && shares[1] < 0.5 * shares[0], "{shares:?}");
}

#[test]
fn a_body_like_the_source_keeps_its_clip() {
    for (size, motion) in
        [(1.0, hand_to_belly as fn(Figure) -> Figure), (2.5, hand_to_belly), (2.5, hands_to_the_ground)]
    {
        let motion = motion(with_boxes(&Rig::default(), 0.1));
        let model = with_boxes(&Rig { size, ..Rig::default() }, 0.1);
        let (off, _) = retarget(&model, &motion, Contacts::Off);
        let (keep, figures) = retarget(&model, &motion, Contacts::Keep);
        assert!(figures.contact_error_metres_mean.unwrap() < 1e-4 * size, "{figures:?}");
        for joint in model.asset.skeleton.joints() {
            assert!(keys_of(&off.clip, joint) == keys_of(&keep.clip, joint), "{size}: {joint:?}");
        }
    }
}

#[test]
fn hands_rest_on_the_ground_whatever_the_proportions() {
    let motion = hands_to_the_ground(with_boxes(&Rig::default(), 0.1));
    let source = fingertips(&motion, &motion.asset.clips[0], 1.7);
    assert!(source.abs() < 0.015, "{source}");
    for (size, leg_length) in [(1.0, 0.9), (1.0, 1.1), (2.5, 0.9)] {
        let model = with_boxes(&Rig { size, leg_length, ..Rig::default() }, 0.1);
        let [(off, before), (keep, after)] =
            [Contacts::Off, Contacts::Keep].map(|contacts| retarget(&model, &motion, contacts));
        let heights = [&off.clip, &keep.clip].map(|clip| fingertips(&model, clip, 1.7) - source);
        assert!(heights[0].abs() > 0.04 && heights[1].abs() < 0.01, "{leg_length}: {heights:?}");
        let errors = [&before, &after].map(|figures| figures.contact_error_metres_mean.unwrap());
        assert!(errors[0] > 0.05 * size && errors[1] < 0.3 * errors[0], "{leg_length}: {errors:?}");
        // Nothing changes while the hands are up, nor the trunk and the legs at any time.
        for time in [0.0, 0.4, 3.1, 3.5] {
            let moved = [&off.clip, &keep.clip].map(|clip| fingertips(&model, clip, time));
            assert!((moved[0] - moved[1]).abs() < 1e-4, "{leg_length}: {moved:?} at {time} s");
        }
        for slot in [Slot::Hips, Slot::Spine, Slot::Chest, Slot::LeftUpperLeg, Slot::LeftLowerLeg, Slot::LeftFoot] {
            let joint = model.joint(slot);
            assert!(keys_of(&off.clip, joint) == keys_of(&keep.clip, joint), "{slot:?}");
        }
    }
}

#[test]
fn a_trunk_leans_as_far_as_arms_are_too_short() {
    let motion = hands_to_the_ground(with_boxes(&Rig::default(), 0.1));
    let source = fingertips(&motion, &motion.asset.clips[0], 1.7);
    for size in [1.0, 2.5] {
        let model = with_boxes(&Rig { size, leg_length: 1.25, ..Rig::default() }, 0.1);
        let [off, keep] = [Contacts::Off, Contacts::Keep].map(|contacts| retarget(&model, &motion, contacts).0.clip);
        // The motion bends at its hips, so only leaning needs the spine.
        let mut stiff = ResolvedMap { contacts: Contacts::Keep, ..map(&model, &motion) };
        stiff.pairs.retain(|pair| ![Slot::Spine, Slot::Chest].map(|slot| model.joint(slot)).contains(&pair.target));
        let stiff = Retargeting::new(body(&model), body(&motion), 0, &stiff).unwrap().bake().unwrap().clip;
        let heights = [&off, &stiff, &keep].map(|clip| fingertips(&model, clip, 1.7) - source);
        assert!(heights[0] > 0.08 && heights[1] > 0.045 && heights[2] < 0.7 * heights[1], "{heights:?}");
        let turn = |slot: Slot, time: f32| {
            let joint = model.joint(slot).get();
            degrees(model.world(&off, time)[joint].0, model.world(&keep, time)[joint].0)
        };
        let chest = turn(Slot::Chest, 1.7);
        assert!((5.0..15.01).contains(&chest), "{chest}");
        // Spine and chest share the turn.
        assert!((turn(Slot::Spine, 1.7) - 0.5 * chest).abs() < 0.01);
        for time in [0.0, 0.4, 1.7, 3.1, 3.5] {
            assert!(turn(Slot::Neck, time) < 0.01 && turn(Slot::Head, time) < 0.01);
        }
        assert!([0.0, 0.4, 3.1, 3.5].iter().all(|&time| turn(Slot::Chest, time) < 0.01), "it leans with its hands up");
        for slot in [Slot::Hips, Slot::LeftUpperLeg, Slot::RightLowerLeg, Slot::LeftFoot] {
            let joint = model.joint(slot);
            assert!(keys_of(&off, joint) == keys_of(&keep, joint), "{slot:?}");
        }
    }
}

#[test]
fn arms_stay_out_of_the_ground() {
    let motion = bend_down(with_boxes(&Rig::default(), 0.1), 120.0);
    let source = fingertips(&motion, &motion.asset.clips[0], 1.7);
    assert!((0.05..0.08).contains(&source), "{source}");
    let model = with_boxes(&Rig { leg_length: 0.8, ..Rig::default() }, 0.1);
    let [off, keep] = [Contacts::Off, Contacts::Keep].map(|contacts| {
        let (done, figures) = retarget(&model, &motion, contacts);
        assert_eq!(figures.contact_error_metres_mean, None);
        fingertips(&model, &done.clip, 1.7)
    });
    // The outermost points of a hand are an eighth of its length before the tips.
    assert!(off < -0.04 && keep > -0.024, "{off} {keep}");
}

/// The source gets down to a push-up.
#[test]
fn hands_of_a_push_up_stay_in_place() {
    let Some(folder) = data_folder() else { return };
    let [model, motion] = ["human-male.glb", "mixamo-original-rig.glb"].map(|name| load_one(&folder, name));
    let map = proposed(&model, &motion).unwrap();
    let skeleton = &model.asset.skeleton;
    let wrist = model.slots.joint(Slot::RightHand).unwrap().get();
    let place = |clip: &Clip, time: f32| {
        let (mut pose, mut world) = (skeleton.rest().clone(), Vec::new());
        clip.sample(skeleton, time, &mut SampleCursor::default(), &mut pose);
        model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut world);
        world[wrist].translation
    };
    let [off, keep] = [Contacts::Off, Contacts::Keep].map(|contacts| {
        let map = ResolvedMap { contacts, feet: Feet::Plant, ..map.clone() };
        let (figures, done) = measured(&model, &motion, &map).unwrap();
        let places: Vec<Vec3A> = (20..48).map(|at| place(&done.clip, at as f32 / 10.0)).collect();
        let mean = places.iter().sum::<Vec3A>() / places.len() as f32;
        let spread = places.iter().map(|at| at.distance(mean)).fold(0.0, f32::max);
        (figures.contact_error_metres_mean.unwrap(), spread)
    });
    assert!(off.0 > 0.02 && keep.0 < 0.4 * off.0, "{off:?} {keep:?}");
    assert!(keep.1 < 0.8 * off.1, "{off:?} {keep:?}");
}

#[test]
fn fat_hands_clap_without_going_through_each_other() {
    let motion = clap(with_boxes(&Rig::default(), 0.1));
    let model = with_hands(&Rig::default(), 0.22, 0.05);
    let hands = [Slot::LeftHand, Slot::RightHand].map(|slot| model.joint(slot).get());
    let [(off, before), (keep, after)] =
        [Contacts::Off, Contacts::Keep].map(|contacts| retarget(&model, &motion, contacts));
    // From the middle of one palm to the other, 8.5 cm along each hand.
    let gap = |clip: &Clip| {
        let world = model.world(clip, 1.25);
        let [left, right] = hands.map(|hand| world[hand]);
        let middle = |(turn, at): (DQuat, DVec3), along: f64| at + turn * DVec3::X * along;
        middle(left, 0.085).x - middle(right, -0.085).x - 2.0 * 0.05
    };
    assert!(gap(&off.clip) < -0.05 && gap(&keep.clip).abs() < 0.025, "{} {}", gap(&off.clip), gap(&keep.clip));
    let errors = [&before, &after].map(|figures| figures.contact_error_metres_mean.unwrap());
    assert!(errors[1] < 0.5 * errors[0], "{errors:?}");
    let shares = [&before, &after].map(|figures| figures.self_penetration_share.unwrap());
    assert!(shares[1] < 0.6 * shares[0], "{shares:?}");
}

#[test]
fn the_same_input_gives_the_same_clip_and_off_is_the_default() {
    let motion = hand_to_belly(with_boxes(&Rig::default(), 0.1));
    let model = with_boxes(&Rig::default(), 0.22);
    let clips = [Contacts::Keep, Contacts::Keep].map(|contacts| retarget(&model, &motion, contacts).0.clip);
    for joint in model.asset.skeleton.joints() {
        assert!(keys_of(&clips[0], joint) == keys_of(&clips[1], joint), "{joint:?}");
    }
    assert_eq!(map(&model, &motion).contacts, Contacts::Off);
}

#[test]
fn a_quick_pass_is_no_contact() {
    let mut motion = hand_to_belly(with_boxes(&Rig::default(), 0.1));
    let joint = motion.joint(Slot::LeftUpperArm);
    let mut clip = ClipBuilder::new("swing", &motion.asset.skeleton);
    let keys = [-1.4_f32, 0.6].map(|swing| Quat::from_rotation_x(-swing) * Quat::from_rotation_z(-1.45)).to_vec();
    clip.channel(joint, Interpolation::Linear, &[0.0, 0.3], Keys::Rotation(keys)).unwrap();
    let clip = clip.build();
    motion.set_clip(clip);
    let (_, figures) = retarget(&with_boxes(&Rig::default(), 0.1), &motion, Contacts::Off);
    assert_eq!(figures.contact_error_metres_mean, None);
}

#[test]
fn corrections_are_smooth() {
    let motion = hand_to_belly(with_boxes(&Rig::default(), 0.1));
    let model = with_boxes(&Rig::default(), 0.22);
    let clips = [Contacts::Off, Contacts::Keep].map(|contacts| retarget(&model, &motion, contacts).0.clip);
    let hand = model.joint(Slot::LeftHand).get();
    let offset = |time: f32| {
        let [off, keep] = clips.each_ref().map(|clip| model.world(clip, time)[hand].1);
        keep - off
    };
    let offsets: Vec<DVec3> = (0..=240).map(|frame| offset(frame as f32 / 60.0)).collect();
    let largest = offsets.iter().map(|offset| offset.length()).fold(0.0, f64::max);
    let step = offsets.windows(2).map(|pair| pair[0].distance(pair[1])).fold(0.0, f64::max);
    assert!(largest > 0.05 && step < 0.015, "{largest} m, {step} m per frame");
}

#[test]
fn without_meshes_nothing_is_said_about_penetration() {
    let motion = hand_to_belly(build(&Rig::default()));
    let (_, figures) = retarget(&build(&Rig::default()), &motion, Contacts::Keep);
    assert_eq!((figures.self_penetration_share, figures.contact_error_metres_mean), (None, None));
    // A motion without a mesh has the proportions of an adult, whose belly is as deep as that of boxes, but round: the hand, beside
    // its middle, has to go further back to touch it.
    let motion = hand_inwards(build(&Rig::default()), 0.35);
    let (_, figures) = retarget(&with_boxes(&Rig::default(), 0.22), &motion, Contacts::Off);
    assert!(figures.self_penetration_share.is_some() && figures.contact_error_metres_mean.is_some(), "{figures:?}");
}

#[test]
fn planted_feet_stay_where_they_are() {
    let motion = hand_to_belly(with_boxes(&Rig::default(), 0.1));
    let model = with_boxes(&Rig { leg_length: 1.3, ..Rig::default() }, 0.22);
    let plain = map(&model, &motion);
    let positions = [Contacts::Off, Contacts::Keep].map(|contacts| {
        let map = ResolvedMap { contacts, feet: Feet::Plant, ..plain.clone() };
        let done = Retargeting::new(body(&model), body(&motion), 0, &map).unwrap().bake().unwrap();
        assert!(done.planting.is_some());
        let world: Vec<(DQuat, DVec3)> = model.world(&done.clip, 1.0);
        [Slot::LeftFoot, Slot::RightFoot, Slot::LeftHand].map(|slot| world[model.joint(slot).get()].1)
    });
    let moved = [0, 1, 2].map(|at| positions[0][at].distance(positions[1][at]));
    assert!(moved[0] < 1e-6 && moved[1] < 1e-6 && moved[2] > 0.02, "{moved:?}");
}

/// Its hands hold a gun, skinned to a joint of one hand: that is neither a part of its body nor a contact.
#[test]
fn a_gun_is_no_part_of_a_hand() {
    let Some(folder) = data_folder() else { return };
    let [model, motion] = ["human-male.glb", "ArmyPilot.glb"].map(|name| load_one(&folder, name));
    let map = ResolvedMap { contacts: Contacts::Keep, ..proposed(&model, &motion).unwrap() };
    let clip = motion.asset.clips.iter().position(|clip| clip.name() == "Standing_2").unwrap();
    let pair = Retargeting::new(model.body(), motion.body(), clip, &map).unwrap();
    let figures = pair.figures(&pair.bake().unwrap());
    assert!(figures.self_penetration_share.unwrap() < 0.01, "{figures:?}");
    assert_eq!(figures.contact_error_metres_mean, None);
}
