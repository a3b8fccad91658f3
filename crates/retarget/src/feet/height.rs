//! Height of the body above the ground before its feet are planted: in motion capture, bodies often hover or sink.

use gaitway_character::anim::JointIndex;
use gaitway_character::sort::sort_by;

use super::body::means;
use super::plan::LegContacts;
use crate::math::smooth;
use crate::pose::{WorldPose, is_within};
use crate::times::near;
use crate::transfer::{Hips, Transfer};

/// A body that hovers higher than this share of the hips' height does so on purpose, unless all its contacts share a floor.
const MAX_HOVER: f64 = 0.25;

/// Contacts whose soles differ by less than this share of the hips' height are on one floor.
const MAX_UNEVENNESS: f64 = 0.08;

/// A foot that is in contact for less than this share of the time says nothing about a floor.
const MIN_CONTACT: f64 = 0.1;

/// No jump takes longer than this.
const MAX_JUMP_SECS: f64 = 1.5;

/// Shares of the hips' height: a body that floats for a while is brought down below the first, and stands on something above the
/// second. In between, it is brought down in part.
const MAX_FLOAT: [f64; 2] = [0.25, 0.35];

/// Returns the height of what a clip's feet stand on, given the heights of their soles and when they are in contact: the first
/// quartile of the heights in contact, since the minimum is often a glitch of the capture. Without contacts, the 5th percentile of
/// the lower sole's height. `None` without feet.
pub fn standing_height(feet: &[(Vec<f64>, &[bool])]) -> Option<f64> {
    let in_contact = |(heights, touching): &(Vec<f64>, &[bool])| {
        let heights = heights.iter().zip(*touching).filter(|(_, touching)| **touching);
        heights.map(|(height, _)| *height).collect::<Vec<f64>>()
    };
    let mut heights: Vec<f64> = feet.iter().flat_map(in_contact).collect();
    let mut at = heights.len() / 4;
    if heights.is_empty() {
        let lower = |at: usize| feet.iter().map(|(heights, _)| heights[at]).fold(f64::INFINITY, f64::min);
        heights = (0..feet.first()?.0.len()).map(lower).collect();
        at = heights.len() / 20;
    }
    sort_by(&mut heights, f64::total_cmp);
    heights.get(at).copied()
}

/// Returns by how much the body is too high above the ground that its soles rest on. `None` without legs.
pub fn hover(transfer: &Transfer, legs: &[LegContacts], poses: &[WorldPose], ground: f64) -> Option<f64> {
    let heights = |leg: &LegContacts| poses.iter().map(|pose| leg.sole.lowest(pose)).collect();
    let feet: Vec<_> = legs.iter().map(|leg| (heights(leg), leg.touching.as_slice())).collect();
    let standing = standing_height(&feet)?;
    let hover = standing - ground;
    let is_ground = |hips: &Hips| hover.abs() < MAX_HOVER * hips.height || is_floor(&feet, standing, hips.height);
    Some(if transfer.hips.is_some_and(is_ground) { hover } else { 0.0 })
}

/// Whether both feet stand at this height whenever they are in contact: the floor of a capture that lost its own, however high.
fn is_floor(feet: &[(Vec<f64>, &[bool])], standing: f64, height: f64) -> bool {
    let stands = |(heights, touching): &(Vec<f64>, &[bool])| {
        let contacts = || heights.iter().zip(*touching).filter(|(_, touching)| **touching);
        let is_even = contacts().all(|(sole, _)| (sole - standing).abs() < MAX_UNEVENNESS * height);
        is_even && contacts().count() as f64 > MIN_CONTACT * heights.len() as f64
    };
    feet.len() > 1 && feet.iter().all(stands)
}

/// Returns the height of the lower sole.
fn lowest(legs: &[LegContacts], pose: &WorldPose) -> f64 {
    legs.iter().map(|leg| leg.sole.lowest(pose)).fold(f64::INFINITY, f64::min)
}

/// Returns how far the body floats at each time: the height above which both soles stay for longer than any jump, since the
/// capture has lost its floor. Smoothed over time.
pub fn floats(times: &[f32], legs: &[LegContacts], poses: &[WorldPose], ground: f64, height: f64) -> Vec<f64> {
    let heights: Vec<f64> = poses.iter().map(|pose| lowest(legs, pose) - ground).collect();
    let secs = 0.5 * MAX_JUMP_SECS;
    let kept = |at: usize| {
        let kept = heights[near(times, at, secs)].iter().copied().fold(f64::INFINITY, f64::min).max(0.0);
        kept * smooth((MAX_FLOAT[1] * height - kept) / ((MAX_FLOAT[1] - MAX_FLOAT[0]) * height))
    };
    let kept: Vec<f64> = (0..times.len()).map(kept).collect();
    // Each range around this time contains it, so its minimum is at most the current height, and so is their mean.
    means(times, &kept, secs)
}

/// Lowers the hips and their descendants, as well as shins and feet that are parented elsewhere. `by` takes the index of a
/// pose.
pub fn lower(transfer: &Transfer, legs: &[LegContacts], poses: &mut [WorldPose], by: impl Fn(usize) -> f64) {
    let Some(hips) = transfer.hips_carrier() else { return };
    let skeleton = transfer.target_skeleton;
    let tops = legs.iter().flat_map(|LegContacts { leg, .. }| [leg.knee, leg.ankle]);
    let tops: Vec<JointIndex> = tops.chain([hips]).collect();
    let is_lowered = |joint: &JointIndex| tops.iter().any(|&top| is_within(skeleton, *joint, top));
    let lowered: Vec<JointIndex> = skeleton.joints().filter(is_lowered).collect();
    for (at, pose) in poses.iter_mut().enumerate() {
        lowered.iter().for_each(|joint| pose.positions[joint.get()].y -= by(at));
    }
}
