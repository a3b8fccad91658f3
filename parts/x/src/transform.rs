//! From left-handed matrices to right-handed translation, rotation and scale.

use glam::{DAffine3, DMat3, DQuat, DVec3};

/// A scale this close to 1 is 1: a matrix of 32-bit floats isn't more precise.
const SCALE_ROUNDING: f64 = 4e-6;
/// Maximum difference between a matrix and its parts, relative to its longest axis.
const MAX_SHEAR: f64 = 1e-3;

/// Translation, rotation and scale.
#[derive(Clone, Copy)]
pub struct Parts {
    pub translation: DVec3,
    pub rotation: DQuat,
    pub scale: DVec3,
    /// Whether the parts don't fully describe the matrix.
    pub is_sheared: bool,
}

/// Returns a point or direction in right-handed space.
pub fn mirrored(vector: [f64; 3]) -> DVec3 {
    DVec3::new(vector[0], vector[1], -vector[2])
}

/// Returns the rotation of a key, `w x y z`, in right-handed space. The key rotates in the opposite direction, and
/// mirroring keeps only the rotation about Z.
pub fn rotation([w, x, y, z]: [f64; 4]) -> DQuat {
    let rotation = DQuat::from_xyzw(x, y, -z, w);
    if rotation.length_squared() > 1e-12 { rotation.normalize() } else { DQuat::IDENTITY }
}

/// Returns the file's matrix in right-handed space.
pub fn matrix(numbers: [f64; 16]) -> DAffine3 {
    let column = |at: usize| DVec3::new(numbers[at], numbers[at + 1], numbers[at + 2]);
    let mirror = DVec3::new(1.0, 1.0, -1.0);
    let matrix3 = DMat3::from_cols(column(0) * mirror, column(4) * mirror, column(8) * -mirror);
    DAffine3 { matrix3, translation: column(12) * mirror }
}

/// Decomposes a matrix.
pub fn parts(matrix: &DAffine3) -> Parts {
    let axes = matrix.matrix3;
    let mut scale = DVec3::new(axes.x_axis.length(), axes.y_axis.length(), axes.z_axis.length());
    if axes.determinant() < 0.0 {
        scale.x = -scale.x;
    }
    let unit = |axis: DVec3, length: f64| (length.abs() > 1e-30).then(|| axis / length);
    let rotation = match (unit(axes.x_axis, scale.x), unit(axes.y_axis, scale.y), unit(axes.z_axis, scale.z)) {
        (Some(x), Some(y), Some(z)) => DQuat::from_mat3(&DMat3::from_cols(x, y, z)).normalize(),
        _ => DQuat::IDENTITY,
    };
    let again = DMat3::from_quat(rotation) * DMat3::from_diagonal(scale);
    let rest = axes - again;
    let furthest = rest.x_axis.length().max(rest.y_axis.length()).max(rest.z_axis.length());
    let is_sheared = furthest > MAX_SHEAR * scale.abs().max_element();
    let rounded = scale.map(|factor| if (factor - 1.0).abs() < SCALE_ROUNDING { 1.0 } else { factor });
    Parts { translation: matrix.translation, rotation, scale: rounded, is_sheared }
}

/// Returns the 16 elements of a glTF matrix.
pub fn columns(matrix: &DAffine3) -> [f64; 16] {
    let DAffine3 { matrix3: m, translation: t } = matrix;
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    [x.x, x.y, x.z, 0.0, y.x, y.y, y.z, 0.0, z.x, z.y, z.z, 0.0, t.x, t.y, t.z, 1.0]
}
