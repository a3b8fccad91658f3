//! How close a model's joints stay to the poses that keys are made from.

use gaitway_character::anim::{JointIndex, Skeleton};
use glam::{DQuat, DVec3};

use crate::math::angle_between;
use crate::pose::{WorldPose, node_locals};

/// Largest error of a rotation, in radians.
pub const MAX_TURN: f64 = 0.05 * std::f64::consts::PI / 180.0;
/// Largest error of a position, per metre of height.
pub const MAX_OFFSET_PER_METRE: f64 = 1e-4;
/// Shares of these errors: for the times between two samples, and for the samples between two keys. They add up to a little less
/// than 1, since only some times are checked.
pub const BETWEEN_SAMPLES: f64 = 0.25;
pub const BETWEEN_KEYS: f64 = 0.7;
/// Error of a position that was interpolated between `f32` values, as a share of its distance from the origin.
pub const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;

/// Returns the height that errors are measured by. If all joints are in one point, a metre stands in for it: no key would be close
/// enough.
pub fn height_or_metre(height: f64) -> f64 {
    if height > 1e-6 && height.is_finite() { height } else { 1.0 }
}

/// The largest errors allowed for joints.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    offset: f64,
}

impl Limits {
    /// The height is the largest extent of the joints at rest: animals may be longer than tall.
    pub fn new(skeleton: &Skeleton) -> Self {
        let positions = WorldPose::new(skeleton, node_locals(skeleton), DQuat::IDENTITY).positions;
        let least = positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let extent = positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max) - least;
        Self { offset: MAX_OFFSET_PER_METRE * height_or_metre(extent.max_element()) }
    }

    /// Returns the largest error of a position this far from the origin, in its unit. No keys bring it closer than `f32` allows.
    pub fn offset(&self, distance: f64) -> f64 {
        self.offset.max(ROUNDING * distance)
    }

    /// Returns a joint's error as a share of its limit: of position or rotation, whichever is larger.
    pub fn share(&self, expected: &WorldPose, found: &WorldPose, joint: JointIndex) -> f64 {
        let at = expected.position(joint);
        let offset = at.distance(found.position(joint)) / self.offset(at.length());
        offset.max(angle_between(expected.rotation(joint), found.rotation(joint)) / MAX_TURN)
    }
}
