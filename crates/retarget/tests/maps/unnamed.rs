//! Rigs whose names were replaced by useless ones: geometry must find the joints that the names gave, or leave them
//! out.

use std::collections::BTreeMap;

use gaitway_character::anim::{Joint, JointIndex, Transform};
use gaitway_character::asset::{Asset, AssetParts, Slot};
use gaitway_retarget::{Recognized, recognize};
use glam::Vec3;

use crate::data::open;
use crate::skeletons;
use crate::truth::{each_file, is_called};

/// Numbers without meaning: neighbours in the file don't get consecutive ones.
fn useless_name(number: usize, count: usize) -> String {
    let step = (1..).map(|step| 7 * step + 1).find(|step| !count.is_multiple_of(*step) || *step > count);
    format!("Object_{}", (number * step.unwrap_or(1) + 5) % count)
}

/// The same asset under useless names.
pub fn without_names(asset: &Asset) -> Asset {
    let count = asset.skeleton.len();
    let names: Vec<String> = (0..count).map(|number| useless_name(number, count)).collect();
    let skeleton = asset.skeleton.with_names(names.iter().map(String::as_str).enumerate());
    let meshes = asset.meshes.clone();
    let parts = AssetParts {
        skeleton,
        clips: asset.clips.clone(),
        skins: asset.skins.clone(),
        meshes,
        instances: asset.instances.clone(),
        materials: asset.materials.clone(),
        textures: asset.textures.clone(),
        images: asset.images.clone(),
        // Clips refer to its expressions.
        avatar: asset.avatar.clone(),
        ..AssetParts::default()
    };
    Asset::new(parts).expect("still valid")
}

/// Counts of body parts found correctly, wrongly and not at all.
#[derive(Debug, Default, Clone, Copy)]
pub struct Score {
    pub right: usize,
    pub wrong: usize,
    pub open: usize,
}

impl Score {
    pub fn wrong_share(self) -> f64 {
        self.wrong as f64 / (self.right + self.wrong).max(1) as f64
    }
}

/// Compares what was found with the joints that the names gave; describes what is wrong.
fn compare(named: &Asset, found: &Recognized, truth: &BTreeMap<Slot, String>) -> (Score, Vec<String>) {
    let (mut score, mut wrong) = (Score::default(), Vec::new());
    for &slot in Slot::ALL {
        let name = truth.get(&slot);
        let is_right = |joint: JointIndex| name.is_some_and(|name| is_called(named, joint, name));
        match found.joint(slot) {
            Some(joint) if is_right(joint) => score.right += 1,
            Some(joint) => {
                score.wrong += 1;
                wrong.push(format!("{} {:?}, not {name:?}", slot.name(), named.skeleton.name(joint)));
            }
            None => score.open += usize::from(name.is_some()),
        }
    }
    (score, wrong)
}

#[test]
fn bodies_with_useless_names_are_found_by_their_shape() {
    let mut all = Score::default();
    let mut bad = Vec::new();
    each_file(|path, asset, truth| {
        let found = recognize(&without_names(asset));
        let (score, wrong) = compare(asset, &found, truth);
        let Score { right, wrong: wrong_count, open } = score;
        println!("{right:3} right {wrong_count:3} wrong {open:3} open  {path}  {}", wrong.join("; "));
        all = Score { right: all.right + right, wrong: all.wrong + wrong_count, open: all.open + open };
        if score.wrong_share() > 0.05 {
            bad.push(path.to_owned());
        }
    });
    if all.right == 0 {
        return;
    }
    let Score { right, wrong, open } = all;
    let total = right + wrong + open;
    println!(
        "{right} right, {wrong} wrong, {open} left open; {:.1} % of what is proposed is wrong",
        100.0 * all.wrong_share()
    );
    assert_eq!(bad, [""; 0], "more than 5 % are wrong");
    assert!((right + open) as f64 >= 0.9 * total as f64);
    // Leaving everything unmapped must not pass.
    assert!(right as f64 >= 0.8 * total as f64, "{right} of {total}");
}

/// The persons of MIT's 6.837 assignment: their root is in the chest, and their arms end in elbows.
#[test]
fn a_body_may_hang_from_its_chest() {
    let parts = [
        (Slot::Hips, 2),
        (Slot::Spine, 1),
        (Slot::Chest, 0),
        (Slot::Head, 3),
        (Slot::RightUpperLeg, 5),
        (Slot::RightLowerLeg, 6),
        (Slot::RightFoot, 7),
        (Slot::LeftUpperLeg, 9),
        (Slot::LeftLowerLeg, 10),
        (Slot::LeftFoot, 11),
        (Slot::RightUpperArm, 13),
        (Slot::RightLowerArm, 14),
        (Slot::LeftUpperArm, 16),
        (Slot::LeftLowerArm, 17),
    ];
    for model in 1..=4 {
        let Some(asset) = open(&format!("mit6837/Model{model}.obj")) else { return };
        let found = recognize(&asset);
        for (slot, expected) in parts {
            let joint = found.joint(slot).map(|joint| asset.skeleton.source_index(joint));
            assert_eq!(joint, Some(expected), "Model{model}: {}", slot.name());
        }
        assert_eq!(found.joint(Slot::LeftHand), None, "Model{model}");
    }
}

#[test]
fn animals_with_useless_names_are_no_bodies() {
    for path in [
        "khronos/Fox/glTF-Binary/Fox.glb",
        "mesh2motion/bird-animations.glb",
        "mesh2motion/fox-animations.glb",
        "mesh2motion/spider-animations.glb",
        "mesh2motion/snake-animations.glb",
        "misc/TRex.glb",
    ] {
        let Some(asset) = open(path) else { return };
        assert_eq!(recognize(&without_names(&asset)).parts, BTreeMap::new(), "{path}");
    }
}

/// How far the toes of a figure are in front of its ankles.
const AHEAD: f32 = 0.15;

/// A body in a T-pose without names: what its left arm consists of, as distances outwards, and where its toes are. Its joints are
/// the trunk's upwards, then the left leg and arm, then the right ones.
pub fn figure(arm: &[f32], ahead: f32) -> Asset {
    let mut joints: Vec<Joint> = Vec::new();
    let mut place = |parent: Option<usize>, at: Vec3| {
        joints.push(skeletons::joint("", parent, Transform::from_translation(at)));
        joints.len() - 1
    };
    let hips = place(None, Vec3::Y);
    let spine = place(Some(hips), Vec3::Y * 0.2);
    let chest = place(Some(spine), Vec3::Y * 0.25);
    let neck = place(Some(chest), Vec3::Y * 0.1);
    place(Some(neck), Vec3::Y * 0.1);
    for side in [1.0, -1.0] {
        let mut at = hips;
        for step in [Vec3::X * 0.1 * side, Vec3::Y * -0.45, Vec3::Y * -0.45, Vec3::new(0.0, -0.07, ahead)] {
            at = place(Some(at), step);
        }
        let mut at = chest;
        for step in arm {
            at = place(Some(at), Vec3::X * side * *step);
        }
    }
    skeletons::asset(joints)
}

/// The numbers of the joints of the left arm, counted from the chest, that fill collar bone, upper arm, forearm and
/// hand.
fn check_arm(arm: &[f32], expected: [Option<usize>; 4]) {
    use Slot::{LeftHand, LeftLowerArm, LeftShoulder, LeftUpperArm};
    const FIRST: usize = 9;
    let asset = figure(arm, AHEAD);
    let found = recognize(&asset);
    let place = |slot| found.joint(slot).map(|joint| asset.skeleton.source_index(joint) - FIRST);
    assert_eq!([LeftShoulder, LeftUpperArm, LeftLowerArm, LeftHand].map(place), expected, "{arm:?}");
}

#[test]
fn a_collar_bone_is_short_and_begins_at_the_spine() {
    check_arm(&[0.03, 0.15, 0.28, 0.26], [Some(0), Some(1), Some(2), Some(3)]);
    check_arm(&[0.18, 0.28, 0.26], [None, Some(0), Some(1), Some(2)]);
    check_arm(&[0.18, 0.28, 0.26, 0.09], [None, Some(0), Some(1), Some(2)]);
    // A twist joint halfway down the upper arm.
    check_arm(&[0.03, 0.15, 0.14, 0.14, 0.26], [Some(0), Some(1), Some(3), Some(4)]);
}

#[test]
fn what_is_not_certain_is_left_out_and_said() {
    // A chain of equal segments could begin with any part.
    let found = recognize(&figure(&[0.15, 0.15, 0.15, 0.15, 0.15, 0.15], AHEAD));
    assert!(found.joint(Slot::LeftUpperLeg).is_some(), "the legs are clear");
    assert_eq!(found.joint(Slot::LeftLowerArm), None);
    let part = found.left_out.get(&Slot::LeftLowerArm).expect("said");
    assert!(part.confidence < 0.45);
}
