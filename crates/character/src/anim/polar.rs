//! Extracts the rotation from a matrix that may be scaled, sheared or mirrored.

use glam::{DMat3, DQuat, DVec3};

/// Returns the rotation nearest to a matrix whose columns have been normalized, by the polar iteration of Higham
/// ("Computing the polar decomposition", 1986). The X axis of a mirrored matrix is flipped first. `None` if the matrix
/// is singular.
pub fn nearest_rotation(matrix: &DMat3) -> Option<DQuat> {
    let mirrored = if matrix.determinant() < 0.0 { -1.0 } else { 1.0 };
    let axis = |axis: DVec3| axis.try_normalize();
    let mut basis = DMat3::from_cols(axis(matrix.x_axis * mirrored)?, axis(matrix.y_axis)?, axis(matrix.z_axis)?);
    if basis.determinant().is_nan() || basis.determinant() < 1e-6 {
        return None;
    }
    for _ in 0..20 {
        let next = (basis + basis.inverse().transpose()) * 0.5;
        if next.abs_diff_eq(basis, 1e-15) {
            break;
        }
        basis = next;
    }
    let rotation = DQuat::from_mat3(&basis);
    rotation.is_finite().then(|| rotation / rotation.length())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned() -> DQuat {
        DQuat::from_axis_angle(DVec3::new(1.0, -2.0, 0.5).normalize(), 0.7)
    }

    #[test]
    fn scale_and_mirroring_leave_the_rotation() {
        for scale in [DVec3::ONE, DVec3::new(0.01, 2.0, 30.0), DVec3::new(-1.0, 1.0, 1.0)] {
            let matrix = DMat3::from_quat(turned()) * DMat3::from_diagonal(scale);
            let found = nearest_rotation(&matrix).unwrap();
            assert!(found.dot(turned()).abs() > 1.0 - 1e-12, "{scale}: {found}");
        }
    }

    /// The columns of a sheared matrix are not perpendicular, so normalizing them is not enough.
    #[test]
    fn shear_is_spread_over_all_axes() {
        let shear = DMat3::from_cols(DVec3::X, DVec3::new(0.6, 0.8, 0.0), DVec3::Z);
        let found = nearest_rotation(&shear).unwrap();
        let half = (0.8_f64.atan2(0.6) - std::f64::consts::FRAC_PI_2) / 2.0;
        assert!(found.angle_between(DQuat::from_rotation_z(half)) < 1e-7, "{found}");
    }

    #[test]
    fn singular_matrices_have_no_rotation() {
        assert_eq!(nearest_rotation(&DMat3::ZERO), None);
        assert_eq!(nearest_rotation(&DMat3::from_cols(DVec3::X, DVec3::X, DVec3::Z)), None);
        assert_eq!(nearest_rotation(&DMat3::from_cols(DVec3::NAN, DVec3::Y, DVec3::Z)), None);
    }
}
