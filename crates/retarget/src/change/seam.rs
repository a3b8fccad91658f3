//! Makes a clip loop: measures how far its end is from its start, and blends the two.
//!
//! Both ends meet halfway: each moves by half of the difference, along an S-curve that fades out over the chosen time. Keys
//! outside of it are untouched. A character that travels or turns keeps doing so.

use std::fmt;

use gaitway_character::anim::{
    Interpolation, JointIndex, Pose, SampleCursor, Skeleton, model_from_joint, model_from_single_joint,
};
use glam::{Affine3A, DQuat, DVec3, Quat};
use serde::Serialize;

use super::path::{model_from_parent, traveller};
use super::track::{Target, Track, Tracks, rotation};
use crate::math::{HORIZONTAL, angle_between, slerp, unit, yaw_of};
use crate::pose::is_within;

/// Rate of the keys that are added where the curve bends.
const BLENDED_PER_SEC: f32 = 30.0;
/// A character that ends farther over the ground from its start than this share of its height travels; below, it drifts.
const MIN_TRAVEL: f64 = 0.15;
/// A character that faces another direction by more than this at its end turns; below, it drifts.
const MIN_TURN_RADIANS: f64 = 0.35;

/// How far the end of a clip is from its start. Displayed as “1.2° and 3.4 cm apart”, plus travel and turn if there are any.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Seam {
    /// The largest angle between a joint's local rotation at the end and at the start, without the turn.
    pub degrees_max: f64,
    /// How far the joint that carries the character is from where it starts, without travel over the ground.
    pub metres: f64,
    /// How far it travels over the ground, if that is more than drift; else 0.
    pub travel_metres: f64,
    /// How far it turns about the vertical, if that is more than drift; else 0. Positive is counter-clockwise from above.
    pub turn_degrees: f64,
}

impl fmt::Display for Seam {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { degrees_max, metres, travel_metres, turn_degrees } = *self;
        write!(f, "{degrees_max:.1}° and {:.1} cm apart", 100.0 * metres)?;
        match (travel_metres != 0.0, turn_degrees != 0.0) {
            (false, false) => Ok(()),
            (true, false) => write!(f, ", not counting {travel_metres:.2} m of travel"),
            (false, true) => write!(f, ", not counting a turn of {turn_degrees:.0}°"),
            (true, true) => write!(f, ", not counting {travel_metres:.2} m of travel and a turn of {turn_degrees:.0}°"),
        }
    }
}

/// How the character moves from the start of a clip to its end.
struct Travel {
    /// The joint that carries the character.
    joint: JointIndex,
    /// Whether it travels over the ground, and whether it turns; a loop keeps both.
    travels: bool,
    turns: bool,
    /// About the vertical.
    turn_radians: f64,
    /// In model space.
    moved: DVec3,
}

fn travel(tracks: &Tracks, skeleton: &Skeleton, joint: JointIndex) -> Travel {
    let clip = tracks.clone().build("", skeleton);
    let pose = |time_secs: f32| {
        let mut pose = skeleton.rest().clone();
        clip.sample(skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
        pose
    };
    let place = |pose: &Pose| {
        let (_, turn, at) = model_from_single_joint(skeleton, pose, joint).to_scale_rotation_translation();
        (at.as_dvec3(), unit(turn.as_dquat()))
    };
    let (first, last) = (pose(0.0), pose(clip.duration_secs()));
    let ((start, first_turn), (end, last_turn)) = (place(&first), place(&last));
    let moved = end - start;
    let turn_radians = yaw_of(last_turn * first_turn.inverse());
    Travel {
        joint,
        travels: (moved * HORIZONTAL).length() > MIN_TRAVEL * height(skeleton, &first, joint),
        turns: turn_radians.abs() > MIN_TURN_RADIANS,
        turn_radians,
        moved,
    }
}

/// Returns the height of the highest joint of a character, which `root` carries: `root` itself often lies on the ground.
fn height(skeleton: &Skeleton, pose: &Pose, root: JointIndex) -> f64 {
    let mut world = Vec::new();
    model_from_joint(skeleton, pose, Affine3A::IDENTITY, &mut world);
    let carried = skeleton.joints().filter(|&joint| is_within(skeleton, joint, root));
    carried.map(|joint| f64::from(world[joint.get()].translation.y)).fold(0.0, f64::max)
}

fn measure(tracks: &Tracks, skeleton: &Skeleton, travel: &Travel) -> Seam {
    let rotations = tracks.tracks.iter().filter(|track| track.is_rotation());
    let apart = rotations.map(|track| angle_between(DQuat::IDENTITY, apart(track, skeleton, travel)));
    Seam {
        degrees_max: apart.fold(0.0, f64::max).to_degrees(),
        metres: if travel.travels { travel.moved.y.abs() } else { travel.moved.length() },
        travel_metres: if travel.travels { (travel.moved * HORIZONTAL).length() } else { 0.0 },
        turn_degrees: if travel.turns { travel.turn_radians.to_degrees() } else { 0.0 },
    }
}

/// Blends the seam over `secs` at either side, at most half the clip, and returns what it was before. Steps stay.
pub fn blend(tracks: &mut Tracks, skeleton: &Skeleton, secs: f32) -> Seam {
    let Some(joint) = traveller(tracks, skeleton) else { return Seam::default() };
    let travel = travel(tracks, skeleton, joint);
    let seam = measure(tracks, skeleton, &travel);
    let duration_secs = tracks.duration_secs;
    if duration_secs <= 0.0 {
        return seam;
    }
    let secs = secs.clamp(0.0, 0.5 * duration_secs);
    for track in &mut tracks.tracks {
        if track.interpolation == Interpolation::Step || track.times.len() < 2 {
            continue;
        }
        insert_keys(track, duration_secs, secs);
        if track.is_rotation() {
            blend_rotation(track, skeleton, &travel, duration_secs, secs);
        } else {
            blend_numbers(track, skeleton, &travel, duration_secs, secs);
        }
    }
    seam
}

/// Adds keys where blending will bend the curve.
fn insert_keys(track: &mut Track, duration_secs: f32, secs: f32) {
    if track.times[0] > 0.0 {
        let first = track.key_at(0.0);
        track.times.insert(0, 0.0);
        track.values.splice(0..0, first);
    }
    track.hold_until(duration_secs);
    let count = (secs * BLENDED_PER_SEC).ceil() as usize;
    for key in 1..=count {
        let away = secs * key as f32 / count as f32;
        track.insert(away);
        track.insert(duration_secs - away);
    }
}

/// Returns the share of the difference by which a key moves, and its slope per second: 0.5 at the end of the clip, −0.5 at
/// its start, 0 farther than `secs` from both.
fn share(time_secs: f32, duration_secs: f32, secs: f32) -> (f64, f64) {
    let (time, duration, secs) = (f64::from(time_secs), f64::from(duration_secs), f64::from(secs));
    let to_end = duration - time;
    let (away, sign) = if to_end < time { (to_end, 1.0) } else { (time, -1.0) };
    if secs <= 0.0 {
        return (if away <= 0.0 { 0.5 * sign } else { 0.0 }, 0.0);
    }
    if away >= secs {
        return (0.0, 0.0);
    }
    let part = 1.0 - away / secs;
    // `part` grows towards the end and shrinks from the start, where the sign is negative too: the slopes are equal.
    (0.5 * sign * part * part * (3.0 - 2.0 * part), 3.0 * part * (1.0 - part) / secs)
}

fn blend_numbers(track: &mut Track, skeleton: &Skeleton, travel: &Travel, duration_secs: f32, secs: f32) {
    let ends = track.value(0).iter().zip(track.last_value());
    let mut apart: Vec<f64> = ends.map(|(start, end)| f64::from(*start) - f64::from(*end)).collect();
    if track.target == Target::Translation(travel.joint) && travel.travels {
        let above = model_from_parent(skeleton, travel.joint).matrix3;
        let vertical = (above * DVec3::new(apart[0], apart[1], apart[2])) * DVec3::Y;
        apart = (above.inverse() * vertical).to_array().to_vec();
    }
    let (stride, width, is_spline) = (track.stride(), track.width, track.is_spline());
    for (key, &time) in track.times.iter().enumerate() {
        let (part, slope) = share(time, duration_secs, secs);
        for (axis, &apart) in apart.iter().enumerate() {
            let mut add = |entry: usize, amount: f64| {
                let number = &mut track.values[key * stride + entry * width + axis];
                *number = (f64::from(*number) + amount) as f32;
            };
            if is_spline {
                add(0, apart * slope);
                add(1, apart * part);
                add(2, apart * slope);
            } else {
                add(0, apart * part);
            }
        }
    }
}

fn is_turn(track: &Track, travel: &Travel) -> bool {
    travel.turns && track.target == Target::Rotation(travel.joint)
}

/// Returns the rotation from the end to the start in the space of the parent, without the turn if the character turns.
fn apart(track: &Track, skeleton: &Skeleton, travel: &Travel) -> DQuat {
    let apart = rotation(track.value(0)) * rotation(track.last_value()).inverse();
    if !is_turn(track, travel) {
        return apart;
    }
    let above = model_from_parent(skeleton, travel.joint).to_scale_rotation_translation().1;
    let in_model = above * apart * above.inverse();
    let yaw = DQuat::from_rotation_y(yaw_of(in_model));
    above.inverse() * (yaw.inverse() * in_model) * above
}

fn blend_rotation(track: &mut Track, skeleton: &Skeleton, travel: &Travel, duration_secs: f32, secs: f32) {
    let is_turn = is_turn(track, travel);
    let apart = apart(track, skeleton, travel);
    let (stride, width, is_spline) = (track.stride(), track.width, track.is_spline());
    for (key, &time) in track.times.iter().enumerate() {
        let (mut part, mut slope) = share(time, duration_secs, secs);
        if is_turn {
            // The rest of the difference doesn't commute with the turn, so all of it goes to the end.
            let factor = if part > 0.0 { 2.0 } else { 0.0 };
            (part, slope) = (factor * part, factor * slope);
        }
        let turned = |part: f64| slerp(DQuat::IDENTITY, apart, part.abs());
        let correction = |part: f64| if part < 0.0 { turned(part).inverse() } else { turned(part) };
        let now = correction(part);
        // The derivative of the correction over time, for spline tangents.
        const STEP: f64 = 1e-4;
        let change = (correction(part + STEP) - correction(part - STEP)) * (slope / (2.0 * STEP));
        let entries = &mut track.values[key * stride..(key + 1) * stride];
        let value = Quat::from_slice(&entries[if is_spline { width } else { 0 }..]).as_dquat();
        for (index, entry) in entries.chunks_exact_mut(width).enumerate() {
            let is_tangent = is_spline && index != 1;
            let old = Quat::from_slice(entry).as_dquat();
            let new = if is_tangent { now * old + change * value } else { now * old };
            new.as_quat().write_to_slice(entry);
        }
    }
}
