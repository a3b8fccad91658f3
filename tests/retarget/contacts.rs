//! Contacts of the body with itself, on figures with bodies of boxes.

use gaitway::anim::{Clip, ClipBuilder, Interpolation, JointIndex, Keys};
use gaitway::asset::{Asset, AssetParts, MeshInstance, Slot};
use gaitway::mesh::{Geometry, Mesh};
use gaitway::retarget::{Contacts, Feet, Figures, ResolvedMap, Retargeted, Retargeting};
use glam::{DQuat, DVec3, Quat, Vec3};

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
fn with_boxes(rig: &Rig, belly: f32) -> Figure {
    with_hands(rig, belly, 0.02)
}

/// The same with hands of a given half width.
fn with_hands(rig: &Rig, belly: f32, hand: f32) -> Figure {
    let mut figure = build(rig);
    let size = rig.size as f32;
    let mut meshes = Vec::new();
    let mut instances = Vec::new();
    for (slot, corners) in boxes(belly, hand) {
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

fn retarget(model: &Figure, motion: &Figure, contacts: Contacts) -> (Retargeted, Figures) {
    let map = ResolvedMap { contacts, ..map(model, motion) };
    let pair = Retargeting::new(body(model), body(motion), 0, &map).unwrap();
    let done = pair.bake().unwrap();
    let figures = pair.figures(&done);
    (done, figures)
}

fn keys_of(clip: &Clip, joint: JointIndex) -> Vec<Keys> {
    clip.channels().iter().filter(|channel| channel.joint == joint).map(|channel| channel.keys.clone()).collect()
}

#[test]
fn a_hand_stays_out_of_a_larger_belly_and_keeps_touching_it() {
    let motion = hand_to_belly(with_boxes(&Rig::default(), 0.1));
    let model = with_boxes(&Rig::default(), 0.22);
    let (off, before) = retarget(&model, &motion, Contacts::Off);
    let (keep, after) = retarget(&model, &motion, Contacts::Keep);
    let shares = [before, after].map(|figures| figures.self_penetration_share.unwrap());
    assert!(shares[0] > 0.02 && shares[1] < 0.4 * shares[0], "{shares:?}");
    let errors = [before, after].map(|figures| figures.contact_error_metres_mean.unwrap());
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
    for size in [1.0, 2.5] {
        let motion = hand_to_belly(with_boxes(&Rig::default(), 0.1));
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
    let errors = [before, after].map(|figures| figures.contact_error_metres_mean.unwrap());
    assert!(errors[1] < 0.5 * errors[0], "{errors:?}");
    let shares = [before, after].map(|figures| figures.self_penetration_share.unwrap());
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

/// Means over some of the pairs in docs/retargeting.md, without contacts kept and with.
#[test]
fn real_people_touch_where_their_sources_do() {
    let Some(folder) = data_folder() else { return };
    let models = ["CesiumMan.glb", "Soldier.glb"].map(|name| load_one(&folder, name));
    let motions = ["assimp_Boxing_Toes.bvh", "Samba_Dancing.glb"].map(|name| load_one(&folder, name));
    let mut sums = [[0.0; 4]; 2];
    for (model, motion) in models.iter().flat_map(|model| motions.iter().map(move |motion| (model, motion))) {
        let map = proposed(model, motion).unwrap();
        for (contacts, sums) in [Contacts::Off, Contacts::Keep].into_iter().zip(&mut sums) {
            let (figures, _) = measured(model, motion, &ResolvedMap { contacts, ..map.clone() }).unwrap();
            let values = [
                figures.self_penetration_share,
                figures.contact_error_metres_mean,
                figures.limb_direction_error_degrees_mean,
                figures.foot_slide_metres_per_sec,
            ];
            // A clip without contacts has no error of them.
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value.unwrap_or_default());
        }
    }
    let [[inside, missed, direction, slide], kept] = sums;
    assert!(inside > 0.1 && missed > 0.1, "{sums:?}");
    assert!(kept[0] < 0.6 * inside && kept[1] < 0.5 * missed, "{sums:?}");
    // These motions touch the body more than most do: over all pairs, limbs turn by less than 1.5°.
    assert!(kept[2] < direction + 4.0 * 2.0 && kept[3] <= slide + 1e-6, "{sums:?}");
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
