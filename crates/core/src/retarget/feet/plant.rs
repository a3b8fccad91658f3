//! Planted feet: while the source's foot is in contact, the target's toes stay in one place on the ground. The whole body is
//! lowered (or raised) to where its feet are lowest in contact; from there the legs reach, and the hips come down further
//! when a leg would have to be longer than it is.

use std::ops::Range;

use glam::{DQuat, DVec3};

use super::contacts::{contacts, source_height};
use super::leg::{Leg, drop_to_reach, solve_leg};
use crate::anim::{Clip, JointIndex, Keys, Property};
use crate::asset::Slot;
use crate::retarget::keys::channel::NewChannel;
use crate::retarget::keys::resample::union;
use crate::retarget::pose::{Scratch, WorldPose, is_within};
use crate::retarget::transfer::{Hips, RemovedTravel, Transfer, removed_travel, rotation_laws};

/// Transition into and out of a contact.
const EASE_SECS: f64 = 0.12;

/// A body that hovers by more than this share of the hips' height does so on purpose.
const MAX_HOVER: f64 = 0.25;

/// A foot in contact that is further off the ground than this share of the hips' height stands on something else.
const MAX_GROUND_OFFSET: f64 = 0.08;

/// Maximum distance between keys of a planted clip.
const MAX_STEP_SECS: f32 = 1.0 / 30.0;

/// A leg with the contacts of the source's foot, as ranges of the sampled times.
struct LegContacts {
    leg: Leg,
    contacts: Vec<Range<usize>>,
}

/// How far a leg's foot is moved at each time.
struct Plan {
    leg: Leg,
    moves: Vec<DVec3>,
}

/// Returns all channels of the clip with planted feet, or None if no mapped foot is ever in contact. `resampled` lists the
/// joints whose keys in `clip` are not the source's own.
pub fn planted_channels(transfer: &Transfer, clip: &Clip, resampled: &[JointIndex]) -> Option<Vec<NewChannel>> {
    let times = dense_times(transfer.tracks.clip);
    let mut scratch = Scratch::default();
    let mut poses: Vec<WorldPose> = times.iter().map(|&time| transfer.target_pose(clip, time, &mut scratch)).collect();
    let legs = legs_in_contact(transfer, &times);
    let hover = hover(transfer, &legs, &poses)?;
    lower(transfer, &mut poses, hover);
    let (laws, _) = rotation_laws(transfer);
    let removed = removed_travel(transfer, &laws, &times);
    let plans: Vec<Plan> = legs.into_iter().map(|leg| plan(transfer, leg, &times, &poses, &removed)).collect();
    let drops = drops(&times, &poses, &plans);

    let rotations = leg_rotations(transfer, &poses, &plans, &drops);
    let is_lowered = hover != 0.0 || drops.iter().any(|&drop| drop > 0.0);
    let hips = transfer.hips_pair().map(|pair| pair.target).filter(|_| is_lowered);
    let is_replaced = |joint: JointIndex, property: Property| match property {
        Property::Rotation => rotations.iter().any(|(other, _)| *other == joint),
        Property::Translation => hips == Some(joint),
        Property::Scale | Property::MorphWeights => false,
    };
    let kept = clip.channels().iter().filter(|channel| !is_replaced(channel.joint, channel.keys.property()));
    let mut channels: Vec<NewChannel> = kept
        .map(|channel| NewChannel {
            joint: channel.joint,
            interpolation: channel.interpolation,
            times: clip.timelines()[channel.timeline as usize].clone(),
            keys: channel.keys.clone(),
            resampled: resampled.contains(&channel.joint),
        })
        .collect();
    if let Some(hips) = hips {
        let translations = poses.iter().zip(&drops).map(|(pose, &drop)| {
            let position = pose.position(hips) - DVec3::Y * drop;
            pose.parent_frame(transfer.target_skeleton, hips).inverse().transform_point3(position).as_vec3()
        });
        channels.push(NewChannel::resampled(hips, times.clone(), Keys::Translation(translations.collect())));
    }
    for (joint, keys) in rotations {
        let keys = keys.into_iter().map(DQuat::as_quat).collect();
        channels.push(NewChannel::resampled(joint, times.clone(), Keys::Rotation(keys)));
    }
    Some(channels)
}

/// The clip's key times, and more where these are far apart.
fn dense_times(clip: &Clip) -> Vec<f32> {
    let keys = union(clip.timelines().iter().map(Vec::as_slice));
    let mut times: Vec<f32> = Vec::with_capacity(keys.len());
    for &key in &keys {
        if let Some(&before) = times.last() {
            let parts = ((key - before) / MAX_STEP_SECS).ceil().clamp(1.0, 1000.0) as usize;
            let step = (key - before) / parts as f32;
            times.extend((1..parts).map(|part| before + step * part as f32));
        }
        times.push(key);
    }
    times
}

/// Legs of which hip, knee and ankle are mapped.
fn legs_in_contact(transfer: &Transfer, times: &[f32]) -> Vec<LegContacts> {
    let sides = [
        [Slot::LeftUpperLeg, Slot::LeftLowerLeg, Slot::LeftFoot, Slot::LeftToes],
        [Slot::RightUpperLeg, Slot::RightLowerLeg, Slot::RightFoot, Slot::RightToes],
    ];
    let leg = |[hip, knee, ankle, toes]: [Slot; 4]| {
        let (hip, knee, ankle) = (transfer.pair(hip)?, transfer.pair(knee)?, transfer.pair(ankle)?);
        let toes = transfer.pair(toes).unwrap_or(ankle);
        let leg = Leg { hip: hip.target, knee: knee.target, ankle: ankle.target, toes: toes.target };
        Some(LegContacts { leg, contacts: contact_ranges(transfer, toes.source, times) })
    };
    sides.into_iter().filter_map(leg).collect()
}

/// When a foot of the source is in contact.
fn contact_ranges(transfer: &Transfer, toes: JointIndex, times: &[f32]) -> Vec<Range<usize>> {
    let positions: Vec<DVec3> = times.iter().map(|&time| transfer.source_pose(time).position(toes)).collect();
    let in_contact = contacts(times, &positions, source_height(transfer.map, transfer.alignment));
    let starts = (0..times.len()).filter(|&at| in_contact[at] && (at == 0 || !in_contact[at - 1]));
    let end = |from: usize| (from..times.len()).find(|&at| !in_contact[at]).unwrap_or(times.len());
    starts.map(|from| from..end(from)).collect()
}

/// Height of the toes above where they rest.
fn height_above_rest(transfer: &Transfer, leg: &Leg, pose: &WorldPose) -> f64 {
    pose.position(leg.toes).y - transfer.alignment.target.position(leg.toes).y
}

/// By how much the body is too high: the first quartile of its feet's heights in contact, because the minimum is often a
/// slip of the capture. None without contacts.
fn hover(transfer: &Transfer, legs: &[LegContacts], poses: &[WorldPose]) -> Option<f64> {
    let mut heights = Vec::new();
    for LegContacts { leg, contacts } in legs {
        let in_contact = contacts.iter().flat_map(|contact| &poses[contact.clone()]);
        heights.extend(in_contact.map(|pose| height_above_rest(transfer, leg, pose)));
    }
    if heights.is_empty() {
        return None;
    }
    let at = heights.len() / 4;
    let hover = *heights.select_nth_unstable_by(at, f64::total_cmp).1;
    let is_near = transfer.hips.is_some_and(|hips| hover.abs() < MAX_HOVER * hips.height);
    Some(if is_near { hover } else { 0.0 })
}

/// Lowers the hips and their descendants.
fn lower(transfer: &Transfer, poses: &mut [WorldPose], by: f64) {
    let Some(hips) = transfer.hips_pair().map(|pair| pair.target) else { return };
    let skeleton = transfer.target_skeleton;
    let lowered: Vec<JointIndex> = skeleton.joints().filter(|&joint| is_within(skeleton, joint, hips)).collect();
    for pose in poses {
        lowered.iter().for_each(|joint| pose.positions[joint.get()].y -= by);
    }
}

/// Moves a foot so that its toes stay, during each contact, at their mean position, and on the ground if that is near.
fn plan(transfer: &Transfer, leg: LegContacts, times: &[f32], poses: &[WorldPose], removed: &RemovedTravel) -> Plan {
    let LegContacts { leg, contacts } = leg;
    // Under a figure that walks in place the ground moves and the feet with it, so removed travel is added back.
    let toes = |index: usize| poses[index].position(leg.toes) + removed.horizontal(index);
    let mut moves = vec![DVec3::ZERO; times.len()];
    for contact in &contacts {
        let mut place = contact.clone().map(toes).sum::<DVec3>() / contact.len() as f64;
        let heights = poses[contact.clone()].iter().map(|pose| height_above_rest(transfer, &leg, pose));
        let height = heights.sum::<f64>() / contact.len() as f64;
        if transfer.hips.is_some_and(|hips| height.abs() < MAX_GROUND_OFFSET * hips.height) {
            place.y -= height;
        }
        let (from, to) = (contact.start, contact.end - 1);
        let (first, last) = (place - toes(from), place - toes(to));
        for (at, by) in moves.iter_mut().enumerate() {
            let secs = |other: usize| (f64::from(times[at]) - f64::from(times[other])).abs();
            *by += match at {
                at if at < from => first * ease(secs(from)),
                at if at > to => last * ease(secs(to)),
                at => place - toes(at),
            };
        }
    }
    if let Some(hips) = transfer.hips {
        keep_above_ground(hips, &leg, poses, &mut moves);
    }
    Plan { leg, moves }
}

fn keep_above_ground(hips: &Hips, leg: &Leg, poses: &[WorldPose], moves: &mut [DVec3]) {
    for (by, pose) in moves.iter_mut().zip(poses) {
        let lowest = pose.position(leg.toes).y.min(pose.position(leg.ankle).y);
        by.y = by.y.max(hips.target_ground - lowest);
    }
}

/// How far the hips come down at each time for all legs to reach, smooth over time.
fn drops(times: &[f32], poses: &[WorldPose], plans: &[Plan]) -> Vec<f64> {
    let needed: Vec<f64> = poses
        .iter()
        .enumerate()
        .map(|(index, pose)| {
            plans.iter().map(|plan| drop_to_reach(&plan.leg, pose, plan.moves[index])).fold(0.0, f64::max)
        })
        .collect();
    // The mean of the neighbourhood's maxima is never less than what is needed.
    let near = |index: usize| {
        let from = times.partition_point(|&time| f64::from(times[index] - time) > EASE_SECS);
        let to = times.partition_point(|&time| f64::from(time - times[index]) <= EASE_SECS);
        from..to
    };
    let max: Vec<f64> = (0..times.len()).map(|at| needed[near(at)].iter().copied().fold(0.0, f64::max)).collect();
    (0..times.len()).map(|at| max[near(at)].iter().sum::<f64>() / near(at).len() as f64).collect()
}

/// Local rotations of the legs' joints at each time.
fn leg_rotations(
    transfer: &Transfer,
    poses: &[WorldPose],
    plans: &[Plan],
    drops: &[f64],
) -> Vec<(JointIndex, Vec<DQuat>)> {
    let mut rotations: Vec<(JointIndex, Vec<DQuat>)> = Vec::new();
    for Plan { leg, moves } in plans {
        let mut keys: [Vec<DQuat>; 3] = Default::default();
        for ((pose, &by), &drop) in poses.iter().zip(moves).zip(drops) {
            let solved = solve_leg(leg, transfer.target_skeleton, pose, by, drop);
            keys.iter_mut().zip(solved).for_each(|(keys, rotation)| keys.push(rotation));
        }
        rotations.extend([leg.hip, leg.knee, leg.ankle].into_iter().zip(keys));
    }
    rotations
}

/// 1 at the end of a contact, 0 beyond the transition.
fn ease(secs: f64) -> f64 {
    let left = (1.0 - secs / EASE_SECS).clamp(0.0, 1.0);
    left * left * (3.0 - 2.0 * left)
}
