//! When a foot stands: slow and low, both relative to the body, with hysteresis so that it does not flicker.

use glam::DVec3;

/// Shares of the body's height: speed per second and height above the ground. A foot lands below the first and lifts above
/// the second of each. For a person of 1.8 m: 0.25 and 0.5 m/s, 4 and 7 cm.
const SPEED: [f64; 2] = [0.14, 0.28];
const HEIGHT: [f64; 2] = [0.022, 0.039];

/// Whether the foot stands at each time. `positions` are of a toe (or ankle) in a frame with +Y up, `body_height` in the
/// same unit.
pub fn contacts(times: &[f32], positions: &[DVec3], body_height: f64) -> Vec<bool> {
    let speed = |at: usize| {
        let (from, to) = (at.saturating_sub(1), (at + 1).min(positions.len() - 1));
        let secs = f64::from(times[to] - times[from]);
        if secs > 0.0 { (positions[to] - positions[from]).length() / secs } else { 0.0 }
    };
    let slow = (0..positions.len()).filter(|&at| speed(at) < SPEED[0] * body_height);
    let floor = ground(slow.map(|at| positions[at].y).collect());
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

/// Where the ground is, by the heights of a foot in its slow moments: all but the lowest twentieth lie above it. The very
/// lowest is often a moment in which the foot rolls or the capture slips, and would leave all others in the air. Without slow
/// moments it does not matter: the foot never lands.
fn ground(mut slow: Vec<f64>) -> f64 {
    let at = slow.len() / 20;
    if at < slow.len() { *slow.select_nth_unstable_by(at, f64::total_cmp).1 } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A second on the ground, a step forward through the air, a second on the ground; for a moment the toe dips below it.
    #[test]
    fn a_moment_below_the_ground_does_not_lift_the_rest() {
        let height = 1.8;
        let positions: Vec<DVec3> = (0..90)
            .map(|frame| {
                let part = ((f64::from(frame) - 30.0) / 30.0).clamp(0.0, 1.0);
                let dip = if frame == 10 { -0.06 } else { 0.0 };
                DVec3::new(0.0, 0.03 + dip + 0.2 * (std::f64::consts::PI * part).sin(), 0.8 * part)
            })
            .collect();
        let times: Vec<f32> = (0..90).map(|frame| frame as f32 / 30.0).collect();
        let standing = contacts(&times, &positions, height);
        for frame in [2, 5, 15, 25, 65, 75, 85] {
            assert!(standing[frame], "it stands at frame {frame}");
        }
        for frame in [36, 45, 54] {
            assert!(!standing[frame], "it is in the air at frame {frame}");
        }
    }

    #[test]
    fn a_foot_that_is_never_slow_never_stands() {
        let positions: Vec<DVec3> = (0..30).map(|frame| DVec3::new(0.0, 0.0, 0.1 * f64::from(frame))).collect();
        let times: Vec<f32> = (0..30).map(|frame| frame as f32 / 30.0).collect();
        assert!(!contacts(&times, &positions, 1.8).contains(&true));
        assert!(contacts(&[], &[], 1.8).is_empty());
    }
}
