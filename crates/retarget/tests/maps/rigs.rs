//! Rigs that we have no files of, built from the joint names of their tools: `A>B` makes B a child of A, `A(B, C)`
//! both. They have no shape, so names and hierarchy must suffice.

use gaitway_character::anim::{Joint, Transform};
use gaitway_character::asset::{Asset, Slot};
use gaitway_retarget::{Reason, Recognized, recognize};

use crate::skeletons;

/// Builds a skeleton from its text.
pub fn rig(text: &str) -> Asset {
    let mut joints: Vec<Joint> = Vec::new();
    let mut parent = None;
    let mut outer = Vec::new();
    let mut name = String::new();
    let mut last = None;
    for char in text.chars().chain([',']) {
        if !"(),>".contains(char) {
            name.push(char);
            continue;
        }
        if !name.trim().is_empty() {
            last = Some(joints.len());
            joints.push(skeletons::joint(name.trim(), parent, Transform::IDENTITY));
        }
        name.clear();
        match char {
            '>' => parent = last,
            '(' => {
                outer.push(last);
                parent = last;
            }
            ',' => parent = outer.last().copied().flatten(),
            _ => {
                outer.pop();
            }
        }
    }
    skeletons::asset(joints)
}

/// Repeats a template for both sides.
pub fn both(template: &str, sides: [&str; 2]) -> String {
    sides.map(|side| template.replace('~', side)).join(", ")
}

pub fn check(asset: &Asset, expected: &[(&str, &str)]) -> Recognized {
    let found = recognize(asset);
    for (slot_name, name) in expected {
        let slot = Slot::from_name(slot_name).unwrap_or_else(|| panic!("{slot_name}"));
        let joint = found.joint(slot).map(|joint| asset.skeleton.name(joint));
        let expected = Some(*name).filter(|name| !name.is_empty());
        assert_eq!(
            joint,
            expected,
            "{slot_name} of {}",
            asset.skeleton.name(asset.skeleton.joints().next().expect("one"))
        );
    }
    found
}

#[test]
fn biped_of_3ds_max() {
    for prefix in ["Bip01", "Bip001"] {
        let arm = "P ~ Clavicle>P ~ UpperArm>P ~ Forearm>P ~ Hand(P ~ Finger0>P ~ Finger01>P ~ Finger02>P ~ Finger0Nub, \
                   P ~ Finger1>P ~ Finger11>P ~ Finger12, P ~ Finger4>P ~ Finger41>P ~ Finger42)";
        let leg = "P ~ Thigh>P ~ Calf>P ~ Foot>P ~ Toe0>P ~ Toe0Nub";
        let text = format!(
            "P(P Footsteps, P Pelvis>P Spine(P Spine1>P Neck(P Head>P HeadNub, {}), {}))",
            both(arm, ["L", "R"]),
            both(leg, ["L", "R"])
        );
        let asset = rig(&text.replace('P', "\u{1}").replace("\u{1}elvis", "Pelvis").replace('\u{1}', prefix));
        let named = |rest: &str| format!("{prefix} {rest}");
        let found = check(
            &asset,
            &[
                ("neck", &named("Neck")),
                ("head", &named("Head")),
                ("leftUpperLeg", &named("L Thigh")),
                ("rightLowerLeg", &named("R Calf")),
                ("leftToes", &named("L Toe0")),
                ("rightShoulder", &named("R Clavicle")),
                ("leftHand", &named("L Hand")),
                ("leftThumbMetacarpal", &named("L Finger0")),
                ("leftThumbProximal", &named("L Finger01")),
                ("leftThumbDistal", &named("L Finger02")),
                ("rightIndexProximal", &named("R Finger1")),
                ("rightIndexIntermediate", &named("R Finger11")),
                ("leftLittleDistal", &named("L Finger42")),
                ("leftRingProximal", ""),
            ],
        );
        assert_eq!(found.parts[&Slot::Head].reason, Reason::Vocabulary("3ds Max Biped"));
    }
}

#[test]
fn unreal_5_with_twist_joints() {
    let arm = "clavicle_~>upperarm_~(upperarm_twist_01_~, upperarm_twist_02_~, lowerarm_~(lowerarm_twist_01_~, \
               hand_~(index_metacarpal_~>index_01_~>index_02_~>index_03_~, thumb_01_~>thumb_02_~>thumb_03_~)))";
    let leg = "thigh_~(thigh_twist_01_~, calf_~(calf_twist_01_~, foot_~>ball_~))";
    let asset = rig(&format!(
        "root(pelvis(spine_01>spine_02>spine_03>spine_04>spine_05(neck_01>neck_02>head, {}), {}), ik_foot_root>ik_foot_l)",
        both(arm, ["l", "r"]),
        both(leg, ["l", "r"])
    ));
    check(
        &asset,
        &[
            ("hips", "pelvis"),
            ("spine", "spine_01"),
            ("chest", "spine_03"),
            ("upperChest", "spine_05"),
            ("neck", "neck_01"),
            ("head", "head"),
            ("leftUpperArm", "upperarm_l"),
            ("rightLowerArm", "lowerarm_r"),
            ("leftHand", "hand_l"),
            ("leftIndexProximal", "index_01_l"),
            ("rightIndexDistal", "index_03_r"),
            ("leftUpperLeg", "thigh_l"),
            ("rightLowerLeg", "calf_r"),
            ("leftFoot", "foot_l"),
            ("leftToes", "ball_l"),
        ],
    );
}

#[test]
fn character_creator() {
    let arm = "CC_Base_~_Clavicle>CC_Base_~_Upperarm(CC_Base_~_UpperarmTwist01, CC_Base_~_Forearm(CC_Base_~_ForearmTwist01, \
               CC_Base_~_ElbowShareBone, CC_Base_~_Hand(CC_Base_~_Thumb1>CC_Base_~_Thumb2>CC_Base_~_Thumb3, \
               CC_Base_~_Mid1>CC_Base_~_Mid2>CC_Base_~_Mid3)))";
    let leg = "CC_Base_~_Thigh(CC_Base_~_ThighTwist01, CC_Base_~_Calf(CC_Base_~_KneeShareBone, \
               CC_Base_~_Foot>CC_Base_~_ToeBase(CC_Base_~_BigToe1)))";
    let asset = rig(&format!(
        "CC_Base_BoneRoot>CC_Base_Hip(CC_Base_Pelvis({}), CC_Base_Waist>CC_Base_Spine01>CC_Base_Spine02(\
         CC_Base_NeckTwist01>CC_Base_NeckTwist02>CC_Base_Head(CC_Base_FacialBone>CC_Base_JawRoot, CC_Base_L_Eye, \
         CC_Base_R_Eye), {}))",
        both(leg, ["L", "R"]),
        both(arm, ["L", "R"])
    ));
    check(
        &asset,
        &[
            ("hips", "CC_Base_Hip"),
            ("spine", "CC_Base_Waist"),
            ("chest", "CC_Base_Spine01"),
            ("upperChest", "CC_Base_Spine02"),
            ("neck", "CC_Base_NeckTwist01"),
            ("head", "CC_Base_Head"),
            ("rightEye", "CC_Base_R_Eye"),
            ("leftUpperArm", "CC_Base_L_Upperarm"),
            ("leftLowerArm", "CC_Base_L_Forearm"),
            ("rightMiddleDistal", "CC_Base_R_Mid3"),
            ("rightUpperLeg", "CC_Base_R_Thigh"),
            ("rightToes", "CC_Base_R_ToeBase"),
        ],
    );
}

#[test]
fn rigify_with_split_limbs() {
    let arm = "DEF-shoulder.~>DEF-upper_arm.~>DEF-upper_arm.~.001>DEF-forearm.~>DEF-forearm.~.001>DEF-hand.~(\
               DEF-palm.01.~>DEF-f_index.01.~>DEF-f_index.02.~>DEF-f_index.03.~, DEF-thumb.01.~>DEF-thumb.02.~>DEF-thumb.03.~)";
    let leg = "DEF-pelvis.~, DEF-thigh.~>DEF-thigh.~.001>DEF-shin.~>DEF-shin.~.001>DEF-foot.~>DEF-toe.~";
    let asset = rig(&format!(
        "root>DEF-spine({}, DEF-spine.001>DEF-spine.002>DEF-spine.003({}, DEF-breast.L, DEF-breast.R, \
         DEF-spine.004>DEF-spine.005>DEF-spine.006))",
        both(leg, ["L", "R"]),
        both(arm, ["L", "R"])
    ));
    check(
        &asset,
        &[
            ("hips", "DEF-spine"),
            ("spine", "DEF-spine.001"),
            ("chest", "DEF-spine.002"),
            ("upperChest", "DEF-spine.003"),
            ("neck", "DEF-spine.004"),
            ("head", "DEF-spine.006"),
            ("leftUpperArm", "DEF-upper_arm.L"),
            ("leftLowerArm", "DEF-forearm.L"),
            ("rightHand", "DEF-hand.R"),
            ("rightIndexProximal", "DEF-f_index.01.R"),
            ("leftUpperLeg", "DEF-thigh.L"),
            ("leftLowerLeg", "DEF-shin.L"),
            ("rightToes", "DEF-toe.R"),
        ],
    );
}

#[test]
fn vroid() {
    let arm = "J_Bip_~_Shoulder>J_Bip_~_UpperArm(J_Sec_~_TopsUpperArm, J_Bip_~_LowerArm>J_Bip_~_Hand(\
               J_Bip_~_Thumb1>J_Bip_~_Thumb2>J_Bip_~_Thumb3, J_Bip_~_Little1>J_Bip_~_Little2>J_Bip_~_Little3))";
    let leg = "J_Bip_~_UpperLeg(J_Sec_~_SkirtFront, J_Bip_~_LowerLeg>J_Bip_~_Foot>J_Bip_~_ToeBase)";
    let asset = rig(&format!(
        "Root>J_Bip_C_Hips(J_Bip_C_Spine>J_Bip_C_Chest>J_Bip_C_UpperChest({}, J_Bip_C_Neck>J_Bip_C_Head(J_Sec_Hair1_01, \
         J_Adj_L_FaceEye, J_Adj_R_FaceEye), J_Sec_L_Bust1), {})",
        both(arm, ["L", "R"]),
        both(leg, ["L", "R"])
    ));
    check(
        &asset,
        &[
            ("hips", "J_Bip_C_Hips"),
            ("upperChest", "J_Bip_C_UpperChest"),
            ("head", "J_Bip_C_Head"),
            ("leftEye", "J_Adj_L_FaceEye"),
            ("leftUpperArm", "J_Bip_L_UpperArm"),
            ("rightLittleDistal", "J_Bip_R_Little3"),
            ("leftThumbMetacarpal", "J_Bip_L_Thumb1"),
            ("rightUpperLeg", "J_Bip_R_UpperLeg"),
            ("leftToes", "J_Bip_L_ToeBase"),
        ],
    );
}

#[test]
fn genesis_of_daz() {
    let arm = "~Collar>~ShldrBend>~ShldrTwist>~ForearmBend>~ForearmTwist>~Hand(~Thumb1>~Thumb2>~Thumb3, \
               ~Carpal1>~Index1>~Index2>~Index3)";
    let leg = "~ThighBend>~ThighTwist>~Shin>~Foot>~Metatarsals>~Toe(~BigToe>~BigToe_2)";
    let asset = rig(&format!(
        "Genesis8Female>hip(pelvis({}), abdomenLower>abdomenUpper>chestLower>chestUpper({}, neckLower>neckUpper>head(\
         lowerJaw, lEye, rEye)))",
        both(leg, ["l", "r"]),
        both(arm, ["l", "r"])
    ));
    check(
        &asset,
        &[
            ("hips", "hip"),
            ("spine", "abdomenLower"),
            ("upperChest", "chestUpper"),
            ("neck", "neckLower"),
            ("head", "head"),
            ("jaw", "lowerJaw"),
            ("leftUpperArm", "lShldrBend"),
            ("rightLowerArm", "rForearmBend"),
            ("leftHand", "lHand"),
            ("rightIndexProximal", "rIndex1"),
            ("leftUpperLeg", "lThighBend"),
            ("rightLowerLeg", "rShin"),
            ("leftFoot", "lFoot"),
            ("leftToes", "lToe"),
        ],
    );
}

#[test]
fn numbers_of_smpl_and_letters_of_optitrack() {
    let smpl = rig("Pelvis(L_Hip>L_Knee>L_Ankle>L_Foot, R_Hip>R_Knee>R_Ankle>R_Foot, Spine1>Spine2>Spine3(Neck>Head, \
         L_Collar>L_Shoulder>L_Elbow>L_Wrist>L_Hand, R_Collar>R_Shoulder>R_Elbow>R_Wrist>R_Hand))");
    check(
        &smpl,
        &[
            ("hips", "Pelvis"),
            ("upperChest", "Spine3"),
            ("leftUpperLeg", "L_Hip"),
            ("leftFoot", "L_Ankle"),
            ("leftToes", "L_Foot"),
            ("rightShoulder", "R_Collar"),
            ("rightUpperArm", "R_Shoulder"),
            ("rightHand", "R_Wrist"),
        ],
    );
    let optitrack = rig(
        "Hip(Ab>Chest(Neck>Head, LShoulder>LUArm>LFArm>LHand, RShoulder>RUArm>RFArm>RHand), LThigh>LShin>LFoot>LToe, \
         RThigh>RShin>RFoot>RToe)",
    );
    check(
        &optitrack,
        &[
            ("spine", "Ab"),
            ("chest", "Chest"),
            ("leftShoulder", "LShoulder"),
            ("leftUpperArm", "LUArm"),
            ("rightLowerArm", "RFArm"),
            ("leftLowerLeg", "LShin"),
            ("rightToes", "RToe"),
        ],
    );
}

/// No vocabulary: words, sides at either end, and the hierarchy.
#[test]
fn words_outside_any_vocabulary() {
    let asset = rig(
        "ROOT>hero_pelvis(hero_torso_a>hero_torso_b(hero_neck>hero_head, hero_left_collarbone>hero_left_upperarm>\
         hero_left_elbow>hero_left_wrist, hero_right_collarbone>hero_right_upperarm>hero_right_elbow>hero_right_wrist), \
         hero_left_thigh>hero_left_knee>hero_left_ankle, hero_right_thigh>hero_right_knee>hero_right_ankle)",
    );
    // A rig name that prefixes every joint is ignored.
    check(
        &asset,
        &[
            ("hips", "hero_pelvis"),
            ("neck", "hero_neck"),
            ("leftShoulder", "hero_left_collarbone"),
            ("rightUpperArm", "hero_right_upperarm"),
            ("leftHand", "hero_left_wrist"),
            ("rightLowerLeg", "hero_right_knee"),
            ("leftFoot", "hero_left_ankle"),
        ],
    );
}

/// Builds a body from its words: hips, spine, neck, head, then per side clavicle, upper arm, forearm, hand, thigh,
/// shin, foot, toes, with `~` for the side.
fn check_language(sides: [&str; 2], trunk: [&str; 4], limbs: [&str; 8]) {
    let [hips, spine, neck, head] = trunk;
    let asset = rig(&format!(
        "{hips}({spine}({neck}>{head}, {}), {})",
        both(&limbs[..4].join(">"), sides),
        both(&limbs[4..].join(">"), sides)
    ));
    let slots = ["Shoulder", "UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot", "Toes"];
    let of_side = |prefix: &str, side: &str| {
        let named = |(slot, limb): (&str, &str)| (format!("{prefix}{slot}"), limb.replace('~', side));
        slots.into_iter().zip(limbs).map(named).collect::<Vec<_>>()
    };
    let trunk = ["hips", "spine", "neck", "head"].into_iter().zip(trunk);
    let mut expected: Vec<(String, String)> = trunk.map(|(slot, name)| (slot.to_owned(), name.to_owned())).collect();
    expected.extend(of_side("left", sides[0]).into_iter().chain(of_side("right", sides[1])));
    let expected: Vec<(&str, &str)> = expected.iter().map(|(slot, name)| (slot.as_str(), name.as_str())).collect();
    check(&asset, &expected);
}

#[test]
fn other_languages() {
    check_language(
        ["links", "rechts"],
        ["Becken", "Wirbelsäule", "Hals", "Kopf"],
        [
            "Schlüsselbein_~",
            "Oberarm_~",
            "Unterarm_~",
            "Hand_~",
            "Oberschenkel_~",
            "Unterschenkel_~",
            "Fuß_~",
            "Zehen_~",
        ],
    );
    check_language(
        ["izq", "der"],
        ["cadera", "columna", "cuello", "cabeza"],
        ["clavicula_~", "brazo_~", "antebrazo_~", "mano_~", "muslo_~", "pierna_~", "pie_~", "dedos_~"],
    );
    check_language(
        ["Gauche", "Droite"],
        ["Bassin", "Colonne", "Cou", "Tete"],
        ["Clavicule~", "Bras~", "AvantBras~", "Main~", "Cuisse~", "Jambe~", "Pied~", "Orteils~"],
    );
    check_language(
        ["左", "右"],
        ["骨盆", "脊柱", "脖子", "头"],
        ["~锁骨", "~上臂", "~前臂", "~手", "~大腿", "~小腿", "~脚", "~脚趾"],
    );
    check_language(
        ["왼쪽", "오른쪽"],
        ["골반", "척추", "목", "머리"],
        ["~쇄골", "~위팔", "~아래팔", "~손", "~허벅지", "~종아리", "~발", "~발가락"],
    );
}

#[test]
fn mikumikudance() {
    let arm = "~肩>~腕>~腕捩>~ひじ>~手捩>~手首(~親指０>~親指１>~親指２, ~人指１>~人指２>~人指３)";
    let leg = "~足>~ひざ>~足首>~つま先";
    let asset = rig(&format!(
        "全ての親>センター>グルーブ(上半身>上半身2(首>頭(左目, 右目), {}), 下半身({})), 左足ＩＫ, 右足ＩＫ",
        both(arm, ["左", "右"]),
        both(leg, ["左", "右"])
    ));
    check(
        &asset,
        &[
            ("hips", "グルーブ"),
            ("spine", "上半身"),
            ("chest", "上半身2"),
            ("neck", "首"),
            ("head", "頭"),
            ("leftEye", "左目"),
            ("leftShoulder", "左肩"),
            ("leftUpperArm", "左腕"),
            ("rightLowerArm", "右ひじ"),
            ("rightHand", "右手首"),
            ("leftThumbMetacarpal", "左親指０"),
            ("leftIndexDistal", "左人指３"),
            ("leftUpperLeg", "左足"),
            ("rightLowerLeg", "右ひざ"),
            ("leftFoot", "左足首"),
            ("rightToes", "右つま先"),
        ],
    );
}

#[test]
fn studio_prefixes_and_suffixes() {
    for (before, after) in [("SK_", ""), ("rig:", "_jnt"), ("", "_env"), ("jt_", "_bnd"), ("acme_", "_zzz")] {
        let named = |name: &str| format!("{before}{name}{after}");
        let limbs = |names: [&str; 4]| names.map(named).join(">");
        let arm = limbs(["clavicle_~", "upperarm_~", "forearm_~", "hand_~"]);
        let leg = limbs(["thigh_~", "shin_~", "foot_~", "toe_~"]);
        let asset = rig(&format!(
            "{}({}({}>{}, {}), {})",
            named("pelvis"),
            named("spine"),
            named("neck"),
            named("head"),
            both(&arm, ["l", "r"]),
            both(&leg, ["l", "r"])
        ));
        check(
            &asset,
            &[
                ("hips", &named("pelvis")),
                ("head", &named("head")),
                ("leftShoulder", &named("clavicle_l")),
                ("rightUpperArm", &named("upperarm_r")),
                ("leftLowerLeg", &named("shin_l")),
                ("rightToes", &named("toe_r")),
            ],
        );
    }
}

#[test]
fn sanitised_mixamo() {
    let limbs = "mixamorig9~Shoulder>mixamorig9~Arm>mixamorig9~ForeArm>mixamorig9~Hand>mixamorig9~HandIndex1";
    let legs = "mixamorig9~UpLeg>mixamorig9~Leg>mixamorig9~Foot>mixamorig9~ToeBase>mixamorig9~Toe_End";
    let asset = rig(&format!(
        "mixamorig9Hips(mixamorig9Spine>mixamorig9Spine1>mixamorig9Spine2(mixamorig9Neck>mixamorig9Head>\
         mixamorig9HeadTop_End, {}), {})",
        both(limbs, ["Left", "Right"]),
        both(legs, ["Left", "Right"])
    ));
    let found = check(
        &asset,
        &[
            ("hips", "mixamorig9Hips"),
            ("chest", "mixamorig9Spine1"),
            ("head", "mixamorig9Head"),
            ("leftIndexProximal", "mixamorig9LeftHandIndex1"),
            ("rightToes", "mixamorig9RightToeBase"),
        ],
    );
    assert!(found.parts.values().all(|part| part.reason == Reason::Vocabulary("Mixamo")));
}

/// Some motion capture has only legs.
#[test]
fn half_a_body_has_less_confidence() {
    let legs = "~UpLeg>~Leg>~Foot>~ToeBase";
    let asset = rig(&format!("Hips({}, Spine>Spine1)", both(legs, ["Left", "Right"])));
    let found = check(&asset, &[("hips", "Hips"), ("leftUpperLeg", "LeftUpLeg"), ("rightToes", "RightToeBase")]);
    assert!(found.parts.values().all(|part| part.confidence < 0.7));
}
