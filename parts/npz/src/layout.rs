//! Which axis of an array counts what: tools write frames × joints × numbers, but also joints × numbers × frames, several people or
//! samples in one array, and axes of length 1. Only some counts of joints, and of numbers per joint, occur, which leaves few
//! readings; of two axes, time is the one along which values change least.

use crate::array::Array;

/// Maximum number of people or samples in a file: each is a clip.
const MAX_SAMPLES: usize = 256;
/// Maximum number of places that are sampled to find out how an array is laid out.
pub const MAX_LOOKS: usize = 8192;
/// Maximum number of axes, those of length 1 included.
const MAX_AXES: usize = 8;

/// The number of values along an axis, and their distance in the array.
#[derive(Clone, Copy, PartialEq)]
struct Axis {
    size: usize,
    stride: usize,
}

/// An axis that the array doesn't have.
const NONE: Axis = Axis { size: 1, stride: 0 };

/// One reading of an array's axes.
#[derive(Clone, Copy, PartialEq)]
pub struct Layout {
    samples: Axis,
    frames: Axis,
    joints: Axis,
    /// Of one joint in one frame.
    numbers: Axis,
}

/// The counts that a layout may have.
#[derive(Clone, Copy)]
pub struct Wanted<'a> {
    /// Numbers of joints. For `[1]`, there is no axis of joints.
    pub joints: &'a [usize],
    /// Numbers per joint; 9 are also 3 × 3.
    pub numbers: &'a [usize],
}

impl Wanted<'_> {
    /// Returns the layouts that an array of this shape may have, usual ones first.
    pub fn layouts(self, shape: &[usize]) -> Vec<Layout> {
        let numbers = shape.iter().try_fold(1_usize, |count, &size| count.checked_mul(size));
        let Some(mut stride) = numbers.filter(|_| shape.len() <= MAX_AXES) else { return Vec::new() };
        let axes: Vec<Axis> = shape
            .iter()
            .map(|&size| {
                stride = usize::checked_div(stride, size).unwrap_or(0);
                Axis { size, stride }
            })
            .filter(|axis| axis.size != 1)
            .collect();
        let has_single = axes.len() < shape.len();
        let mut found = Vec::new();
        for at in (0..axes.len()).rev() {
            let Axis { size, stride } = axes[at];
            let without = |count: usize| [&axes[..at + 1 - count], &axes[at + 1..]].concat();
            if size == 3 && at > 0 && axes[at - 1].size == 3 && self.numbers.contains(&9) {
                self.add_joints(Axis { size: 9, stride }, &without(2), has_single, &mut found);
                // Rows of matrices aren't to be taken for axes times angles.
                if !found.is_empty() {
                    return found;
                }
            }
            if self.numbers.contains(&size) {
                self.add_joints(axes[at], &without(1), has_single, &mut found);
            }
            // Joints and numbers in one axis are the last: the number of frames, too, may be a multiple of both.
            let flattened = if at + 1 == axes.len() { self.numbers } else { &[] };
            for &numbers in flattened {
                let joints = size / numbers;
                if joints > 1 && size % numbers == 0 && self.joints.contains(&joints) {
                    let joints = Axis { size: joints, stride: numbers * stride };
                    add_frames(Axis { size: numbers, stride }, joints, &without(1), has_single, &mut found);
                }
            }
        }
        found
    }

    fn add_joints(self, numbers: Axis, axes: &[Axis], has_single: bool, found: &mut Vec<Layout>) {
        if self.joints.contains(&1) {
            add_frames(numbers, NONE, axes, has_single, found);
        }
        for at in (0..axes.len()).rev().filter(|&at| self.joints.contains(&axes[at].size)) {
            add_frames(numbers, axes[at], &[&axes[..at], &axes[at + 1..]].concat(), has_single, found);
        }
    }

    /// Describes what is expected, for messages.
    pub fn expected(self) -> String {
        let what = if self.numbers == [3] { "positions" } else { "rotations" };
        let plural = if self.joints == [1] { "" } else { "s" };
        format!("{what} (frames × {} joint{plural} × {})", any_of(self.joints), self.expected_numbers())
    }

    /// Describes how many numbers a joint should have.
    pub fn expected_numbers(self) -> String {
        any_of(self.numbers).replace('9', "3 × 3")
    }
}

/// `22, 24 or 52`
fn any_of(counts: &[usize]) -> String {
    let counts: Vec<String> = counts.iter().map(usize::to_string).collect();
    match counts.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} or {last}", others.join(", ")),
        _ => counts.concat(),
    }
}

/// Adds the readings of the axes that are left.
fn add_frames(numbers: Axis, joints: Axis, axes: &[Axis], has_single: bool, found: &mut Vec<Layout>) {
    let mut add = |samples, frames| found.push(Layout { samples, frames, joints, numbers });
    match *axes {
        [] if has_single => add(NONE, NONE),
        [frames] => add(NONE, frames),
        [first, second] => {
            add(first, second);
            add(second, first);
        }
        _ => (),
    }
}

/// An array with one of its layouts.
pub struct Grid {
    pub label: String,
    pub layout: Layout,
    values: Vec<f64>,
}

impl Grid {
    /// Reads an array in the layout with the least `deviation`; among equal ones, one without an axis of samples, then the one in
    /// which values change least from frame to frame, or else the most usual one. `None` if its shape fits none.
    pub fn of(array: Array, wanted: Wanted, deviation: &dyn Fn(&Grid) -> f64) -> Result<Option<Grid>, String> {
        let Array { label, shape, values } = array;
        let layouts = wanted.layouts(&shape);
        let Some(&first) = layouts.first() else { return Ok(None) };
        let mut grid = Grid { label, layout: first, values };
        if layouts.len() > 1 && !grid.values.is_empty() {
            // Rounding and noise don't decide, and most files hold one motion.
            let mut best = ((f64::INFINITY, false), f64::INFINITY);
            let mut chosen = first;
            for layout in layouts {
                grid.layout = layout;
                let (fit, step) = (((deviation(&grid) * 20.0).round(), grid.samples() > 1), grid.step());
                if fit < best.0 || fit == best.0 && step < 0.9 * best.1 {
                    (best, chosen) = ((fit, step), layout);
                }
            }
            grid.layout = chosen;
        }
        let samples = grid.samples();
        if samples > MAX_SAMPLES {
            let expected = format!("at most {MAX_SAMPLES} people or samples");
            return Err(unexpected(&grid.label, &expected, &samples.to_string()));
        }
        Ok(Some(grid))
    }

    /// Returns the array, whose shape the caller kept.
    pub fn into_array(self, shape: Vec<usize>) -> Array {
        Array { label: self.label, shape, values: self.values }
    }

    pub fn samples(&self) -> usize {
        self.layout.samples.size
    }

    pub fn frames(&self) -> usize {
        self.layout.frames.size
    }

    pub fn joints(&self) -> usize {
        self.layout.joints.size
    }

    /// Returns how many numbers a joint has in a frame.
    pub fn numbers(&self) -> usize {
        self.layout.numbers.size
    }

    /// Returns the first `N` numbers of a joint.
    pub fn at<const N: usize>(&self, sample: usize, frame: usize, joint: usize) -> [f64; N] {
        std::array::from_fn(|number| self.value(sample, frame, joint, number))
    }

    fn value(&self, sample: usize, frame: usize, joint: usize, number: usize) -> f64 {
        let Layout { samples, frames, joints, numbers } = self.layout;
        let at = sample * samples.stride + frame * frames.stride + joint * joints.stride;
        self.values[at + number * numbers.stride]
    }

    /// Returns about `count` places (sample, frame, joint): all joints in frames that are spread over all of them.
    pub fn places(&self, count: usize) -> impl Iterator<Item = (usize, usize, usize)> + use<> {
        let joints = self.joints();
        let moments = self.every((self.samples() * self.frames() * joints).div_ceil(count));
        moments.flat_map(move |(sample, frame)| (0..joints).map(move |joint| (sample, frame, joint)))
    }

    /// Returns about `count` moments (sample, frame) that are spread over all of them.
    pub fn moments(&self, count: usize) -> impl Iterator<Item = (usize, usize)> + use<> {
        self.every((self.samples() * self.frames()).div_ceil(count))
    }

    fn every(&self, step: usize) -> impl Iterator<Item = (usize, usize)> + use<> {
        let frames = self.frames();
        (0..self.samples() * frames).step_by(step.max(1)).map(move |at| (at / frames, at % frames))
    }

    /// Returns how much values differ from one frame to the next, on average.
    fn step(&self) -> f64 {
        let (mut sum, mut count) = (0.0, 0);
        for (sample, frame, joint) in self.places(MAX_LOOKS) {
            if frame + 1 < self.frames() {
                for number in 0..self.numbers() {
                    let [this, next] = [frame, frame + 1].map(|frame| self.value(sample, frame, joint, number));
                    sum += (next - this).abs();
                    count += 1;
                }
            }
        }
        if count == 0 { f64::INFINITY } else { sum / f64::from(count) }
    }

    /// Rejects an array without frames, and numbers that 32-bit floats can't express.
    pub fn check(&self) -> Result<(), String> {
        if self.values.is_empty() {
            return Err(unexpected(&self.label, "at least one frame", "none"));
        }
        let frames = self.layout.frames;
        match self.values.iter().position(|&value| !(value as f32).is_finite()) {
            Some(at) => {
                let frame = at.checked_div(frames.stride).unwrap_or(0) % frames.size;
                let found = format!("{} in frame {frame}", self.values[at]);
                Err(unexpected(&self.label, "finite numbers", &found))
            }
            None => Ok(()),
        }
    }

    /// Describes the number of people or samples and an unusual order of axes, for the report.
    pub fn describe(&self) -> String {
        let Layout { samples, frames, joints, numbers } = self.layout;
        let mut axes: Vec<(usize, &str)> =
            [(samples, "samples"), (frames, "frames"), (joints, "joints"), (numbers, "numbers")]
                .into_iter()
                .filter(|(axis, _)| axis.size > 1)
                .map(|(axis, name)| (axis.stride, name))
                .collect();
        let usual: Vec<&str> = axes.iter().map(|&(_, name)| name).collect();
        axes.sort_by_key(|&(stride, _)| std::cmp::Reverse(stride));
        let order: Vec<&str> = axes.into_iter().map(|(_, name)| name).collect();
        let order = if order == usual { String::new() } else { format!(", stored as {}", order.join(" × ")) };
        match samples.size {
            1 => order,
            samples => format!(", {samples} people or samples{order}"),
        }
    }
}

/// Returns a message about an array that isn't what was expected.
pub fn unexpected(label: &str, expected: &str, found: &str) -> String {
    let hint = "Save the motion as the joints' positions, or as the arrays of AMASS.";
    format!("{label}: expected {expected}, found {found}. {hint}")
}
