//! When a foot is in contact with the ground: slow and low, both relative to the body, with hysteresis against flicker.

use glam::DVec3;

use crate::retarget::align::Alignment;
use crate::retarget::map::ResolvedMap;
use crate::retarget::math::HORIZONTAL;

/// Speed (per second) and height above the ground, as shares of the body's height. A contact begins below the first and ends
/// above the second of each. For a person of 1.8 m: 0.25 and 0.5 m/s, 4 and 7 cm.
const SPEED: [f64; 2] = [0.14, 0.28];
const HEIGHT: [f64; 2] = [0.022, 0.039];

/// Minimum speed of the ground under a walk in place, per second, as a share of the body's height.
const MIN_TREADMILL_SPEED: f64 = 0.07;

/// How far velocities of feet may be from the moving ground's, as a share of its speed.
const TREADMILL_SPREAD: f64 = 0.3;

/// Height of the source from its lowest to its highest mapped joint at the aligned rest, in source units.
pub fn source_height(map: &ResolvedMap, alignment: &Alignment) -> f64 {
    let heights = map.pairs.iter().map(|pair| alignment.source.position(pair.source).y);
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
    (high - low).max(1e-9)
}

/// What the feet of a source do, each at the sampled times.
#[derive(Debug)]
pub struct SourceContacts {
    /// Whether a foot is in contact with the ground, by foot and time.
    pub touching: Vec<Vec<bool>>,
    /// Of the ground, in source units per second: not zero under a figure that walks or runs in place.
    pub ground_velocity: DVec3,
}

/// Finds the contacts of feet. `positions` are those of the toes or ankles, by foot and time, in a frame with +Y up; `hips` is the
/// path of the hips, and `body_height` is in the same unit.
pub fn source_contacts(times: &[f32], positions: &[Vec<DVec3>], hips: &[DVec3], body_height: f64) -> SourceContacts {
    let ground_velocity = treadmill_velocity(times, positions, hips, body_height);
    let on_ground = |positions: &Vec<DVec3>| {
        let travel = |&time: &f32| ground_velocity * f64::from(time);
        let relative: Vec<DVec3> = positions.iter().zip(times).map(|(at, time)| *at - travel(time)).collect();
        contacts(times, &relative, body_height, TREADMILL_SPREAD * ground_velocity.length())
    };
    SourceContacts { touching: positions.iter().map(on_ground).collect(), ground_velocity }
}

/// Whether the foot is in contact at each time. `slack` is added to the speed that a foot in contact may have.
fn contacts(times: &[f32], positions: &[DVec3], body_height: f64, slack: f64) -> Vec<bool> {
    let speed = |at: usize| velocity(times, positions, at).length();
    let max_speed = SPEED.map(|share| share * body_height + slack);
    let slow = (0..positions.len()).filter(|&at| speed(at) < max_speed[0]);
    let ground = low_height(slow.map(|at| positions[at].y).collect());
    let mut in_contact = false;
    (0..positions.len())
        .map(|at| {
            let limit = usize::from(in_contact);
            in_contact = positions.len() > 1
                && speed(at) < max_speed[limit]
                && positions[at].y - ground < HEIGHT[limit] * body_height;
            in_contact
        })
        .collect()
}

/// Velocity per second, from the previous time to the next.
fn velocity(times: &[f32], positions: &[DVec3], at: usize) -> DVec3 {
    let (from, to) = (at.saturating_sub(1), (at + 1).min(positions.len() - 1));
    let secs = f64::from(times[to] - times[from]);
    if secs > 0.0 { (positions[to] - positions[from]) / secs } else { DVec3::ZERO }
}

/// Height below which the lowest twentieth lies: of a foot while it is slow, the height of the ground. The minimum is often a
/// moment in which the foot rolls or the capture slips, and would leave all other contacts in the air. Infinite without
/// heights: such a foot is never in contact.
fn low_height(mut heights: Vec<f64>) -> f64 {
    let at = heights.len() / 20;
    if at < heights.len() { *heights.select_nth_unstable_by(at, f64::total_cmp).1 } else { f64::INFINITY }
}

/// Velocity at which the ground passes below a figure that walks or runs in place: the median of its feet's while they are low.
/// Zero if the hips travel, the feet are slow, or their velocities have little in common.
fn treadmill_velocity(times: &[f32], positions: &[Vec<DVec3>], hips: &[DVec3], body_height: f64) -> DVec3 {
    let mut low = Vec::new();
    for positions in positions {
        let ground = low_height(positions.iter().map(|position| position.y).collect());
        let is_low = |at: &usize| positions[*at].y - ground < HEIGHT[0] * body_height;
        low.extend((0..positions.len()).filter(is_low).map(|at| velocity(times, positions, at) * HORIZONTAL));
    }
    let ([first, .., last], [from, .., to]) = (hips, times) else { return DVec3::ZERO };
    if low.is_empty() {
        return DVec3::ZERO;
    }
    let middle = DVec3::new(median(low.iter().map(|low| low.x)), 0.0, median(low.iter().map(|low| low.z)));
    let speed = middle.length();
    let spread = median(low.iter().map(|low| (*low - middle).length()));
    let travel = ((*last - *first) * HORIZONTAL).length() / f64::from(to - from).max(1e-9);
    let is_treadmill = speed > MIN_TREADMILL_SPEED * body_height
        && spread < TREADMILL_SPREAD * speed
        && travel < TREADMILL_SPREAD * speed;
    if is_treadmill { middle } else { DVec3::ZERO }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    let at = values.len() / 2;
    if at < values.len() { *values.select_nth_unstable_by(at, f64::total_cmp).1 } else { 0.0 }
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
        let found = contacts(&times, &positions, height, 0.0);
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
        assert!(!contacts(&times, &positions, 1.8, 0.0).contains(&true));
        assert!(contacts(&[], &[], 1.8, 0.0).is_empty());
    }
}
