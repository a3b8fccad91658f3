//! An arm as two bones: the wrist moves, the elbow stays in the arm's plane, and the hand keeps its direction.

use gaitway_character::anim::JointIndex;
use glam::{DQuat, DVec3};

use crate::math::{smooth, unit};
use crate::pose::WorldPose;
use crate::two_bones::{max_reach, reach_goal};

/// An elbow that is bent by less than about this sine is held by its hinge at rest, too.
const CLEAR_BEND: f64 = 0.35;

/// How far forwards a straight arm bends at rest.
const REST_BEND: f64 = 0.17;

/// The target joints of one arm.
#[derive(Debug, Clone, Copy)]
pub struct Arm {
    /// Shoulder, elbow and wrist.
    pub joints: [JointIndex; 3],
    /// Axis about which the elbow bends at rest, in the frame of the shoulder.
    hinge: DVec3,
}

impl Arm {
    /// `rest` faces +Z.
    pub fn new(joints: [JointIndex; 3], rest: &WorldPose) -> Self {
        let [shoulder, elbow, wrist] = joints.map(|joint| rest.position(joint));
        let [upper, lower] = [elbow - shoulder, wrist - elbow].map(DVec3::normalize_or_zero);
        let axis = upper.cross(lower) + REST_BEND * upper.cross(DVec3::Z);
        Self { joints, hinge: rest.rotation(joints[0]).conjugate() * axis.normalize_or(DVec3::Y) }
    }

    /// Returns how upper arm and forearm turn in the common frame to move the wrist by `by`, or as near as the arm reaches.
    pub fn reach(&self, pose: &WorldPose, by: DVec3) -> [DQuat; 2] {
        let [shoulder, elbow, wrist] = self.joints.map(|joint| pose.position(joint));
        let (upper, lower) = (elbow - shoulder, wrist - elbow);
        let length = upper.length() + lower.length();
        if by.length() <= 1e-6 * length {
            return [DQuat::IDENTITY; 2];
        }
        // Captured arms twist where they like, so that their elbows bend about any axis.
        let bend = upper.normalize_or_zero().cross(lower.normalize_or_zero());
        let at_rest = pose.rotation(self.joints[0]) * self.hinge;
        let share = smooth(bend.length() / CLEAR_BEND);
        let hinge = (share * bend.normalize_or_zero() + (1.0 - share) * at_rest).normalize_or(at_rest);
        let goal = wrist + by - shoulder;
        match reach_goal([upper, lower], hinge, goal, goal.length().min(max_reach([upper, lower])), 0.0) {
            Some([swing, bend]) => [swing, unit(swing * bend)],
            None => [DQuat::IDENTITY; 2],
        }
    }
}
