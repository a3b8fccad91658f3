//! The rest that a motion is measured from: on the same rig the model's, whatever the rest of the motion's nodes;
//! otherwise a pose that looks like a rest, or a warning.

use gaitway_character::anim::{Clip, Interpolation, Joint, JointIndex, Keys, SampleCursor, Skeleton};
use gaitway_character::asset::{Asset, AssetParts, Slot};
use gaitway_retarget::{Body, ResolvedMap, RestOrigin, Retargeting, propose, recognize};
use glam::{DQuat, DVec3, Quat, Vec3};

use crate::data_folder::data_folder;
use crate::figure::{BODY, Figure, Rig, build};
use crate::laws::{body, degrees, map};
use crate::people::{load_people, model_rotations};
use crate::random::Random;

/// Binding by name is exact in theory; the clips are stored in single precision.
const MAX_DEGREES: f64 = 0.1;

/// The same joints with other rest transforms.
pub fn with_rest(
    skeleton: &Skeleton,
    mut rest: impl FnMut(JointIndex, &mut gaitway_character::anim::Transform),
) -> Skeleton {
    let in_file = (0..skeleton.len()).filter_map(|number| skeleton.joint_of_source(number));
    let joints = in_file.map(|joint| {
        let mut transform = skeleton.rest().local(joint);
        rest(joint, &mut transform);
        let parent = skeleton.parent(joint).map(|parent| skeleton.source_index(parent));
        let morph_weights = skeleton.rest().morph_weights[skeleton.morph_range(joint)].to_vec();
        Joint { name: skeleton.name(joint).to_owned(), parent, rest: transform, morph_weights }
    });
    Skeleton::new(joints.collect()).unwrap()
}

/// A file with this skeleton and the clip, and nothing else.
pub fn alone(skeleton: Skeleton, clip: Clip) -> Asset {
    Asset::new(AssetParts { clips: vec![clip], ..Asset::from(skeleton).into_parts() }).unwrap()
}

/// Largest angle between two clips of one skeleton, over some moments, and the joint that has it.
pub fn largest_degrees<'a>(skeleton: &'a Skeleton, a: &Clip, b: &Clip) -> (f64, &'a str) {
    let moments = (0..=20).map(|step| a.duration_secs() * step as f32 / 20.0);
    let angles = moments.flat_map(|time| {
        let (a, b) = (model_rotations(skeleton, a, time), model_rotations(skeleton, b, time));
        let angles = skeleton.joints().map(|joint| (degrees(a[joint.get()], b[joint.get()]), skeleton.name(joint)));
        angles.collect::<Vec<_>>()
    });
    angles.fold((0.0, ""), |worst, angle| if angle.0 > worst.0 { angle } else { worst })
}

/// The clip of `figure` in a file whose nodes rest elsewhere. Only rotations of the body and the place of the hips
/// differ.
fn rested(figure: &Figure, mut turn: impl FnMut(Slot) -> DQuat, hips: Vec3) -> Asset {
    let skeleton = with_rest(&figure.asset.skeleton, |joint, rest| {
        if let Some((&slot, _)) = figure.slots.0.iter().find(|(_, slot_joint)| **slot_joint == joint) {
            rest.rotation = (rest.rotation.as_dquat() * turn(slot)).normalize().as_quat();
            if slot == Slot::Hips {
                rest.translation += hips;
            }
        }
    });
    alone(skeleton, figure.asset.clips[0].clone())
}

/// Retargets `motion` to `model`, which has its joints in the same order, and compares with its clip bound by name.
fn check_bound_by_name(model: &Figure, motion: &Asset, by_name: &Clip) {
    let map = map(model, model);
    let motion = Body { asset: motion, slots: &model.slots };
    let retargeting = Retargeting::new(body(model), motion, 0, &map).unwrap();
    assert_eq!(retargeting.motion_rest().origin, RestOrigin::Model);
    let found = retargeting.bake().unwrap().clip;
    let worst = largest_degrees(&model.asset.skeleton, by_name, &found);
    assert!(worst.0 < MAX_DEGREES, "{worst:?} degrees");
}

fn dancer(rig: &Rig, seed: u64) -> Figure {
    let mut figure = build(rig);
    figure.dance(seed, 60.0, Interpolation::Linear);
    figure
}

#[test]
fn a_clip_on_another_file_of_the_same_rig_is_bound_by_name() {
    let mut random = Random(5);
    for seed in 0..24 {
        let rig = Rig {
            axes: seed % 5,
            armature: seed % 2 == 1,
            arms_down_degrees: 15.0 * (seed % 4) as f64,
            facing_degrees: if seed % 3 == 2 { 90.0 } else { 0.0 },
            doubled: if seed % 4 == 3 { vec![Slot::Chest, Slot::LeftLowerArm] } else { Vec::new() },
            ..Rig::default()
        };
        let model = dancer(&rig, 100 + seed);
        let degrees = [8.0, 40.0, 90.0, 180.0][seed as usize % 4];
        let hips = random.vec3();
        let motion = rested(&model, |_| random.rotation(degrees), hips);
        check_bound_by_name(&model, &motion, &model.asset.clips[0]);
    }
}

#[test]
fn one_posed_joint_is_a_rest_like_any_other() {
    let model = dancer(&Rig { axes: 3, ..Rig::default() }, 7);
    for (slot, ..) in BODY {
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let turn = |other| if other == slot { DQuat::from_axis_angle(axis, 0.7) } else { DQuat::IDENTITY };
            check_bound_by_name(&model, &rested(&model, turn, Vec3::ZERO), &model.asset.clips[0]);
        }
    }
}

#[test]
fn the_hips_go_where_the_clip_puts_them_on_the_same_rig() {
    let model = dancer(&Rig { axes: 2, armature: true, ..Rig::default() }, 3);
    let motion = rested(&model, |_| DQuat::from_rotation_x(0.4), Vec3::new(90.0, -30.0, 200.0));
    let map = map(&model, &model);
    let retargeting = Retargeting::new(body(&model), Body { asset: &motion, slots: &model.slots }, 0, &map).unwrap();
    let found = retargeting.bake().unwrap().clip;
    for time in [0.0, 0.6, 1.4] {
        let at = |clip| model.world(clip, time)[model.joint(Slot::Hips).get()].1;
        assert!(at(&found).distance(at(&model.asset.clips[0])) < 1e-4, "at {time}");
    }
}

#[test]
fn joints_that_the_clip_does_not_move_rest_as_the_model_does() {
    let mut model = dancer(&Rig { axes: 4, ..Rig::default() }, 9);
    let clip = &model.asset.clips[0];
    let still = [Slot::Neck, Slot::LeftLowerArm, Slot::RightFoot].map(|slot| model.joint(slot));
    let mut builder = gaitway_character::anim::ClipBuilder::new("some", &model.asset.skeleton);
    for channel in clip.channels().iter().filter(|channel| !still.contains(&channel.joint)) {
        let times = &clip.timelines()[channel.timeline as usize];
        builder.channel(channel.joint, channel.interpolation, times, channel.keys.clone()).unwrap();
    }
    let clip = builder.build();
    model.set_clip(clip);
    let mut random = Random(2);
    let motion = rested(&model, |_| random.rotation(60.0), Vec3::ZERO);
    check_bound_by_name(&model, &motion, &model.asset.clips[0]);
}

#[test]
fn the_same_names_with_other_axes_are_another_rig() {
    let model = build(&Rig { axes: 2, ..Rig::default() });
    let motion = dancer(&Rig { axes: 3, ..Rig::default() }, 1);
    let map = map(&model, &motion);
    let retargeting = Retargeting::new(body(&model), body(&motion), 0, &map).unwrap();
    assert_eq!(retargeting.motion_rest().origin, RestOrigin::Motion);
}

/// Rolls a joint's axes about the offset of its child, which stays as it is: only the rest shows it.
fn roll(figure: &mut Figure, slot: Slot, child: Slot) {
    let along = figure.asset.skeleton.rest().local(figure.joint(child)).translation.normalize();
    turn_axes(figure, slot, child, Quat::from_axis_angle(along, std::f32::consts::PI));
}

/// Turns the axes of a joint with one child, but not its body part.
fn turn_axes(figure: &mut Figure, slot: Slot, child: Slot, turn: Quat) {
    let (joint, child) = (figure.joint(slot), figure.joint(child));
    let skeleton = with_rest(&figure.asset.skeleton, |other, rest| {
        if other == joint {
            rest.rotation = (rest.rotation * turn).normalize();
        } else if other == child {
            rest.translation = turn.inverse() * rest.translation;
            rest.rotation = (turn.inverse() * rest.rotation).normalize();
        }
    });
    figure.asset = Asset::from(skeleton);
    let t_pose = figure.t_pose.get_mut(&slot).unwrap();
    *t_pose = (*t_pose * turn.as_dquat()).normalize();
}

#[test]
fn rolled_axes_are_another_rig() {
    let rig = Rig { axes: 6, ..Rig::default() };
    let mut model = build(&rig);
    roll(&mut model, Slot::LeftUpperLeg, Slot::LeftLowerLeg);
    roll(&mut model, Slot::RightUpperLeg, Slot::RightLowerLeg);
    let motion = dancer(&rig, 4);
    let map = map(&model, &motion);
    let retargeting = Retargeting::new(body(&model), body(&motion), 0, &map).unwrap();
    assert_eq!(retargeting.motion_rest().origin, RestOrigin::Motion);
    let found = retargeting.bake().unwrap().clip;
    for time in [0.2, 0.9] {
        let wanted = motion.body_parts(&motion.asset.clips[0], time);
        for (slot, turn) in model.body_parts(&found, time) {
            assert!(degrees(wanted[&slot], turn) < 0.01, "{slot:?}");
        }
    }
}

/// Two of many offsets, in a rest that shows nothing.
#[test]
fn feet_with_other_axes_are_another_rig() {
    let rig = Rig { axes: 6, ..Rig::default() };
    let (model, mut motion) = (build(&rig), build(&rig));
    for (foot, toes) in [(Slot::LeftFoot, Slot::LeftToes), (Slot::RightFoot, Slot::RightToes)] {
        let along = motion.asset.skeleton.rest().local(motion.joint(toes)).translation.normalize();
        let turn = Quat::from_axis_angle(along.any_orthonormal_vector(), std::f32::consts::FRAC_PI_2);
        turn_axes(&mut motion, foot, toes, turn);
    }
    motion.dance(4, 60.0, Interpolation::Linear);
    let mut random = Random(5);
    let motion = rested(&motion, |_| random.rotation(60.0), Vec3::ZERO);
    let source = Body { asset: &motion, slots: &model.slots };
    let map = map(&model, &model);
    let rest = Retargeting::new(body(&model), source, 0, &map).unwrap().motion_rest();
    assert_ne!(rest.origin, RestOrigin::Model);
}

/// Makes `figure` walk in place: legs and arms swing against each other, knees bend.
pub fn walk(figure: &mut Figure) {
    const KEYS: usize = 17;
    let times: Vec<f32> = (0..KEYS).map(|key| key as f32 / (KEYS - 1) as f32).collect();
    let skeleton = &figure.asset.skeleton;
    let mut clip = gaitway_character::anim::ClipBuilder::new("walk", skeleton);
    let swings = [
        (Slot::LeftUpperLeg, 0.6, 0.0, 0.0),
        (Slot::RightUpperLeg, 0.6, 0.5, 0.0),
        (Slot::LeftLowerLeg, 0.3, 0.25, 0.3),
        (Slot::RightLowerLeg, 0.3, 0.75, 0.3),
        (Slot::LeftFoot, 0.5, 0.1, 0.0),
        (Slot::RightFoot, 0.5, 0.6, 0.0),
        (Slot::Hips, 0.2, 0.0, 0.0),
    ];
    for (slot, swing, phase, bend) in swings {
        let joint = figure.joint(slot);
        let rest = skeleton.rest().local(joint).rotation;
        // About the body's left side, which `t_pose` finds in the joint's axes.
        let axis = figure.t_pose[&slot].conjugate() * if slot == Slot::Hips { DVec3::Y } else { DVec3::X };
        let key = |time: &f32| {
            let angle = bend + swing * (std::f64::consts::TAU * (f64::from(*time) + phase)).sin();
            (rest.as_dquat() * DQuat::from_axis_angle(axis, angle)).normalize().as_quat()
        };
        let keys = Keys::Rotation(times.iter().map(key).collect());
        clip.channel(joint, Interpolation::Linear, &times, keys).unwrap();
    }
    let clip = clip.build();
    figure.set_clip(clip);
}

/// The walk in a file that rests in its own frame at this time.
pub fn resting_in_motion(figure: &Figure, time_secs: f32) -> Asset {
    let mut pose = figure.asset.skeleton.rest().clone();
    figure.asset.clips[0].sample(&figure.asset.skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
    let skeleton = with_rest(&figure.asset.skeleton, |joint, rest| *rest = pose.local(joint));
    alone(skeleton, figure.asset.clips[0].clone())
}

#[test]
fn a_rest_in_motion_is_found_out_on_another_rig() {
    let mut walker = build(&Rig { axes: 3, prefix: "a_", ..Rig::default() });
    walk(&mut walker);
    let model = build(&Rig { axes: 8, prefix: "b_", size: 1.2, ..Rig::default() });
    let map: ResolvedMap = map(&model, &walker);
    let standing = Retargeting::new(body(&model), body(&walker), 0, &map).unwrap();
    assert_eq!(standing.motion_rest().origin, RestOrigin::Motion);
    assert!(!standing.motion_rest().is_doubtful(), "{:?}", standing.motion_rest());
    let wanted = standing.bake().unwrap().clip;

    let stride = resting_in_motion(&walker, 0.22);
    let worst_of = |map: &ResolvedMap| {
        let source = Body { asset: &stride, slots: &walker.slots };
        let retargeting = Retargeting::new(body(&model), source, 0, map).unwrap();
        let done = retargeting.bake().unwrap();
        let figures = retargeting.figures(&done);
        (largest_degrees(&model.asset.skeleton, &wanted, &done.clip).0, retargeting.motion_rest(), figures)
    };
    let (found, rest, _) = worst_of(&map);
    assert_eq!(rest.origin, RestOrigin::Mean);
    let mut as_it_rests = map.clone();
    as_it_rests.rest.motion = gaitway_retarget::RestChoice::Node;
    let (taken, _, figures) = worst_of(&as_it_rests);
    assert!(taken > 25.0 && found < 0.6 * taken, "{found} and {taken} degrees");
    // Figures that take the rest for granted miss it; the direction of the feet shows it.
    assert!(figures.orientation_error_degrees_max.unwrap() < 0.01, "{figures:?}");
    assert!(figures.facing_error_degrees_max.unwrap() > 20.0, "{figures:?}");
}

#[test]
fn a_rest_that_nothing_improves_is_doubtful() {
    let mut walker = build(&Rig { axes: 3, prefix: "a_", ..Rig::default() });
    walk(&mut walker);
    // One leg in front for the whole clip.
    let (stride, joint) = (resting_in_motion(&walker, 0.22), walker.joint(Slot::Head));
    let mut clip = gaitway_character::anim::ClipBuilder::new("nod", &stride.skeleton);
    let rest = stride.skeleton.rest().local(joint).rotation;
    let keys = Keys::Rotation(vec![rest, rest * Quat::from_rotation_x(0.3)]);
    clip.channel(joint, Interpolation::Linear, &[0.0, 1.0], keys).unwrap();
    let clip = clip.build();
    let stride = alone(stride.into_parts().skeleton, clip);
    let model = build(&Rig { axes: 8, prefix: "b_", ..Rig::default() });
    let map = map(&model, &walker);
    let source = Body { asset: &stride, slots: &walker.slots };
    let rest = Retargeting::new(body(&model), source, 0, &map).unwrap().motion_rest();
    assert!(rest.is_doubtful(), "{rest:?}");
}

/// Every character of the data with its own clip in a file of its own, whose nodes rest in the middle of it.
#[test]
fn clips_of_real_rigs_survive_a_rest_in_motion() {
    let Some(folder) = data_folder() else { return };
    let mut rigs = 0;
    for model in load_people(&folder).iter().filter(|model| model.person.has_mesh && model.clip.is_some()) {
        let skeleton = &model.asset.skeleton;
        let clip = &model.asset.clips[model.clip.unwrap()];
        let mut pose = skeleton.rest().clone();
        clip.sample(skeleton, 0.4 * clip.duration_secs(), &mut SampleCursor::default(), &mut pose);
        let motion = alone(with_rest(skeleton, |joint, rest| *rest = pose.local(joint)), clip.clone());
        check_file_bound_by_name(&model.asset, &motion, clip, model.name);
        rigs += 1;
    }
    assert!(rigs > 10, "{rigs}");
}

#[test]
fn clips_of_the_same_rig_in_another_file_are_bound_by_name() {
    let Some(folder) = data_folder() else { return };
    let open = |path: &str| {
        let mut files = gaitway_formats::FileSet::default();
        files.insert("file.glb", std::fs::read(folder.join(path)).unwrap());
        gaitway_formats::load(&files).unwrap()
    };
    for (model_file, motion_file) in [
        ("playcanvas/bitmoji.glb", "playcanvas/bitmoji-anim/walk.glb"),
        ("cosc422/mannequin.glb", "cosc422/mannequin_run.glb"),
        // Another character of the same rig, in the same rest.
        ("threejs/Samba_Dancing.glb", "threejs/Xbot.glb"),
    ] {
        let (model, motion) = (open(model_file), open(motion_file));
        // The motion's clip with the model's joints.
        let source = &motion.clips[0];
        let mut clip = gaitway_character::anim::ClipBuilder::new("by name", &model.skeleton);
        for channel in source.channels() {
            let Some(joint) = model.skeleton.find(motion.skeleton.name(channel.joint)) else { continue };
            if matches!(channel.keys, Keys::Rotation(_)) {
                let times = &source.timelines()[channel.timeline as usize];
                clip.channel(joint, channel.interpolation, times, channel.keys.clone()).unwrap();
            }
        }
        check_file_bound_by_name(&model, &motion, &clip.build(), motion_file);
    }
}

fn check_file_bound_by_name(model: &Asset, motion: &Asset, by_name: &Clip, name: &str) {
    let proposal = propose(model, motion);
    let map = proposal.to_map(model, motion).resolve(model, motion).unwrap();
    let (model_slots, motion_slots) = (recognize(model).humanoid(), recognize(motion).humanoid());
    let target = Body { asset: model, slots: &model_slots };
    let source = Body { asset: motion, slots: &motion_slots };
    let retargeting = Retargeting::new(target, source, 0, &map).unwrap();
    assert_eq!(retargeting.motion_rest().origin, RestOrigin::Model, "{name}");
    let found = retargeting.bake().unwrap().clip;
    let worst = largest_degrees(&model.skeleton, by_name, &found);
    assert!(worst.0 < MAX_DEGREES, "{name}: {worst:?} degrees");
}
