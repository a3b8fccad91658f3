//! A leg as two bones: its knee bends about a hinge, and the foot keeps its direction.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::Slot;
use glam::{DQuat, DVec3};

use crate::math::{smooth, unit};
use crate::pose::WorldPose;
use crate::transfer::Transfer;
use crate::two_bones::{max_reach, reach_goal};

/// Sine of the bend below which the hinge at rest is blended in.
const MIN_BEND: f64 = 0.17;

/// A knee bent the wrong way stays so unless planting moves the foot by more than this share of the leg's length.
const SMALL_MOVE: f64 = 0.02;

/// Hip, knee, ankle and toes of each leg.
const LEGS: [[Slot; 4]; 2] = [
    [Slot::LeftUpperLeg, Slot::LeftLowerLeg, Slot::LeftFoot, Slot::LeftToes],
    [Slot::RightUpperLeg, Slot::RightLowerLeg, Slot::RightFoot, Slot::RightToes],
];

/// The target joints of one leg.
#[derive(Debug, Clone, Copy)]
pub struct Leg {
    pub hip: JointIndex,
    pub knee: JointIndex,
    pub ankle: JointIndex,
    /// What stays in place: the toes, or the ankle itself.
    pub toes: JointIndex,
    /// Axis about which the knee bends at rest, in the frame of `hip`.
    hinge: DVec3,
}

/// How thigh and shin are turned in the common frame to bring a foot to its place.
#[derive(Debug, Clone, Copy)]
pub struct LegTurns {
    pub thigh: DQuat,
    pub shin: DQuat,
}

impl Leg {
    /// The left and the right leg, and the source's joint for `toes`; `None` unless hip, knee and ankle are mapped.
    pub fn mapped(transfer: &Transfer) -> [Option<(Self, JointIndex)>; 2] {
        LEGS.map(|slots| {
            let [hip, knee, ankle, toes] = slots.map(|slot| transfer.pair(slot));
            let (hip, knee, ankle) = (hip?, knee?, ankle?);
            let toes = toes.unwrap_or(ankle);
            let joints = [hip, knee, ankle, toes].map(|pair| pair.target);
            Some((Self::new(joints, &transfer.alignment.target), toes.source))
        })
    }

    /// `joints` are hip, knee, ankle and toes; `rest` faces +Z.
    fn new([hip, knee, ankle, toes]: [JointIndex; 4], rest: &WorldPose) -> Self {
        let thigh = (rest.position(knee) - rest.position(hip)).normalize_or_zero();
        let shin = (rest.position(ankle) - rest.position(knee)).normalize_or_zero();
        let bend = thigh.cross(shin);
        let axis = if bend.length() > MIN_BEND { bend } else { bend + MIN_BEND * DVec3::X };
        let hinge = rest.rotation(hip).conjugate() * axis.reject_from(thigh).normalize_or(DVec3::X);
        Self { hip, knee, ankle, toes, hinge }
    }

    /// Axis about which the knee bends: across the plane of the leg, unless it is nearly straight or bent the wrong way.
    pub fn hinge(&self, pose: &WorldPose, [thigh, shin]: [DVec3; 2]) -> DVec3 {
        let at_rest = pose.rotation(self.hip) * self.hinge;
        let bend = thigh.normalize_or_zero().cross(shin.normalize_or_zero());
        let across = bend - bend.dot(at_rest).min(0.0) * at_rest;
        (across + MIN_BEND * at_rest).normalize_or(at_rest)
    }
}

/// How far the hips must come down for the leg to reach its ankle's position moved by `by`.
pub fn drop_to_reach(leg: &Leg, pose: &WorldPose, by: DVec3) -> f64 {
    let [hip, knee, ankle] = [leg.hip, leg.knee, leg.ankle].map(|joint| pose.position(joint));
    let reach = max_reach([knee - hip, ankle - knee]);
    let goal = ankle + by - hip;
    if by.length() <= 1e-9 || goal.length() <= reach {
        return 0.0;
    }
    // The nearer solution of |goal + drop · Y| = reach; if the goal is out of reach at any height, the hips come down to it.
    let horizontal = goal.x * goal.x + goal.z * goal.z;
    let rise = (reach * reach - horizontal).max(0.0).sqrt();
    (-goal.y - rise).max(0.0)
}

/// Turns that move the ankle by `by` while the hips come down by `drop`, or as near as the leg reaches.
pub fn solve_leg(leg: &Leg, pose: &WorldPose, by: DVec3, drop: f64) -> LegTurns {
    let unmoved = LegTurns { thigh: DQuat::IDENTITY, shin: DQuat::IDENTITY };
    let [hip, knee, ankle] = [leg.hip, leg.knee, leg.ankle].map(|joint| pose.position(joint));
    let (thigh, shin) = (knee - hip, ankle - knee);
    let length = thigh.length() + shin.length();
    let by = by + DVec3::Y * drop;
    let goal = ankle + by - hip;
    if by.length() <= 1e-6 * length {
        return unmoved;
    }
    let hinge = leg.hinge(pose, [thigh, shin]);
    let certainty = smooth(by.length() / (SMALL_MOVE * length));
    let distance = goal.length().min(max_reach([thigh, shin]));
    let Some([swing, knee_turn]) = reach_goal([thigh, shin], hinge, goal, distance, certainty) else { return unmoved };
    LegTurns { thigh: swing, shin: unit(swing * knee_turn) }
}
