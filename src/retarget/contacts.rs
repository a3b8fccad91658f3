//! When a foot stands: slow and low, both relative to the body, with hysteresis so that it does not flicker.

use glam::DVec3;

/// Shares of the body's height: speed per second and height above the foot's lowest point. A foot lands below the first
/// and lifts above the second of each. For a person of 1.8 m: 0.25 and 0.5 m/s, 4 and 7 cm.
const SPEED: [f64; 2] = [0.14, 0.28];
const HEIGHT: [f64; 2] = [0.022, 0.039];

/// Whether the foot stands at each time. `positions` are of a toe (or ankle) in a frame with +Y up, `body_height` in the
/// same unit.
pub(super) fn contacts(times: &[f32], positions: &[DVec3], body_height: f64) -> Vec<bool> {
    let floor = positions.iter().map(|position| position.y).fold(f64::INFINITY, f64::min);
    let speed = |at: usize| {
        let (from, to) = (at.saturating_sub(1), (at + 1).min(positions.len() - 1));
        let secs = f64::from(times[to] - times[from]);
        if secs > 0.0 { (positions[to] - positions[from]).length() / secs } else { 0.0 }
    };
    let mut standing = false;
    (0..positions.len())
        .map(|at| {
            let limit = usize::from(standing);
            standing = positions.len() > 1
                && speed(at) < SPEED[limit] * body_height
                && positions[at].y - floor < HEIGHT[limit] * body_height;
            standing
        })
        .collect()
}
