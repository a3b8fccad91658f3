//! Limbs as two bones whose end moves.

use gaitway_character::anim::JointIndex;
use glam::{DQuat, DVec3};

use super::arm::Arm;
use super::bodies::Bodies;
use crate::feet::{Leg, solve_leg};
use crate::pose::WorldPose;
use crate::transfer::Transfer;

/// Two arms, then two legs: the order of [`super::parts::Region::limb`].
pub const LIMBS: usize = 4;
pub const ARMS: usize = 2;

/// A limb of the target.
#[derive(Debug, Clone, Copy)]
pub enum Limb {
    Arm(Arm),
    Leg(Leg),
}

impl Limb {
    /// The target's limbs; `None` for those that lack a joint.
    pub fn mapped(transfer: &Transfer, bodies: &Bodies) -> [Option<Self>; LIMBS] {
        let [left_arm, right_arm] =
            bodies.arms.map(|joints| Some(Self::Arm(Arm::new(joints?, &transfer.alignment.target))));
        let [left_leg, right_leg] = Leg::mapped(transfer).map(|leg| Some(Self::Leg(leg?.0)));
        [left_arm, right_arm, left_leg, right_leg]
    }

    /// Shoulder, elbow and wrist, or hip, knee and ankle.
    pub fn joints(&self) -> [JointIndex; 3] {
        match self {
            Self::Arm(arm) => arm.joints,
            Self::Leg(leg) => [leg.hip, leg.knee, leg.ankle],
        }
    }

    /// Returns how both bones turn in the common frame to move the limb's end by `by`, or as near as it reaches.
    pub fn reach(&self, pose: &WorldPose, by: DVec3) -> [DQuat; 2] {
        match self {
            Self::Arm(arm) => arm.reach(pose, by),
            Self::Leg(leg) => {
                let turns = solve_leg(leg, pose, by, 0.0);
                [turns.thigh, turns.shin]
            }
        }
    }
}
