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

/// Returns the head joint of the bone nearest to a point of the viewport, x and y from −1 (left, bottom) to 1.
/// `tolerance` is the maximum distance in the units of y. Hidden bones count too.
pub fn pick_joint(frame: &Frame, point: Vec2, tolerance: f32) -> Option<PickedJoint> {
    let projection = frame.view.projection_from_view;
    let projection_from_world = projection * frame.view.view_from_world;
    let stretch = Vec2::new((projection.y_axis.y / projection.x_axis.x).abs(), 1.0);
    let project = |point: Vec3| {
        let at = projection_from_world * point.extend(1.0);
        (at.w > 0.0).then(|| at.xy() / at.w * stretch)
    };
    let point = point * stretch;
    let mut nearest: Option<(f32, PickedJoint)> = None;
    for bone in &frame.bones {
        let (Some(head), Some(tail)) = (project(bone.head), project(bone.tail)) else { continue };
        let along = tail - head;
        let share = ((point - head).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
        // Where bones meet in a joint, the tiny bias prefers the one whose head it is.
        let distance = point.distance(head + share * along) + 1e-5 * share;
        if distance <= tolerance && nearest.is_none_or(|(best, _)| distance < best) {
            let joint = bone.joint as usize;
            let picked = if bone.of_source { PickedJoint::Source(joint) } else { PickedJoint::Model(joint) };
            nearest = Some((distance, picked));
        }
    }
    nearest.map(|(_, joint)| joint)
}
