//! The humanoid bones of VRM 1.0 (`VRMC_vrm-1.0`, humanoid.md).

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::anim::JointIndex;

macro_rules! slots {
    ($($slot:ident $name:literal),* $(,)?) => {
        /// One of the 55 humanoid bones of VRM 1.0. Left and right are the character's own.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        pub enum Slot {
            $(#[doc = concat!("VRM's `", $name, "`.")] #[serde(rename = $name)] $slot,)*
        }

        impl Slot {
            /// From the hips outwards; parents before children.
            pub const ALL: &[Self] = &[$(Self::$slot,)*];

            /// Its name in VRM 1.0.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$slot => $name,)*
                }
            }
        }
    };
}

slots! {
    Hips "hips", Spine "spine", Chest "chest", UpperChest "upperChest", Neck "neck", Head "head",
    LeftEye "leftEye", RightEye "rightEye", Jaw "jaw",
    LeftUpperLeg "leftUpperLeg", LeftLowerLeg "leftLowerLeg", LeftFoot "leftFoot", LeftToes "leftToes",
    RightUpperLeg "rightUpperLeg", RightLowerLeg "rightLowerLeg", RightFoot "rightFoot", RightToes "rightToes",
    LeftShoulder "leftShoulder", LeftUpperArm "leftUpperArm", LeftLowerArm "leftLowerArm", LeftHand "leftHand",
    RightShoulder "rightShoulder", RightUpperArm "rightUpperArm", RightLowerArm "rightLowerArm", RightHand "rightHand",
    LeftThumbMetacarpal "leftThumbMetacarpal", LeftThumbProximal "leftThumbProximal", LeftThumbDistal "leftThumbDistal",
    LeftIndexProximal "leftIndexProximal", LeftIndexIntermediate "leftIndexIntermediate",
    LeftIndexDistal "leftIndexDistal",
    LeftMiddleProximal "leftMiddleProximal", LeftMiddleIntermediate "leftMiddleIntermediate",
    LeftMiddleDistal "leftMiddleDistal",
    LeftRingProximal "leftRingProximal", LeftRingIntermediate "leftRingIntermediate", LeftRingDistal "leftRingDistal",
    LeftLittleProximal "leftLittleProximal", LeftLittleIntermediate "leftLittleIntermediate",
    LeftLittleDistal "leftLittleDistal",
    RightThumbMetacarpal "rightThumbMetacarpal", RightThumbProximal "rightThumbProximal",
    RightThumbDistal "rightThumbDistal",
    RightIndexProximal "rightIndexProximal", RightIndexIntermediate "rightIndexIntermediate",
    RightIndexDistal "rightIndexDistal",
    RightMiddleProximal "rightMiddleProximal", RightMiddleIntermediate "rightMiddleIntermediate",
    RightMiddleDistal "rightMiddleDistal",
    RightRingProximal "rightRingProximal", RightRingIntermediate "rightRingIntermediate",
    RightRingDistal "rightRingDistal",
    RightLittleProximal "rightLittleProximal", RightLittleIntermediate "rightLittleIntermediate",
    RightLittleDistal "rightLittleDistal",
}

impl Slot {
    /// Returns the slot with this VRM 1.0 name; case-sensitive.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|slot| slot.name() == name)
    }

    /// Returns the slot on the other side; a slot in the middle mirrors to itself.
    pub fn mirrored(self) -> Self {
        let name = self.name();
        let other = match (name.strip_prefix("left"), name.strip_prefix("right")) {
            (Some(rest), _) => format!("right{rest}"),
            (_, Some(rest)) => format!("left{rest}"),
            _ => return self,
        };
        Self::from_name(&other).unwrap_or(self)
    }
}

/// Maps humanoid slots to joints, as a file declares or as its names and shape suggest.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Humanoid(pub BTreeMap<Slot, JointIndex>);

impl Humanoid {
    /// Returns the joint of a slot.
    pub fn joint(&self, slot: Slot) -> Option<JointIndex> {
        self.0.get(&slot).copied()
    }

    /// Returns the slot of a joint, the first in [`Slot::ALL`] if it has several.
    pub fn slot(&self, joint: JointIndex) -> Option<Slot> {
        self.0.iter().find(|&(_, &other)| other == joint).map(|(&slot, _)| slot)
    }
}
