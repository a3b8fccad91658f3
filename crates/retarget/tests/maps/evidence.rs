//! How names, hierarchy, skin and shape are weighed against each other.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::{Asset, AssetParts, Humanoid, Slot};
use gaitway_retarget::{Contradiction, ProposedPair, propose, recognize};

use crate::rigs::{both, check, rig};
use crate::skeletons;
use crate::unnamed::figure;

#[test]
fn a_limb_s_names_are_read_together() {
    // “Shoulder” is the collar bone above an upper arm, and the upper arm below a clavicle.
    let body = |arm: &str, leg: &str| {
        let limbs = |template| both(template, ["Left", "Right"]);
        rig(&format!("Root>Hips(Spine1>Spine2>Chest(Neck1>Neck2>Head, {}), {})", limbs(arm), limbs(leg)))
    };
    for (arm, [shoulder, upper, lower, hand]) in [
        ("~Clavicle>~Shoulder>~Elbow>~Hand", ["LeftClavicle", "LeftShoulder", "LeftElbow", "LeftHand"]),
        ("~Scapula>~Shoulder>~Elbow>~Wrist", ["LeftScapula", "LeftShoulder", "LeftElbow", "LeftWrist"]),
        ("~Shoulder>~Arm>~ForeArm>~Hand", ["LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand"]),
        ("~Shoulder>~Elbow>~Fist", ["", "LeftShoulder", "LeftElbow", "LeftFist"]),
        ("~Shoulder>~Arm0>~Arm1>~ArmEnd", ["LeftShoulder", "LeftArm0", "LeftArm1", "LeftArmEnd"]),
    ] {
        let asset = body(arm, "~UpLeg>~Leg>~Foot");
        let slots = ["leftShoulder", "leftUpperArm", "leftLowerArm", "leftHand"];
        check(&asset, &slots.into_iter().zip([shoulder, upper, lower, hand]).collect::<Vec<_>>());
    }
    for (leg, [upper, lower, foot, toes]) in [
        ("~Leg>~Shin>~Foot>~ToeBase", ["LeftLeg", "LeftShin", "LeftFoot", "LeftToeBase"]),
        ("~UpLeg>~Leg>~Foot>~Toes", ["LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToes"]),
        ("~Hip>~Knee>~Ankle>~Ball>~Toe", ["LeftHip", "LeftKnee", "LeftAnkle", "LeftBall"]),
        ("~Hip>~UpperLeg>~Leg>~Foot", ["LeftUpperLeg", "LeftLeg", "LeftFoot", ""]),
    ] {
        let asset = body("~Shoulder>~Arm>~ForeArm>~Hand", leg);
        let slots = ["leftUpperLeg", "leftLowerLeg", "leftFoot", "leftToes"];
        check(&asset, &slots.into_iter().zip([upper, lower, foot, toes]).collect::<Vec<_>>());
    }
}

#[test]
fn what_the_arms_hang_on_is_no_neck_if_one_is_above() {
    let arm = both("~_shoulder>~_upperarm>~_forearm>~_hand", ["l", "r"]);
    let leg = both("~_thigh>~_shin>~_foot>~_toes", ["l", "r"]);
    let asset = rig(&format!("hip(pelvis({leg}), spine1>spine2>spine3>spine4(neck1>neck2>head, {arm}))"));
    check(&asset, &[("spine", "spine1"), ("upperChest", "spine4"), ("neck", "neck1"), ("head", "head")]);
}

#[test]
fn m_and_x_mark_the_middle() {
    for middle in ["M", "x", "C"] {
        let arm = both("Scapula_~>Shoulder_~>Elbow_~>Wrist_~", ["L", "R"]);
        let leg = both("Hip_~>Knee_~>Ankle_~>Toes_~", ["L", "R"]);
        let text = format!("Root_M(Spine1_M>Spine2_M>Chest_M(Neck_M>Head_M, {arm}), {leg})");
        let asset = rig(&text.replace("_M", &format!("_{middle}")));
        check(&asset, &[("neck", &format!("Neck_{middle}")), ("head", &format!("Head_{middle}"))]);
    }
}

/// A control rig has several arms with the same names: the one that moves the skin is the arm.
#[test]
fn the_arm_that_moves_the_skin_is_the_arm() {
    let copy = |kind: &str| both(&format!("{kind}UpperArm.~>{kind}LowerArm.~>{kind}Hand.~"), ["L", "R"]);
    let legs = both("UpperLeg.~>LowerLeg.~>Foot.~", ["L", "R"]);
    let text = format!(
        "Hips(Spine>Chest(Neck>Head, {}, {}, {}), {legs})",
        both("Elbow.~", ["L", "R"]),
        copy("ORG-"),
        copy("DEF-")
    );
    let (asset, skinned) = (rig(&text), ["DEF-UpperArm.L", "DEF-LowerArm.L", "DEF-Hand.L"]);
    let slots = ["leftUpperArm", "leftLowerArm", "leftHand"];
    check(&asset, &slots.into_iter().zip(["ORG-UpperArm.L", "ORG-LowerArm.L", "ORG-Hand.L"]).collect::<Vec<_>>());
    check(&skeletons::with_skin(&asset, &skinned), &slots.into_iter().zip(skinned).collect::<Vec<_>>());
}

type Limb = fn(&str) -> [String; 4];

/// A body in a T-pose whose limbs have names. `left` is the side that the geometry gives to the limbs of `l`, and `ahead` how far
/// the toes are in front of the ankles.
fn named_figure([arm, leg]: [Limb; 2], left: f32, ahead: f32) -> Asset {
    let figure = figure(&[0.03, 0.15, 0.28, 0.26], ahead);
    let trunk = ["root.x", "spine_01.x", "spine_02.x", "neck.x", "head.x"].map(str::to_owned).into_iter();
    let sides = if left > 0.0 { ["l", "r"] } else { ["r", "l"] };
    let names: Vec<String> =
        trunk.chain(sides.into_iter().flat_map(|side| leg(side).into_iter().chain(arm(side)))).collect();
    let skeleton = figure.skeleton.with_names(names.iter().map(String::as_str).enumerate());
    Asset::new(AssetParts { skeleton, ..figure.into_parts() }).expect("as before")
}

/// Auto-Rig Pro: half of the words are known, and the shape agrees with them.
#[test]
fn shape_helps_where_names_are_half_known() {
    let arm: Limb = |side| ["shoulder", "arm_stretch", "forearm_stretch", "hand"].map(|part| format!("{part}.{side}"));
    let leg: Limb = |side| ["thigh_stretch", "leg_stretch", "foot", "toes_01"].map(|part| format!("{part}.{side}"));
    let found = check(
        &named_figure([arm, leg], 1.0, 0.15),
        &[
            ("hips", "root.x"),
            ("head", "head.x"),
            ("leftUpperArm", "arm_stretch.l"),
            ("leftHand", "hand.l"),
            ("leftUpperLeg", "thigh_stretch.l"),
            ("leftToes", "toes_01.l"),
        ],
    );
    assert!(found.contradictions.is_empty() && !found.by_position, "{:?}", found.contradictions);
}

/// Only the side is a known word: it counts, unless the feet show another.
#[test]
fn sides_are_read_from_names_that_say_nothing_else() {
    let limbs: [Limb; 2] = [
        |side| ["Kata", "Ude", "Hiji", "Te"].map(|part| format!("{side}_{part}")),
        |side| ["Momo", "Sune", "Ashi", "Yubi"].map(|part| format!("{side}_{part}")),
    ];
    for left in [1.0, -1.0] {
        let found = check(&named_figure(limbs, left, 0.0), &[("leftUpperArm", "l_Ude"), ("rightFoot", "r_Ashi")]);
        assert!(!found.by_position && found.contradictions.is_empty());
    }
    let found = check(&named_figure(limbs, -1.0, 0.15), &[("leftUpperArm", "r_Ude"), ("rightFoot", "l_Ashi")]);
    let contradicts =
        |Contradiction::Side { slot, name, .. }: &Contradiction| *slot == Slot::LeftFoot && name == "r_Ashi";
    assert!(found.by_position && found.contradictions.iter().any(contradicts), "{:?}", found.contradictions);
}

/// Figures of rigid parts have arms and legs of one joint each.
#[test]
fn a_figure_of_rigid_parts_is_a_body() {
    let parts = [("head", "head"), ("spine", "torso"), ("leftUpperArm", "arm-left"), ("rightUpperLeg", "leg-right")];
    check(&rig("root(torso(head, arm-left, arm-right), leg-left, leg-right)"), &parts);
    let found = recognize(&rig("root(torso(head, arm-left, arm-right))"));
    assert!(found.parts.is_empty(), "without legs it may be anything: {:?}", found.parts);
}

/// A VRM animation may move any bones, even two.
#[test]
fn a_motion_that_says_what_it_moves_needs_no_whole_body() {
    let arm = both("~UpperArm>~LowerArm>~Hand", ["Left", "Right"]);
    let leg = both("~UpperLeg>~LowerLeg>~Foot", ["Left", "Right"]);
    let model = rig(&format!("Hips(Spine>Chest(Neck>Head, {arm}), {leg})"));
    let skeleton = rig("a>b>c").skeleton.clone();
    let humanoid = Humanoid([(Slot::Hips, JointIndex(0)), (Slot::LeftUpperArm, JointIndex(2))].into());
    let declared = |humanoid| {
        let parts = AssetParts { skeleton: skeleton.clone(), humanoid, ..AssetParts::default() };
        Asset::new(parts).expect("an asset")
    };
    let names = |motion: &Asset| {
        let pair =
            |pair: &ProposedPair| (model.skeleton.name(pair.target).to_owned(), skeleton.name(pair.source).to_owned());
        propose(&model, motion).pairs.iter().map(pair).collect::<Vec<_>>()
    };
    let pair = |target: &str, source: &str| (target.to_owned(), source.to_owned());
    assert_eq!(names(&declared(Some(humanoid))), [pair("Hips", "a"), pair("LeftUpperArm", "c")]);
    assert_eq!(names(&declared(None)), []);
}
