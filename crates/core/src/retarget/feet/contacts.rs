//! When a foot is in contact with the ground: slow and low, both relative to the body, with hysteresis against flicker.

use glam::DVec3;

use crate::retarget::align::Alignment;
use crate::retarget::map::ResolvedMap;

/// Speed per second and height above the ground, as shares of the body's height. A contact begins below the first and ends
/// above the second of each. For a person of 1.8 m: 0.25 and 0.5 m/s, 4 and 7 cm.
const SPEED: [f64; 2] = [0.14, 0.28];
const HEIGHT: [f64; 2] = [0.022, 0.039];

/// Height of the source from its lowest to its highest mapped joint at the aligned rest, in source units.
pub fn source_height(map: &ResolvedMap, alignment: &Alignment) -> f64 {
    let heights = map.pairs.iter().map(|pair| alignment.source.position(pair.source).y);
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
    (high - low).max(1e-9)
}

/// Whether the foot is in contact at each time. `positions` are those of a toe or ankle in a frame with +Y up;
/// `body_height` is in the same unit.
pub fn contacts(times: &[f32], positions: &[DVec3], body_height: f64) -> Vec<bool> {
    let speed = |at: usize| {
        let (from, to) = (at.saturating_sub(1), (at + 1).min(positions.len() - 1));
        let secs = f64::from(times[to] - times[from]);
        if secs > 0.0 { (positions[to] - positions[from]).length() / secs } else { 0.0 }
    };
    let slow = (0..positions.len()).filter(|&at| speed(at) < SPEED[0] * body_height);
    let ground = ground_height(slow.map(|at| positions[at].y).collect());
    let mut in_contact = false;
    (0..positions.len())
        .map(|at| {
            let limit = usize::from(in_contact);
            in_contact = positions.len() > 1
                && speed(at) < SPEED[limit] * body_height
                && positions[at].y - ground < HEIGHT[limit] * body_height;
            in_contact
        })
        .collect()
}

/// Height of the ground, from the heights of a foot while it is slow: the lowest twentieth lies below it. The minimum is
/// often a moment in which the foot rolls or the capture slips, and would leave all other contacts in the air. Without slow
/// moments the answer is infinite, and does not matter: the foot is never in contact.
fn ground_height(mut slow: Vec<f64>) -> f64 {
    let at = slow.len() / 20;
    if at < slow.len() { *slow.select_nth_unstable_by(at, f64::total_cmp).1 } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A second on the ground, a step forward through the air, a second on the ground; for one frame the toe dips below it.
    #[test]
    fn one_frame_below_the_ground_does_not_end_other_contacts() {
        let height = 1.8;
        let positions: Vec<DVec3> = (0..90)
            .map(|frame| {
                let part = ((f64::from(frame) - 30.0) / 30.0).clamp(0.0, 1.0);
                let dip = if frame == 10 { -0.06 } else { 0.0 };
                DVec3::new(0.0, 0.03 + dip + 0.2 * (std::f64::consts::PI * part).sin(), 0.8 * part)
            })
            .collect();
        let times: Vec<f32> = (0..90).map(|frame| frame as f32 / 30.0).collect();
        let found = contacts(&times, &positions, height);
        for frame in [2, 5, 15, 25, 65, 75, 85] {
            assert!(found[frame], "in contact at frame {frame}");
        }
        for frame in [36, 45, 54] {
            assert!(!found[frame], "in the air at frame {frame}");
        }
    }

    #[test]
    fn a_foot_that_is_never_slow_has_no_contacts() {
        let positions: Vec<DVec3> = (0..30).map(|frame| DVec3::new(0.0, 0.0, 0.1 * f64::from(frame))).collect();
        let times: Vec<f32> = (0..30).map(|frame| frame as f32 / 30.0).collect();
        assert!(!contacts(&times, &positions, 1.8).contains(&true));
        assert!(contacts(&[], &[], 1.8).is_empty());
    }
}
