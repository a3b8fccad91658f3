//! Which way bodies face, and whether the side named left is on the left.

use gaitway_character::anim::{Joint, Transform};
use gaitway_character::asset::{Asset, Slot};
use gaitway_retarget::{Contradiction, recognize};
use glam::Vec3;

use crate::data::open;
use crate::skeletons;

/// A T-pose facing +Z with the left side at `left` (+1 or -1) times +X.
fn figure(left: f32, toes: bool) -> Asset {
    let mut joints: Vec<Joint> = Vec::new();
    let mut place = |name: &str, parent: Option<usize>, at: Vec3| {
        joints.push(skeletons::joint(name, parent, Transform::from_translation(at)));
        joints.len() - 1
    };
    let hips = place("Hips", None, Vec3::Y);
    let spine = place("Spine", Some(hips), Vec3::Y * 0.2);
    let neck = place("Neck", Some(spine), Vec3::Y * 0.3);
    place("Head", Some(neck), Vec3::Y * 0.1);
    for (side, out) in [("Left", left), ("Right", -left)] {
        let mut at = hips;
        for (name, step) in [
            ("UpLeg", Vec3::new(0.1 * out, 0.0, 0.0)),
            ("Leg", Vec3::Y * -0.45),
            ("Foot", Vec3::Y * -0.45),
            ("ToeBase", Vec3::new(0.0, -0.05, 0.15)),
        ] {
            if name != "ToeBase" || toes {
                at = place(&format!("{side}{name}"), Some(at), step);
            }
        }
        let mut at = spine;
        for (name, step) in [("Arm", 0.2), ("ForeArm", 0.25), ("Hand", 0.25)] {
            at = place(&format!("{side}{name}"), Some(at), Vec3::new(step * out, 0.0, 0.0));
        }
    }
    skeletons::asset(joints)
}

#[test]
fn a_figure_with_correct_names() {
    let found = recognize(&figure(1.0, true));
    assert_eq!(
        (found.facing.up, found.facing.left, found.facing.forward),
        (Some(Vec3::Y), Some(Vec3::X), Some(Vec3::Z))
    );
    assert!(!found.facing.is_mirrored());
    assert_eq!(found.contradictions, []);
}

/// A converter mirrored the body and kept the names.
#[test]
fn where_feet_are_clear_position_wins_over_names_and_the_contradiction_is_reported() {
    let asset = figure(-1.0, true);
    let found = recognize(&asset);
    let called = |slot: Slot| found.joint(slot).map(|joint| asset.skeleton.name(joint));
    assert_eq!(called(Slot::LeftUpperLeg), Some("RightUpLeg"));
    assert_eq!(called(Slot::RightHand), Some("LeftHand"));
    assert!(found.by_position && !found.facing.is_mirrored());
    assert_eq!(found.facing.forward, Some(Vec3::Z));
    // Both sides of four joints of the legs and three of the arms.
    assert_eq!(found.contradictions.len(), 14);
    for Contradiction::Side { slot, joint, .. } in &found.contradictions {
        assert_eq!(found.joint(*slot), Some(*joint));
        assert!(found.parts[slot].confidence < 0.95, "{slot:?}");
    }
}

/// One crossed leg doesn't make a mirrored body.
#[test]
fn a_few_joints_on_the_other_side_do_not_swap_the_sides() {
    let mut asset = figure(1.0, true);
    let mut rest = asset.skeleton.rest().clone();
    for name in ["LeftUpLeg", "RightUpLeg"] {
        let joint = asset.skeleton.find(name).expect(name);
        let local = rest.local(joint);
        rest.set_translation(joint, local.translation * Vec3::new(-1.0, 1.0, 1.0));
    }
    asset = Asset::from(asset.skeleton.with_rest(&rest));
    let found = recognize(&asset);
    assert!(!found.by_position);
    assert_eq!(found.joint(Slot::LeftHand), asset.skeleton.find("LeftHand"));
    assert!(!found.contradictions.is_empty());
}

#[test]
fn without_toes_eyes_and_bent_knees_the_facing_is_unknown() {
    let found = recognize(&figure(-1.0, false));
    assert_eq!(found.facing.left, Some(Vec3::NEG_X));
    assert_eq!(found.facing.forward, None);
    assert_eq!(found.contradictions, []);
}

#[test]
fn real_bodies_face_the_right_way() {
    for (path, forward, mirrored) in [
        ("threejs/Xbot.glb", Vec3::Z, false),
        ("threejs/Soldier.glb", Vec3::NEG_Z, false),
        ("vrm/vrm0_cryptovoxels.vrm", Vec3::NEG_Z, false),
        ("khronos/CesiumMan/glTF-Binary/CesiumMan.glb", Vec3::X, false),
        ("kaykit/Knight.glb", Vec3::Z, false),
        // At rest all bones lie along one axis, so the first frame is used.
        ("bvh/animateddrawings_rokoko_jesse_dance.bvh", Vec3::Z, false),
        ("cosc422/original/Dwarf/avatar_walk.bvh", Vec3::Z, false),
        // A converter mirrored these and kept the names.
        ("cosc422/dwarf.glb", Vec3::Z, true),
        ("cosc422/ArmyPilot.glb", Vec3::NEG_Z, true),
        ("misc/godot_robot_player.glb", Vec3::Z, true),
    ] {
        let Some(asset) = open(path) else { return };
        let found = recognize(&asset);
        assert!(found.facing.forward.is_some_and(|found| found.dot(forward) > 0.99), "{path}: {:?}", found.facing);
        assert_eq!(found.by_position, mirrored, "{path}");
        assert!(!found.facing.is_mirrored(), "{path}");
        assert_eq!(!found.contradictions.is_empty(), mirrored, "{path}");
    }
}
