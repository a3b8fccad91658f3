//! The joints that a pin turns, and by how much. All in model space and double precision.

use gaitway_character::anim::{JointIndex, Pose, Skeleton};
use gaitway_character::asset::Slot;
use glam::{DAffine3, DQuat, DVec3, Vec3};

use super::Pinning;
use crate::math::{limited, smooth, unit};
use crate::pose::{Local, is_within, parent_frame};
use crate::two_bones::reach_goal;

/// Sine of the bend below which a limb has no plane of its own: it bends about its hinge at rest.
const MIN_BEND: f64 = 0.17;

/// A nearly straight limb keeps its plane unless its end moves by more than this share of its length.
const SMALL_MOVE: f64 = 0.02;

/// `model_from_parent` of a joint.
pub fn parent_of(skeleton: &Skeleton, pose: &Pose, joint: JointIndex) -> DAffine3 {
    parent_frame(skeleton, joint, DQuat::IDENTITY, |ancestor| Local::from(&pose.local(ancestor)))
}

/// `model_from_joint` of a joint.
pub fn frame_of(skeleton: &Skeleton, pose: &Pose, joint: JointIndex) -> DAffine3 {
    parent_of(skeleton, pose, joint) * Local::from(&pose.local(joint)).to_affine()
}

/// Turns a joint by a rotation in model space. Its parent may be scaled and mirrored: the axis of a turn is a pseudovector.
pub fn turn_joint(joint: JointIndex, model_from_parent: DAffine3, turn: DQuat, pose: &mut Pose) {
    let matrix = model_from_parent.matrix3;
    let axis = matrix.inverse() * turn.xyz() * matrix.determinant().cbrt();
    let turn = unit(DQuat::from_vec4(axis.extend(turn.w)));
    let rotation = turn * pose.local(joint).rotation.as_dquat();
    pose.set_rotation(joint, rotation.as_quat());
}

impl Pinning<'_> {
    /// The joints of two bones that end at a joint: an arm or a leg, otherwise its two nearest ancestors. A hand or foot may be
    /// [detached](Self::is_detached).
    pub(super) fn limb(&self, end: JointIndex) -> Option<[JointIndex; 3]> {
        let skeleton = &self.asset.skeleton;
        let slots = match self.body.slot(end) {
            Some(Slot::LeftHand) => Some([Slot::LeftUpperArm, Slot::LeftLowerArm]),
            Some(Slot::RightHand) => Some([Slot::RightUpperArm, Slot::RightLowerArm]),
            Some(Slot::LeftFoot) => Some([Slot::LeftUpperLeg, Slot::LeftLowerLeg]),
            Some(Slot::RightFoot) => Some([Slot::RightUpperLeg, Slot::RightLowerLeg]),
            _ => None,
        };
        let of_body = || {
            let [upper, lower] = slots?.map(|slot| self.body.joint(slot));
            let (upper, lower) = (upper?, lower?);
            let is_above = |joint, other| joint != other && is_within(skeleton, other, joint);
            let ends_there =
                is_above(lower, end) || (self.is_detached([upper, lower, end]) && !is_within(skeleton, upper, end));
            (is_above(upper, lower) && ends_there).then_some([upper, lower, end])
        };
        of_body().or_else(|| {
            let lower = skeleton.parent(end)?;
            Some([skeleton.parent(lower)?, lower, end])
        })
    }

    /// Whether the end of a limb hangs beside its bones, not below them, as in rigs with controls for inverse kinematics: it has to
    /// be moved, too.
    pub(super) fn is_detached(&self, [upper, _, end]: [JointIndex; 3]) -> bool {
        !is_within(&self.asset.skeleton, end, upper)
    }

    /// Where the end of a limb comes to lie when both of its bones are turned as [`reach`](Self::reach) says.
    pub(super) fn turned_end(&self, limb: [JointIndex; 3], [swing, bend]: [DQuat; 2], pose: &Pose) -> DVec3 {
        let [start, middle, end] = limb.map(|joint| frame_of(&self.asset.skeleton, pose, joint).translation);
        start + swing * (middle - start) + swing * bend * (end - middle)
    }

    /// Turns of the upper bone, and of the lower one relative to it, that bring the end of a limb to a goal, or as near as it
    /// reaches.
    pub(super) fn reach(&self, limb: [JointIndex; 3], goal: DVec3, pose: &Pose) -> Option<[DQuat; 2]> {
        let [start, middle, end] = limb.map(|joint| frame_of(&self.asset.skeleton, pose, joint).translation);
        let (upper, lower, goal) = (middle - start, end - middle, goal - start);
        let (along, onwards) = (upper.try_normalize()?, lower.try_normalize()?);
        let (reach, shortest) = (upper.length() + lower.length(), (upper.length() - lower.length()).abs());
        let moved = (upper + lower).distance(goal) / reach;
        let hinge = self.hinge(limb, along, onwards, moved, pose);
        // From a straight limb, which has no side, any distance is reached exactly.
        let straighten = DQuat::from_rotation_arc(onwards, along);
        let bones = [upper, lower.length() * along];
        let [swing, bend] = reach_goal(bones, hinge, goal, limited(goal.length(), shortest, reach), 1.0)?;
        Some([swing, bend * straighten])
    }

    /// Axis about which a limb bends: across its own plane, turned round if it is bent backwards. A straight limb bends as it
    /// does at rest. `moved`: how far its end moves, as a share of its length.
    fn hinge(&self, limb: [JointIndex; 3], along: DVec3, onwards: DVec3, moved: f64, pose: &Pose) -> DVec3 {
        let skeleton = &self.asset.skeleton;
        let now_from_rest =
            frame_of(skeleton, pose, limb[0]).matrix3 * frame_of(skeleton, skeleton.rest(), limb[0]).matrix3.inverse();
        let at_rest = now_from_rest * self.hinge_at_rest(limb);
        let at_rest = at_rest.reject_from_normalized(along).normalize_or(along.any_orthonormal_vector());
        let bend = along.cross(onwards);
        let forwards = bend - 2.0 * bend.dot(at_rest).min(0.0) * at_rest;
        let doubt = (MIN_BEND - bend.length()).max(0.0) * smooth(moved / SMALL_MOVE);
        (forwards + doubt * at_rest).normalize_or(at_rest)
    }

    /// In model space. Arms that are straight at rest bend forwards, legs backwards.
    fn hinge_at_rest(&self, limb: [JointIndex; 3]) -> DVec3 {
        let skeleton = &self.asset.skeleton;
        let [start, middle, end] = limb.map(|joint| frame_of(skeleton, skeleton.rest(), joint).translation);
        let along = (middle - start).normalize_or_zero();
        let bend = along.cross((end - middle).normalize_or_zero());
        let towards = match self.body.slot(limb[2]) {
            Some(Slot::LeftHand | Slot::RightHand) => self.forward(),
            Some(Slot::LeftFoot | Slot::RightFoot) => -self.forward(),
            _ => DVec3::ZERO,
        };
        let axis =
            if bend.length() > MIN_BEND { bend } else { bend + MIN_BEND * along.cross(towards).normalize_or_zero() };
        axis.try_normalize()
            .unwrap_or_else(|| along.try_normalize().map_or(DVec3::X, |along| along.any_orthonormal_vector()))
    }

    /// Where the body faces at rest.
    fn forward(&self) -> DVec3 {
        self.body.facing.forward.unwrap_or(Vec3::Z).as_dvec3()
    }

    /// Turn of a joint with which it looks at a goal.
    pub(super) fn gaze(&self, joint: JointIndex, goal: DVec3, pose: &Pose) -> Option<DQuat> {
        let frame = frame_of(&self.asset.skeleton, pose, joint);
        let [eyes, ahead] = self.sight(joint).map(|vector| frame.transform_vector3(vector));
        let (goal, ahead) = (goal - frame.translation, ahead.try_normalize()?);
        // Turns the point on the line of sight that is as far from the joint as the goal.
        let nearest = eyes.dot(ahead);
        let distance = (nearest * nearest - eyes.length_squared() + goal.length_squared()).max(0.0).sqrt() - nearest;
        let aim = (eyes + distance.max(0.0) * ahead).try_normalize()?;
        Some(DQuat::from_rotation_arc(aim, goal.try_normalize()?))
    }

    /// The point between a head's eyes, in its own space, and its line of sight. Other joints look along the way that the body
    /// faces at rest.
    fn sight(&self, joint: JointIndex) -> [DVec3; 2] {
        let skeleton = &self.asset.skeleton;
        let joint_from_model = frame_of(skeleton, skeleton.rest(), joint).inverse();
        let of_avatar = self.asset.avatar.look_at.filter(|look_at| look_at.head == joint);
        let eyes = [Slot::LeftEye, Slot::RightEye].map(|slot| self.body.joint(slot));
        let eyes = match (of_avatar, eyes) {
            (Some(look_at), _) => look_at.offset.as_dvec3(),
            (None, [Some(left), Some(right)])
                if is_within(skeleton, left, joint) && is_within(skeleton, right, joint) =>
            {
                let [left, right] = [left, right].map(|eye| frame_of(skeleton, skeleton.rest(), eye).translation);
                joint_from_model.transform_point3(0.5 * (left + right))
            }
            _ => DVec3::ZERO,
        };
        [eyes, joint_from_model.transform_vector3(self.forward())]
    }
}
