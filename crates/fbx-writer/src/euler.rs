//! Euler angles: XYZ, as FBX means it (about X first), continuous over time.

use glam::{DQuat, DVec3};

/// Beyond this sine of Y, X and Z turn about the same axis.
const LOCKED: f64 = 1.0 - 1e-12;
const TURN: f64 = std::f64::consts::TAU;
const HALF_TURN: f64 = std::f64::consts::PI;

/// Returns the rotation about X, then Y, then Z, by angles in radians.
pub fn quaternion(angles: DVec3) -> DQuat {
    let half = |angle: f64| {
        let (sin, cos) = libm::sincos(0.5 * angle);
        [sin, cos]
    };
    let [[sx, cx], [sy, cy], [sz, cz]] = [half(angles.x), half(angles.y), half(angles.z)];
    DQuat::from_xyzw(
        sx * cy * cz - cx * sy * sz,
        cx * sy * cz + sx * cy * sz,
        cx * cy * sz - sx * sy * cz,
        cx * cy * cz + sx * sy * sz,
    )
}

/// Returns the angles of a unit quaternion that are nearest to others, so that a motion's angles don't jump.
pub fn nearest(q: DQuat, to: DVec3) -> DVec3 {
    let sine = (2.0 * (q.w * q.y - q.z * q.x)).clamp(-1.0, 1.0);
    if sine.abs() > LOCKED {
        // Only the sum or the difference of X and Z counts: X stays.
        let y = HALF_TURN / 2.0 * sine.signum();
        let both = 2.0 * libm::atan2(q.x, q.w) * sine.signum();
        let z = if sine > 0.0 { to.x - both } else { -to.x - both };
        // Y may be near a full turn from there.
        return near(DVec3::new(to.x, y, z), to);
    }
    let x = libm::atan2(2.0 * (q.w * q.x + q.y * q.z), 1.0 - 2.0 * (q.x * q.x + q.y * q.y));
    let z = libm::atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z));
    let y = libm::asin(sine);
    let one = near(DVec3::new(x, y, z), to);
    let other = near(DVec3::new(x + HALF_TURN, HALF_TURN - y, z + HALF_TURN), to);
    if (one - to).length_squared() <= (other - to).length_squared() { one } else { other }
}

/// Moves angles by whole turns towards others.
fn near(angles: DVec3, to: DVec3) -> DVec3 {
    let turns = (to - angles) / TURN;
    angles + TURN * DVec3::new(libm::round(turns.x), libm::round(turns.y), libm::round(turns.z))
}

/// Returns the angle between two rotations, in radians, if it is small.
pub fn difference(a: DQuat, b: DQuat) -> f64 {
    let b = if a.dot(b) < 0.0 { -b } else { b };
    2.0 * (a - b).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_give_back_the_rotation_near_any_others() {
        let values = [-3.1, -1.6, -HALF_TURN / 2.0, -0.4, 0.0, 0.7, HALF_TURN / 2.0, 1.5, 2.9];
        let all = values.iter().flat_map(|&x| values.iter().map(move |&y| (x, y)));
        for (x, y) in all {
            values.iter().for_each(|&z| check_angles(DVec3::new(x, y, z)));
        }
    }

    fn check_angles(angles: DVec3) {
        let DVec3 { x, y, z } = angles;
        let q = quaternion(angles);
        let expected = DQuat::from_rotation_z(z) * DQuat::from_rotation_y(y) * DQuat::from_rotation_x(x);
        assert!(difference(q, expected) < 1e-12);
        for to in [DVec3::ZERO, angles, DVec3::new(9.0, -4.0, 1.0)] {
            let found = nearest(q, to);
            assert!(difference(quaternion(found), q) < 1e-5, "{angles} near {to}: {found}");
        }
        // Away from the poles there is a single one that near.
        if y.abs() != HALF_TURN / 2.0 {
            assert!((nearest(q, angles + 0.01) - angles).length() < 1e-6, "{angles}");
        }
    }

    #[test]
    fn a_turn_through_the_pole_does_not_jump() {
        let mut last = DVec3::new(0.3, 0.0, 0.2);
        for step in 0..=360 {
            let y = f64::from(step).to_radians();
            let found = nearest(quaternion(DVec3::new(0.3, y, 0.2)), last);
            assert!((found - last).length() < 0.02, "{step}: {last} {found}");
            last = found;
        }
        assert!((last.y - TURN).abs() < 1e-6);
    }
}
