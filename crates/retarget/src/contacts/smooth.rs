//! Makes corrections that are wanted at single moments smooth over time.

use glam::DVec3;

use crate::times::near;

/// Half the width of the windows that are averaged over. A bit more than whole frames at usual rates: otherwise rounding would
/// decide whether a window has one frame more or less, and the mean would jump.
const EASE_SECS: f64 = 0.105;

/// Returns moves that are as wanted where they are wanted fully, and come and go smoothly around. `wanted` has a move and how much
/// it is wanted, from 0 to 1, at each time.
pub fn eased(times: &[f32], wanted: &[(DVec3, f64)]) -> Vec<DVec3> {
    if wanted.iter().all(|(_, share)| *share == 0.0) {
        return vec![DVec3::ZERO; times.len()];
    }
    let windows: Vec<_> = (0..times.len()).map(|at| near(times, at, EASE_SECS)).collect();
    // The mean of the neighbourhood's maxima is never less than the share itself.
    let max: Vec<f64> =
        windows.iter().map(|near| wanted[near.clone()].iter().fold(0.0, |max, (_, share)| share.max(max))).collect();
    let shaped = |near: &std::ops::Range<usize>| {
        let (sum, shares) = wanted[near.clone()]
            .iter()
            .fold((DVec3::ZERO, 0.0), |(sum, shares), (by, share)| (sum + *share * *by, shares + share));
        let share = max[near.clone()].iter().sum::<f64>() / near.len() as f64;
        if shares > 0.0 { share * sum / shares } else { DVec3::ZERO }
    };
    let shaped: Vec<DVec3> = windows.iter().map(shaped).collect();
    let half = |at: usize| near(times, at, 0.5 * EASE_SECS);
    (0..times.len()).map(|at| shaped[half(at)].iter().sum::<DVec3>() / half(at).len() as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_move_that_is_wanted_for_a_moment_comes_and_goes() {
        let times: Vec<f32> = (0..120).map(|frame| frame as f32 / 60.0).collect();
        let wanted: Vec<(DVec3, f64)> =
            (0..120).map(|at| if (50..60).contains(&at) { (DVec3::Y, 1.0) } else { (DVec3::X, 0.0) }).collect();
        let moves = eased(&times, &wanted);
        assert!((moves[55] - DVec3::Y).length() < 1e-9, "{}", moves[55]);
        assert_eq!((moves[20], moves[90]), (DVec3::ZERO, DVec3::ZERO));
        let step = moves.windows(2).map(|pair| (pair[1] - pair[0]).length()).fold(0.0, f64::max);
        assert!(step < 0.2, "{step}");
    }
}
