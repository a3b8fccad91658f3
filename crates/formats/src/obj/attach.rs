//! `.attach`: skin weights. One row per vertex, in the order of the .obj; one column for every joint but the first, whose
//! weight is 0 and is not written.

use gaitway_character::asset::{Warning, Warnings};
use gaitway_character::mesh::{Influences, MAX_INFLUENCES};
use gaitway_character::sort::sort_by;

use crate::error::Problem;
use crate::limits::Budget;
use crate::lines::{Lines, number, quoted};

/// Weight sums farther from 1 are reported; smaller errors are rounding.
const SUM_TOLERANCE: f64 = 1e-3;

/// Bytes of one influence of one vertex.
pub const INFLUENCE_BYTES: usize = size_of::<u16>() + size_of::<f32>();

/// Reads the influences of all vertices, normalized. A row of zeros follows the first joint. Of more than [`MAX_INFLUENCES`]
/// weights the largest are kept. `file` is the name for warnings.
pub fn read(
    file: &str,
    bytes: &[u8],
    vertices: usize,
    joints: usize,
    budget: &Budget,
    warnings: &mut Warnings,
) -> Result<Influences, Problem> {
    let mut rows = Rows { max_count: 1, ..Rows::default() };
    let mut row: Vec<(u16, f64)> = Vec::new();
    let mut lines = Lines::new(bytes);
    while let Some((line, content)) = lines.next_full_line() {
        if content.starts_with(b"#") {
            continue;
        }
        if rows.ends.len() == vertices {
            let expected = format!("{vertices} rows, one for each vertex of the .obj");
            return Err(Problem::new(format!("line {line}"), expected, "more"));
        }
        let total = read_row(line, content, joints, &mut row)?;
        budget.allocate(row.len().clamp(1, MAX_INFLUENCES), size_of::<(u16, f32)>(), &format_args!("line {line}"))?;
        rows.add(&mut row, total);
    }
    // With a single joint, rows have no columns, so there is nothing to count.
    if rows.ends.len() < vertices && joints > 1 {
        let expected = format!("{vertices} rows, one for each vertex of the .obj");
        return Err(Problem::new(lines.place(), expected, format!("{} and the end of the file", rows.ends.len())));
    }
    for _ in rows.ends.len()..vertices {
        rows.pairs.push((0, 1.0));
        rows.ends.push(rows.pairs.len());
    }
    rows.warn(file, warnings);
    budget.allocate(rows.stride() * rows.ends.len(), INFLUENCE_BYTES, &"the whole file")?;
    Ok(rows.influences())
}

/// The rows read so far, and what has to be reported about them.
#[derive(Default)]
struct Rows {
    /// Pairs of joint and weight of all rows, strongest first.
    pairs: Vec<(u16, f32)>,
    /// End of each row in `pairs`.
    ends: Vec<usize>,
    max_count: usize,
    missing: usize,
    normalized: usize,
    largest_lost_weight: f32,
}

impl Rows {
    /// Adds a row, whose weights sum to `total`.
    fn add(&mut self, row: &mut Vec<(u16, f64)>, total: f64) {
        if row.is_empty() {
            self.missing += 1;
            row.push((0, 1.0));
        } else if (total - 1.0).abs() > SUM_TOLERANCE {
            self.normalized += 1;
        }
        // Stable: equal weights keep the file's order.
        sort_by(row, |a, b| b.1.total_cmp(&a.1));
        self.max_count = self.max_count.max(row.len());
        if let Some(lost) = row.get(MAX_INFLUENCES) {
            self.largest_lost_weight = self.largest_lost_weight.max((lost.1 / total) as f32);
        }
        row.truncate(MAX_INFLUENCES);
        let kept: f64 = row.iter().map(|pair| pair.1).sum();
        self.pairs.extend(row.iter().map(|&(joint, weight)| (joint, (weight / kept) as f32)));
        self.ends.push(self.pairs.len());
    }

    fn warn(&self, file: &str, warnings: &mut Warnings) {
        let mesh = || file.to_owned();
        if self.max_count > MAX_INFLUENCES {
            let (found, kept, largest_lost_weight) = (self.max_count, MAX_INFLUENCES, self.largest_lost_weight);
            warnings.push(Warning::InfluencesDropped { mesh: mesh(), found, kept, largest_lost_weight });
        }
        if self.missing > 0 {
            warnings.push(Warning::WeightsMissing { mesh: mesh(), vertices: self.missing });
        }
        if self.normalized > 0 {
            warnings.push(Warning::WeightsNormalized { mesh: mesh(), vertices: self.normalized });
        }
    }

    fn stride(&self) -> usize {
        self.max_count.min(MAX_INFLUENCES).next_multiple_of(4)
    }

    fn influences(&self) -> Influences {
        let stride = self.stride();
        let count = stride * self.ends.len();
        let mut influences = Influences { stride, joints: vec![0; count], weights: vec![0.0; count] };
        let mut start = 0;
        for (vertex, &end) in self.ends.iter().enumerate() {
            for (at, &(joint, weight)) in self.pairs[start..end].iter().enumerate() {
                influences.joints[vertex * stride + at] = joint;
                influences.weights[vertex * stride + at] = weight;
            }
            start = end;
        }
        influences
    }
}

/// Reads the influences of one row, in the file's order, and returns the sum of their weights.
fn read_row(line: usize, content: &[u8], joints: usize, row: &mut Vec<(u16, f64)>) -> Result<f64, Problem> {
    row.clear();
    let mut columns = 0;
    let mut total = 0.0;
    let expected = || format!("{} weights, one for each joint of the .skel but the first", joints.saturating_sub(1));
    for word in content.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()) {
        columns += 1;
        if columns >= joints {
            return Err(Problem::new(format!("line {line}"), expected(), "more"));
        }
        let weight = number(word).filter(|&weight| weight >= 0.0 && weight <= f64::from(f32::MAX));
        let weight = weight.ok_or_else(|| {
            Problem::new(
                format!("line {line}, number {columns}"),
                "a weight: a number of 0 or more",
                quoted(Some(word)),
            )
        })?;
        if weight > 0.0 {
            row.push((columns as u16, weight));
            total += weight;
        }
    }
    if columns + 1 != joints {
        return Err(Problem::new(format!("line {line}"), expected(), columns));
    }
    Ok(total)
}
