//! How the body goes along with its feet: where both would have to be moved alike, moving the hips leaves the legs as they are.

use std::ops::Range;

use glam::DVec3;

use super::plan::{EASE_SECS, Plan};
use crate::times::near;

/// Sideways, the body follows feet that stay in contact, not single steps: half the width of the window it is averaged over.
const SWAY_SECS: f64 = 0.25;

/// Number of held feet that a body without contacts counts as: it returns to its own path.
const OWN_PATH: f64 = 0.25;

/// How far the body moves at each time: the mean of what its feet need, smooth over time.
pub fn body_shifts(times: &[f32], plans: &[Plan]) -> Vec<DVec3> {
    let moves = |at: usize| plans.iter().map(move |plan| plan.moves[at]);
    let sideways = |at: usize| {
        let held = moves(at).map(|foot| (foot.by * foot.hold, foot.hold));
        held.fold((DVec3::ZERO, 0.0), |(sum, holds), (by, hold)| (sum + by, holds + hold))
    };
    // A foot in the ground lifts the body even if it isn't held.
    let upwards = |at: usize| {
        let held = moves(at).map(|foot| if foot.lift > foot.by.y { (foot.lift, 1.0) } else { (foot.by.y, foot.hold) });
        held.fold((DVec3::ZERO, 0.0), |(sum, holds), (by, hold)| (sum + hold * by * DVec3::Y, holds + hold))
    };
    let sideways: Vec<(DVec3, f64)> = (0..times.len()).map(sideways).collect();
    let upwards: Vec<(DVec3, f64)> = (0..times.len()).map(upwards).collect();
    let sideways = smoothed_mean(times, &sideways, SWAY_SECS);
    let upwards = smoothed_mean(times, &upwards, EASE_SECS);
    sideways.into_iter().zip(upwards).map(|(side, up)| DVec3 { y: up.y, ..side }).collect()
}

/// Means of sums and their weights over twice `secs`, twice, so that they change smoothly.
fn smoothed_mean(times: &[f32], sums: &[(DVec3, f64)], secs: f64) -> Vec<DVec3> {
    let twice = box_means(times, &box_means(times, sums, secs), secs);
    twice.into_iter().map(|(sum, weight)| sum / (weight + OWN_PATH)).collect()
}

fn box_means(times: &[f32], values: &[(DVec3, f64)], secs: f64) -> Vec<(DVec3, f64)> {
    let mut totals = vec![(DVec3::ZERO, 0.0)];
    for &(value, weight) in values {
        let (sum, weights) = totals[totals.len() - 1];
        totals.push((sum + value, weights + weight));
    }
    let mean = |at: usize| {
        let Range { start, end } = near(times, at, secs);
        let count = (end - start) as f64;
        ((totals[end].0 - totals[start].0) / count, (totals[end].1 - totals[start].1) / count)
    };
    (0..times.len()).map(mean).collect()
}

/// Returns the mean of the values within `secs` of each time.
pub fn means(times: &[f32], values: &[f64], secs: f64) -> Vec<f64> {
    let mean = |at: usize| {
        let values = &values[near(times, at, secs)];
        values.iter().sum::<f64>() / values.len() as f64
    };
    (0..times.len()).map(mean).collect()
}
