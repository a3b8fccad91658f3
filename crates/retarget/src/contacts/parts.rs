//! The parts that bodies are divided into: what they are called, what they are next to, and which way they point.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::Slot;
use glam::DVec3;

use crate::map::Pair;
use crate::pose::WorldPose;
use crate::transfer::Transfer;

/// Parts of one region don't touch each other: they are neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Region {
    Trunk,
    LeftArm,
    RightArm,
    LeftLeg,
    RightLeg,
}

impl Region {
    /// 0 for the left arm, 1 for the right one.
    pub fn arm(self) -> Option<usize> {
        self.limb().filter(|_| !self.is_leg())
    }

    /// 0 for the left arm, 1 for the right one, 2 for the left leg, 3 for the right one.
    pub fn limb(self) -> Option<usize> {
        match self {
            Self::Trunk => None,
            Self::LeftArm => Some(0),
            Self::RightArm => Some(1),
            Self::LeftLeg => Some(2),
            Self::RightLeg => Some(3),
        }
    }

    pub fn is_leg(self) -> bool {
        matches!(self, Self::LeftLeg | Self::RightLeg)
    }
}

/// One kind of body part. Lengths are shares of the body's height.
pub struct Kind {
    pub slot: Slot,
    pub region: Region,
    /// The axis leads to the first of these that is mapped.
    pub ends: &'static [Slot],
    /// Without a mesh: radii to the front and to the side, and how far the part extends beyond both of its ends.
    pub radii: [f64; 2],
    pub beyond: [f64; 2],
    /// How far points on it move if the end of its limb does, at the part's beginning and at its end. `None` for parts without
    /// points.
    pub levers: Option<[f64; 2]>,
}

const fn kind(
    slot: Slot,
    region: Region,
    ends: &'static [Slot],
    radii: [f64; 2],
    beyond: [f64; 2],
    levers: Option<[f64; 2]>,
) -> Kind {
    Kind { slot, region, ends, radii, beyond, levers }
}

/// The parts, with the proportions of an adult.
const KINDS: [Kind; 17] = {
    use Region::{LeftArm, LeftLeg, RightArm, RightLeg, Trunk};
    use Slot::*;
    const NECK: &[Slot] = &[Neck, Head];
    const ELBOW: Option<[f64; 2]> = Some([0.5, 1.0]);
    const END: Option<[f64; 2]> = Some([1.0, 1.0]);
    [
        kind(Hips, Trunk, &[Spine, Chest, UpperChest, Neck, Head], [0.07, 0.1], [0.06, 0.0], None),
        kind(Spine, Trunk, &[Chest, UpperChest, Neck, Head], [0.065, 0.085], [0.0, 0.0], None),
        kind(Chest, Trunk, &[UpperChest, Neck, Head], [0.07, 0.1], [0.0, 0.0], None),
        kind(UpperChest, Trunk, NECK, [0.065, 0.1], [0.0, 0.0], None),
        kind(Head, Trunk, &[], [0.06, 0.048], [0.0, 0.1], None),
        kind(LeftUpperArm, LeftArm, &[LeftLowerArm], [0.028, 0.028], [0.0, 0.0], None),
        kind(LeftLowerArm, LeftArm, &[LeftHand], [0.023, 0.023], [0.0, 0.0], ELBOW),
        kind(LeftHand, LeftArm, &[LeftMiddleProximal], [0.02, 0.02], [0.0, 0.05], END),
        kind(RightUpperArm, RightArm, &[RightLowerArm], [0.028, 0.028], [0.0, 0.0], None),
        kind(RightLowerArm, RightArm, &[RightHand], [0.023, 0.023], [0.0, 0.0], ELBOW),
        kind(RightHand, RightArm, &[RightMiddleProximal], [0.02, 0.02], [0.0, 0.05], END),
        kind(LeftUpperLeg, LeftLeg, &[LeftLowerLeg], [0.045, 0.045], [0.0, 0.0], None),
        kind(LeftLowerLeg, LeftLeg, &[LeftFoot], [0.03, 0.03], [0.0, 0.0], ELBOW),
        kind(LeftFoot, LeftLeg, &[LeftToes], [0.025, 0.025], [0.03, 0.04], END),
        kind(RightUpperLeg, RightLeg, &[RightLowerLeg], [0.045, 0.045], [0.0, 0.0], None),
        kind(RightLowerLeg, RightLeg, &[RightFoot], [0.03, 0.03], [0.0, 0.0], ELBOW),
        kind(RightFoot, RightLeg, &[RightToes], [0.025, 0.025], [0.03, 0.04], END),
    ]
};

/// A mapped body part.
pub struct Part<'a> {
    pub kind: &'static Kind,
    pub pair: &'a Pair,
    /// What its axis leads to.
    pub end: Option<&'a Pair>,
}

impl<'a> Part<'a> {
    /// All parts whose slots are mapped.
    pub fn mapped(transfer: &Transfer<'a>) -> Vec<Self> {
        let part = |kind: &'static Kind| {
            let end = kind.ends.iter().find_map(|&slot| transfer.pair(slot));
            Some(Self { kind, pair: transfer.pair(kind.slot)?, end })
        };
        KINDS.iter().filter_map(part).collect()
    }

    pub fn is_hand(&self) -> bool {
        matches!(self.kind.slot, Slot::LeftHand | Slot::RightHand)
    }

    pub fn is_shin(&self) -> bool {
        matches!(self.kind.slot, Slot::LeftLowerLeg | Slot::RightLowerLeg)
    }

    pub fn is_trunk(&self) -> bool {
        self.kind.region == Region::Trunk && self.kind.slot != Slot::Head
    }

    /// The axis at rest, and its length. Heads go up, feet forward, and hands on along their arm.
    pub fn axis(&self, parts: &[Part], rest: &WorldPose, joint: fn(&Pair) -> JointIndex) -> (DVec3, f64) {
        let start = rest.position(joint(self.pair));
        let to_end = self.end.map_or(DVec3::ZERO, |end| rest.position(joint(end)) - start);
        if let Some(axis) = to_end.try_normalize() {
            return (axis, to_end.length());
        }
        let arm =
            parts.iter().find(|part| self.kind.region.arm().is_some() && part.kind.ends.contains(&self.kind.slot));
        let axis = match arm {
            Some(before) => start - rest.position(joint(before.pair)),
            None if self.kind.region == Region::Trunk => DVec3::Y,
            None => DVec3::Z,
        };
        (axis.normalize_or(DVec3::Y), 0.0)
    }
}
