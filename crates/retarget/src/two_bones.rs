//! Inverse kinematics of two bones by the law of cosines: the joint between them bends, then both swing as one. Shared by legs, arms
//! and pins.

use gaitway_character::anim::{JointIndex, Skeleton};
use glam::{DQuat, DVec3};

use super::math::{limited, unit};
use super::pose::{WorldPose, is_within};

/// A limb is never stretched beyond this share of its length: a straight one has no plane.
const MAX_REACH: f64 = 0.999;

/// Beyond this share, a limb is stretched only as far as it already is: in a nearly straight one, millimetres of its end's position
/// turn the joint between by degrees.
const COMFORTABLE_REACH: f64 = 0.99;

/// How far a limb of two bones, vectors from joint to joint, may reach.
pub fn max_reach([upper, lower]: [DVec3; 2]) -> f64 {
    let length = upper.length() + lower.length();
    limited((upper + lower).length(), COMFORTABLE_REACH * length, MAX_REACH * length)
}

/// Returns two turns that bring the end of two bones, vectors from joint to joint, towards `goal`, to `distance` from their
/// start: of the first bone, and of the second relative to the first. The second bends about the unit vector `hinge`. If it is
/// bent the wrong way, it is turned round in proportion to `certainty`. `None` if the bones or the goal have no direction.
pub fn reach_goal(
    [upper, lower]: [DVec3; 2],
    hinge: DVec3,
    goal: DVec3,
    distance: f64,
    certainty: f64,
) -> Option<[DQuat; 2]> {
    let bend = DQuat::from_axis_angle(hinge, further_bend(upper, lower, hinge, distance, certainty));
    let line = (upper + bend * lower).try_normalize()?;
    Some([DQuat::from_rotation_arc(line, goal.try_normalize()?), bend])
}

/// By how much the second bone bends further about the hinge for its end to be at a distance from the start of the first.
fn further_bend(upper: DVec3, lower: DVec3, hinge: DVec3, distance: f64, certainty: f64) -> f64 {
    let along = (upper + lower).dot(hinge);
    let (upper, lower) = (upper.reject_from_normalized(hinge), lower.reject_from_normalized(hinge));
    let product = upper.length() * lower.length();
    if product <= 0.0 {
        return 0.0;
    }
    let squares = upper.length_squared() + lower.length_squared();
    let wanted = ((distance * distance - along * along - squares) / (2.0 * product)).clamp(-1.0, 1.0).acos();
    let bent = hinge.dot(upper.cross(lower)).atan2(upper.dot(lower));
    wanted - bent + 2.0 * (1.0 - certainty) * bent.min(0.0)
}

/// Local rotations of a limb's three joints, such as hip, knee and ankle, that turn its bones in each pose while its end keeps its
/// direction. The turns of the upper and lower bones are in the common frame.
pub fn limb_rotations(
    skeleton: &Skeleton,
    [root, middle, end]: [JointIndex; 3],
    poses: &[WorldPose],
    [uppers, lowers]: [&[DQuat]; 2],
) -> [(JointIndex, Vec<DQuat>); 3] {
    // A foot that is not parented to its shin does not turn with it, nor does such a shin with its thigh.
    let middle_is_carried = is_within(skeleton, middle, root);
    let end_is_carried = is_within(skeleton, end, middle);
    let mut rotations = [root, middle, end].map(|joint| (joint, Vec::with_capacity(poses.len())));
    for ((pose, &upper), &lower) in poses.iter().zip(uppers).zip(lowers) {
        let parent_turns = [
            DQuat::IDENTITY,
            if middle_is_carried { upper } else { DQuat::IDENTITY },
            if end_is_carried { lower } else { DQuat::IDENTITY },
        ];
        let own_turns = [upper, lower, DQuat::IDENTITY];
        for (((joint, rotations), parent_turn), own_turn) in rotations.iter_mut().zip(parent_turns).zip(own_turns) {
            let parent = pose.parent_rotation(skeleton, *joint);
            rotations.push(unit((parent_turn * parent).conjugate() * own_turn * pose.rotation(*joint)));
        }
    }
    rotations
}
