//! Moves helpers beside the body along with the hands and feet that they belong to, in a finished clip. Otherwise an engine's inverse
//! kinematics would pull these back to where the helpers rest.

use gaitway_character::anim::{Clip, Keys};
use glam::{DAffine3, DQuat, DVec3};

use super::Transfer;
use super::turns::is_free;
use crate::body::Follower;
use crate::keys::channel::{NewChannel, continuous};
use crate::keys::limits::MAX_TURN;
use crate::keys::resample::fewest;
use crate::keys::tracks::SourceTracks;
use crate::math::{angle_between, slerp, unit};
use crate::pose::{PartialPose, WorldPose, node_locals};
use crate::times::dense_times;

/// Maximum error of resampled positions, as a share of the hips' height.
const TOLERANCE_OF_HEIGHT: f64 = 1e-3;

/// A follower's transform relative to its parent.
type Placed = (DVec3, DQuat);

/// Returns the translations and rotations of all followers that the map leaves free.
pub fn follower_channels(transfer: &Transfer, clip: &Clip) -> Vec<NewChannel> {
    let skeleton = transfer.target_skeleton;
    let mut has_channel = vec![false; skeleton.len()];
    clip.channels().iter().for_each(|channel| has_channel[channel.joint.get()] = true);
    let is_open = |follower: &&Follower| {
        let turns = transfer.turns.of(follower.follows).is_some();
        turns && is_free(transfer.map, follower.joint) && !has_channel[follower.joint.get()]
    };
    let followers: Vec<Follower> = transfer.anatomy.followers.iter().filter(is_open).copied().collect();
    if followers.is_empty() || clip.channels().is_empty() {
        return Vec::new();
    }
    let nodes = node_locals(skeleton);
    let tracks = SourceTracks::new(skeleton, clip, &[], &nodes);
    let joints = followers.iter().flat_map(|follower| [follower.joint, follower.follows]);
    let times = dense_times(clip);
    let rest = WorldPose::new(skeleton, nodes.clone(), DQuat::IDENTITY);
    let mut pose = PartialPose::new(skeleton, DQuat::IDENTITY, joints);
    let placed: Vec<Vec<Placed>> =
        times.iter().map(|&time| placed(transfer, &followers, &rest, pose.update(tracks.locals_at(time)))).collect();
    let tolerance = TOLERANCE_OF_HEIGHT * transfer.hips.map_or(1.0, |hips| hips.height);
    let channels = followers.iter().enumerate().flat_map(|(follower, &Follower { joint, .. })| {
        let at = |time: usize| placed[time][follower];
        let fits = |from: usize, to: usize| {
            let secs = f64::from(times[to] - times[from]);
            (from + 1..to).all(|between| {
                let share = f64::from(times[between] - times[from]) / secs;
                let (from, to, at) = (at(from), at(to), at(between));
                from.0.lerp(to.0, share).distance(at.0) <= tolerance
                    && angle_between(slerp(from.1, to.1, share), at.1) <= MAX_TURN
            })
        };
        let kept = fewest(times.len(), fits);
        let kept_times: Vec<f32> = kept.iter().map(|&time| times[time]).collect();
        let translations = kept.iter().map(|&time| at(time).0.as_vec3()).collect();
        let rotations = continuous(kept.iter().map(|&time| at(time).1));
        [Keys::Translation(translations), rotations].map(|keys| NewChannel::resampled(joint, kept_times.clone(), keys))
    });
    channels.collect()
}

/// Where the followers are relative to their parents if each keeps its place beside the joint that it belongs to.
fn placed(transfer: &Transfer, followers: &[Follower], rest: &WorldPose, pose: &WorldPose) -> Vec<Placed> {
    let skeleton = transfer.target_skeleton;
    let in_model = |follower: &Follower| {
        let turn = pose.rotation(follower.follows) * rest.rotation(follower.follows).conjugate();
        let offset = rest.position(follower.joint) - rest.position(follower.follows);
        (pose.position(follower.follows) + turn * offset, unit(turn * rest.rotation(follower.joint)))
    };
    let relative = |follower: &Follower| {
        let (position, rotation) = in_model(follower);
        let parent = skeleton.parent(follower.joint);
        // One that hangs on another one.
        let other = followers.iter().find(|other| Some(other.joint) == parent);
        let (frame, parent_rotation) = match other {
            Some(other) => {
                let (position, rotation) = in_model(other);
                let scale = rest.parent_frame(skeleton, follower.joint).to_scale_rotation_translation().0;
                (DAffine3::from_scale_rotation_translation(scale, rotation, position), rotation)
            }
            None => (pose.parent_frame(skeleton, follower.joint), pose.parent_rotation(skeleton, follower.joint)),
        };
        (frame.inverse().transform_point3(position), unit(parent_rotation.conjugate() * rotation))
    };
    followers.iter().map(relative).collect()
}
