//! The body parts of real skeletons, labelled by a person from the joints' names (from the skeleton's shape if there are none),
//! and how many of them are recognized.

use std::collections::BTreeMap;

use gaitway::anim::{ClipBuilder, Joint, JointIndex, Skeleton};
use gaitway::asset::{Asset, AssetParts, MeshInstance, Slot, Slot::*};
use gaitway::mesh::Skin;
use gaitway::retarget::{ProposedPair, Reason, Recognized, propose, recognize};

use crate::data::open;

/// One rig. Names are those of the left side; an empty name means that there is no such joint.
struct Rig {
    files: &'static [&'static str],
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
enum Sides {
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

const RIGS: &[Rig] = &[
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
        // Body is the parent of legs and spine; Hips is above the legs' joint. Feet are parented to the floor, and hands are
        // only palms.
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

/// A converter mirrored these and kept the names, so that what lies left is named right; where feet point shows it.
const MIRRORED: [&str; 3] = ["cosc422/dwarf.glb", "cosc422/ArmyPilot.glb", "misc/godot_robot_player.glb"];

/// Skeletons that aren't human bodies, and an arm that isn't enough of one.
const NOT_BODIES: [&str; 9] = [
    "khronos/Fox/glTF-Binary/Fox.glb",
    "khronos/Monster/glTF-Binary/Monster.glb",
    "khronos/RiggedSimple/glTF-Binary/RiggedSimple.glb",
    "mesh2motion/fox-animations.glb",
    "mesh2motion/bird-animations.glb",
    "mesh2motion/snake-animations.glb",
    "mesh2motion/spider-animations.glb",
    "misc/TRex.glb",
    "bvh/cosc422_Test.bvh",
];

impl Rig {
    /// The joint of each part, by name or `#NODE`, on the side where it lies.
    fn truth(&self) -> BTreeMap<Slot, String> {
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

fn without_humanoid(asset: Asset) -> Asset {
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

/// Counts the correct parts, those that exist or were found, and describes the wrong ones.
fn score(asset: &Asset, found: &Recognized, truth: &BTreeMap<Slot, String>) -> (usize, usize, Vec<String>) {
    let (mut right, mut all, mut wrong) = (0, 0, Vec::new());
    for &slot in Slot::ALL {
        let (joint, name) = (found.joint(slot), truth.get(&slot));
        if joint.is_none() && name.is_none() {
            continue;
        }
        all += 1;
        if joint.zip(name).is_some_and(|(joint, name)| is_called(asset, joint, name)) {
            right += 1;
        } else {
            let joint = joint.map(|joint| asset.skeleton.name(joint));
            wrong.push(format!("{}: {joint:?}, not {name:?}", slot.name()));
        }
    }
    (right, all, wrong)
}

#[test]
fn parts_of_real_files_are_recognised() {
    let (mut right, mut all) = (0, 0);
    each_file(|path, asset, truth| {
        let found = recognize(asset);
        let (file_right, file_all, wrong) = score(asset, &found, truth);
        println!("{file_right:3} of {file_all:3}  {path}  {}", wrong.join("; "));
        for (slot, part) in &found.parts {
            let other = truth.get(&slot.mirrored()).filter(|_| slot.mirrored() != *slot);
            assert!(
                other.is_none_or(|other| !is_called(asset, part.joint, other)),
                "{path}: {slot:?} is on the wrong side"
            );
        }
        right += file_right;
        all += file_all;
    });
    println!("{right} of {all}");
    assert!(right as f64 >= 0.97 * all as f64, "{right} of {all}");
}

#[test]
fn what_is_no_body_gets_no_parts() {
    for path in NOT_BODIES {
        let Some(asset) = open(path) else { return };
        assert_eq!(recognize(&asset), Recognized::default(), "{path}");
    }
}

/// One file's own map lacks `leftThumbMetacarpal`, although the joint exists.
#[test]
fn files_that_say_what_is_what_are_believed() {
    for path in ["vrm/vrm0_cryptovoxels.vrm", "vrm/chatvrm_idle_loop.vrma"] {
        let Some(asset) = open(path) else { return };
        let found = recognize(&asset);
        let own = asset.humanoid.as_ref().expect(path);
        assert!(own.0.len() >= 15, "{path}");
        for (&slot, &joint) in &own.0 {
            let part = found.parts[&slot];
            assert_eq!((part.joint, part.reason, part.confidence), (joint, Reason::File, 1.0), "{path} {slot:?}");
        }
        let more: Vec<Slot> = found.parts.keys().copied().filter(|slot| own.joint(*slot).is_none()).collect();
        assert_eq!(more.contains(&LeftThumbMetacarpal), path.contains("cryptovoxels"), "{path}");
    }
}

/// The same skeleton, skins and first clip with the nodes listed in reverse, which reverses siblings.
fn with_nodes_reversed(asset: &Asset) -> Asset {
    let old = &asset.skeleton;
    let count = old.len();
    let joints = (0..count).rev().map(|source| {
        let joint = old.joint_of_source(source).expect("every node is a joint");
        let parent = old.parent(joint).map(|parent| count - 1 - old.source_index(parent));
        let morph_weights = old.rest().morph_weights[old.morph_range(joint)].to_vec();
        Joint { name: old.name(joint).to_owned(), parent, rest: old.rest().local(joint), morph_weights }
    });
    let skeleton = Skeleton::new(joints.collect()).expect("still a tree");
    let moved = |joint: &JointIndex| {
        skeleton.joint_of_source(count - 1 - old.source_index(*joint)).expect("every node is a joint")
    };
    let skins = asset.skins.iter().map(|skin| {
        let joints = skin.joints().iter().map(moved).collect();
        Skin::new(skin.name().to_owned(), joints, skin.joint_from_bind().to_vec(), count).expect("still a skin")
    });
    let clips = asset.clips.first().map(|clip| {
        let mut moved_clip = ClipBuilder::new(clip.name(), &skeleton);
        for channel in clip.channels() {
            let times_secs = &clip.timelines()[channel.timeline as usize];
            let keys = channel.keys.clone();
            moved_clip
                .channel(moved(&channel.joint), channel.interpolation, times_secs, keys)
                .expect("still a channel");
        }
        moved_clip.build()
    });
    let instances = asset.instances.iter().map(|instance| MeshInstance { joint: moved(&instance.joint), ..*instance });
    let (skins, clips, instances) = (skins.collect(), clips.into_iter().collect(), instances.collect());
    let parts = AssetParts {
        skeleton,
        skins,
        clips,
        instances,
        meshes: asset.meshes.clone(),
        materials: asset.materials.clone(),
        textures: asset.textures.clone(),
        images: asset.images.clone(),
        ..AssetParts::default()
    };
    Asset::new(parts).expect("still valid")
}

#[test]
fn the_order_of_nodes_does_not_change_what_is_recognised() {
    each_file(|path, asset, _| {
        let reversed = with_nodes_reversed(asset);
        let last = asset.skeleton.len() - 1;
        let found: Vec<_> = recognize(asset)
            .parts
            .into_iter()
            .map(|(slot, part)| (slot, asset.skeleton.source_index(part.joint), part.reason, part.confidence))
            .collect();
        let found_reversed: Vec<_> = recognize(&reversed)
            .parts
            .into_iter()
            .map(|(slot, part)| (slot, last - reversed.skeleton.source_index(part.joint), part.reason, part.confidence))
            .collect();
        assert_eq!(found, found_reversed, "{path}");
    });
}

/// The same skeleton in another file of a series: what it wears and holds, and who it is, change nothing.
#[test]
fn what_hangs_on_a_rig_does_not_change_what_its_joints_are() {
    let Some(knight) = open("kaykit/Knight.glb") else { return };
    let skinned: Vec<JointIndex> = knight.skins.iter().flat_map(|skin| skin.joints().iter().copied()).collect();
    let carriers: Vec<JointIndex> = knight.instances.iter().map(|instance| instance.joint).collect();
    let worn = carriers.into_iter().filter(|joint| !skinned.contains(joint));
    let things = ["Barbarian_BearTail", "Barbarian_Wings", "head", "Barbarian_ArmLeft", "LeftHand", "hips"];
    let numbers: Vec<usize> = worn.map(|joint| knight.skeleton.source_index(joint)).collect();
    assert!(numbers.len() > things.len());
    let skeleton = knight.skeleton.with_names(numbers.into_iter().zip(things.into_iter().cycle()));
    let found = recognize(&knight);
    let other = Asset::new(AssetParts { skeleton, ..knight.into_parts() }).expect("still valid");
    assert_eq!(recognize(&other), found);
}

/// Every rig with every other one: no left joint follows a right one, and few parts are lost.
#[test]
fn no_proposal_crosses_sides() {
    let mut files: Vec<(String, Asset, BTreeMap<JointIndex, Slot>)> = Vec::new();
    for rig in RIGS {
        let Some(asset) = rig.files.first().and_then(|path| open(path)).map(without_humanoid) else { return };
        let slots = rig.truth().into_iter().map(|(slot, name)| {
            let joint = asset.skeleton.joints().find(|&joint| is_called(&asset, joint, &name));
            (joint.unwrap_or_else(|| panic!("{name}")), slot)
        });
        let slots = slots.collect();
        files.push((rig.files[0].to_owned(), asset, slots));
    }
    for (model_path, model, target_slots) in &files {
        for (motion_path, motion, source_slots) in &files {
            let proposal = propose(model, motion);
            for pair in &proposal.pairs {
                let slots = (target_slots.get(&pair.target), source_slots.get(&pair.source));
                if let (Some(target), Some(source)) = slots {
                    let crossed = *target == source.mirrored() && target != source;
                    assert!(!crossed, "{model_path} from {motion_path}: {target:?} follows {source:?}");
                }
            }
            let common = target_slots.values().filter(|slot| source_slots.values().any(|other| other == *slot));
            let (mut count, mut mapped) = (0, 0);
            for slot in common {
                count += 1;
                let is_mapped = |pair: &ProposedPair| target_slots.get(&pair.target) == Some(slot);
                mapped += usize::from(proposal.pairs.iter().any(is_mapped));
            }
            assert!(mapped as f64 >= 0.9 * count as f64, "{model_path} from {motion_path}: {mapped} of {count}");
        }
    }
}
