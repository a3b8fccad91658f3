//! A person whose joints move smoothly, evaluated here: independent of the converter that the tests check.

use crate::numpy::floats;

pub type Vector = [f64; 3];
/// Rows.
pub type Matrix = [Vector; 3];

const PARENTS: [usize; 24] = [0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19, 20, 21];
/// A body with other proportions than the converter's.
const OFFSETS: [Vector; 24] = [
    [0.0, 0.0, 0.0],
    [0.09, -0.08, 0.0],
    [-0.09, -0.08, 0.0],
    [0.0, 0.11, -0.02],
    [0.03, -0.41, 0.01],
    [-0.03, -0.41, 0.01],
    [0.0, 0.13, 0.0],
    [0.0, -0.42, -0.03],
    [0.0, -0.42, -0.03],
    [0.0, 0.07, 0.01],
    [0.02, -0.05, 0.13],
    [-0.02, -0.05, 0.13],
    [0.0, 0.2, -0.02],
    [0.07, 0.12, -0.01],
    [-0.07, 0.12, -0.01],
    [0.0, 0.1, 0.04],
    [0.12, 0.03, 0.0],
    [-0.12, 0.03, 0.0],
    [0.28, 0.0, -0.02],
    [-0.28, 0.0, -0.02],
    [0.26, 0.0, 0.01],
    [-0.26, 0.0, 0.01],
    [0.08, -0.01, 0.0],
    [-0.08, -0.01, 0.0],
];

/// The parents of SOMA's 77 joints, as in Kimodo's skeleton definitions.
const SOMA_PARENTS: [usize; 77] = [
    0, 0, 1, 2, 3, 4, 5, 6, 6, 6, 6, 3, 11, 12, 13, 14, 15, 16, 17, 14, 19, 20, 21, 22, 14, 24, 25, 26, 27, 14, 29, 30,
    31, 32, 14, 34, 35, 36, 37, 3, 39, 40, 41, 42, 43, 44, 45, 42, 47, 48, 49, 50, 42, 52, 53, 54, 55, 42, 57, 58, 59,
    60, 42, 62, 63, 64, 65, 0, 67, 68, 69, 70, 0, 72, 73, 74, 75,
];

/// Frames × joints.
pub struct Person {
    pub joints: usize,
    pub frames: usize,
    parents: Vec<usize>,
    offsets: Vec<Vector>,
    /// Axis times angle, relative to the parent.
    pub turns: Vec<Vec<Vector>>,
    /// Of the pelvis.
    pub path: Vec<Vector>,
}

/// Returns the matrix of a rotation (Rodrigues).
pub fn matrix(turn: Vector) -> Matrix {
    let angle = turn.iter().map(|x| x * x).sum::<f64>().sqrt();
    let axis = turn.map(|x| if angle > 0.0 { x / angle } else { 0.0 });
    let (sin, cos) = angle.sin_cos();
    let cross = [[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]];
    std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            let one = if row == column { cos } else { 0.0 };
            one + sin * cross[row][column] + (1.0 - cos) * axis[row] * axis[column]
        })
    })
}

pub fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|row| std::array::from_fn(|column| (0..3).map(|i| a[row][i] * b[i][column]).sum()))
}

fn turned(a: &Matrix, vector: Vector) -> Vector {
    std::array::from_fn(|row| (0..3).map(|i| a[row][i] * vector[i]).sum())
}

impl Person {
    /// Walks, waves and looks around; `phase` makes persons differ.
    pub fn new(joints: usize, frames: usize, phase: f64) -> Person {
        let turn = |frame: usize, joint: usize| -> Vector {
            let time = frame as f64 / 20.0;
            let wave = |axis: f64| (2.0 * time + 1.3 * joint as f64 + axis + phase).sin();
            match joint {
                0 => [0.1 * wave(0.0), 0.4 * time + phase, 0.1 * wave(1.0)],
                // Knees and elbows bend one way.
                4 | 5 => [0.8 + 0.7 * wave(0.0), 0.0, 0.0],
                18 => [0.0, -0.8 - 0.7 * wave(0.0), 0.0],
                19 => [0.0, 0.8 + 0.7 * wave(0.0), 0.0],
                // What has no children doesn't show in positions, nor does the twist of what has one child.
                10 | 11 | 15 | 20.. => [0.0; 3],
                _ => [0.3 * wave(0.0), 0.3 * wave(1.0), 0.3 * wave(2.0)],
            }
        };
        let turns = (0..frames).map(|frame| (0..joints).map(|joint| turn(frame, joint)).collect()).collect();
        let at = |frame: usize| [0.02 * frame as f64, 0.95 + 0.02 * (0.3 * frame as f64).sin(), phase];
        let path = (0..frames).map(at).collect();
        Person { joints, frames, parents: PARENTS[..joints].to_vec(), offsets: OFFSETS[..joints].to_vec(), turns, path }
    }

    /// All of SOMA's joints turn; bones are of any length and direction.
    pub fn soma(frames: usize) -> Person {
        let wave = |joint: usize, axis: usize, time: f64| (1.7 * joint as f64 + 2.1 * axis as f64 + time).sin();
        let vector = |joint, time, size: f64| std::array::from_fn(|axis| size * wave(joint, axis, time));
        let turn = |joint, frame: usize| vector(joint, frame as f64 / 10.0, if joint == 0 { 0.2 } else { 0.5 });
        Person {
            joints: 77,
            frames,
            parents: SOMA_PARENTS.to_vec(),
            offsets: (0..77).map(|joint| vector(joint, 0.5, 0.1)).collect(),
            turns: (0..frames).map(|frame| (0..77).map(|joint| turn(joint, frame)).collect()).collect(),
            path: (0..frames).map(|frame| [0.0, 1.0, 0.03 * frame as f64]).collect(),
        }
    }

    pub fn locals(&self, frame: usize) -> Vec<Matrix> {
        self.turns[frame].iter().map(|&turn| matrix(turn)).collect()
    }

    /// Relative to the world.
    pub fn globals(&self, frame: usize) -> Vec<Matrix> {
        let mut worlds: Vec<Matrix> = Vec::new();
        for (joint, local) in self.locals(frame).iter().enumerate() {
            worlds.push(if joint == 0 { *local } else { product(&worlds[self.parents[joint]], local) });
        }
        worlds
    }

    pub fn positions(&self, frame: usize) -> Vec<Vector> {
        let worlds = self.globals(frame);
        let mut placed = vec![self.path[frame]];
        for joint in 1..self.joints {
            let parent = self.parents[joint];
            let bone = turned(&worlds[parent], self.offsets[joint]);
            placed.push(std::array::from_fn(|axis| placed[parent][axis] + bone[axis]));
        }
        placed
    }

    /// Returns the numbers that a function makes of each frame.
    pub fn numbers<T: IntoIterator<Item = f64>>(&self, of: impl Fn(usize) -> T) -> Vec<f64> {
        (0..self.frames).flat_map(of).collect()
    }

    pub fn all_positions(&self) -> Vec<f64> {
        self.numbers(|frame| self.positions(frame).concat())
    }

    /// Returns the path as an array.
    pub fn path_array(&self) -> Vec<u8> {
        floats(&format!("({}, 3)", self.frames), &self.path.concat())
    }
}

/// Returns values with their axes in another order: `order` has the axes of the result.
pub fn transposed(values: &[f64], shape: &[usize], order: &[usize]) -> Vec<f64> {
    let mut out = Vec::new();
    let sides: Vec<usize> = order.iter().map(|&axis| shape[axis]).collect();
    for mut place in 0..values.len() {
        let mut at = vec![0; shape.len()];
        for (&axis, &side) in order.iter().zip(&sides).rev() {
            at[axis] = place % side;
            place /= side;
        }
        out.push(values[at.iter().zip(shape).fold(0, |from, (&at, &side)| from * side + at)]);
    }
    out
}
