//! The body parts of real skeletons, labelled manually by the joints' names, or by the skeleton's shape if it has no
//! names.

use std::collections::BTreeMap;

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::{Asset, AssetParts, Slot, Slot::*};

use crate::data::open;

/// One rig. Names are those of the left side; an empty name means that there is no such joint.
pub struct Rig {
    pub files: &'static [&'static str],
    /// The common prefix of all names.
    prefix: &'static str,
    /// Hips, spine, chest, upper chest, neck, head.
    trunk: [&'static str; 6],
    /// Shoulder, upper arm, lower arm, hand, upper leg, lower leg, foot, toes.
    limbs: [&'static str; 8],
    /// Thumb, index, middle, ring, little finger, from the palm outwards.
    fingers: [[&'static str; 3]; 5],
    /// Left eye, right eye, jaw.
    face: [&'static str; 3],
    /// Turns a name of the left side into that of the right.
    sides: Sides,
}

#[derive(Clone, Copy)]
pub enum Sides {
    Begin(&'static str, &'static str),
    End(&'static str, &'static str),
    /// Both are written out, as `left/right`.
    Both,
}

const TRUNK: [Slot; 6] = [Hips, Spine, Chest, UpperChest, Neck, Head];
const LIMBS: [Slot; 8] =
    [LeftShoulder, LeftUpperArm, LeftLowerArm, LeftHand, LeftUpperLeg, LeftLowerLeg, LeftFoot, LeftToes];
const FINGERS: [[Slot; 3]; 5] = [
    [LeftThumbMetacarpal, LeftThumbProximal, LeftThumbDistal],
    [LeftIndexProximal, LeftIndexIntermediate, LeftIndexDistal],
    [LeftMiddleProximal, LeftMiddleIntermediate, LeftMiddleDistal],
    [LeftRingProximal, LeftRingIntermediate, LeftRingDistal],
    [LeftLittleProximal, LeftLittleIntermediate, LeftLittleDistal],
];
const NO_FACE: [&str; 3] = [""; 3];
const NO_FINGER: [&str; 3] = [""; 3];
const NO_FINGERS: [[&str; 3]; 5] = [NO_FINGER; 5];

const MIXAMO: Rig = Rig {
    files: &[
        "threejs/Soldier.glb",
        "mesh2motion/retarget/mixamo-original-rig.glb",
        "mesh2motion/retarget/mixamo-sample-rig.glb",
    ],
    prefix: "mixamorig:",
    trunk: ["Hips", "Spine", "Spine1", "Spine2", "Neck", "Head"],
    limbs: ["LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand", "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase"],
    fingers: [
        ["LeftHandThumb1", "LeftHandThumb2", "LeftHandThumb3"],
        ["LeftHandIndex1", "LeftHandIndex2", "LeftHandIndex3"],
        ["LeftHandMiddle1", "LeftHandMiddle2", "LeftHandMiddle3"],
        ["LeftHandRing1", "LeftHandRing2", "LeftHandRing3"],
        ["LeftHandPinky1", "LeftHandPinky2", "LeftHandPinky3"],
    ],
    face: NO_FACE,
    sides: Sides::Begin("Left", "Right"),
};

const UNREAL: Rig = Rig {
    files: &[
        "mesh2motion/retarget/m2m-sample-rig.glb",
        "mesh2motion/human-male.glb",
        "mesh2motion/rig-human.glb",
        "mesh2motion/import-negative/m2m-custom-animation-wrong-bone-count.glb",
    ],
    prefix: "",
    trunk: ["pelvis", "spine_01", "spine_02", "spine_03", "neck_01", "head"],
    limbs: ["clavicle_l", "upperarm_l", "lowerarm_l", "hand_l", "thigh_l", "calf_l", "foot_l", "ball_l"],
    fingers: [
        ["thumb_01_l", "thumb_02_l", "thumb_03_l"],
        ["index_01_l", "index_02_l", "index_03_l"],
        ["middle_01_l", "middle_02_l", "middle_03_l"],
        ["ring_01_l", "ring_02_l", "ring_03_l"],
        ["pinky_01_l", "pinky_02_l", "pinky_03_l"],
    ],
    face: NO_FACE,
    sides: Sides::End("_l", "_r"),
};

const BLENDER: Rig = Rig {
    files: &["cosc422/mannequin.glb", "cosc422/mannequin_run.glb"],
    prefix: "",
    trunk: ["hips", "abdomen", "abdomen2", "chest", "neck", "head"],
    limbs: ["shoulder.L", "upper_arm.L", "forearm.L", "hand.L", "thigh.L", "shin.L", "foot.L", "toe.L"],
    fingers: [
        ["thumb.01.L", "thumb.02.L", "thumb.03.L"],
        ["f_index.01.L", "f_index.02.L", "f_index.03.L"],
        ["f_middle.01.L", "f_middle.02.L", "f_middle.03.L"],
        ["f_ring.01.L", "f_ring.02.L", "f_ring.03.L"],
        ["f_pinky.01.L", "f_pinky.02.L", "f_pinky.03.L"],
    ],
    face: NO_FACE,
    sides: Sides::End(".L", ".R"),
};

const POSER: Rig = Rig {
    files: &["mesh2motion/cmu_91_48.glb", "mesh2motion/cmu_91_51.glb", "bvh/threejs_pirouette.bvh"],
    prefix: "",
    trunk: ["hip", "abdomen", "chest", "", "neck", "head"],
    limbs: ["lCollar", "lShldr", "lForeArm", "lHand", "lThigh", "lShin", "lFoot", ""],
    fingers: [
        ["lThumb1", "lThumb2", ""],
        ["lIndex1", "lIndex2", ""],
        ["lMid1", "lMid2", ""],
        ["lRing1", "lRing2", ""],
        ["lPinky1", "lPinky2", ""],
    ],
    face: ["leftEye", "rightEye", ""],
    sides: Sides::Begin("l", "r"),
};

const CMU: Rig = Rig {
    files: &["bvh/cmu_01_01.bvh"],
    prefix: "",
    trunk: ["Hips", "LowerBack", "Spine", "Spine1", "Neck", "Head"],
    limbs: MIXAMO.limbs,
    fingers: [["LThumb/RThumb", "", ""], NO_FINGER, NO_FINGER, NO_FINGER, NO_FINGER],
    face: NO_FACE,
    sides: Sides::Begin("Left", "Right"),
};

const BITMOJI: Rig = Rig {
    files: &["playcanvas/bitmoji.glb", "playcanvas/bitmoji-anim/walk.glb"],
    prefix: "",
    trunk: [
        "C_spine0001_bind_JNT",
        "C_spine0002_bind_JNT",
        "C_spine0006_bind_JNT",
        "",
        "C_neck0001_bind_JNT",
        "C_head0001_bind_JNT",
    ],
    limbs: [
        "L_clavicle_bind_JNT",
        "L_armUpper0001_bind_JNT",
        "L_armLower0001_bind_JNT",
        "L_hand0001_bind_JNT",
        "L_legUpper0001_bind_JNT",
        "L_legLower0001_bind_JNT",
        "L_foot0001_bind_JNT",
        "L_foot0002_bind_JNT",
    ],
    fingers: [
        ["L_handThumb0001_bind_JNT", "L_handThumb0002_bind_JNT", "L_handThumb0003_bind_JNT"],
        ["L_handPointer0002_bind_JNT", "L_handPointer0003_bind_JNT", "L_handPointer0004_bind_JNT"],
        ["L_handMiddle0002_bind_JNT", "L_handMiddle0003_bind_JNT", "L_handMiddle0004_bind_JNT"],
        ["L_handRing0002_bind_JNT", "L_handRing0003_bind_JNT", "L_handRing0004_bind_JNT"],
        ["L_handPinky0002_bind_JNT", "L_handPinky0003_bind_JNT", "L_handPinky0004_bind_JNT"],
    ],
    face: ["", "", "C_jaw_bind_JNT"],
    sides: Sides::Begin("L_", "R_"),
};

pub const RIGS: &[Rig] = &[
    MIXAMO,
    Rig { files: &["threejs/Xbot.glb", "threejs/Samba_Dancing.glb"], face: ["LeftEye", "RightEye", ""], ..MIXAMO },
    Rig {
        files: &["mesh2motion/human-interleaved-buffer-mesh.glb"],
        prefix: "",
        face: ["LeftEye", "RightEye", ""],
        ..MIXAMO
    },
    Rig { files: &["vrm/vrm0_EmissionMigration_v0.107.0.vrm"], prefix: "Character1_", ..MIXAMO },
    UNREAL,
    Rig {
        files: &["mesh2motion/human-zombie.glb"],
        fingers: [UNREAL.fingers[0], UNREAL.fingers[1], NO_FINGER, NO_FINGER, NO_FINGER],
        ..UNREAL
    },
    Rig {
        files: &["misc/godot_mannequiny.glb"],
        trunk: ["pelvis", "spine_01", "spine_02", "", "neck_01", "head"],
        limbs: ["clavicle.l", "upperarm.l", "lowerarm.l", "hand.l", "thigh.l", "calf.l", "foot.l", "ball.l"],
        fingers: [
            ["thumb_01.l", "thumb_02.l", "thumb_03.l"],
            ["index_01.l", "index_02.l", "index_03.l"],
            ["middle_01.l", "middle_02.l", "middle_03.l"],
            ["ring_01.l", "ring_02.l", "ring_03.l"],
            NO_FINGER,
        ],
        sides: Sides::End(".l", ".r"),
        ..UNREAL
    },
    Rig {
        files: &["mesh2motion/import-negative/m2m-wrong-bone-names.glb"],
        prefix: "DEF-",
        trunk: ["hips", "spine.001", "spine.002", "spine.003", "neck", "head"],
        fingers: [
            ["thumb01.L", "thumb02.L", "thumb03.L"],
            ["f_index01.L", "f_index02.L", "f_index03.L"],
            ["f_middle01.L", "f_middle02.L", "f_middle03.L"],
            ["f_ring01.L", "f_ring02.L", "f_ring03.L"],
            ["f_pinky01.L", "f_pinky02.L", "f_pinky03.L"],
        ],
        ..BLENDER
    },
    BLENDER,
    Rig {
        files: &["misc/babylon_riggedMesh.glb"],
        limbs: [
            "shoulderFBXASC046L",
            "upper_armFBXASC046L",
            "forearmFBXASC046L",
            "handFBXASC046L",
            "thighFBXASC046L",
            "shinFBXASC046L",
            "footFBXASC046L",
            "toeFBXASC046L",
        ],
        fingers: [
            ["thumbFBXASC04601FBXASC046L", "thumbFBXASC04602FBXASC046L", "thumbFBXASC04603FBXASC046L"],
            ["f_indexFBXASC04601FBXASC046L", "f_indexFBXASC04602FBXASC046L", "f_indexFBXASC04603FBXASC046L"],
            ["f_middleFBXASC04601FBXASC046L", "f_middleFBXASC04602FBXASC046L", "f_middleFBXASC04603FBXASC046L"],
            ["f_ringFBXASC04601FBXASC046L", "f_ringFBXASC04602FBXASC046L", "f_ringFBXASC04603FBXASC046L"],
            ["f_pinkyFBXASC04601FBXASC046L", "f_pinkyFBXASC04602FBXASC046L", "f_pinkyFBXASC04603FBXASC046L"],
        ],
        sides: Sides::End("FBXASC046L", "FBXASC046R"),
        ..BLENDER
    },
    POSER,
    Rig { files: &["cosc422/original/Dwarf/avatar_walk.bvh"], fingers: NO_FINGERS, face: NO_FACE, ..POSER },
    CMU,
    Rig {
        files: &[
            "bvh/deepmotion_rest.bvh",
            "bvh/deepmotion_blender_example.bvh",
            "bvh/deepmotion_xia_neutral_16_000.bvh",
            "bvh/deepmotion_xia_depressed_18_000.bvh",
        ],
        fingers: [["LThumb/RThumb", "", ""], ["LeftHandIndex1", "", ""], NO_FINGER, NO_FINGER, NO_FINGER],
        ..CMU
    },
    Rig {
        files: &["bvh/animateddrawings_fair1_dab.bvh", "bvh/animateddrawings_fair1_zombie.bvh"],
        trunk: ["Hips", "Spine", "Spine1", "Spine3", "Neck", "Head"],
        fingers: [["LeftHandThumb1", "", ""], NO_FINGER, NO_FINGER, NO_FINGER, NO_FINGER],
        ..CMU
    },
    Rig {
        files: &["bvh/cosc422_Walk.bvh"],
        // ToSpine only connects the spine: it never rotates.
        trunk: ["Hips", "Spine", "Spine1", "", "Neck", "Head"],
        fingers: NO_FINGERS,
        ..CMU
    },
    Rig { files: &["bvh/animateddrawings_rokoko_jesse_dance.bvh"], prefix: "", ..MIXAMO },
    Rig {
        files: &["bvh/animateddrawings_cmu1_jumping_jacks.bvh"],
        prefix: "",
        trunk: ["Hips", "lowerback", "Chest", "Chest2", "Neck", "Head"],
        limbs: ["LeftCollar", "LeftShoulder", "LeftElbow", "LeftWrist", "LeftHip", "LeftKnee", "LeftAnkle", "LeftToe"],
        fingers: CMU.fingers,
        face: NO_FACE,
        sides: Sides::Begin("Left", "Right"),
    },
    Rig {
        files: &["bvh/assimp_Boxing_Toes.bvh"],
        prefix: "",
        trunk: ["Hips", "Ab", "Chest", "", "Neck", "Head"],
        limbs: ["LeftCollar", "LeftShoulder", "LeftElbow", "LeftWrist", "LeftHip", "LeftKnee", "LeftAnkle", "LeftToes"],
        fingers: NO_FINGERS,
        face: NO_FACE,
        sides: Sides::Begin("Left", "Right"),
    },
    Rig {
        files: &["bvh/cosc422_Dance.bvh"],
        prefix: "",
        trunk: ["Hips", "Chest", "", "", "Neck", "Head"],
        limbs: ["LeftCollar", "LeftUpArm", "LeftLowArm", "LeftHand", "LeftUpLeg", "LeftLowLeg", "LeftFoot", ""],
        fingers: NO_FINGERS,
        face: NO_FACE,
        sides: Sides::Begin("Left", "Right"),
    },
    Rig {
        files: &["kaykit/Knight.glb"],
        prefix: "",
        trunk: ["hips", "spine", "chest", "", "", "head"],
        limbs: ["", "upperarm.l", "lowerarm.l", "wrist.l", "upperleg.l", "lowerleg.l", "foot.l", "toes.l"],
        fingers: NO_FINGERS,
        face: NO_FACE,
        sides: Sides::End(".l", ".r"),
    },
    Rig {
        files: &["threejs/RobotExpressive.glb"],
        prefix: "",
        // Body is the parent of legs and spine; Hips is above the legs' joint. Feet are parented to the floor, and
        // hands are only palms.
        trunk: ["Body", "Abdomen", "#10", "", "Neck", "#12"],
        limbs: ["#15/#35", "UpperArm.L", "LowerArm.L", "", "UpperLeg.L", "#57/#62", "#3/#67", ""],
        fingers: [
            ["Thumb.L", "Thumb2.L", ""],
            ["Index.L", "Index2.L", ""],
            ["Middle1.L", "Middle2.L", ""],
            ["Ring1.L", "Ring2.L", ""],
            NO_FINGER,
        ],
        face: NO_FACE,
        sides: Sides::End(".L", ".R"),
    },
    Rig {
        files: &["misc/godot_robot_player.glb"],
        prefix: "",
        trunk: ["hip", "waist", "chest", "", "neck", "head"],
        limbs: ["", "l-arm", "l-forearm", "", "l-thigh", "l-leg", "l-foot", ""],
        fingers: NO_FINGERS,
        face: NO_FACE,
        sides: Sides::Begin("l-", "r-"),
    },
    Rig {
        files: &["cosc422/dwarf.glb"],
        prefix: "",
        // The head's parent is spine1, which people have always mapped to the neck.
        trunk: ["middle", "spine2", "", "", "spine1", "head"],
        limbs: ["", "lsholda", "lelbo", "lwrist", "lhip", "lknee", "lankle", "ltoe"],
        fingers: NO_FINGERS,
        face: NO_FACE,
        sides: Sides::Begin("l", "r"),
    },
    Rig {
        files: &["cosc422/ArmyPilot.glb"],
        prefix: "",
        trunk: ["Pelvis", "Spine1", "Spine2", "Spine3", "Neck1", "NeckHead"],
        limbs: [
            "LArmCollarbone",
            "LArmUpper1",
            "LArmForearm1",
            "LArmHand",
            "LLegUpper",
            "LLegCalf",
            "LLegAnkle",
            "LLegToe1",
        ],
        fingers: [
            ["LArmThumb1", "LArmThumb2", "LArmThumb3"],
            ["LArmIndex1", "LArmIndex2", "LArmIndex3"],
            ["LArmMid1", "LArmMid2", "LArmMid3"],
            ["LArmRing1", "LArmRing2", "LArmRing3"],
            ["LArmPinky1", "LArmPinky2", "LArmPinky3"],
        ],
        face: NO_FACE,
        sides: Sides::Begin("L", "R"),
    },
    // Unnamed, so by node. The man faces +X, so his left is at -Z; the figure faces +Z.
    Rig {
        files: &["khronos/CesiumMan/glTF-Binary/CesiumMan.glb", "khronos/RiggedFigure/glTF-Binary/RiggedFigure.glb"],
        prefix: "",
        trunk: ["#2", "#11", "#12", "", "#19", "#20"],
        limbs: ["", "#16/#13", "#17/#14", "#18/#15", "#7/#3", "#8/#4", "#9/#5", "#10/#6"],
        fingers: NO_FINGERS,
        face: NO_FACE,
        sides: Sides::Both,
    },
    BITMOJI,
    Rig {
        files: &["playcanvas/bitmoji-anim/jump-flip.glb"],
        trunk: ["C_spine0001_bind_JNT", "C_spine0006_bind_JNT", "", "", "C_neck0001_bind_JNT", "C_head0001_bind_JNT"],
        fingers: NO_FINGERS,
        face: NO_FACE,
        ..BITMOJI
    },
    Rig {
        files: &["vrm/vrm0_cryptovoxels.vrm"],
        prefix: "",
        trunk: ["Hips", "Spine", "Chest", "", "Neck", "Head"],
        limbs: [
            "Left shoulder/Right shoulder",
            "Left arm/Right arm",
            "Left elbow/Right elbow",
            "Left wrist/Right wrist",
            "Left leg/Right leg",
            "Left knee/Right knee",
            "Left ankle/Right ankle",
            "Left toe/Right toe",
        ],
        fingers: [
            ["Thumb0_L", "Thumb1_L", "Thumb2_L"],
            ["IndexFinger1_L", "IndexFinger2_L", "IndexFinger3_L"],
            ["MiddleFinger1_L", "MiddleFinger2_L", "MiddleFinger3_L"],
            ["RingFinger1_L", "RingFinger2_L", "RingFinger3_L"],
            ["LittleFinger1_L", "LittleFinger2_L", "LittleFinger3_L"],
        ],
        face: NO_FACE,
        sides: Sides::End("_L", "_R"),
    },
    Rig {
        files: &["vrm/vrm1_VRMC_materials_mtoon_UV_Animation_Test.vrm"],
        prefix: "",
        trunk: ["hips", "spine", "chest", "", "neck", "head"],
        limbs: ["shoulder.L", "upper_arm.L", "lower_arm.L", "hand.L", "upper_leg.L", "lower_leg.L", "foot.L", "toes.L"],
        fingers: [
            ["thumb.proximal.L", "thumb.intermediate.L", "thumb.distal.L"],
            ["index.proximal.L", "index.intermediate.L", "index.distal.L"],
            ["middle.proximal.L", "middle.intermediate.L", "middle.distal.L"],
            ["ring.proximal.L", "ring.intermediate.L", "ring.distal.L"],
            ["little.proximal.L", "little.intermediate.L", "little.distal.L"],
        ],
        face: ["eye.L", "eye.R", ""],
        sides: Sides::End(".L", ".R"),
    },
    Rig {
        files: &["vrm/vrm1_VRMC_vrm_expressions_isBinary_Overridden.vrm"],
        prefix: "",
        trunk: ["Hips", "Spine", "Chest", "UpperChest", "Neck", "Head"],
        limbs: ["Shoulder.L", "UpperArm.L", "LowerArm.L", "Hand.L", "UpperLeg.L", "LowerLeg.L", "Foot.L", "Toes.L"],
        fingers: NO_FINGERS,
        face: NO_FACE,
        sides: Sides::End(".L", ".R"),
    },
    Rig {
        files: &["vrm/three-vrm_test.vrma"],
        prefix: "",
        trunk: ["hips", "spine", "chest", "", "neck", "head"],
        limbs: [
            "leftShoulder",
            "leftUpperArm",
            "leftLowerArm",
            "leftHand",
            "leftUpperLeg",
            "leftLowerLeg",
            "leftFoot",
            "leftToes",
        ],
        fingers: [
            ["leftThumbMetacarpal", "leftThumbProximal", "leftThumbDistal"],
            ["leftIndexProximal", "leftIndexIntermediate", "leftIndexDistal"],
            ["leftMiddleProximal", "leftMiddleIntermediate", "leftMiddleDistal"],
            ["leftRingProximal", "leftRingIntermediate", "leftRingDistal"],
            ["leftLittleProximal", "leftLittleIntermediate", "leftLittleDistal"],
        ],
        face: NO_FACE,
        sides: Sides::Begin("left", "right"),
    },
    Rig {
        files: &["vrm/chatvrm_idle_loop.vrma"],
        prefix: "",
        trunk: ["root", "torso_1", "torso_4", "torso_7", "neck_1", "head"],
        limbs: ["l_shoulder", "l_up_arm", "l_low_arm", "l_hand", "l_up_leg", "l_low_leg", "l_foot", "l_toes"],
        fingers: NO_FINGERS,
        face: NO_FACE,
        sides: Sides::Begin("l_", "r_"),
    },
];

/// A converter mirrored these and kept the names, so joints on the left are named “right”. The direction of the feet
/// shows it.
const MIRRORED: [&str; 3] = ["cosc422/dwarf.glb", "cosc422/ArmyPilot.glb", "misc/godot_robot_player.glb"];

impl Rig {
    /// The joint of each part, by name or `#NODE`, on the side where it lies.
    pub fn truth(&self) -> BTreeMap<Slot, String> {
        let truth = self.named();
        match MIRRORED.contains(&self.files[0]) {
            true => truth.into_iter().map(|(slot, name)| (slot.mirrored(), name)).collect(),
            false => truth,
        }
    }

    fn named(&self) -> BTreeMap<Slot, String> {
        let mut truth = BTreeMap::new();
        let mut put = |slot: Slot, name: &str| {
            if !name.is_empty() {
                truth.insert(slot, format!("{}{name}", self.prefix));
            }
        };
        for (slot, name) in TRUNK.into_iter().zip(self.trunk).chain([LeftEye, RightEye, Jaw].into_iter().zip(self.face))
        {
            put(slot, name);
        }
        let fingers = FINGERS.into_iter().flatten().zip(self.fingers.into_iter().flatten());
        for (slot, name) in LIMBS.into_iter().zip(self.limbs).chain(fingers) {
            let (left, right) = self.both(name);
            put(slot, &left);
            put(slot.mirrored(), &right);
        }
        truth
    }

    fn both(&self, name: &str) -> (String, String) {
        if name.is_empty() {
            return Default::default();
        }
        if let Some((left, right)) = name.split_once('/') {
            return (left.to_owned(), right.to_owned());
        }
        let right = match self.sides {
            Sides::Begin(left, right) => name.strip_prefix(left).map(|rest| format!("{right}{rest}")),
            Sides::End(left, right) => name.strip_suffix(left).map(|rest| format!("{rest}{right}")),
            Sides::Both => None,
        };
        (name.to_owned(), right.unwrap_or_else(|| panic!("{name} has no side")))
    }
}

pub fn is_called(asset: &Asset, joint: JointIndex, name: &str) -> bool {
    asset.skeleton.name(joint) == name || format!("#{}", asset.skeleton.source_index(joint)) == name
}

pub fn without_humanoid(asset: Asset) -> Asset {
    Asset::new(AssetParts { humanoid: None, ..asset.into_parts() }).expect("indices in range")
}

/// Visits every file without its own humanoid map, so that names and shape alone decide.
pub fn each_file(mut visit: impl FnMut(&str, &Asset, &BTreeMap<Slot, String>)) {
    for rig in RIGS {
        for path in rig.files {
            let Some(asset) = open(path).map(without_humanoid) else { return };
            let truth = rig.truth();
            for (slot, name) in &truth {
                let count = asset.skeleton.joints().filter(|&joint| is_called(&asset, joint, name)).count();
                assert_eq!(count, 1, "the table is wrong: {path} {slot:?} {name}");
            }
            visit(path, &asset, &truth);
        }
    }
}
