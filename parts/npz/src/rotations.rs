//! Rotations: axis times angle, matrices, two axes of them ("6D", Zhou et al. 2019), quaternions.

use glam::{DMat3, DQuat, DVec3};

use crate::array::Array;
use crate::layout::{Grid, MAX_LOOKS, Wanted, unexpected};

/// Maximum difference between a rotation matrix times its transpose and the identity, or the squares of quaternions and axes and 1.
/// 16-bit floats and the models that predict such numbers aren't exact.
const TOLERANCE: f64 = 0.1;

/// How a rotation is stored.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Form {
    /// Axis times angle.
    AxisAngle,
    /// A matrix, row by row.
    Matrix,
    /// The first two columns of a matrix, row by row, as HY-Motion and SPIN write them: `x.view(3, 2)`.
    Interleaved,
    /// The first column of a matrix, then the second one, as HumanML3D's `cont6d_to_matrix` reads them.
    Columns,
    /// The first row of a matrix, then the second one, as PyTorch3D's `rotation_6d_to_matrix` reads them.
    Rows,
    /// A quaternion, w first.
    WFirst,
    /// A quaternion, w last.
    WLast,
}

impl Form {
    /// What the report calls it.
    pub fn title(self) -> &'static str {
        match self {
            Form::AxisAngle => "axis-angle rotations",
            Form::Matrix => "rotation matrices",
            Form::Interleaved => "6D rotations (two columns, row by row)",
            Form::Columns => "6D rotations (one column, then another)",
            Form::Rows => "6D rotations (one row, then another)",
            Form::WFirst => "quaternions (w first)",
            Form::WLast => "quaternions (w last)",
        }
    }
}

/// Rotations of some of the joints.
pub struct Rotations {
    pub grid: Grid,
    pub form: Form,
}

impl Rotations {
    /// Reads an array. `None` if its shape doesn't fit.
    pub fn of(array: Array, wanted: Wanted) -> Result<Option<Rotations>, String> {
        let Some(grid) = Grid::of(array, wanted, &deviation)? else { return Ok(None) };
        grid.check()?;
        let form = form(&grid);
        let rotations = Rotations { grid, form };
        rotations.check()?;
        Ok(Some(rotations))
    }

    /// Rejects numbers that aren't rotations.
    fn check(&self) -> Result<(), String> {
        let expected = match self.grid.numbers() {
            3 => return Ok(()),
            4 => "quaternions of length 1",
            6 => "pairs of axes of length 1, at right angles",
            _ => "matrices that are rotations",
        };
        for (sample, frame, joint) in self.grid.places(usize::MAX) {
            let error = error(&self.grid, self.form, (sample, frame, joint));
            if error.is_nan() || error > TOLERANCE {
                let found = format!("another in frame {frame}");
                return Err(unexpected(&self.grid.label, expected, &found));
            }
        }
        Ok(())
    }

    /// Returns the rotation of a joint.
    pub fn at(&self, sample: usize, frame: usize, joint: usize) -> DQuat {
        match self.form {
            Form::AxisAngle => DQuat::from_scaled_axis(self.grid.at(sample, frame, joint).into()),
            Form::WFirst => {
                let [w, x, y, z] = self.grid.at(sample, frame, joint);
                DQuat::from_xyzw(x, y, z, w).normalize()
            }
            Form::WLast => DQuat::from_array(self.grid.at(sample, frame, joint)).normalize(),
            Form::Matrix => {
                // Rows become columns.
                let rows: [f64; 9] = self.grid.at(sample, frame, joint);
                DQuat::from_mat3(&DMat3::from_cols_array(&rows).transpose()).normalize()
            }
            Form::Interleaved | Form::Columns | Form::Rows => {
                // Gram-Schmidt, as in the tools that write them.
                let [a, b] = axes(self.grid.at(sample, frame, joint), self.form);
                let a = a.normalize();
                let b = b.reject_from_normalized(a).normalize();
                let columns = DMat3::from_cols(a, b, a.cross(b));
                let rotation = if self.form == Form::Rows { columns.transpose() } else { columns };
                DQuat::from_mat3(&rotation).normalize()
            }
        }
    }
}

/// Returns the two axes of a 6D rotation.
fn axes(values: [f64; 6], form: Form) -> [DVec3; 2] {
    let [a, b, c, d, e, f] = values;
    match form {
        Form::Interleaved => [DVec3::new(a, c, e), DVec3::new(b, d, f)],
        _ => [DVec3::new(a, b, c), DVec3::new(d, e, f)],
    }
}

/// Returns how far stored numbers are from a rotation.
fn error(grid: &Grid, form: Form, (sample, frame, joint): (usize, usize, usize)) -> f64 {
    let largest = |values: &[f64]| values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    match form {
        Form::AxisAngle => 0.0,
        Form::WFirst | Form::WLast => {
            let quaternion: [f64; 4] = grid.at(sample, frame, joint);
            (DQuat::from_array(quaternion).length_squared() - 1.0).abs()
        }
        Form::Matrix => {
            let matrix = DMat3::from_cols_array(&grid.at(sample, frame, joint));
            let product = matrix * matrix.transpose() - DMat3::IDENTITY;
            if matrix.determinant() <= 0.0 { 1.0 } else { largest(&product.to_cols_array()) }
        }
        Form::Interleaved | Form::Columns | Form::Rows => {
            let [a, b] = axes(grid.at(sample, frame, joint), form);
            largest(&[a.length_squared() - 1.0, b.length_squared() - 1.0, a.dot(b)])
        }
    }
}

fn mean_error(grid: &Grid, form: Form) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for place in grid.places(MAX_LOOKS) {
        // Beyond 1, it doesn't matter how far numbers are from a rotation.
        sum += error(grid, form, place).min(1.0);
        count += 1;
    }
    if count == 0 { 0.0 } else { sum / f64::from(count) }
}

/// Returns how far the numbers are from rotations, on average.
fn deviation(grid: &Grid) -> f64 {
    mean_error(grid, form(grid))
}

fn form(grid: &Grid) -> Form {
    match grid.numbers() {
        3 => Form::AxisAngle,
        // Joints turn by less than a quarter turn on average, so w is the largest number.
        4 => {
            let (mut first, mut last) = (0.0, 0.0);
            for (sample, frame, joint) in grid.places(MAX_LOOKS) {
                let [a, _, _, d] = grid.at(sample, frame, joint);
                (first, last) = (first + a * a, last + d * d);
            }
            if last > first { Form::WLast } else { Form::WFirst }
        }
        6 => [Form::Interleaved, Form::Columns]
            .into_iter()
            .min_by(|&a, &b| mean_error(grid, a).total_cmp(&mean_error(grid, b)))
            .unwrap_or(Form::Columns),
        _ => Form::Matrix,
    }
}
