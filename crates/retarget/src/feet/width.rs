//! Keeps feet as far apart as the source's, in proportion to the hips: with rotations alone, legs that are long for the width of
//! the hips would cross.

use gaitway_character::asset::Slot;
use glam::DVec3;

use crate::math::{HORIZONTAL, limited};
use crate::pose::WorldPose;
use crate::transfer::Transfer;

/// Feet are moved apart by at most this share of the hips' height.
const MAX_GAP: f64 = 0.1;

struct Stance {
    /// Distance between the hip joints.
    hips: f64,
    /// How far the left ankle is to the left of the right one; negative if the legs cross.
    feet: f64,
    /// Unit vector from the right hip joint to the left one, over the ground.
    to_left: DVec3,
}

/// `joints` are the left and right hip, then the left and right ankle.
fn stance(joints: [DVec3; 4]) -> Option<Stance> {
    let [left_hip, right_hip, left_ankle, right_ankle] = joints;
    let across = (left_hip - right_hip) * HORIZONTAL;
    let to_left = across.try_normalize()?;
    Some(Stance { hips: across.length(), feet: (left_ankle - right_ankle).dot(to_left), to_left })
}

/// Returns how far the left foot moves to the left at each time, and the right one to the right. Feet that are as far apart as
/// the source's, or as the hip joints, stay where they are.
pub fn spreads(transfer: &Transfer, times: &[f32], poses: &[WorldPose], height: f64) -> Vec<DVec3> {
    let slots = [Slot::LeftUpperLeg, Slot::RightUpperLeg, Slot::LeftFoot, Slot::RightFoot];
    let [Some(left_hip), Some(right_hip), Some(left_ankle), Some(right_ankle)] = slots.map(|slot| transfer.pair(slot))
    else {
        return vec![DVec3::ZERO; times.len()];
    };
    let pairs = [left_hip, right_hip, left_ankle, right_ankle];
    let spread = |(pose, &time): (&WorldPose, &f32)| {
        let source = stance(pairs.map(|pair| transfer.source_position(pair.source, time)))?;
        let target = stance(pairs.map(|pair| pose.position(pair.target)))?;
        let wanted = target.hips * (source.feet / source.hips).min(1.0);
        Some(0.5 * limited(wanted - target.feet, 0.0, MAX_GAP * height) * target.to_left)
    };
    poses.iter().zip(times).map(|at| spread(at).unwrap_or_default()).collect()
}
