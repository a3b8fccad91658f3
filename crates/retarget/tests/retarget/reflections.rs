//! A node above a body that mirrors it, in the model, the motion or both: what was retargeted, mirrored, and nothing else.

use std::collections::BTreeMap;

use gaitway_character::anim::{Clip, Interpolation, JointIndex, Pose, SampleCursor, Transform, model_from_joint};
use gaitway_character::asset::{Asset, AssetParts, Slot};
use gaitway_formats::{FileSet, load, write_vrma};
use gaitway_retarget::{Body, Pin, PinGoal, Pinning, Retargeting, propose, recognize};
use glam::{Affine3A, Vec3, Vec3A};

use crate::data_folder::data_folder;
use crate::figure::{Figure, Rig, build};
use crate::laws::{body, map};
use crate::people::load_people;
use crate::rests::with_rest;

/// The same asset with its root node scaled by −1 along some axes.
fn mirrored(asset: Asset, axes: Vec3) -> Asset {
    let root = asset.skeleton.joints().next().unwrap();
    let skeleton = with_rest(&asset.skeleton, |joint, rest| {
        if joint == root {
            rest.scale *= axes;
        }
    });
    Asset::new(AssetParts { skeleton, ..asset.into_parts() }).unwrap()
}

/// What scaling the root does to model space.
fn mirror(asset: &Asset, axes: Vec3) -> Affine3A {
    let Transform { translation, rotation, .. } = asset.skeleton.rest().local(asset.skeleton.joints().next().unwrap());
    let root = Affine3A::from_rotation_translation(rotation, translation);
    root * Affine3A::from_scale(axes) * root.inverse()
}

fn pose_at(asset: &Asset, clip: &Clip, time_secs: f32) -> Pose {
    let mut pose = asset.skeleton.rest().clone();
    clip.sample(&asset.skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
    pose
}

fn frames(asset: &Asset, pose: &Pose) -> Vec<Affine3A> {
    let mut world = Vec::new();
    model_from_joint(&asset.skeleton, pose, Affine3A::IDENTITY, &mut world);
    world
}

/// The largest angle between the axes of two frames, mirrored or not, in degrees.
fn degrees_apart(a: Affine3A, b: Affine3A) -> f32 {
    let angle = |(a, b): (Vec3A, Vec3A)| a.cross(b).length().atan2(a.dot(b)).to_degrees();
    let [a, b] =
        [a, b].map(|frame| [frame.matrix3.x_axis, frame.matrix3.y_axis, frame.matrix3.z_axis].map(Vec3A::normalize));
    a.into_iter().zip(b).map(angle).fold(0.0, f32::max)
}

/// Checks that a clip of a mirrored model is the other's, mirrored.
fn check(plain: (&Asset, &Clip), found: (&Asset, &Clip), mirror: Affine3A, size: f32, what: &str) {
    for step in 0..=12 {
        let time = plain.1.duration_secs() * step as f32 / 12.0;
        let [wanted, found_frames] = [plain, found].map(|(asset, clip)| frames(asset, &pose_at(asset, clip, time)));
        for joint in plain.0.skeleton.joints().skip(1) {
            let (wanted, found) = (mirror * wanted[joint.get()], found_frames[joint.get()]);
            let name = plain.0.skeleton.name(joint);
            let off = wanted.translation.distance(found.translation);
            assert!(off < 1e-3 * size, "{what}: {name} is {off} away at {time}");
            let degrees = degrees_apart(wanted, found);
            assert!(degrees < 0.5, "{what}: {name} is turned by {degrees} degrees at {time}");
        }
    }
}

/// Scales that mirror.
const AXES: [Vec3; 4] =
    [Vec3::new(-1.0, 1.0, 1.0), Vec3::new(1.0, 1.0, -1.0), Vec3::new(1.0, -1.0, 1.0), Vec3::new(-1.0, -1.0, -1.0)];

fn dancer(rig: &Rig) -> Figure {
    let mut figure = build(rig);
    figure.dance(31, 60.0, Interpolation::Linear);
    figure
}

fn in_mirror(figure: Figure, axes: Vec3) -> Figure {
    Figure { asset: mirrored(figure.asset, axes), ..figure }
}

#[test]
fn mirrored_figures_do_the_same_mirrored() {
    let rigs = [
        Rig { axes: 3, armature: true, prefix: "m_", ..Rig::default() },
        Rig { axes: 5, armature: true, arms_down_degrees: 40.0, size: 1.4, ..Rig::default() },
    ];
    let retarget = |model: &Figure, motion: &Figure| {
        Retargeting::new(body(model), body(motion), 0, &map(model, motion)).unwrap().bake().unwrap().clip
    };
    for [motion_rig, model_rig] in [[&rigs[0], &rigs[1]], [&rigs[1], &rigs[0]], [&rigs[1], &rigs[1]]] {
        let (model, motion) = (build(model_rig), dancer(motion_rig));
        let wanted = retarget(&model, &motion);
        for axes in AXES {
            let (other_model, other_motion) = (in_mirror(build(model_rig), axes), in_mirror(dancer(motion_rig), axes));
            let plane = mirror(&model.asset, axes);
            let plain = (&model.asset, &wanted);
            let clip = retarget(&other_model, &motion);
            check(plain, (&other_model.asset, &clip), plane, 1.7, &format!("model {axes}"));
            let clip = retarget(&model, &other_motion);
            check(plain, (&model.asset, &clip), Affine3A::IDENTITY, 1.7, &format!("motion {axes}"));
            let clip = retarget(&other_model, &other_motion);
            check(plain, (&other_model.asset, &clip), plane, 1.7, &format!("both {axes}"));
        }
    }
}

#[test]
fn mirrored_characters_do_the_same_mirrored() {
    let Some(folder) = data_folder() else { return };
    let people = load_people(&folder);
    let motion = people.iter().find(|person| person.name == "deepmotion_blender_example.bvh").unwrap();
    let retarget = |model: &Asset, motion: &Asset| {
        let proposal = propose(model, motion);
        let map = proposal.to_map(model, motion).resolve(model, motion).unwrap();
        let (slots, sources) = (proposal.model.humanoid(), proposal.motion.humanoid());
        let [model, motion] = [(model, &slots), (motion, &sources)].map(|(asset, slots)| Body { asset, slots });
        Retargeting::new(model, motion, 0, &map).unwrap().bake().unwrap().clip
    };
    let mut rigs = 0;
    let twice = load_people(&folder).into_iter().zip(load_people(&folder));
    for (person, twin) in twice.filter(|(person, _)| person.person.has_mesh) {
        let root = person.asset.skeleton.joints().next().unwrap();
        let is_above = person.asset.skins.iter().all(|skin| !skin.joints().contains(&root));
        let is_only = person.asset.skeleton.parents().iter().filter(|parent| parent.is_none()).count() == 1;
        if !is_above || !is_only {
            continue;
        }
        let plain = person.asset;
        let wanted = retarget(&plain, &motion.asset);
        let plane = mirror(&plain, AXES[0]);
        let size = frames(&plain, &pose_at(&plain, &wanted, 0.0))
            .iter()
            .map(|frame| frame.translation.length())
            .fold(0.0, f32::max);
        let names: BTreeMap<Slot, JointIndex> = recognize(&plain).humanoid().0;
        let other = mirrored(twin.asset, AXES[0]);
        assert_eq!(names, recognize(&other).humanoid().0, "{}", person.name);
        let clip = retarget(&other, &motion.asset);
        check((&plain, &wanted), (&other, &clip), plane, size, person.name);
        rigs += 1;
    }
    assert!(rigs > 5, "{rigs}");
}

/// Bones in a file can't be mirrored.
#[test]
fn a_mirrored_model_writes_the_same_vrm_animation() {
    let rig = Rig { axes: 4, armature: true, ..Rig::default() };
    let written = |figure: Figure, forward: Vec3| {
        let bytes = write_vrma(&figure.asset, &figure.slots, Some(forward), &figure.asset.clips[0]).unwrap();
        let mut files = FileSet::default();
        files.insert("written.vrma", bytes);
        load(&files).unwrap()
    };
    let (plain, other) = (written(dancer(&rig), Vec3::Z), written(in_mirror(dancer(&rig), AXES[0]), Vec3::Z));
    check((&plain, &plain.clips[0]), (&other, &other.clips[0]), Affine3A::IDENTITY, 1.7, "written");
}

/// A hand that is held at a place is held at the mirrored place.
#[test]
fn pins_hold_what_is_mirrored() {
    let rig = Rig { axes: 4, armature: true, ..Rig::default() };
    let plain = dancer(&rig);
    for axes in AXES {
        let other = in_mirror(dancer(&rig), axes);
        let plane = mirror(&plain.asset, axes);
        for (slot, goal) in [(Slot::LeftHand, Vec3::new(0.3, 1.2, 0.4)), (Slot::RightFoot, Vec3::new(-0.2, 0.3, 0.3))] {
            let apply = |figure: &Figure, goal: Vec3| {
                let asset = &figure.asset;
                let mut pose = pose_at(asset, &asset.clips[0], 0.7);
                let number = asset.skeleton.source_index(figure.joint(slot));
                let pins = BTreeMap::from([(number, Pin { goal: PinGoal::Point(goal), times: None })]);
                let recognized = recognize(asset);
                let pinning =
                    Pinning { asset, body: &recognized, pins: &pins, world_from_model: Affine3A::IDENTITY, eye: None };
                pinning.apply(0.0, &mut pose);
                frames(asset, &pose)
            };
            let wanted = apply(&plain, goal);
            let found = apply(&other, plane.transform_point3(goal));
            for joint in plain.asset.skeleton.joints().skip(1) {
                let (wanted, found) = (plane * wanted[joint.get()], found[joint.get()]);
                assert!(degrees_apart(wanted, found) < 0.5, "{slot:?}, {axes}: {}", plain.asset.skeleton.name(joint));
            }
        }
    }
}
