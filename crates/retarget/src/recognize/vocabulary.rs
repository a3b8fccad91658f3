//! The names that programs, shops and archives give to the joints of a body. To add a vocabulary, add an entry with the names
//! as the files have them, left side only. Separators, capitals, the spelling of the side and known prefixes make no
//! difference (see `names`).

use gaitway_character::asset::Slot::{self, *};

pub(super) struct Vocabulary {
    /// Its common name.
    pub name: &'static str,
    pub body: &'static [(&'static str, Slot)],
    /// Names in the order of [`FINGERS`]; empty or missing ones have no name.
    pub fingers: &'static [&'static str],
}

/// The left hand's slots, in the order of [`Vocabulary::fingers`].
pub(super) const FINGERS: [Slot; 15] = [
    LeftThumbMetacarpal,
    LeftThumbProximal,
    LeftThumbDistal,
    LeftIndexProximal,
    LeftIndexIntermediate,
    LeftIndexDistal,
    LeftMiddleProximal,
    LeftMiddleIntermediate,
    LeftMiddleDistal,
    LeftRingProximal,
    LeftRingIntermediate,
    LeftRingDistal,
    LeftLittleProximal,
    LeftLittleIntermediate,
    LeftLittleDistal,
];

/// The first of several that fit equally well wins.
#[rustfmt::skip]
pub(super) const VOCABULARIES: &[Vocabulary] = &[
    Vocabulary {
        name: "Mixamo",
        body: &[
            ("mixamorig:Hips", Hips), ("mixamorig:Spine", Spine), ("mixamorig:Spine1", Chest),
            ("mixamorig:Spine2", UpperChest), ("mixamorig:Neck", Neck), ("mixamorig:Head", Head),
            ("mixamorig:LeftEye", LeftEye),
            ("mixamorig:LeftUpLeg", LeftUpperLeg), ("mixamorig:LeftLeg", LeftLowerLeg),
            ("mixamorig:LeftFoot", LeftFoot), ("mixamorig:LeftToeBase", LeftToes), ("LeftToe", LeftToes),
            ("mixamorig:LeftShoulder", LeftShoulder), ("mixamorig:LeftArm", LeftUpperArm),
            ("mixamorig:LeftForeArm", LeftLowerArm), ("mixamorig:LeftHand", LeftHand),
        ],
        fingers: &[
            "LeftHandThumb1", "LeftHandThumb2", "LeftHandThumb3",
            "LeftHandIndex1", "LeftHandIndex2", "LeftHandIndex3",
            "LeftHandMiddle1", "LeftHandMiddle2", "LeftHandMiddle3",
            "LeftHandRing1", "LeftHandRing2", "LeftHandRing3",
            "LeftHandPinky1", "LeftHandPinky2", "LeftHandPinky3",
        ],
    },
    Vocabulary {
        name: "Quaternius",
        // The joint `Hips` is in the belly; legs and spine meet in `Body`.
        body: &[
            ("Body", Hips), ("Abdomen", Spine), ("Torso", Chest), ("Neck", Neck), ("Head", Head),
            ("UpperLeg.L", LeftUpperLeg), ("LowerLeg.L", LeftLowerLeg), ("Foot.L", LeftFoot),
            ("Shoulder.L", LeftShoulder), ("UpperArm.L", LeftUpperArm), ("LowerArm.L", LeftLowerArm),
        ],
        fingers: &[
            "Thumb.L", "Thumb2.L", "", "Index.L", "Index2.L", "", "Middle1.L", "Middle2.L", "", "Ring1.L", "Ring2.L",
        ],
    },
    Vocabulary {
        name: "KayKit",
        // The hand begins at the wrist; `hand.l` is in the palm.
        body: &[
            ("hips", Hips), ("spine", Spine), ("chest", Chest), ("head", Head),
            ("upperleg.l", LeftUpperLeg), ("lowerleg.l", LeftLowerLeg), ("foot.l", LeftFoot), ("toes.l", LeftToes),
            ("upperarm.l", LeftUpperArm), ("lowerarm.l", LeftLowerArm), ("wrist.l", LeftHand),
        ],
        fingers: &[],
    },
    Vocabulary {
        name: "VRM 1.0",
        body: VRM_BODY,
        fingers: &[
            "leftThumbMetacarpal", "leftThumbProximal", "leftThumbDistal",
            "leftIndexProximal", "leftIndexIntermediate", "leftIndexDistal",
            "leftMiddleProximal", "leftMiddleIntermediate", "leftMiddleDistal",
            "leftRingProximal", "leftRingIntermediate", "leftRingDistal",
            "leftLittleProximal", "leftLittleIntermediate", "leftLittleDistal",
        ],
    },
    Vocabulary {
        name: "VRM 0 and Unity",
        body: VRM_BODY,
        fingers: &[
            "leftThumbProximal", "leftThumbIntermediate", "leftThumbDistal",
            "leftIndexProximal", "leftIndexIntermediate", "leftIndexDistal",
            "leftMiddleProximal", "leftMiddleIntermediate", "leftMiddleDistal",
            "leftRingProximal", "leftRingIntermediate", "leftRingDistal",
            "leftLittleProximal", "leftLittleIntermediate", "leftLittleDistal",
        ],
    },
    Vocabulary {
        name: "VRoid",
        body: &[
            ("J_Bip_C_Hips", Hips), ("J_Bip_C_Spine", Spine), ("J_Bip_C_Chest", Chest),
            ("J_Bip_C_UpperChest", UpperChest), ("J_Bip_C_Neck", Neck), ("J_Bip_C_Head", Head),
            ("J_Adj_L_FaceEye", LeftEye),
            ("J_Bip_L_UpperLeg", LeftUpperLeg), ("J_Bip_L_LowerLeg", LeftLowerLeg), ("J_Bip_L_Foot", LeftFoot),
            ("J_Bip_L_ToeBase", LeftToes), ("J_Bip_L_Shoulder", LeftShoulder), ("J_Bip_L_UpperArm", LeftUpperArm),
            ("J_Bip_L_LowerArm", LeftLowerArm), ("J_Bip_L_Hand", LeftHand),
        ],
        fingers: &[
            "J_Bip_L_Thumb1", "J_Bip_L_Thumb2", "J_Bip_L_Thumb3", "J_Bip_L_Index1", "J_Bip_L_Index2", "J_Bip_L_Index3",
            "J_Bip_L_Middle1", "J_Bip_L_Middle2", "J_Bip_L_Middle3", "J_Bip_L_Ring1", "J_Bip_L_Ring2",
            "J_Bip_L_Ring3", "J_Bip_L_Little1", "J_Bip_L_Little2", "J_Bip_L_Little3",
        ],
    },
    Vocabulary {
        name: "Unreal mannequin",
        body: &[
            ("pelvis", Hips), ("spine_01", Spine), ("spine_02", Chest), ("spine_03", UpperChest),
            ("neck_01", Neck), ("head", Head),
            ("thigh_l", LeftUpperLeg), ("calf_l", LeftLowerLeg), ("foot_l", LeftFoot), ("ball_l", LeftToes),
            ("clavicle_l", LeftShoulder), ("upperarm_l", LeftUpperArm), ("lowerarm_l", LeftLowerArm),
            ("hand_l", LeftHand),
        ],
        fingers: &[
            "thumb_01_l", "thumb_02_l", "thumb_03_l", "index_01_l", "index_02_l", "index_03_l",
            "middle_01_l", "middle_02_l", "middle_03_l", "ring_01_l", "ring_02_l", "ring_03_l",
            "pinky_01_l", "pinky_02_l", "pinky_03_l",
        ],
    },
    Vocabulary {
        name: "Unreal 5 mannequin",
        body: &[
            ("pelvis", Hips), ("spine_01", Spine), ("spine_03", Chest), ("spine_05", UpperChest),
            ("neck_01", Neck), ("head", Head),
            ("thigh_l", LeftUpperLeg), ("calf_l", LeftLowerLeg), ("foot_l", LeftFoot), ("ball_l", LeftToes),
            ("clavicle_l", LeftShoulder), ("upperarm_l", LeftUpperArm), ("lowerarm_l", LeftLowerArm),
            ("hand_l", LeftHand),
        ],
        fingers: &[
            "thumb_01_l", "thumb_02_l", "thumb_03_l", "index_01_l", "index_02_l", "index_03_l",
            "middle_01_l", "middle_02_l", "middle_03_l", "ring_01_l", "ring_02_l", "ring_03_l",
            "pinky_01_l", "pinky_02_l", "pinky_03_l",
        ],
    },
    Vocabulary {
        name: "Rigify",
        body: &[
            ("DEF-spine", Hips), ("DEF-spine.001", Spine), ("DEF-spine.002", Chest), ("DEF-spine.003", UpperChest),
            ("DEF-spine.004", Neck), ("DEF-spine.006", Head), ("DEF-jaw", Jaw), ("DEF-eye.L", LeftEye),
            ("DEF-thigh.L", LeftUpperLeg), ("DEF-shin.L", LeftLowerLeg), ("DEF-foot.L", LeftFoot),
            ("DEF-toe.L", LeftToes), ("DEF-shoulder.L", LeftShoulder), ("DEF-upper_arm.L", LeftUpperArm),
            ("DEF-forearm.L", LeftLowerArm), ("DEF-hand.L", LeftHand),
        ],
        fingers: BLENDER_FINGERS,
    },
    Vocabulary {
        name: "Rigify with a hips joint",
        body: &[
            ("DEF-hips", Hips), ("DEF-spine.001", Spine), ("DEF-spine.002", Chest), ("DEF-spine.003", UpperChest),
            ("DEF-neck", Neck), ("DEF-head", Head),
            ("DEF-thigh.L", LeftUpperLeg), ("DEF-shin.L", LeftLowerLeg), ("DEF-foot.L", LeftFoot),
            ("DEF-toe.L", LeftToes), ("DEF-shoulder.L", LeftShoulder), ("DEF-upper_arm.L", LeftUpperArm),
            ("DEF-forearm.L", LeftLowerArm), ("DEF-hand.L", LeftHand),
        ],
        fingers: &[
            "DEF-thumb01.L", "DEF-thumb02.L", "DEF-thumb03.L", "DEF-f_index01.L", "DEF-f_index02.L",
            "DEF-f_index03.L", "DEF-f_middle01.L", "DEF-f_middle02.L", "DEF-f_middle03.L", "DEF-f_ring01.L",
            "DEF-f_ring02.L", "DEF-f_ring03.L", "DEF-f_pinky01.L", "DEF-f_pinky02.L", "DEF-f_pinky03.L",
        ],
    },
    Vocabulary {
        name: "Blender human",
        body: &[
            ("hips", Hips), ("abdomen", Spine), ("abdomen2", Chest), ("spine", Spine), ("chest", UpperChest),
            ("neck", Neck), ("head", Head),
            ("thigh.L", LeftUpperLeg), ("shin.L", LeftLowerLeg), ("foot.L", LeftFoot), ("toe.L", LeftToes),
            ("shoulder.L", LeftShoulder), ("upper_arm.L", LeftUpperArm), ("forearm.L", LeftLowerArm),
            ("hand.L", LeftHand),
        ],
        fingers: BLENDER_FINGERS,
    },
    Vocabulary {
        name: "3ds Max Biped",
        body: &[
            ("Bip01 Pelvis", Hips), ("Bip01 Spine", Spine), ("Bip01 Spine1", Chest), ("Bip01 Spine2", UpperChest),
            ("Bip01 Neck", Neck), ("Bip01 Head", Head),
            ("Bip01 L Thigh", LeftUpperLeg), ("Bip01 L Calf", LeftLowerLeg), ("Bip01 L Foot", LeftFoot),
            ("Bip01 L Toe0", LeftToes), ("Bip01 L Clavicle", LeftShoulder), ("Bip01 L UpperArm", LeftUpperArm),
            ("Bip01 L Forearm", LeftLowerArm), ("Bip01 L Hand", LeftHand),
        ],
        fingers: BIPED_FINGERS,
    },
    Vocabulary {
        name: "Source engine",
        body: &[
            ("ValveBiped.Bip01_Pelvis", Hips), ("ValveBiped.Bip01_Spine", Spine), ("ValveBiped.Bip01_Spine2", Chest),
            ("ValveBiped.Bip01_Spine4", UpperChest), ("ValveBiped.Bip01_Neck1", Neck),
            ("ValveBiped.Bip01_Head1", Head), ("ValveBiped.Bip01_L_Thigh", LeftUpperLeg),
            ("ValveBiped.Bip01_L_Calf", LeftLowerLeg), ("ValveBiped.Bip01_L_Foot", LeftFoot),
            ("ValveBiped.Bip01_L_Toe0", LeftToes), ("ValveBiped.Bip01_L_Clavicle", LeftShoulder),
            ("ValveBiped.Bip01_L_UpperArm", LeftUpperArm), ("ValveBiped.Bip01_L_Forearm", LeftLowerArm),
            ("ValveBiped.Bip01_L_Hand", LeftHand),
        ],
        fingers: BIPED_FINGERS,
    },
    Vocabulary {
        name: "CMU motion capture",
        body: &[
            ("Hips", Hips), ("LowerBack", Spine), ("Spine", Chest), ("Spine1", UpperChest), ("Neck", Neck),
            ("Head", Head),
            ("LeftUpLeg", LeftUpperLeg), ("LeftLeg", LeftLowerLeg), ("LeftFoot", LeftFoot), ("LeftToeBase", LeftToes),
            ("LeftShoulder", LeftShoulder), ("LeftArm", LeftUpperArm), ("LeftForeArm", LeftLowerArm),
            ("LeftHand", LeftHand),
        ],
        fingers: &["LThumb", "", "", "LeftHandIndex1"],
    },
    Vocabulary {
        name: "hip, knee and ankle of motion capture",
        body: &[
            ("Hips", Hips), ("Ab", Spine), ("LowerBack", Spine), ("Chest", Chest), ("Chest2", UpperChest),
            ("Neck", Neck), ("Head", Head),
            ("LeftHip", LeftUpperLeg), ("LeftKnee", LeftLowerLeg), ("LeftAnkle", LeftFoot), ("LeftToe", LeftToes),
            ("LeftToes", LeftToes), ("LeftCollar", LeftShoulder), ("LeftShoulder", LeftUpperArm),
            ("LeftElbow", LeftLowerArm), ("LeftWrist", LeftHand),
        ],
        fingers: &["LThumb"],
    },
    Vocabulary {
        name: "up and low limbs of motion capture",
        body: &[
            ("Hips", Hips), ("Chest", Chest), ("Neck", Neck), ("Head", Head),
            ("LeftUpLeg", LeftUpperLeg), ("LeftLowLeg", LeftLowerLeg), ("LeftFoot", LeftFoot), ("LeftToe", LeftToes),
            ("LeftCollar", LeftShoulder), ("LeftUpArm", LeftUpperArm), ("LeftLowArm", LeftLowerArm),
            ("LeftHand", LeftHand),
        ],
        fingers: &[],
    },
    Vocabulary {
        name: "OptiTrack",
        body: &[
            ("Hip", Hips), ("Ab", Spine), ("Chest", Chest), ("Neck", Neck), ("Head", Head),
            ("LThigh", LeftUpperLeg), ("LShin", LeftLowerLeg), ("LFoot", LeftFoot), ("LToe", LeftToes),
            ("LShoulder", LeftShoulder), ("LUArm", LeftUpperArm), ("LFArm", LeftLowerArm), ("LHand", LeftHand),
        ],
        fingers: DAZ_FINGERS,
    },
    Vocabulary {
        name: "SMPL",
        body: &[
            ("Pelvis", Hips), ("Spine1", Spine), ("Spine2", Chest), ("Spine3", UpperChest), ("Neck", Neck),
            ("Head", Head),
            ("L_Hip", LeftUpperLeg), ("L_Knee", LeftLowerLeg), ("L_Ankle", LeftFoot), ("L_Foot", LeftToes),
            ("L_Collar", LeftShoulder), ("L_Shoulder", LeftUpperArm), ("L_Elbow", LeftLowerArm),
            ("L_Wrist", LeftHand),
        ],
        fingers: DAZ_FINGERS,
    },
    Vocabulary {
        name: "Poser and Daz",
        body: &[
            ("hip", Hips), ("abdomen", Spine), ("chest", Chest), ("neck", Neck), ("head", Head), ("leftEye", LeftEye),
            ("lEye", LeftEye),
            ("lThigh", LeftUpperLeg), ("lShin", LeftLowerLeg), ("lFoot", LeftFoot), ("lToe", LeftToes),
            ("lCollar", LeftShoulder), ("lShldr", LeftUpperArm), ("lForeArm", LeftLowerArm), ("lHand", LeftHand),
        ],
        fingers: DAZ_FINGERS,
    },
    Vocabulary {
        name: "Daz Genesis",
        body: &[
            ("hip", Hips), ("abdomenLower", Spine), ("abdomenUpper", Chest), ("chestLower", UpperChest),
            ("neckLower", Neck), ("head", Head), ("lEye", LeftEye), ("lowerJaw", Jaw),
            ("lThighBend", LeftUpperLeg), ("lShin", LeftLowerLeg), ("lFoot", LeftFoot), ("lToe", LeftToes),
            ("lCollar", LeftShoulder), ("lShldrBend", LeftUpperArm), ("lForearmBend", LeftLowerArm),
            ("lHand", LeftHand),
        ],
        fingers: DAZ_FINGERS,
    },
    Vocabulary {
        name: "Character Creator",
        body: &[
            ("CC_Base_Hip", Hips), ("CC_Base_Waist", Spine), ("CC_Base_Spine01", Chest),
            ("CC_Base_Spine02", UpperChest), ("CC_Base_NeckTwist01", Neck), ("CC_Base_Head", Head),
            ("CC_Base_L_Eye", LeftEye), ("CC_Base_JawRoot", Jaw),
            ("CC_Base_L_Thigh", LeftUpperLeg), ("CC_Base_L_Calf", LeftLowerLeg), ("CC_Base_L_Foot", LeftFoot),
            ("CC_Base_L_ToeBase", LeftToes), ("CC_Base_L_Clavicle", LeftShoulder),
            ("CC_Base_L_Upperarm", LeftUpperArm), ("CC_Base_L_Forearm", LeftLowerArm), ("CC_Base_L_Hand", LeftHand),
        ],
        fingers: &[
            "CC_Base_L_Thumb1", "CC_Base_L_Thumb2", "CC_Base_L_Thumb3", "CC_Base_L_Index1", "CC_Base_L_Index2",
            "CC_Base_L_Index3", "CC_Base_L_Mid1", "CC_Base_L_Mid2", "CC_Base_L_Mid3", "CC_Base_L_Ring1",
            "CC_Base_L_Ring2", "CC_Base_L_Ring3", "CC_Base_L_Pinky1", "CC_Base_L_Pinky2", "CC_Base_L_Pinky3",
        ],
    },
    Vocabulary {
        name: "VRChat and MMD in English",
        body: &[
            ("Hips", Hips), ("Spine", Spine), ("Chest", Chest), ("Upper Chest", UpperChest), ("Neck", Neck),
            ("Head", Head), ("Eye_L", LeftEye),
            ("Left leg", LeftUpperLeg), ("Left knee", LeftLowerLeg), ("Left ankle", LeftFoot), ("Left toe", LeftToes),
            ("Left shoulder", LeftShoulder), ("Left arm", LeftUpperArm), ("Left elbow", LeftLowerArm),
            ("Left wrist", LeftHand),
        ],
        fingers: &[
            "Thumb0_L", "Thumb1_L", "Thumb2_L", "IndexFinger1_L", "IndexFinger2_L", "IndexFinger3_L",
            "MiddleFinger1_L", "MiddleFinger2_L", "MiddleFinger3_L", "RingFinger1_L", "RingFinger2_L",
            "RingFinger3_L", "LittleFinger1_L", "LittleFinger2_L", "LittleFinger3_L",
        ],
    },
    Vocabulary {
        name: "Bitmoji",
        body: &[
            ("C_spine0001_bind_JNT", Hips), ("C_spine0002_bind_JNT", Spine), ("C_spine0006_bind_JNT", Chest),
            ("C_neck0001_bind_JNT", Neck), ("C_head0001_bind_JNT", Head), ("C_jaw_bind_JNT", Jaw),
            ("L_legUpper0001_bind_JNT", LeftUpperLeg), ("L_legLower0001_bind_JNT", LeftLowerLeg),
            ("L_foot0001_bind_JNT", LeftFoot), ("L_foot0002_bind_JNT", LeftToes),
            ("L_clavicle_bind_JNT", LeftShoulder), ("L_armUpper0001_bind_JNT", LeftUpperArm),
            ("L_armLower0001_bind_JNT", LeftLowerArm), ("L_hand0001_bind_JNT", LeftHand),
        ],
        fingers: &[
            "L_handThumb0001_bind_JNT", "L_handThumb0002_bind_JNT", "L_handThumb0003_bind_JNT",
            "L_handPointer0002_bind_JNT", "L_handPointer0003_bind_JNT", "L_handPointer0004_bind_JNT",
            "L_handMiddle0002_bind_JNT", "L_handMiddle0003_bind_JNT", "L_handMiddle0004_bind_JNT",
            "L_handRing0002_bind_JNT", "L_handRing0003_bind_JNT", "L_handRing0004_bind_JNT",
            "L_handPinky0002_bind_JNT", "L_handPinky0003_bind_JNT", "L_handPinky0004_bind_JNT",
        ],
    },
    Vocabulary {
        name: "MilkShape dwarf",
        // The spine is numbered from the top: the head sits on spine1.
        body: &[
            ("middle", Hips), ("spine2", Spine), ("spine1", Neck), ("head", Head),
            ("lhip", LeftUpperLeg), ("lknee", LeftLowerLeg), ("lankle", LeftFoot), ("ltoe", LeftToes),
            ("lsholda", LeftUpperArm), ("lelbo", LeftLowerArm), ("lwrist", LeftHand),
        ],
        fingers: &[],
    },
];

#[rustfmt::skip]
const VRM_BODY: &[(&str, Slot)] = &[
    ("hips", Hips), ("spine", Spine), ("chest", Chest), ("upperChest", UpperChest), ("neck", Neck), ("head", Head),
    ("leftEye", LeftEye), ("jaw", Jaw),
    ("leftUpperLeg", LeftUpperLeg), ("leftLowerLeg", LeftLowerLeg), ("leftFoot", LeftFoot), ("leftToes", LeftToes),
    ("leftShoulder", LeftShoulder), ("leftUpperArm", LeftUpperArm), ("leftLowerArm", LeftLowerArm),
    ("leftHand", LeftHand),
];

const BLENDER_FINGERS: &[&str] = &[
    "thumb.01.L",
    "thumb.02.L",
    "thumb.03.L",
    "f_index.01.L",
    "f_index.02.L",
    "f_index.03.L",
    "f_middle.01.L",
    "f_middle.02.L",
    "f_middle.03.L",
    "f_ring.01.L",
    "f_ring.02.L",
    "f_ring.03.L",
    "f_pinky.01.L",
    "f_pinky.02.L",
    "f_pinky.03.L",
];

#[rustfmt::skip]
const BIPED_FINGERS: &[&str] = &[
    "L Finger0", "L Finger01", "L Finger02", "L Finger1", "L Finger11", "L Finger12", "L Finger2", "L Finger21",
    "L Finger22", "L Finger3", "L Finger31", "L Finger32", "L Finger4", "L Finger41", "L Finger42",
];

#[rustfmt::skip]
const DAZ_FINGERS: &[&str] = &[
    "lThumb1", "lThumb2", "lThumb3", "lIndex1", "lIndex2", "lIndex3", "lMid1", "lMid2", "lMid3", "lRing1", "lRing2",
    "lRing3", "lPinky1", "lPinky2", "lPinky3",
];
