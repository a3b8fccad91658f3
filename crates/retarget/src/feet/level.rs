//! Levels feet that would dig their toes or heels into the ground because they are longer for their legs than the source's.
//! Raising the ankle alone would fold the leg.

use gaitway_character::anim::Skeleton;
use glam::{DQuat, DVec3};

use super::plan::LegContacts;
use crate::limit::limit_turns;
use crate::pose::{WorldPose, is_within};

/// Feet that are deeper in the ground than this share of the hips' height are levelled.
const MAX_DEPTH: f64 = 0.04;

/// How far a foot may be turned, and how fast.
const MAX_TURN_DEGREES: f64 = 60.0;
const MAX_TURN_DEGREES_PER_SEC: f64 = 250.0;

/// Number of halvings in the search for an angle.
const STEPS: usize = 10;

/// Turns the feet of all poses about their ankles, with all descendants. In `rest`, they are flat on the ground.
pub fn level_feet(
    times: &[f32],
    skeleton: &Skeleton,
    rest: &WorldPose,
    legs: &[LegContacts],
    poses: &mut [WorldPose],
    [ground, height]: [f64; 2],
) {
    for leg in legs {
        let ankle = leg.leg.ankle;
        let up = rest.rotation(ankle).conjugate() * DVec3::Y;
        let floor = ground - MAX_DEPTH * height;
        let turn = |pose: &WorldPose| {
            let level = DQuat::from_rotation_arc(pose.rotation(ankle) * up, DVec3::Y);
            level_turn(level, |turn| leg.sole.lowest_turned(pose, ankle, turn) >= floor)
        };
        let mut turns: Vec<DQuat> = poses.iter().map(turn).collect();
        limit_turns(times, &mut turns, MAX_TURN_DEGREES.to_radians(), MAX_TURN_DEGREES_PER_SEC.to_radians());
        let foot: Vec<usize> =
            skeleton.joints().filter(|&joint| is_within(skeleton, joint, ankle)).map(|joint| joint.get()).collect();
        for (pose, turn) in poses.iter_mut().zip(turns).filter(|(_, turn)| *turn != DQuat::IDENTITY) {
            let center = pose.position(ankle);
            for &joint in &foot {
                pose.positions[joint] = center + turn * (pose.positions[joint] - center);
                pose.rotations[joint] = turn * pose.rotations[joint];
            }
        }
    }
}

/// Returns the smallest part of a rotation that is enough, or all of it.
fn level_turn(level: DQuat, is_enough: impl Fn(DQuat) -> bool) -> DQuat {
    if is_enough(DQuat::IDENTITY) {
        return DQuat::IDENTITY;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        if is_enough(DQuat::IDENTITY.slerp(level, middle)) {
            high = middle;
        } else {
            low = middle;
        }
    }
    DQuat::IDENTITY.slerp(level, high)
}
