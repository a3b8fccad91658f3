//! Inverse kinematics of two bones by the law of cosines: the joint between them bends, then both swing as one.

use glam::{DQuat, DVec3};

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
