//! The rotation law on figures whose exact answer is known.

use gaitway_character::anim::{Clip, Interpolation, Keys};
use gaitway_character::asset::{Asset, AssetParts, Slot};
use gaitway_retarget::{
    Body, Keep, Pair, PathOrigin, ResolvedMap, RestChoice, Retargeted, Retargeting, RootOptions, RootPart,
};
use glam::{DQuat, DVec3, Quat, Vec3};

use crate::contacts::dressed;
use crate::figure::{BODY, Figure, Rig, build};
use crate::rests::with_rest;

/// Maps all slots that both have.
pub fn map(model: &Figure, motion: &Figure) -> ResolvedMap {
    let mut pairs: Vec<Pair> = model
        .slots
        .0
        .iter()
        .filter_map(|(&slot, &target)| {
            Some(Pair { target, source: motion.slots.joint(slot)?, correction: Quat::IDENTITY })
        })
        .collect();
    pairs.sort_by_key(|pair| pair.target);
    ResolvedMap { pairs, ..ResolvedMap::default() }
}

pub fn body(figure: &Figure) -> Body<'_> {
    Body { asset: &figure.asset, slots: &figure.slots }
}

fn retarget(model: &Figure, motion: &Figure, map: &ResolvedMap) -> Retargeted {
    Retargeting::new(body(model), body(motion), 0, map).unwrap().bake().unwrap()
}

pub fn degrees(a: DQuat, b: DQuat) -> f64 {
    let turn = a.conjugate() * b;
    (2.0 * turn.xyz().length().atan2(turn.w.abs())).to_degrees()
}

/// Checks that each body part that both have turns alike, within `max_degrees`, at many times.
fn check_body_parts(model: &Figure, motion: &Figure, max_degrees: f64) -> Retargeted {
    let map = map(model, motion);
    let done = retarget(model, motion, &map);
    let mut worst: f64 = 0.0;
    for step in 0..=60 {
        let time = step as f32 * 1.6 / 60.0;
        let wanted = motion.body_parts(&motion.asset.clips[0], time);
        let found = model.body_parts(&done.clip, time);
        for (slot, turn) in &found {
            if let Some(wanted) = wanted.get(slot) {
                worst = worst.max(degrees(*wanted, *turn));
            }
        }
    }
    assert!(worst < max_degrees, "{worst} degrees");
    done
}

fn dancer(rig: &Rig, interpolation: Interpolation) -> Figure {
    let mut figure = build(rig);
    figure.dance(11, 70.0, interpolation);
    figure
}

#[test]
fn the_same_skeleton_keeps_its_keys() {
    for interpolation in [Interpolation::Step, Interpolation::Linear, Interpolation::CubicSpline] {
        for armature in [false, true] {
            let figure = dancer(&Rig { axes: 3, armature, ..Rig::default() }, interpolation);
            let map = ResolvedMap { translations: Keep::Keep, scales: Keep::Keep, ..map(&figure, &figure) };
            let done = retarget(&figure, &figure, &map);
            assert_eq!(done.resampled, []);
            assert_eq!(done.keys_in, done.keys_out);
            let clip = &figure.asset.clips[0];
            for step in 0..=60 {
                let time = step as f32 * 1.5 / 60.0;
                for (wanted, found) in figure.world(clip, time).iter().zip(figure.world(&done.clip, time)) {
                    assert!(wanted.1.distance(found.1) < 1e-6 * 1.7, "{} at {time}", wanted.1.distance(found.1));
                    assert!(degrees(wanted.0, found.0) < 1e-4);
                }
            }
        }
    }
}

#[test]
fn other_axes_sizes_names_and_an_armature_change_nothing() {
    let motion = dancer(&Rig::default(), Interpolation::Linear);
    let rig = Rig { axes: 5, prefix: "x:", size: 2.5, leg_length: 0.7, armature: true, ..Rig::default() };
    let done = check_body_parts(&build(&rig), &motion, 1e-3);
    assert_eq!(done.resampled, [], "every joint has a counterpart, so keys are transformed");
    let motion = dancer(&rig, Interpolation::Linear);
    check_body_parts(&build(&Rig { axes: 9, ..Rig::default() }), &motion, 1e-3);
}

#[test]
fn rests_with_lowered_and_raised_arms_are_aligned() {
    let lowered = Rig { axes: 5, arms_down_degrees: 45.0, ..Rig::default() };
    let raised = Rig { axes: 8, armature: true, ..Rig::default() };
    for (model, motion) in [(&lowered, &raised), (&raised, &lowered)] {
        check_body_parts(&build(model), &dancer(motion, Interpolation::Linear), 0.05);
    }
}

#[test]
fn a_model_that_faces_another_way_turns_the_whole_motion() {
    let motion = dancer(&Rig { axes: 2, ..Rig::default() }, Interpolation::Linear);
    let model = build(&Rig { axes: 4, facing_degrees: 90.0, ..Rig::default() });
    let done = retarget(&model, &motion, &map(&model, &motion));
    let turn = DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2);
    for step in 0..=20 {
        let time = step as f32 * 1.5 / 20.0;
        let wanted = motion.body_parts(&motion.asset.clips[0], time);
        for (slot, found) in model.body_parts(&done.clip, time) {
            assert!(degrees(turn * wanted[&slot], found) < 0.01, "{slot:?}");
        }
        let hips = |figure: &Figure, clip| figure.world(clip, time)[figure.joint(Slot::Hips).get()].1;
        assert!((turn * hips(&motion, &motion.asset.clips[0])).distance(hips(&model, &done.clip)) < 1e-4);
    }
}

#[test]
fn joints_missing_on_one_side_are_folded_into_their_neighbours() {
    let full = Rig { axes: 5, ..Rig::default() };
    let lacking = Rig { axes: 6, without: vec![Slot::Spine, Slot::Neck, Slot::LeftShoulder], ..Rig::default() };
    let more = Rig { axes: 7, doubled: vec![Slot::Chest, Slot::LeftLowerArm, Slot::RightFoot], ..Rig::default() };
    let motion = dancer(&full, Interpolation::Linear);
    let done = check_body_parts(&build(&lacking), &motion, 0.1);
    assert!(!done.resampled.is_empty(), "a joint that combines two moving ones cannot keep either's keys");
    check_body_parts(&build(&more), &motion, 1e-3);
    check_body_parts(&build(&full), &dancer(&lacking, Interpolation::Linear), 1e-3);
    // Moving joints of the source that the target does not have.
    let mut motion = build(&more);
    let extra = motion.asset.skeleton.find("extra_chest").unwrap();
    motion.slots.0.insert(Slot::UpperChest, extra);
    motion.t_pose.insert(Slot::UpperChest, DQuat::IDENTITY);
    motion.dance(12, 60.0, Interpolation::Linear);
    motion.slots.0.remove(&Slot::UpperChest);
    check_body_parts(&build(&full), &motion, 0.1);
}

#[test]
fn retargeting_there_and_back_gives_the_same_motion() {
    let first = dancer(&Rig { axes: 3, arms_down_degrees: 30.0, ..Rig::default() }, Interpolation::Linear);
    let mut second =
        build(&Rig { axes: 4, size: 0.6, leg_length: 1.2, armature: true, prefix: "other_", ..Rig::default() });
    let there = retarget(&second, &first, &map(&second, &first));
    second.set_clip(there.clip);
    let back = retarget(&first, &second, &map(&first, &second));
    for step in 0..=30 {
        let time = step as f32 * 1.5 / 30.0;
        let (wanted, found) = (first.world(&first.asset.clips[0], time), first.world(&back.clip, time));
        for (wanted, found) in wanted.iter().zip(found) {
            assert!(degrees(wanted.0, found.0) < 0.01, "{}", degrees(wanted.0, found.0));
            assert!(wanted.1.distance(found.1) < 1e-4, "{}", wanted.1.distance(found.1));
        }
    }
}

#[test]
fn splines_stay_splines() {
    let motion = dancer(&Rig { axes: 1, ..Rig::default() }, Interpolation::CubicSpline);
    let model = build(&Rig { axes: 2, size: 3.0, armature: true, ..Rig::default() });
    let done = check_body_parts(&model, &motion, 1e-3);
    assert!(done.clip.channels().iter().all(|channel| channel.interpolation == Interpolation::CubicSpline));
    // Not only rotations but the hips' path between the keys as well.
    let scale = done.hips_scale.unwrap();
    fn hips(figure: &Figure, clip: &Clip, time: f32) -> DVec3 {
        figure.world(clip, time)[figure.joint(Slot::Hips).get()].1
    }
    let (model_rest, motion_rest) = (rest_of(&model), rest_of(&motion));
    let offset = hips(&model, &model_rest, 0.0) - scale * hips(&motion, &motion_rest, 0.0);
    for step in 0..=200 {
        let time = step as f32 * 1.5 / 200.0;
        let wanted = offset + scale * hips(&motion, &motion.asset.clips[0], time);
        let found = hips(&model, &done.clip, time);
        assert!(wanted.distance(found) < 1e-4, "{} at {time}", wanted.distance(found));
    }
}

fn rest_of(figure: &Figure) -> gaitway_character::anim::Clip {
    gaitway_character::anim::ClipBuilder::new("", &figure.asset.skeleton).build()
}

#[test]
fn a_correction_turns_one_joint_and_not_its_children() {
    let motion = dancer(&Rig::default(), Interpolation::Linear);
    let model = build(&Rig { axes: 6, ..Rig::default() });
    let plain = retarget(&model, &motion, &map(&model, &motion));
    let mut corrected = map(&model, &motion);
    let correction = Quat::from_rotation_y(0.4);
    let joint = model.joint(Slot::LeftUpperArm);
    corrected.pairs.iter_mut().find(|pair| pair.target == joint).unwrap().correction = correction;
    let turned = retarget(&model, &motion, &corrected);
    let (plain, turned) = (model.world(&plain.clip, 0.7), model.world(&turned.clip, 0.7));
    for (index, (plain, turned)) in plain.iter().zip(&turned).enumerate() {
        let wanted = if index == joint.get() { plain.0 * correction.as_dquat() } else { plain.0 };
        assert!(degrees(wanted, turned.0) < 1e-3);
    }
}

#[test]
fn root_options_edit_the_hips_path() {
    let motion = dancer(&Rig::default(), Interpolation::Linear);
    let model = build(&Rig { axes: 6, armature: true, ..Rig::default() });
    let plain = map(&model, &motion);
    let path = |map: &ResolvedMap| {
        let done = retarget(&model, &motion, map);
        move |time: f32| model_hips(&done, time)
    };
    fn model_hips(done: &Retargeted, time: f32) -> (DQuat, glam::DVec3) {
        let model = build(&Rig { axes: 6, armature: true, ..Rig::default() });
        model.world(&done.clip, time)[model.joint(Slot::Hips).get()]
    }
    let kept = path(&plain);
    let mut options = plain.clone();
    options.root.horizontal = RootPart::InPlace;
    let in_place = path(&options);
    assert!(in_place(0.0).1.distance(kept(0.0).1) < 1e-5);
    let ends = in_place(1.5).1 - in_place(0.0).1;
    assert!(ends.x.abs() < 1e-5 && ends.z.abs() < 1e-5 && (kept(1.5).1 - kept(0.0).1).length() > 0.05);
    let middle = kept(0.6).1 - (kept(1.5).1 - kept(0.0).1) * glam::DVec3::new(0.4, 0.0, 0.4);
    assert!(in_place(0.6).1.distance(middle) < 1e-4, "the sway stays");

    options.root.horizontal = RootPart::Keep;
    options.root.vertical = RootPart::Freeze;
    let frozen = path(&options);
    for time in [0.0, 0.4, 1.1, 1.5] {
        assert!((frozen(time).1.y - kept(0.0).1.y).abs() < 1e-5);
        assert!((frozen(time).1.x - kept(time).1.x).abs() < 1e-4);
    }

    options = plain.clone();
    options.root.yaw = RootPart::Freeze;
    let facing = path(&options);
    let yaw = |turn: DQuat| {
        let rest = model.t_pose[&Slot::Hips];
        let away = turn * rest.conjugate();
        2.0 * (away.y * away.w.signum()).atan2(away.w.abs())
    };
    for time in [0.0, 0.4, 1.1, 1.5] {
        assert!((yaw(facing(time).0) - yaw(kept(0.0).0)).abs() < 2e-3, "{time}");
    }

    options = plain.clone();
    options.root.extract = true;
    let extracted = path(&options);
    for time in [0.0, 0.4, 1.1, 1.5] {
        assert!(extracted(time).1.distance(kept(time).1) < 2e-3, "the figure still travels");
        assert!(degrees(extracted(time).0, kept(time).0) < 0.1);
    }
    let done = retarget(&model, &motion, &options);
    let armature = model.asset.skeleton.find("Armature").unwrap();
    let travels = |channel: &&gaitway_character::anim::Channel| {
        channel.joint == armature && matches!(channel.keys, Keys::Translation(_))
    };
    assert!(done.clip.channels().iter().any(|channel| travels(&channel)), "the root joint carries the travel");
}

/// The same dance by a figure that rests elsewhere.
#[test]
fn feet_are_where_the_sources_are_wherever_it_rests() {
    let motion = dancer(&Rig::default(), Interpolation::Linear);
    let mut aside = dancer(&Rig::default(), Interpolation::Linear);
    let hips = aside.joint(Slot::Hips);
    let mut rest = aside.asset.skeleton.rest().clone();
    let mut local = rest.local(hips);
    local.translation += Vec3::new(2.0, 0.0, 3.0);
    rest.set_local(hips, local);
    let parts = aside.asset.into_parts();
    let skeleton = parts.skeleton.with_rest(&rest);
    aside.asset = Asset::new(AssetParts { skeleton, ..parts }).unwrap();
    // Of the same proportions, so that its feet can be in the same places.
    let model = build(&Rig { axes: 6, size: 3.0, ..Rig::default() });
    let feet = |figure: &Figure, clip: &Clip, time: f32| {
        let world = figure.world(clip, time);
        [Slot::LeftFoot, Slot::RightFoot].map(|slot| world[figure.joint(slot).get()].1)
    };
    for (origin, shift) in [(PathOrigin::Feet, DVec3::ZERO), (PathOrigin::Rest, DVec3::new(-6.0, 0.0, -9.0))] {
        let options = RootOptions { origin, ..RootOptions::default() };
        let done = retarget(&model, &aside, &ResolvedMap { root: options, ..map(&model, &aside) });
        for time in [0.0, 0.4, 1.1, 1.5] {
            let wanted = feet(&motion, &motion.asset.clips[0], time).map(|at| 3.0 * at + shift);
            for (wanted, found) in wanted.into_iter().zip(feet(&model, &done.clip, time)) {
                assert!(wanted.distance(found) < 1e-3, "{origin:?}: {wanted} and {found} at {time}");
            }
        }
    }
}

#[test]
fn the_first_frame_can_be_the_rest() {
    let mut motion = dancer(&Rig::default(), Interpolation::Linear);
    // The clip starts at the rest, so its first frame as the rest gives the same result as the nodes'.
    let skeleton = &motion.asset.skeleton;
    let mut clip = gaitway_character::anim::ClipBuilder::new("from rest", skeleton);
    for channel in motion.asset.clips[0].channels() {
        if let Keys::Rotation(values) = &channel.keys {
            let mut values = values.clone();
            values[0] = skeleton.rest().local(channel.joint).rotation;
            let times = &motion.asset.clips[0].timelines()[channel.timeline as usize];
            clip.channel(channel.joint, channel.interpolation, times, Keys::Rotation(values)).unwrap();
        }
    }
    let clip = clip.build();
    motion.set_clip(clip);
    let model = build(&Rig { axes: 6, ..Rig::default() });
    let mut first = map(&model, &motion);
    first.rest.motion = RestChoice::FirstFrame;
    let (node, first) = (retarget(&model, &motion, &map(&model, &motion)), retarget(&model, &motion, &first));
    let worst = model
        .world(&node.clip, 0.8)
        .iter()
        .zip(model.world(&first.clip, 0.8))
        .map(|(a, b)| degrees(a.0, b.0))
        .fold(0.0, f64::max);
    assert!(worst < 1e-3, "{worst}");
}

#[test]
fn figures_tell_a_good_clip_from_a_bad_one() {
    let motion = dancer(&Rig::default(), Interpolation::Linear);
    let model = build(&Rig { axes: 6, size: 1.3, arms_down_degrees: 40.0, ..Rig::default() });
    let map = map(&model, &motion);
    let retargeting = Retargeting::new(body(&model), body(&motion), 0, &map).unwrap();
    let done = retargeting.bake().unwrap();
    let figures = retargeting.figures(&done);
    assert!(figures.orientation_error_degrees_max.unwrap() < 0.01, "{figures:?}");
    assert!(figures.limb_direction_error_degrees_max.unwrap() < 0.1, "{figures:?}");
    assert_eq!(figures.coverage, Some(1.0));
    let wrong = rest_of(&model);
    let figures = retargeting.measure(&wrong, None).0;
    assert!(figures.orientation_error_degrees_mean.unwrap() > 10.0, "{figures:?}");
    assert!(figures.limb_direction_error_degrees_mean.unwrap() > 10.0, "{figures:?}");
}

/// A root on the ground fills the slot of the hips, or there are no legs: the path is scaled by what there is of the body.
#[test]
fn a_path_is_scaled_by_legs_or_torso_where_hips_have_no_height() {
    let of_leg = |slot: &Slot| ["Leg", "Foot", "Toes"].into_iter().any(|part| slot.name().ends_with(part));
    let legs: Vec<Slot> = BODY.iter().map(|(slot, ..)| *slot).filter(of_leg).collect();
    let grounded = |mut figure: Figure| {
        let hips = figure.joint(Slot::Hips);
        let height = figure.asset.skeleton.rest().local(hips).translation.y;
        let skeleton = with_rest(&figure.asset.skeleton, |joint, rest| {
            if joint == hips {
                rest.translation.y = 0.0;
            } else if figure.asset.skeleton.parent(joint) == Some(hips) {
                rest.translation.y += height;
            }
        });
        figure.asset = Asset::from(skeleton);
        figure
    };
    let with_legs = |size: f64, prefix| build(&Rig { size, prefix, ..Rig::default() });
    let bust = |size: f64, prefix| build(&Rig { size, prefix, without: legs.clone(), ..Rig::default() });
    for (model, mut motion) in [
        (with_legs(2.0, ""), grounded(with_legs(1.0, "m_"))),
        (grounded(with_legs(2.0, "")), with_legs(1.0, "m_")),
        (grounded(with_legs(2.0, "")), grounded(with_legs(1.0, "m_"))),
        (bust(2.0, ""), bust(1.0, "m_")),
        (bust(2.0, ""), with_legs(1.0, "m_")),
    ] {
        motion.dance(3, 20.0, Interpolation::Linear);
        let scale = retarget(&model, &motion, &map(&model, &motion)).hips_scale.unwrap();
        assert!((scale - 2.0).abs() < 1e-3, "{scale}");
    }
}

/// A hand that isn't mapped, since it has no slot on one side.
#[test]
fn a_limb_without_a_mapped_end_is_aligned_by_its_child() {
    let motion =
        dancer(&Rig { axes: 8, arms_down_degrees: 50.0, prefix: "m_", ..Rig::default() }, Interpolation::Linear);
    let mut model = build(&Rig { axes: 5, ..Rig::default() });
    for hand in [Slot::LeftHand, Slot::RightHand] {
        model.slots.0.remove(&hand);
    }
    check_body_parts(&model, &motion, 0.05);
}

/// The forearm of the model is its last joint.
#[test]
fn a_limb_without_an_end_is_aligned_by_its_skin() {
    let motion =
        dancer(&Rig { axes: 8, arms_down_degrees: 50.0, prefix: "m_", ..Rig::default() }, Interpolation::Linear);
    let forearm = |side: f32| [Vec3::new(0.0, -0.03, -0.03), Vec3::new(0.4 * side, 0.03, 0.03)];
    let rig = Rig { without: vec![Slot::LeftHand, Slot::RightHand], ..Rig::default() };
    let model = dressed(&rig, &[(Slot::LeftLowerArm, forearm(1.0)), (Slot::RightLowerArm, forearm(-1.0))]);
    check_body_parts(&model, &motion, 0.05);
}
