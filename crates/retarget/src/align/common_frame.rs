//! The frame that both skeletons are turned into: +Y up, facing +Z.

use gaitway_character::asset::{Humanoid, Slot};
use glam::{DQuat, DVec3};

use crate::math::unit;
use crate::pose::WorldPose;

/// A body that faces within this angle of an axis is taken to face along it: no rig is exactly symmetric.
const SNAP_DEGREES: f64 = 2.0;

/// Returns the rotation from a body's model space to the common frame: the axis nearest to the spine becomes +Y and the
/// body faces +Z. None without hips, head and two sides.
pub fn common_from_model(rest: &WorldPose, slots: &Humanoid) -> Option<DQuat> {
    let Front { upright, yaw_degrees: yaw } = front(rest, slots)?;
    let quarter = nearest_quarter(yaw);
    let yaw = if (yaw - quarter).abs() < SNAP_DEGREES { quarter } else { yaw };
    Some(unit(DQuat::from_rotation_y(-yaw.to_radians()) * upright))
}

/// How a body stands in its model space.
#[derive(Debug, Clone, Copy)]
pub struct Front {
    /// Turns the axis nearest to the spine onto +Y.
    pub upright: DQuat,
    /// The angle about that axis from +Z to where the body faces.
    pub yaw_degrees: f64,
}

/// None without hips, head and two sides.
pub fn front(rest: &WorldPose, slots: &Humanoid) -> Option<Front> {
    let at = |slot| slots.joint(slot).map(|joint| rest.position(joint));
    let up = at(Slot::Head)? - at(Slot::Hips)?;
    let upright = nearest_axis_to_y(up);
    let at = |slot| at(slot).map(|position| upright * position);
    let between = |from, to| Some(at(from)? - at(to)?);
    let sides = [
        between(Slot::LeftUpperLeg, Slot::RightUpperLeg),
        between(Slot::LeftUpperArm, Slot::RightUpperArm),
        between(Slot::LeftFoot, Slot::RightFoot),
    ];
    let left: DVec3 = sides.into_iter().flatten().map(DVec3::normalize_or_zero).sum();
    let mut forward = left.cross(DVec3::Y).try_normalize()?;
    let toes = [between(Slot::LeftToes, Slot::LeftFoot), between(Slot::RightToes, Slot::RightFoot)];
    let pointed: DVec3 = toes.into_iter().flatten().map(DVec3::normalize_or_zero).sum();
    // Names win over geometry in the map, but a body with swapped names still walks the way its toes point.
    if pointed.dot(forward) < -0.5 {
        forward = -forward;
    }
    Some(Front { upright, yaw_degrees: forward.x.atan2(forward.z).to_degrees() })
}

/// The multiple of 90 that is nearest to an angle in degrees.
pub fn nearest_quarter(degrees: f64) -> f64 {
    (degrees / 90.0).round() * 90.0
}

/// Turns the coordinate axis nearest to a direction onto +Y.
fn nearest_axis_to_y(up: DVec3) -> DQuat {
    let nearest = nearest_axis(up);
    if nearest == DVec3::Y { DQuat::IDENTITY } else { DQuat::from_rotation_arc(nearest, DVec3::Y) }
}

/// The coordinate axis nearest to a direction, of two equally near ones the first as here: up is usually +Y, else +Z.
pub fn nearest_axis(up: DVec3) -> DVec3 {
    let axes = [DVec3::Y, DVec3::Z, DVec3::X, -DVec3::Y, -DVec3::Z, -DVec3::X];
    let mut nearest = DVec3::Y;
    for axis in axes {
        if up.dot(axis) > up.dot(nearest) + 1e-6 * up.length() {
            nearest = axis;
        }
    }
    nearest
}
