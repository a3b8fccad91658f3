//! Which axis is up.

use gaitway_glb::Warnings;
use glam::{DQuat, DVec3};

use crate::motion::{Body, Motion};

/// Maximum number of frames in which the body's height is looked up.
const MAX_LOOKS: usize = 64;
/// A body that is deeper in the ground than this, in metres, isn't upright along that axis.
const MAX_DEPTH: f64 = 0.35;
/// Minimum difference between Y and Z of the pelvis's mean direction that shows which axis is up.
const MIN_LEAN: f64 = 0.2;

/// Returns whether Z is up: on average, the pelvis's own Y axis is closer to Z than to Y. A person may lie, however: if the
/// body would be in the ground then, and wouldn't with the other axis, that one is up.
pub fn is_z_up(motion: &Motion, warnings: &mut Warnings) -> bool {
    let pelvis = |body: &Body| -> DVec3 { body.rotations[..motion.frames].iter().map(|&turn| turn * DVec3::Y).sum() };
    let up: DVec3 = motion.bodies.iter().map(pelvis).sum();
    let is_z = up.z > up.y;
    let lowest = motion.bodies.iter().filter_map(|body| lowest(motion, body)).reduce(DVec3::min);
    let Some(lowest) = lowest else { return is_z };
    let [own, other] = if is_z { [lowest.z, lowest.y] } else { [lowest.y, lowest.z] };
    let is_in_the_ground = own < -MAX_DEPTH;
    let is_other = is_in_the_ground && other.abs() < MAX_DEPTH;
    let is_z = is_z != is_other;
    let frames = (motion.bodies.len() * motion.frames) as f64;
    if is_in_the_ground && !is_other || (up.z - up.y).abs() < MIN_LEAN * frames {
        let axis = if is_z { "Z" } else { "Y" };
        warnings.add(format!(
            "The file doesn't say which axis is up, and the body doesn't show it clearly: {axis} is assumed."
        ));
    }
    is_z
}

/// Returns the least coordinates of any joint in some of the frames, if the body has a path. The ground is at 0 in nearly all files.
fn lowest(motion: &Motion, body: &Body) -> Option<DVec3> {
    let path = body.path.as_ref()?;
    let frames = motion.frames;
    let mut lowest = DVec3::INFINITY;
    for frame in (0..frames).step_by(frames.div_ceil(MAX_LOOKS).max(1)) {
        let mut placed: Vec<(DQuat, DVec3)> = Vec::new();
        for (index, joint) in motion.skeleton.joints.iter().enumerate() {
            let (turn, at) = match placed.get(joint.parent) {
                Some(&(turn, at)) => (turn, at + turn * joint.offset),
                None => (DQuat::IDENTITY, path[frame]),
            };
            lowest = lowest.min(at);
            placed.push((turn * body.rotations[index * frames + frame], at));
        }
    }
    Some(lowest)
}
