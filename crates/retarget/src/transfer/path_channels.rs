//! The channels that the path of the hips makes: their translation, relative to their parent, and those of the root joint.

use gaitway_character::anim::{Interpolation, JointIndex, Keys};
use glam::{DAffine3, DQuat, DVec3, Vec3};

use super::path::{HipsPath, unedited};
use super::rotation::RotationLaw;
use super::yaw::Yaw;
use super::{Hips, Transfer};
use crate::keys::channel::NewChannel;
use crate::keys::limits::{MAX_OFFSET_PER_METRE, height_or_metre};
use crate::keys::resample::{resample_positions, union};
use crate::keys::tracks::Track;
use crate::math::unit;
use crate::pose::{Local, ancestry, parent_frame};

/// Channels of the hips' translation, and of the root joint if travel moves there. `root_turn` is the turning that moved to
/// the root joint.
pub fn hips_channels(
    transfer: &Transfer,
    hips: &Hips,
    laws: &[RotationLaw],
    root_turn: Option<&Yaw>,
) -> Vec<NewChannel> {
    let Some(path) = HipsPath::new(transfer, hips) else {
        return constant_channel(transfer, hips, laws).into_iter().collect();
    };
    let mut channels = Vec::new();
    if let Some(root) = path.policy.extraction_joint {
        channels.extend(root_joint_channels(transfer, root, &path, root_turn));
    }
    if root_turn.is_none()
        && path.travel.is_straight()
        && let Some(transformed) = transformed_channel(transfer, hips, &path)
    {
        channels.push(transformed);
        return channels;
    }
    let seen_from_root = |position: DVec3, time: f32| match (path.policy.extraction_joint, root_turn) {
        (Some(root), Some(turn)) => {
            // The root turns below the hips; its travel is not in the path.
            let pivot = transfer.alignment.target.position(root);
            pivot + DQuat::from_rotation_y(-turn.at(time)) * (position - pivot)
        }
        _ => position,
    };
    let translation = |time: f32| carried(transfer, hips, laws, time, seen_from_root(path.at(time), time));
    // The tolerance is in the units of the hips' parent.
    let carrier = hips.carrier;
    let unit_length = rest_parent_frame(transfer, carrier).matrix3.x_axis.length().max(1e-12);
    let tolerance = MAX_OFFSET_PER_METRE * height_or_metre(hips.height) / unit_length;
    let turning = turning_times(transfer, hips, laws);
    let times = union(turning.iter().map(Vec::as_slice).chain([path.times.as_slice()]));
    let positions = resample_positions(&times, &jumps(transfer, hips), tolerance, translation);
    channels.push(NewChannel::resampled_translation(carrier, positions));
    channels
}

/// Channels of the root joint: its travel and its turning.
fn root_joint_channels(transfer: &Transfer, root: JointIndex, path: &HipsPath, turn: Option<&Yaw>) -> Vec<NewChannel> {
    let rest = &transfer.alignment.target;
    let local = rest.locals[root.get()];
    let world_from_parent = rest.parent_frame(transfer.target_skeleton, root);
    let parent_from_world = world_from_parent.inverse();
    let position = |time: f32| {
        let step = parent_from_world.transform_vector3(path.policy.extracted * path.travel.root(time));
        (local.translation + step).as_vec3()
    };
    let times = path.travel.root_times();
    let positions = times.iter().map(|&time| position(time)).collect();
    let mut channels = vec![NewChannel {
        joint: root,
        interpolation: Interpolation::Linear,
        times,
        keys: Keys::Translation(positions),
        resampled: false,
    }];
    if let Some(turn) = turn {
        let parent =
            gaitway_character::anim::nearest_rotation(&world_from_parent.matrix3).map_or(DQuat::IDENTITY, unit);
        let rotation =
            |&radians: &f64| (parent.conjugate() * DQuat::from_rotation_y(radians) * parent * local.rotation).as_quat();
        let rotations = turn.radians.iter().map(rotation).collect();
        channels.push(NewChannel::resampled(root, turn.times.clone(), Keys::Rotation(rotations)));
    }
    channels
}

/// Times at which the source's hips jump.
fn jumps(transfer: &Transfer, hips: &Hips) -> Vec<f32> {
    let tracks = transfer.tracks;
    let path = ancestry(tracks.skeleton, transfer.map.pairs[hips.pair].source);
    union(path.flat_map(|joint| [tracks.translations[joint.get()].jumps(), tracks.scales[joint.get()].jumps()]))
}

/// Hips that do not move may still be elsewhere than at rest.
fn constant_channel(transfer: &Transfer, hips: &Hips, laws: &[RotationLaw]) -> Option<NewChannel> {
    let (pair, tracks) = (&transfer.map.pairs[hips.pair], transfer.tracks);
    let has_channel = ancestry(tracks.skeleton, pair.source).any(|joint| tracks.has_channel[joint.get()]);
    let translation = carried(transfer, hips, laws, 0.0, unedited(transfer, hips, 0.0));
    has_channel.then(|| NewChannel::constant(hips.carrier, Keys::Translation(vec![translation.as_vec3()])))
}

/// The local translation that brings the hips to a position: their own, or that of the joint that carries them.
fn carried(transfer: &Transfer, hips: &Hips, laws: &[RotationLaw], time_secs: f32, position: DVec3) -> DVec3 {
    let joint = transfer.map.pairs[hips.pair].target;
    let world_from_parent = hips_parent_frame(transfer, joint, laws, time_secs);
    if hips.carrier == joint {
        return world_from_parent.inverse().transform_point3(position);
    }
    let locals = &transfer.alignment.target.locals;
    let by = position - world_from_parent.transform_point3(locals[joint.get()].translation);
    let parent_from_world = hips_parent_frame(transfer, hips.carrier, laws, time_secs).inverse();
    locals[hips.carrier.get()].translation + parent_from_world.transform_vector3(by)
}

/// Key times of the joints between the hips and the joint that carries them, whose turning moves the hips.
fn turning_times(transfer: &Transfer, hips: &Hips, laws: &[RotationLaw]) -> Vec<Vec<f32>> {
    let joint = transfer.map.pairs[hips.pair].target;
    let above = ancestry(transfer.target_skeleton, joint).skip(1).filter(|&joint| joint >= hips.carrier);
    above.filter_map(|joint| transfer.map.pair_index(joint)).map(|pair| laws[pair].times().0).collect()
}

/// `world_from_parent` of the hips at the aligned rest.
fn rest_parent_frame(transfer: &Transfer, hips: JointIndex) -> DAffine3 {
    transfer.alignment.target.parent_frame(transfer.target_skeleton, hips)
}

/// The same at a given time, as mapped ancestors rotate.
fn hips_parent_frame(transfer: &Transfer, hips: JointIndex, laws: &[RotationLaw], time_secs: f32) -> DAffine3 {
    let rest = &transfer.alignment.target;
    parent_frame(transfer.target_skeleton, hips, rest.world_from_model, |ancestor| {
        let local: Local = rest.locals[ancestor.get()];
        let law = transfer.map.pair_index(ancestor).map(|pair| &laws[pair]);
        Local { rotation: law.map_or(local.rotation, |law| law.at(time_secs)), ..local }
    })
}

/// The source's own keys, if everything between them and the target's is constant.
fn transformed_channel(transfer: &Transfer, hips: &Hips, path: &HipsPath) -> Option<NewChannel> {
    let (tracks, pair) = (transfer.tracks, &transfer.map.pairs[hips.pair]);
    let Track::Keys { times, channel } = &tracks.translations[pair.source.get()] else { return None };
    let Keys::Translation(values) = &channel.keys else { return None };
    let source_ancestor_moves = ancestry(tracks.skeleton, pair.source).skip(1).any(|joint| tracks.is_moving(joint));
    let target_ancestor_turns =
        ancestry(transfer.target_skeleton, pair.target).skip(1).any(|joint| transfer.map.source_of(joint).is_some());
    let step_would_slide =
        channel.interpolation == Interpolation::Step && path.policy.stopped() * path.travel.slope != DVec3::ZERO;
    if source_ancestor_moves || target_ancestor_turns || step_would_slide || !tracks.has_own_keys(pair.source) {
        return None;
    }
    let world_from_source_parent =
        parent_frame(tracks.skeleton, pair.source, transfer.alignment.source.world_from_model, |ancestor| {
            tracks.local(ancestor, 0.0)
        });
    let target_parent_from_world = rest_parent_frame(transfer, hips.carrier).inverse();
    let rest = &transfer.alignment.target;
    let (carrier_rest, hips_rest) = (rest.locals[hips.carrier.get()].translation, rest.position(pair.target));
    let point = |value: &Vec3, time: f32| {
        let position = hips.target_position(world_from_source_parent.transform_point3(value.as_dvec3()));
        let by = path.edit(position, time) - hips_rest;
        (carrier_rest + target_parent_from_world.transform_vector3(by)).as_vec3()
    };
    let tangent = |value: &Vec3| {
        let tangent = hips.scale * world_from_source_parent.transform_vector3(value.as_dvec3());
        target_parent_from_world.transform_vector3(path.edit_tangent(tangent)).as_vec3()
    };
    let keys = match channel.interpolation {
        Interpolation::CubicSpline => values
            .chunks(3)
            .zip(*times)
            .flat_map(|(entry, &time)| [tangent(&entry[0]), point(&entry[1], time), tangent(&entry[2])])
            .collect(),
        Interpolation::Step | Interpolation::Linear => {
            values.iter().zip(*times).map(|(value, &time)| point(value, time)).collect()
        }
    };
    Some(NewChannel {
        joint: hips.carrier,
        interpolation: channel.interpolation,
        times: times.to_vec(),
        keys: Keys::Translation(keys),
        resampled: false,
    })
}
