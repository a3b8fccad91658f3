//! Moves and turns a character along with its path.

use std::collections::{HashMap, HashSet};
use std::f64::consts::TAU;

use gaitway_character::anim::{JointIndex, Skeleton};
use gaitway_character::asset::Asset;
use gaitway_character::sort::collect_set;
use glam::{DAffine3, DQuat, DVec3, Quat, Vec3};

use super::track::{Target, Track, Tracks};
use crate::math::unit;
use crate::pose::{Local, Scratch, WorldPose, ancestry, is_within, locals_of, parent_frame};

/// Returns the joints that carry all others: the animated joints without an animated ancestor.
fn carriers(tracks: &Tracks, skeleton: &Skeleton) -> Vec<JointIndex> {
    let mut is_animated = vec![false; skeleton.len()];
    for track in &tracks.tracks {
        if let Target::Translation(joint) | Target::Rotation(joint) | Target::Scale(joint) = track.target {
            is_animated[joint.get()] = true;
        }
    }
    let has_animated_above =
        |joint: JointIndex| ancestry(skeleton, joint).skip(1).any(|ancestor| is_animated[ancestor.get()]);
    skeleton.joints().filter(|&joint| is_animated[joint.get()] && !has_animated_above(joint)).collect()
}

/// Returns the joint that travels: the first carrier whose translation changes, else the first carrier.
pub fn traveller(tracks: &Tracks, skeleton: &Skeleton) -> Option<JointIndex> {
    let carriers = carriers(tracks, skeleton);
    let moves =
        |joint: &&JointIndex| tracks.find(Target::Translation(**joint)).is_some_and(|track| track.times.len() > 1);
    carriers.iter().find(moves).or(carriers.first()).copied()
}

/// Returns the joints to move the whole character by: the handles of its carriers.
fn handles(tracks: &Tracks, asset: &Asset) -> Vec<JointIndex> {
    let carriers = carriers(tracks, &asset.skeleton);
    let handles = collect_set(carriers.into_iter().map(|carrier| handle(asset, carrier)));
    let has_handle_above =
        |joint: JointIndex| ancestry(&asset.skeleton, joint).skip(1).any(|above| handles.contains(&above));
    handles.iter().copied().filter(|&joint| !has_handle_above(joint)).collect()
}

/// Returns a carrier, or the joint that carries all of its skin if the carrier carries only a part, as in a clip of an arm.
fn handle(asset: &Asset, carrier: JointIndex) -> JointIndex {
    let is_within = |joint: JointIndex, other: JointIndex| is_within(&asset.skeleton, joint, other);
    let skin = asset.skins.iter().find(|skin| skin.joints().iter().any(|&joint| is_within(joint, carrier)));
    let Some(skin) = skin else { return carrier };
    let is_left_behind = |joint: &JointIndex| !is_within(*joint, carrier) && !is_within(carrier, *joint);
    if !skin.joints().iter().any(is_left_behind) {
        return carrier;
    }
    let carries_all = |&joint: &JointIndex| skin.joints().iter().all(|&other| is_within(other, joint));
    ancestry(&asset.skeleton, carrier).find(carries_all).unwrap_or(carrier)
}

/// Returns the rest transform from the space of a joint's parent to model space; the identity if it has no inverse.
pub fn model_from_parent(skeleton: &Skeleton, joint: JointIndex) -> DAffine3 {
    let rest = |ancestor: JointIndex| Local::from(&skeleton.rest().local(ancestor));
    let model_from_parent = parent_frame(skeleton, joint, DQuat::IDENTITY, rest);
    if model_from_parent.inverse().is_finite() { model_from_parent } else { DAffine3::IDENTITY }
}

/// Turns the character about the vertical through its start, then moves it. Nothing above its handles is animated, so this is
/// an affine map of keys.
pub fn place(tracks: &mut Tracks, asset: &Asset, offset: [f64; 2], radians: f64) {
    let skeleton = &asset.skeleton;
    let Some(start) = start(tracks, asset) else { return };
    let turn = DQuat::from_rotation_y(radians % TAU);
    let moved = DVec3::new(offset[0], 0.0, offset[1]);
    let placed =
        DAffine3::from_translation(start + moved) * DAffine3::from_quat(turn) * DAffine3::from_translation(-start);
    let mut animated: HashSet<Target> = tracks.tracks.iter().map(|track| track.target).collect();
    let mut moves = HashMap::new();
    for joint in handles(tracks, asset) {
        let above = model_from_parent(skeleton, joint);
        let local = above.inverse() * placed * above;
        let above_turn = unit(above.to_scale_rotation_translation().1);
        moves.insert(joint, (local, above_turn.inverse() * turn * above_turn));
        let rest = skeleton.rest().local(joint);
        let (translation, rotation) = (rest.translation.to_array(), rest.rotation.to_array());
        for (target, value) in
            [(Target::Translation(joint), &translation[..]), (Target::Rotation(joint), &rotation[..])]
        {
            if animated.insert(target) {
                tracks.tracks.push(Track::constant(target, value));
            }
        }
    }
    for track in &mut tracks.tracks {
        match track.target {
            Target::Translation(joint) => {
                let Some((local, _)) = moves.get(&joint) else { continue };
                let affine = local.translation.as_vec3().to_array();
                let linear = |entry: &mut [f32]| {
                    (local.matrix3 * Vec3::from_slice(entry).as_dvec3()).as_vec3().write_to_slice(entry);
                };
                track.map(linear, &affine);
            }
            Target::Rotation(joint) if radians != 0.0 => {
                let Some((_, local_turn)) = moves.get(&joint) else { continue };
                let linear = |entry: &mut [f32]| {
                    (*local_turn * Quat::from_slice(entry).as_dquat()).as_quat().write_to_slice(entry);
                };
                track.map(linear, &[]);
            }
            _ => {}
        }
    }
}

/// Returns the position of the character at the start of the clip.
fn start(tracks: &Tracks, asset: &Asset) -> Option<DVec3> {
    let skeleton = &asset.skeleton;
    let joint = handle(asset, traveller(tracks, skeleton)?);
    let clip = tracks.clone().build("", skeleton);
    let locals = locals_of(Scratch::default().sample(skeleton, &clip, 0.0));
    Some(WorldPose::new(skeleton, locals, DQuat::IDENTITY).position(joint))
}
