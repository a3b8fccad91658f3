//! Rotations and translations of a rest come from one pose. A skin that was bound in another pose than its nodes rest in changes
//! nothing, whatever of the body its nodes have moved.

use gaitway_character::anim::{Clip, Interpolation, Joint, JointIndex, Skeleton, model_from_joint};
use gaitway_character::asset::{Asset, AssetParts, Humanoid, Slot};
use gaitway_character::mesh::Skin;
use gaitway_retarget::{RestChoice, Retargeting};
use glam::{Affine3A, DQuat, DVec3};

use crate::figure::{Figure, Rig, build};
use crate::laws::{body, map};
use crate::random::Random;
use crate::rests::with_rest;

/// Adds a skin that was bound as the figure rests, with these joints.
fn with_skin(figure: Figure, joints: Vec<JointIndex>) -> Figure {
    let mut world = Vec::new();
    model_from_joint(&figure.asset.skeleton, figure.asset.skeleton.rest(), Affine3A::IDENTITY, &mut world);
    let joint_from_bind = joints.iter().map(|joint| world[joint.get()].inverse()).collect();
    let count = joints.len();
    let skin = Skin::new(String::new(), joints, joint_from_bind, count).unwrap();
    let parts = AssetParts { skins: vec![skin], ..figure.asset.into_parts() };
    Figure { asset: Asset::new(parts).unwrap(), ..figure }
}

/// Hangs the feet beside the body, where they are, as inverse kinematics leaves them.
fn with_feet_beside(figure: &Figure) -> Figure {
    let skeleton = &figure.asset.skeleton;
    let mut world = Vec::new();
    model_from_joint(skeleton, skeleton.rest(), Affine3A::IDENTITY, &mut world);
    let feet = [Slot::LeftFoot, Slot::RightFoot].map(|slot| figure.joint(slot));
    let top = skeleton.joints().next().filter(|top| figure.slots.slot(*top).is_none());
    let joints = (0..skeleton.len()).filter_map(|number| skeleton.joint_of_source(number)).map(|joint| {
        let mut rest = skeleton.rest().local(joint);
        let mut parent = skeleton.parent(joint);
        if feet.contains(&joint) {
            let top_from_model = top.map_or(Affine3A::IDENTITY, |top| world[top.get()].inverse());
            let (_, rotation, translation) = (top_from_model * world[joint.get()]).to_scale_rotation_translation();
            (rest.rotation, rest.translation, parent) = (rotation, translation, top);
        }
        let parent = parent.map(|parent| skeleton.source_index(parent));
        Joint { name: skeleton.name(joint).to_owned(), parent, rest, ..Joint::default() }
    });
    let asset = Asset::from(Skeleton::new(joints.collect()).unwrap());
    let moved = |(&slot, &joint): (&Slot, &JointIndex)| (slot, asset.skeleton.find(skeleton.name(joint)).unwrap());
    let slots = Humanoid(figure.slots.0.iter().map(moved).collect());
    Figure { asset, slots, t_pose: figure.t_pose.clone() }
}

/// Its nodes rest in another pose: joints turned, limbs shorter, everything below the armature lower.
fn posed(figure: Figure, seed: u64, lower: bool) -> Figure {
    let mut random = Random(seed);
    let (slots, top) = (figure.slots.clone(), figure.joint(Slot::Hips));
    let skeleton = with_rest(&figure.asset.skeleton, |joint, rest| {
        let Some(slot) = slots.slot(joint) else { return };
        if joint != top || lower {
            rest.rotation = (rest.rotation.as_dquat() * random.rotation(40.0)).normalize().as_quat();
        }
        match slot {
            Slot::LeftLowerLeg | Slot::RightLowerLeg | Slot::LeftLowerArm => rest.translation *= 0.8,
            Slot::Hips if lower => rest.translation *= 0.85,
            _ => {}
        }
    });
    let parts = AssetParts { skeleton, ..figure.asset.into_parts() };
    Figure { asset: Asset::new(parts).unwrap(), ..figure }
}

fn retargeted(model: &Figure, motion: &Figure, rest: RestChoice) -> Clip {
    let mut map = map(model, motion);
    map.rest.model = rest;
    Retargeting::new(body(model), body(motion), 0, &map).unwrap().bake().unwrap().clip
}

/// The largest distance of a slot's joint between two clips, each on its own figure.
fn furthest(a: (&Figure, &Clip), b: (&Figure, &Clip)) -> (f64, Slot) {
    let mut worst = (0.0, Slot::Hips);
    for step in 0..=30 {
        let time = step as f32 * 1.5 / 30.0;
        let [a_world, b_world] = [a, b].map(|(figure, clip)| figure.world(clip, time));
        let at = |figure: &Figure, world: &[(DQuat, DVec3)], slot| world[figure.joint(slot).get()].1;
        for &slot in a.0.slots.0.keys() {
            let distance = at(a.0, &a_world, slot).distance(at(b.0, &b_world, slot));
            if distance > worst.0 {
                worst = (distance, slot);
            }
        }
    }
    worst
}

fn dancer(rig: &Rig) -> Figure {
    let mut figure = build(rig);
    figure.dance(21, 50.0, Interpolation::Linear);
    figure
}

#[test]
fn limbs_of_a_model_are_as_long_as_its_skin_was_bound() {
    let motion = dancer(&Rig { axes: 4, prefix: "m_", ..Rig::default() });
    for seed in 0..8 {
        let armature = seed % 2 == 1;
        let plain = build(&Rig { axes: seed % 3, armature, size: 1.3, ..Rig::default() });
        let wanted = retargeted(&plain, &motion, RestChoice::Auto);
        for beside in [false, true] {
            let model = if beside {
                with_feet_beside(&plain)
            } else {
                build(&Rig { axes: seed % 3, armature, size: 1.3, ..Rig::default() })
            };
            let joints: Vec<JointIndex> = model.asset.skeleton.joints().collect();
            let model = posed(with_skin(model, joints), seed, armature);
            for rest in [RestChoice::Auto, RestChoice::Bind] {
                let found = retargeted(&model, &motion, rest);
                let (distance, slot) = furthest((&plain, &wanted), (&model, &found));
                assert!(distance < 2e-3, "{seed}, feet beside: {beside}: {slot:?} is {distance} m away");
            }
        }
    }
}

#[test]
fn a_motion_is_measured_from_the_pose_its_skin_was_bound_in() {
    let model = build(&Rig { axes: 5, prefix: "m_", ..Rig::default() });
    for seed in 0..8 {
        let rig = Rig { axes: seed % 3, armature: true, ..Rig::default() };
        let (plain, bound) = (dancer(&rig), dancer(&rig));
        let joints: Vec<JointIndex> = bound.asset.skeleton.joints().collect();
        let bound = with_skin(bound, joints);
        let hips = bound.joint(Slot::Hips);
        let skeleton = with_rest(&bound.asset.skeleton, |joint, rest| {
            if joint == hips {
                rest.translation *= 0.8;
            }
        });
        let parts = AssetParts { skeleton, ..bound.asset.into_parts() };
        let lower = Figure { asset: Asset::new(parts).unwrap(), ..bound };
        let (wanted, found) =
            (retargeted(&model, &plain, RestChoice::Auto), retargeted(&model, &lower, RestChoice::Auto));
        let (distance, slot) = furthest((&model, &wanted), (&model, &found));
        assert!(distance < 1e-3, "{seed}: {slot:?} is {distance} m away");
    }
}
