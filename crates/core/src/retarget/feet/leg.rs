//! Two-bone inverse kinematics for a leg, by the law of cosines: the knee keeps its plane and the foot its direction.

use glam::{DMat3, DQuat, DVec3};

use crate::anim::{JointIndex, Skeleton};
use crate::retarget::math::unit;
use crate::retarget::pose::WorldPose;

/// A leg is never stretched beyond this share of its length: a straight knee has no plane.
const MAX_REACH: f64 = 0.999;

/// Beyond this share, a leg is stretched only as far as it is without planting: in a nearly straight leg, millimetres of the
/// foot's position turn the knee by degrees.
const COMFORTABLE_REACH: f64 = 0.99;

/// The target joints of one leg.
#[derive(Debug, Clone, Copy)]
pub struct Leg {
    pub hip: JointIndex,
    pub knee: JointIndex,
    pub ankle: JointIndex,
    /// What stays in place: the toes, or the ankle itself.
    pub toes: JointIndex,
}

/// How far the hips must come down for the leg to reach its ankle's position moved by `by`.
pub fn drop_to_reach(leg: &Leg, pose: &WorldPose, by: DVec3) -> f64 {
    let [hip, knee, ankle] = [leg.hip, leg.knee, leg.ankle].map(|joint| pose.position(joint));
    let length = (knee - hip).length() + (ankle - knee).length();
    let reach = (ankle - hip).length().clamp(COMFORTABLE_REACH * length, MAX_REACH * length);
    let goal = ankle + by - hip;
    if by.length() <= 1e-9 || goal.length() <= reach {
        return 0.0;
    }
    // The nearer solution of |goal + drop · Y| = reach; if the goal is out of reach at any height, the hips come down to it.
    let horizontal = goal.x * goal.x + goal.z * goal.z;
    let rise = (reach * reach - horizontal).max(0.0).sqrt();
    (-goal.y - rise).max(0.0)
}

/// Returns the local rotations of hip, knee and ankle that move the ankle by `by` while the hips come down by `drop`.
pub fn solve_leg(leg: &Leg, skeleton: &Skeleton, pose: &WorldPose, by: DVec3, drop: f64) -> [DQuat; 3] {
    let goal = pose.position(leg.ankle) + by + DVec3::Y * drop;
    let (thigh_turn, shin_turn) = segment_turns(leg, pose, goal).unwrap_or((DQuat::IDENTITY, DQuat::IDENTITY));
    let local = |joint: JointIndex, parent_turn: DQuat, own_turn: DQuat| {
        let parent = pose.parent_rotation(skeleton, joint);
        unit((parent_turn * parent).conjugate() * own_turn * pose.rotation(joint))
    };
    [
        local(leg.hip, DQuat::IDENTITY, thigh_turn),
        local(leg.knee, thigh_turn, shin_turn),
        local(leg.ankle, shin_turn, DQuat::IDENTITY),
    ]
}

/// World rotations of thigh and shin that bring the ankle to `goal`, or as near as the leg reaches. None if it is there
/// already, or the leg has no plane to bend in.
fn segment_turns(leg: &Leg, pose: &WorldPose, goal: DVec3) -> Option<(DQuat, DQuat)> {
    let [hip, knee, ankle] = [leg.hip, leg.knee, leg.ankle].map(|joint| pose.position(joint));
    let (thigh, shin, line) = (knee - hip, ankle - knee, ankle - hip);
    let (upper, lower) = (thigh.length(), shin.length());
    if (goal - ankle).length() <= 1e-9 || upper <= 0.0 || lower <= 0.0 {
        return None;
    }
    let plane = thigh.cross(line).try_normalize()?;
    let aim = (goal - hip).try_normalize()?;
    let distance = (goal - hip).length().clamp((upper - lower).abs() * 1.001, MAX_REACH * (upper + lower));
    let new_plane = DQuat::from_rotation_arc(line.normalize_or(aim), aim) * plane;
    let cos = (upper * upper + distance * distance - lower * lower) / (2.0 * upper * distance);
    let angle = cos.clamp(-1.0, 1.0).acos();
    let new_thigh = DQuat::from_axis_angle(new_plane, -angle) * aim;
    let new_shin = (distance * aim - upper * new_thigh).normalize_or(aim);
    let thigh_turn = basis_turn([thigh / upper, plane], [new_thigh, new_plane]);
    let shin_turn = basis_turn([shin / lower, plane], [new_shin, new_plane]);
    Some((thigh_turn, shin_turn))
}

/// The rotation that takes one pair of perpendicular unit vectors to another.
fn basis_turn(from: [DVec3; 2], to: [DVec3; 2]) -> DQuat {
    let basis = |[along, across]: [DVec3; 2]| DMat3::from_cols(along, across, along.cross(across));
    unit(DQuat::from_mat3(&(basis(to) * basis(from).transpose())))
}
