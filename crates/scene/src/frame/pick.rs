//! Picks joints in the viewport.

use glam::{Vec2, Vec3, Vec4Swizzles};

use super::Frame;

/// A picked joint, by its file's number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PickedJoint {
    /// In the model's own file.
    Model(usize),
    /// In the file that the clip is borrowed from.
    Source(usize),
}

/// A ball smaller than this share of the tolerance is hit as if it were as large.
const MIN_BALL: f32 = 0.5;

/// A ball is at most this share of its bone, so that the middle of a short one still belongs to it.
const MAX_BALL: f32 = 0.3;

/// Returns the joint whose ball is at a point of the viewport, otherwise the head joint of the nearest bone. x and y are from −1
/// (left, bottom) to 1; `tolerance` is the maximum distance in the units of y. Hidden bones count too.
pub fn pick_joint(frame: &Frame, point: Vec2, tolerance: f32) -> Option<PickedJoint> {
    let projection = frame.view.projection_from_view;
    let projection_from_world = projection * frame.view.view_from_world;
    let stretch = Vec2::new((projection.y_axis.y / projection.x_axis.x).abs(), 1.0);
    let project = |point: Vec3| {
        let at = projection_from_world * point.extend(1.0);
        (at.w > 0.0).then(|| (at.xy() / at.w * stretch, at.w))
    };
    let point = point * stretch;
    let mut nearest: Option<(f32, PickedJoint)> = None;
    for bone in &frame.bones {
        let (Some((head, depth)), Some((tail, _))) = (project(bone.head), project(bone.tail)) else { continue };
        let along = tail - head;
        let share = ((point - head).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
        let projected = |metres: f32| (projection.y_axis.y / depth).abs() * metres;
        let ball = projected(bone.radius).max(MIN_BALL * tolerance);
        let ball = ball.min(MAX_BALL * projected(bone.head.distance(bone.tail)));
        // Bones of the parent and of children meet in a ball, which is the joint's. The tiny bias prefers it for the rest, too.
        let from_head = point.distance(head);
        let to_bone = point.distance(head + share * along) + 1e-5 * share;
        let distance = if from_head < ball { from_head - ball } else { to_bone };
        if distance <= tolerance && nearest.is_none_or(|(best, _)| distance < best) {
            let joint = bone.joint as usize;
            let picked = if bone.of_source { PickedJoint::Source(joint) } else { PickedJoint::Model(joint) };
            nearest = Some((distance, picked));
        }
    }
    nearest.map(|(_, joint)| joint)
}
