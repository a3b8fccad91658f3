//! Rotations, directions and ranges in double precision.

use glam::{DQuat, DVec3};

/// Keeps the horizontal components of a vector and drops the vertical one.
pub const HORIZONTAL: DVec3 = DVec3::new(1.0, 0.0, 1.0);

/// Normalizes a rotation; the identity if it has no usable length.
pub fn unit(rotation: DQuat) -> DQuat {
    let length = rotation.length();
    if length.is_finite() && length > 0.0 { rotation / length } else { DQuat::IDENTITY }
}

/// Clamps a number to a range; the default if it isn't finite.
pub fn clamped(value: f64, default: f64, min: f64, max: f64) -> f64 {
    if value.is_finite() { value.clamp(min, max) } else { default }
}

/// Limits a number to a range. Unlike `clamp`, never panics: far from the origin, where numbers overflow, the range may be empty or
/// not a number.
pub fn limited(value: f64, min: f64, max: f64) -> f64 {
    value.max(min).min(max)
}

/// Interpolates along the shorter arc at constant speed (glTF 2.0, appendix C.3).
pub fn slerp(from: DQuat, to: DQuat, factor: f64) -> DQuat {
    let cos = from.dot(to);
    let to = if cos < 0.0 { -to } else { to };
    let angle = cos.abs().min(1.0).acos();
    if angle < 1e-9 {
        return unit(from + (to - from) * factor);
    }
    unit(from * ((1.0 - factor) * angle).sin() + to * (factor * angle).sin())
}

/// Angle of the rotation between two orientations, in radians. More accurate near zero than an arc cosine.
pub fn angle_between(from: DQuat, to: DQuat) -> f64 {
    let turn = from.conjugate() * to;
    2.0 * turn.xyz().length().atan2(turn.w.abs())
}

pub fn degrees_between(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

/// The rotation's twist about +Y, in radians from −π to π.
pub fn yaw_of(rotation: DQuat) -> f64 {
    let side = if rotation.w < 0.0 { -1.0 } else { 1.0 };
    2.0 * (side * rotation.y).atan2(side * rotation.w)
}

/// From 0 to 1, flat at both ends.
pub fn smooth(share: f64) -> f64 {
    let share = share.clamp(0.0, 1.0);
    share * share * (3.0 - 2.0 * share)
}
