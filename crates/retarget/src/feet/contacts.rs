//! When a foot is in contact with the ground: slow and low, both relative to the body, with hysteresis against flicker.

use std::ops::Range;

use gaitway_character::anim::JointIndex;
use gaitway_character::sort::sort_by;
use glam::DVec3;

use crate::align::Alignment;
use crate::map::ResolvedMap;
use crate::math::HORIZONTAL;
use crate::transfer::Transfer;

/// Speed (per second) and height above the ground, as shares of the body's height. A contact begins below the first and ends
/// above the second of each. For a person of 1.8 m: 0.25 and 0.5 m/s, 4 and 7 cm.
const SPEED: [f64; 2] = [0.14, 0.28];
const HEIGHT: [f64; 2] = [0.022, 0.039];

/// Minimum speed of the ground under a walk in place, per second, as a share of the body's height.
const MIN_TREADMILL_SPEED: f64 = 0.07;

/// How far velocities of feet may be from the moving ground's, as a share of its speed.
const TREADMILL_SPREAD: f64 = 0.3;

/// Length of the sum of the feet's velocities as a share of the sum of their lengths, 1 if all point the same way. Feet that are
/// not lifted on their way back have almost 0.
const MIN_AGREEMENT: f64 = 0.8;

/// Height of the source from its lowest to its highest mapped joint at the aligned rest, in source units.
pub fn source_height(map: &ResolvedMap, alignment: &Alignment) -> f64 {
    let heights = map.pairs.iter().map(|pair| alignment.source.position(pair.source).y);
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
    (high - low).max(1e-9)
}

/// Finds the contacts of the source's feet, given by their toes or ankles.
pub fn contacts_of(transfer: &Transfer, feet: &[JointIndex], times: &[f32]) -> SourceContacts {
    let path = |&joint: &JointIndex| times.iter().map(|&time| transfer.source_position(joint, time)).collect();
    let positions: Vec<Vec<DVec3>> = feet.iter().map(path).collect();
    let hips: Vec<DVec3> = times.iter().filter_map(|&time| transfer.source_hips(time)).collect();
    source_contacts(times, &positions, &hips, source_height(transfer.map, transfer.alignment))
}

/// What the feet of a source do, each at the sampled times.
#[derive(Debug)]
pub struct SourceContacts {
    /// Whether a foot is in contact with the ground, by foot and time.
    pub touching: Vec<Vec<bool>>,
    pub ground: Ground,
}

impl SourceContacts {
    /// Whether a hand or knee is in contact with the same ground at each time. `positions` are relative to the ground's height.
    pub fn of_part(&self, times: &[f32], positions: &[DVec3], body_height: f64) -> Vec<bool> {
        // Below the ground, as far as above it: what is further down is beside what the feet stand on.
        let relative = positions.iter().zip(&self.ground.travel).map(|(at, travel)| *at - *travel);
        let relative: Vec<DVec3> = relative.map(|at| DVec3 { y: at.y.abs(), ..at }).collect();
        contacts(times, &relative, 0.0, body_height, TREADMILL_SPREAD * self.ground.speed)
    }
}

/// How the ground moves below a figure that walks or runs in place, in source units.
#[derive(Debug)]
pub struct Ground {
    /// How far it has moved, by time.
    pub travel: Vec<DVec3>,
    /// Its mean speed per second; 0 if it stands still.
    pub speed: f64,
}

/// Finds the contacts of feet. `positions` are those of the toes or ankles, by foot and time, in a frame with +Y up; `hips` is the
/// path of the hips, and `body_height` is in the same unit.
pub fn source_contacts(times: &[f32], positions: &[Vec<DVec3>], hips: &[DVec3], body_height: f64) -> SourceContacts {
    let ground = moving_ground(times, positions, hips, body_height);
    let on_ground = |positions: &Vec<DVec3>| {
        let relative: Vec<DVec3> = positions.iter().zip(&ground.travel).map(|(at, travel)| *at - *travel).collect();
        foot_contacts(times, &relative, body_height, TREADMILL_SPREAD * ground.speed)
    };
    SourceContacts { touching: positions.iter().map(on_ground).collect(), ground }
}

/// Whether the foot is in contact at each time: its own low height is the ground's.
fn foot_contacts(times: &[f32], positions: &[DVec3], body_height: f64, slack: f64) -> Vec<bool> {
    let speed = |at: usize| velocity(times, positions, at).length();
    let slow = (0..positions.len()).filter(|&at| speed(at) < SPEED[0] * body_height + slack);
    let ground = low_height(slow.map(|at| positions[at].y).collect());
    contacts(times, positions, ground, body_height, slack)
}

/// Whether a foot, hand or knee is in contact at each time. `slack` is added to the speed that it may have in contact.
fn contacts(times: &[f32], positions: &[DVec3], ground: f64, body_height: f64, slack: f64) -> Vec<bool> {
    let speed = |at: usize| velocity(times, positions, at).length();
    let max_speed = SPEED.map(|share| share * body_height + slack);
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
    sort_by(&mut heights, f64::total_cmp);
    heights.get(at).copied().unwrap_or(f64::INFINITY)
}

/// The ground below a figure that walks or runs in place moves like its feet while they are low: at their median velocity or,
/// if only their directions agree, at that of whichever foot is low. It stands still if the hips travel, the feet are slow, or
/// their velocities have little in common.
fn moving_ground(times: &[f32], positions: &[Vec<DVec3>], hips: &[DVec3], body_height: f64) -> Ground {
    let low = low_velocities(times, positions, body_height);
    let all: Vec<DVec3> = low.iter().flatten().copied().collect();
    let travel = match (hips, times) {
        ([first, .., last], [from, .., to]) => {
            ((*last - *first) * HORIZONTAL).length() / f64::from(to - from).max(1e-9)
        }
        _ => f64::INFINITY,
    };
    let is_treadmill =
        |speed: f64, slowest: f64| slowest > MIN_TREADMILL_SPEED * body_height && travel < TREADMILL_SPREAD * speed;
    let middle = DVec3::new(median(all.iter().map(|low| low.x)), 0.0, median(all.iter().map(|low| low.z)));
    let speed = middle.length();
    let spread = median(all.iter().map(|low| (*low - middle).length()));
    if spread < TREADMILL_SPREAD * speed && is_treadmill(speed, speed) {
        return Ground { travel: times.iter().map(|&time| middle * f64::from(time)).collect(), speed };
    }
    // Feet that stand for a quarter of the time stand on ground that stands.
    let mut speeds: Vec<f64> = all.iter().map(|low| low.length()).collect();
    sort_by(&mut speeds, f64::total_cmp);
    let slowest = speeds.get(speeds.len() / 4).copied().unwrap_or(0.0);
    let sum = all.iter().sum::<DVec3>().length();
    let speed = sum / all.len().max(1) as f64;
    if sum <= MIN_AGREEMENT * speeds.iter().sum::<f64>() || !is_treadmill(speed, slowest) {
        return Ground { travel: vec![DVec3::ZERO; times.len()], speed: 0.0 };
    }
    let known = times.iter().zip(&low).filter(|(_, low)| !low.is_empty());
    let known = known.map(|(&time, low)| (time, low.iter().sum::<DVec3>() / low.len() as f64));
    Ground { travel: integrated(times, &known.collect::<Vec<_>>()), speed }
}

/// Horizontal velocities of the feet that are low, by time.
fn low_velocities(times: &[f32], positions: &[Vec<DVec3>], body_height: f64) -> Vec<Vec<DVec3>> {
    let mut low = vec![Vec::new(); times.len()];
    for positions in positions {
        let ground = low_height(positions.iter().map(|position| position.y).collect());
        for (at, low) in low.iter_mut().enumerate() {
            if positions[at].y - ground < HEIGHT[0] * body_height {
                low.push(velocity(times, positions, at) * HORIZONTAL);
            }
        }
    }
    low
}

/// Integrates velocities that are known at some times, in between linear and beyond them constant.
fn integrated(times: &[f32], known: &[(f32, DVec3)]) -> Vec<DVec3> {
    let velocity = |time: f32| match known.partition_point(|(known, _)| *known <= time) {
        0 => known.first().map_or(DVec3::ZERO, |first| first.1),
        next if next == known.len() => known[next - 1].1,
        next => {
            let [(from, before), (to, after)] = [known[next - 1], known[next]];
            before.lerp(after, f64::from((time - from) / (to - from)))
        }
    };
    let mut travel = DVec3::ZERO;
    let mut travels = Vec::with_capacity(times.len());
    for (at, &time) in times.iter().enumerate() {
        let before = times[at.saturating_sub(1)];
        travel += velocity(before).midpoint(velocity(time)) * f64::from(time - before);
        travels.push(travel);
    }
    travels
}

/// Ranges in which all are true.
pub fn ranges(touching: &[bool]) -> Vec<Range<usize>> {
    let starts = (0..touching.len()).filter(|&at| touching[at] && (at == 0 || !touching[at - 1]));
    let end = |from: usize| (from..touching.len()).find(|&at| !touching[at]).unwrap_or(touching.len());
    starts.map(|from| from..end(from)).collect()
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    let at = values.len() / 2;
    sort_by(&mut values, f64::total_cmp);
    values.get(at).copied().unwrap_or(0.0)
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
        let found = foot_contacts(&times, &positions, height, 0.0);
        for frame in [2, 5, 15, 25, 65, 75, 85] {
            assert!(found[frame], "in contact at frame {frame}");
        }
        for frame in [36, 45, 54] {
            assert!(!found[frame], "in the air at frame {frame}");
        }
    }

    /// A second of steps in place: each foot is on the ground for half of it, and may go back meanwhile.
    fn uneven_steps(goes_back: bool) -> SourceContacts {
        let times: Vec<f32> = (0..=60).map(|frame| frame as f32 / 60.0).collect();
        let foot = |phase: f32| {
            let at = |time: &f32| {
                let part = f64::from((time + phase).fract());
                let (stance, swing) = ((part / 0.5).min(1.0), ((part - 0.5) / 0.5).max(0.0));
                // It starts slowly and ends fast.
                let back = if goes_back { 0.8 * (stance.powi(2) - swing) } else { 0.0 };
                DVec3::new(0.0, 0.3 * (std::f64::consts::PI * swing).sin().max(0.0).sqrt(), -back)
            };
            times.iter().map(at).collect::<Vec<DVec3>>()
        };
        let hips = vec![DVec3::Y; times.len()];
        source_contacts(&times, &[foot(0.0), foot(0.5)], &hips, 1.8)
    }

    #[test]
    fn the_ground_moves_with_feet_of_uneven_speed() {
        let SourceContacts { touching, ground } = uneven_steps(true);
        // 0.8 m in each half of a second.
        assert!((ground.speed - 1.6).abs() < 0.3, "{}", ground.speed);
        let travelled = ground.travel[60].z - ground.travel[0].z;
        assert!((travelled + 1.6).abs() < 0.3, "{travelled}");
        for (foot, frames) in [(0, [10, 20, 25]), (1, [40, 50, 55])] {
            assert!(frames.iter().all(|&frame| touching[foot][frame]), "{:?}", touching[foot]);
        }
    }

    #[test]
    fn the_ground_stands_below_feet_that_step_on_the_spot() {
        assert_eq!(uneven_steps(false).ground.speed, 0.0);
    }

    #[test]
    fn a_foot_that_is_never_slow_has_no_contacts() {
        let positions: Vec<DVec3> = (0..30).map(|frame| DVec3::new(0.0, 0.0, 0.1 * f64::from(frame))).collect();
        let times: Vec<f32> = (0..30).map(|frame| frame as f32 / 30.0).collect();
        assert!(!foot_contacts(&times, &positions, 1.8, 0.0).contains(&true));
        assert!(foot_contacts(&[], &[], 1.8, 0.0).is_empty());
    }
}
