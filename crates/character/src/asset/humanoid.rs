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

    /// Left slots with those opposite.
    pub const PAIRS: [(Self, Self); 24] = [
        (Self::LeftEye, Self::RightEye),
        (Self::LeftUpperLeg, Self::RightUpperLeg),
        (Self::LeftLowerLeg, Self::RightLowerLeg),
        (Self::LeftFoot, Self::RightFoot),
        (Self::LeftToes, Self::RightToes),
        (Self::LeftShoulder, Self::RightShoulder),
        (Self::LeftUpperArm, Self::RightUpperArm),
        (Self::LeftLowerArm, Self::RightLowerArm),
        (Self::LeftHand, Self::RightHand),
        (Self::LeftThumbMetacarpal, Self::RightThumbMetacarpal),
        (Self::LeftThumbProximal, Self::RightThumbProximal),
        (Self::LeftThumbDistal, Self::RightThumbDistal),
        (Self::LeftIndexProximal, Self::RightIndexProximal),
        (Self::LeftIndexIntermediate, Self::RightIndexIntermediate),
        (Self::LeftIndexDistal, Self::RightIndexDistal),
        (Self::LeftMiddleProximal, Self::RightMiddleProximal),
        (Self::LeftMiddleIntermediate, Self::RightMiddleIntermediate),
        (Self::LeftMiddleDistal, Self::RightMiddleDistal),
        (Self::LeftRingProximal, Self::RightRingProximal),
        (Self::LeftRingIntermediate, Self::RightRingIntermediate),
        (Self::LeftRingDistal, Self::RightRingDistal),
        (Self::LeftLittleProximal, Self::RightLittleProximal),
        (Self::LeftLittleIntermediate, Self::RightLittleIntermediate),
        (Self::LeftLittleDistal, Self::RightLittleDistal),
    ];

    /// Returns the side of the body; `None` for a slot in the middle.
    pub fn side(self) -> Option<Side> {
        let is_left = Self::PAIRS.iter().any(|(left, _)| *left == self);
        let is_right = Self::PAIRS.iter().any(|(_, right)| *right == self);
        if is_left { Some(Side::Left) } else { is_right.then_some(Side::Right) }
    }

    /// Returns the slot on the other side; a slot in the middle mirrors to itself.
    pub fn mirrored(self) -> Self {
        let other = |(left, right): &(Self, Self)| match self {
            slot if slot == *left => Some(*right),
            slot if slot == *right => Some(*left),
            _ => None,
        };
        Self::PAIRS.iter().find_map(other).unwrap_or(self)
    }

    /// Whether it is in a finger or thumb.
    pub fn is_finger(self) -> bool {
        // They come last.
        self >= Self::LeftThumbMetacarpal
    }
}

/// A side of the body, the character's own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// Left.
    Left,
    /// Right.
    Right,
}

impl Side {
    /// The opposite side.
    pub fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_and_pairs_agree_with_the_names() {
        for &slot in Slot::ALL {
            let name = slot.name();
            let sides = [("left", "right", Side::Left), ("right", "left", Side::Right)];
            let named = sides
                .iter()
                .find_map(|(here, there, side)| Some((format!("{there}{}", name.strip_prefix(here)?), *side)));
            assert_eq!(slot.side(), named.as_ref().map(|(_, side)| *side), "{name}");
            assert_eq!(slot.mirrored().name(), named.map_or(name.to_owned(), |(other, _)| other));
            let fingers = ["Thumb", "Index", "Middle", "Ring", "Little"];
            assert_eq!(slot.is_finger(), fingers.iter().any(|finger| name.contains(finger)), "{name}");
        }
    }
}
