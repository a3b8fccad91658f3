//! Bounds how fast a correction of a joint may turn, so that planted feet and kept contacts never snap a limb.

use glam::DQuat;

use crate::math::{angle_between, slerp};

/// Clamps rotations to `max_radians` and their speed to `radians_per_sec`, beginning before a fast change and ending after it.
/// Rotations that are small and slow enough stay as they are. `max_radians` is far enough from a half turn for the mean of two
/// of them to be well defined; at 60°, a mean is up to 1.16 times as fast as they are.
pub fn limit_turns(times: &[f32], turns: &mut [DQuat], max_radians: f64, radians_per_sec: f64) {
    for turn in &mut *turns {
        *turn = towards(DQuat::IDENTITY, *turn, max_radians);
    }
    let max_turn = |at: usize| radians_per_sec * f64::from(times[at] - times[at - 1]);
    let is_slow = |at: usize| angle_between(turns[at - 1], turns[at]) <= max_turn(at);
    if (1..turns.len()).all(is_slow) {
        return;
    }
    // A limited rate lags behind. A pass forwards and one backwards lag equally in opposite directions, so their mean does not.
    let mut forwards = turns.to_vec();
    for at in 1..turns.len() {
        forwards[at] = towards(forwards[at - 1], turns[at], max_turn(at));
    }
    for at in (1..turns.len()).rev() {
        turns[at - 1] = towards(turns[at], turns[at - 1], max_turn(at));
    }
    for (turn, forwards) in turns.iter_mut().zip(forwards) {
        *turn = slerp(*turn, forwards, 0.5);
    }
}

fn towards(from: DQuat, to: DQuat, max_radians: f64) -> DQuat {
    let angle = angle_between(from, to);
    if angle <= max_radians { to } else { slerp(from, to, max_radians / angle) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_becomes_a_ramp_around_it() {
        let times: Vec<f32> = (0..60).map(|frame| frame as f32 / 60.0).collect();
        let jump = DQuat::from_rotation_x(1.0);
        let mut turns: Vec<DQuat> = (0..60).map(|at| if at < 30 { DQuat::IDENTITY } else { jump }).collect();
        limit_turns(&times, &mut turns, 1.0, 4.0);
        let largest = turns.windows(2).map(|pair| angle_between(pair[0], pair[1])).fold(0.0, f64::max);
        assert!(largest < 4.0 / 60.0 + 1e-6, "{largest}");
        assert_eq!((turns[10], turns[50]), (DQuat::IDENTITY, jump));
        let middle = angle_between(turns[29].slerp(turns[30], 0.5), DQuat::from_rotation_x(0.5));
        assert!(middle < 1e-6, "{middle}");
    }

    /// Corrections that turn about other axes from one frame to the next, as of a leg whose foot passes its hip.
    #[test]
    fn no_change_is_too_fast() {
        let times: Vec<f32> = (0..300).map(|frame| frame as f32 / 60.0).collect();
        let turn = |frame: u32| {
            let angle = f64::from(frame * frame % 17) - 8.0;
            DQuat::from_rotation_x(0.4 * angle) * DQuat::from_rotation_z(f64::from(frame % 7) - 3.0)
        };
        let mut turns: Vec<DQuat> = (0..300).map(turn).collect();
        limit_turns(&times, &mut turns, 1.0, 4.0);
        for pair in turns.windows(2) {
            let angle = angle_between(pair[0], pair[1]);
            assert!(angle < 1.16 * 4.0 / 60.0 + 1e-6, "{angle}");
        }
        assert!(turns.iter().all(|&turn| angle_between(turn, DQuat::IDENTITY) < 1.0 + 1e-6));
    }

    #[test]
    fn slow_turns_stay_as_they_are() {
        let times = [0.0, 0.5, 1.0];
        let turns = [0.0, 0.3, -0.1].map(DQuat::from_rotation_z);
        let mut limited = turns;
        limit_turns(&times, &mut limited, 1.0, 1.0);
        assert_eq!(limited, turns);
    }
}
