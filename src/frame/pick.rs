//! Which joint a click means.

use glam::{Vec2, Vec3, Vec4Swizzles};

use super::Frame;

/// A joint of the picture, as its file numbers it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PickedJoint {
    Model(usize),
    /// Of the file that the clip is borrowed from.
    Source(usize),
}

/// The joint (as the file numbers it) of the bone nearest to a point of the picture, x and y from −1 (left, bottom) to 1.
/// `tolerance` is the furthest a bone may be away, in the same units up and down. Bones count whether they are drawn or not.
pub fn pick_joint(frame: &Frame, point: Vec2, tolerance: f32) -> Option<PickedJoint> {
    let projection = frame.view.projection_from_view;
    let projection_from_world = projection * frame.view.view_from_world;
    let stretch = Vec2::new((projection.y_axis.y / projection.x_axis.x).abs(), 1.0);
    let on_picture = |point: Vec3| {
        let at = projection_from_world * point.extend(1.0);
        (at.w > 0.0).then(|| at.xy() / at.w * stretch)
    };
    let point = point * stretch;
    let mut nearest: Option<(f32, PickedJoint)> = None;
    for bone in &frame.bones {
        let (Some(head), Some(tail)) = (on_picture(bone.head), on_picture(bone.tail)) else { continue };
        let along = tail - head;
        let part = ((point - head).dot(along) / along.length_squared().max(1e-12)).clamp(0.0, 1.0);
        // Of bones that meet in a joint the one whose head it is is nearer by a hair.
        let distance = point.distance(head + part * along) + 1e-5 * part;
        if distance <= tolerance && nearest.is_none_or(|(best, _)| distance < best) {
            let joint = bone.joint as usize;
            let picked = if bone.of_source { PickedJoint::Source(joint) } else { PickedJoint::Model(joint) };
            nearest = Some((distance, picked));
        }
    }
    nearest.map(|(_, joint)| joint)
}
