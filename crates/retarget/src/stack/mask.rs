//! Which joints a layer changes: parts of the body, by humanoid slot, and subtrees of joints.

use std::collections::BTreeSet;

use gaitway_character::asset::{Side, Slot};
use serde::{Deserialize, Serialize};

use crate::Body;

/// A part of the body. Every joint belongs to one: that of the nearest joint with a slot at or above it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BodyPart {
    /// The hips, and everything that no other part has.
    Hips,
    /// From the spine to the upper chest.
    Torso,
    /// Neck, head, eyes and jaw.
    Head,
    /// From the shoulder to the fingers.
    LeftArm,
    /// From the shoulder to the fingers.
    RightArm,
    /// From the thigh to the toes.
    LeftLeg,
    /// From the thigh to the toes.
    RightLeg,
}

impl BodyPart {
    /// All parts with their names in links, in display order.
    pub const ALL: [(Self, &str); 7] = [
        (Self::Hips, "hips"),
        (Self::Torso, "torso"),
        (Self::Head, "head"),
        (Self::LeftArm, "left-arm"),
        (Self::RightArm, "right-arm"),
        (Self::LeftLeg, "left-leg"),
        (Self::RightLeg, "right-leg"),
    ];

    /// Returns the part that a slot belongs to.
    pub fn of(slot: Slot) -> Self {
        use Slot::*;
        match slot {
            Hips => Self::Hips,
            Spine | Chest | UpperChest => Self::Torso,
            Neck | Head | LeftEye | RightEye | Jaw => Self::Head,
            LeftUpperLeg | LeftLowerLeg | LeftFoot | LeftToes => Self::LeftLeg,
            RightUpperLeg | RightLowerLeg | RightFoot | RightToes => Self::RightLeg,
            other if other.side() == Some(Side::Left) => Self::LeftArm,
            _ => Self::RightArm,
        }
    }

    fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// The joints that a layer changes: all if nothing is chosen.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct LayerMask {
    /// One bit per part.
    parts: u8,
    /// Joints by index in the file, each with everything below it.
    pub joints: BTreeSet<usize>,
}

impl LayerMask {
    /// Returns the mask of some parts.
    pub fn of_parts(parts: &[BodyPart]) -> Self {
        Self { parts: parts.iter().fold(0, |bits, part| bits | part.bit()), joints: BTreeSet::new() }
    }

    /// Whether it includes all joints.
    pub fn is_all(&self) -> bool {
        self.parts == 0 && self.joints.is_empty()
    }

    /// Whether a part is chosen.
    pub fn has(&self, part: BodyPart) -> bool {
        self.parts & part.bit() != 0
    }

    /// Adds a part, or removes it.
    pub fn toggle(&mut self, part: BodyPart) {
        self.parts ^= part.bit();
    }

    /// Returns one flag per joint. Indices that the file lacks are ignored.
    pub fn included(&self, body: &Body<'_>) -> Vec<bool> {
        let Body { asset, slots } = body;
        let skeleton = &asset.skeleton;
        let mut parts = vec![None; skeleton.len()];
        for (&slot, &joint) in &slots.0 {
            parts[joint.get()] = Some(BodyPart::of(slot));
        }
        let mut is_below = vec![false; skeleton.len()];
        let roots = self.joints.iter().filter_map(|&root| skeleton.joint_of_source(root));
        roots.for_each(|root| is_below[root.get()] = true);
        let mut included = vec![self.is_all(); skeleton.len()];
        for (at, parent) in skeleton.parents().iter().enumerate() {
            let above = parent.map(|parent| (parts[parent.get()], is_below[parent.get()]));
            let (part_above, below) = above.unwrap_or((None, false));
            let part = *parts[at].get_or_insert(part_above.unwrap_or(BodyPart::Hips));
            is_below[at] |= below;
            included[at] |= is_below[at] || self.has(part);
        }
        included
    }
}
