//! Values averaged over a short time, for a root joint that follows the hips but not their sway.

use std::ops::{Add, Div};

/// Longest time between two values.
const STEP_SECS: f64 = 1.0 / 30.0;

/// Values on either side that each one is averaged with: 0.25 s.
const STEPS_AROUND: usize = 8;

/// Most steps of a clip; of a longer one, they are longer.
const MAX_STEPS: usize = 50_000;

/// Returns times at equal distances, from the first to the last, ascending without duplicates.
pub fn steps(first_secs: f32, last_secs: f32) -> Vec<f32> {
    let (first, secs) = (f64::from(first_secs), f64::from(last_secs) - f64::from(first_secs));
    let count = ((secs / STEP_SECS).ceil() as usize).clamp(1, MAX_STEPS);
    let mut times: Vec<f32> = (0..=count).map(|step| (first + secs * step as f64 / count as f64) as f32).collect();
    // Far from zero, `f32` is too coarse for such steps.
    times.dedup();
    times
}

/// Averages each value with as many before as after it, so that both ends and straight lines stay as they are.
pub fn averaged<T: Copy + Add<Output = T> + Div<f64, Output = T>>(values: &[T]) -> Vec<T> {
    let around = |at: usize| {
        let reach = STEPS_AROUND.min(at).min(values.len() - 1 - at);
        let others = (1..=reach).map(|by| values[at - by] + values[at + by]);
        others.fold(values[at], |sum, both| sum + both) / (2 * reach + 1) as f64
    };
    (0..values.len()).map(around).collect()
}
