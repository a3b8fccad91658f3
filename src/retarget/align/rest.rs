//! The rest pose that motion is measured from: a skeleton's nodes, a skin's bind pose, or a frame of a clip. Rotations come
//! from orthonormalized matrices, so scaled or rotated ancestors do no harm.

use glam::{Affine3A, DAffine3, DQuat, DVec3};

use crate::anim::{Clip, JointIndex, Skeleton, nearest_rotation};
use crate::asset::{Asset, Humanoid, Slot};
use crate::mesh::Skin;
use crate::retarget::map::RestChoice;
use crate::retarget::pose::{Local, Scratch, WorldPose, ancestry, clip_locals, node_locals};

/// Returns the source's rest. `Auto` takes a pose from the clip if the body does not stand upright at rest.
pub fn source_rest(source: &Asset, slots: &Humanoid, clip: &Clip, choice: RestChoice) -> Vec<Local> {
    let locals = chosen_locals(source, Some(clip), choice);
    if choice != RestChoice::Auto {
        return locals;
    }
    match upright_moment(&source.skeleton, slots, &locals, clip) {
        Some(time_secs) => clip_locals(&source.skeleton, clip, time_secs, &mut Scratch::default()),
        None => locals,
    }
}

/// Returns the target's rest. Only its rotations are a choice: translations and scales are the nodes', from which the
/// player moves the joints.
pub fn target_rest(target: &Asset, nodes: &[Local], choice: RestChoice) -> Vec<Local> {
    let mut locals = chosen_locals(target, target.clips.first(), choice);
    for (local, node) in locals.iter_mut().zip(nodes) {
        (local.translation, local.scale) = (node.translation, node.scale);
    }
    locals
}

/// `Auto` is the bind pose where a skin covers a joint. Without a clip, the first frame is the nodes' rest.
fn chosen_locals(asset: &Asset, clip: Option<&Clip>, choice: RestChoice) -> Vec<Local> {
    let skeleton = &asset.skeleton;
    match (choice, clip) {
        (RestChoice::Auto | RestChoice::Bind, _) => bind_locals(skeleton, &asset.skins),
        (RestChoice::FirstFrame, Some(clip)) => {
            clip_locals(skeleton, clip, first_key_secs(clip), &mut Scratch::default())
        }
        (RestChoice::Node | RestChoice::FirstFrame, _) => node_locals(skeleton),
    }
}

/// Time of the first key of any channel; 0 without channels.
fn first_key_secs(clip: &Clip) -> f32 {
    let first = clip.timelines().iter().map(|times| times[0]).fold(f32::INFINITY, f32::min);
    if first.is_finite() { first } else { 0.0 }
}

/// A rest below this [`uprightness`] is not a standing pose.
const MIN_UPRIGHTNESS: f64 = 0.75;

/// Moments of the clip to compare.
const REST_SAMPLES: usize = 64;

/// Returns the time at which the body stands most upright, or None if its rest is good enough or no frame is better. Some
/// motion capture rests with all bones along one axis, which says nothing about how two bodies correspond.
fn upright_moment(skeleton: &Skeleton, slots: &Humanoid, rest: &[Local], clip: &Clip) -> Option<f32> {
    let uprightness_of = |locals| uprightness(&WorldPose::new(skeleton, locals, DQuat::IDENTITY), slots);
    let at_rest = uprightness_of(rest.to_vec())?;
    if at_rest > MIN_UPRIGHTNESS {
        return None;
    }
    let (first_secs, last_secs) = (first_key_secs(clip), clip.duration_secs());
    let mut scratch = Scratch::default();
    let mut best = (at_rest, None);
    for sample in 0..=REST_SAMPLES {
        let time_secs = first_secs + (last_secs - first_secs) * sample as f32 / REST_SAMPLES as f32;
        let found = uprightness_of(clip_locals(skeleton, clip, time_secs, &mut scratch)).unwrap_or(-1.0);
        // Of similar poses, the first wins.
        if found > best.0 + 0.01 {
            best = (found, Some(time_secs));
        }
    }
    best.1
}

/// Mean cosine between the torso and the four leg segments, from −1 to 1: 1 for straight legs in line with the torso. None
/// without hips, head and legs.
fn uprightness(pose: &WorldPose, slots: &Humanoid) -> Option<f64> {
    let at = |slot| slots.joint(slot).map(|joint| pose.position(joint));
    let (hips, head) = (at(Slot::Hips)?, at(Slot::Head)?);
    let up = (head - hips).try_normalize()?;
    let leg = |upper, lower, foot| {
        let (upper, lower, foot): (DVec3, DVec3, DVec3) = (at(upper)?, at(lower)?, at(foot)?);
        Some([(upper - lower).try_normalize()?.dot(up), (lower - foot).try_normalize()?.dot(up)])
    };
    let left = leg(Slot::LeftUpperLeg, Slot::LeftLowerLeg, Slot::LeftFoot)?;
    let right = leg(Slot::RightUpperLeg, Slot::RightLowerLeg, Slot::RightFoot)?;
    Some((left[0] + left[1] + right[0] + right[1]) / 4.0)
}

/// The nodes' rest with the rotations of the bind pose. A bind rotation is taken relative to the nearest ancestor in the
/// same skin, because bind space may have other units and another up axis. Joints without such an ancestor, and those whose
/// matrix is singular, keep their node's rotation.
fn bind_locals(skeleton: &Skeleton, skins: &[Skin]) -> Vec<Local> {
    let nodes = node_locals(skeleton);
    let mut locals = nodes.clone();
    let mut is_bound = vec![false; locals.len()];
    let mut bind_from_joint: Vec<Option<DAffine3>> = vec![None; locals.len()];
    for skin in skins {
        bind_from_joint.fill(None);
        for (joint, joint_from_bind) in skin.joints().iter().zip(skin.joint_from_bind()) {
            bind_from_joint[joint.get()] = inverse(joint_from_bind);
        }
        for &joint in skin.joints() {
            if is_bound[joint.get()] {
                continue;
            }
            if let Some(rotation) = bind_rotation(skeleton, &nodes, &bind_from_joint, joint) {
                locals[joint.get()].rotation = rotation;
                is_bound[joint.get()] = true;
            }
        }
    }
    locals
}

/// Local rotation of a joint in the bind pose; the nodes between it and its nearest bound ancestor are at rest.
fn bind_rotation(
    skeleton: &Skeleton,
    nodes: &[Local],
    bind_from_joint: &[Option<DAffine3>],
    joint: JointIndex,
) -> Option<DQuat> {
    let bind = bind_from_joint[joint.get()]?;
    let mut bound_from_parent = DAffine3::IDENTITY;
    for ancestor in ancestry(skeleton, joint).skip(1) {
        if let Some(ancestor_bind) = bind_from_joint[ancestor.get()] {
            return nearest_rotation(&((ancestor_bind * bound_from_parent).inverse() * bind).matrix3);
        }
        bound_from_parent = nodes[ancestor.get()].to_affine() * bound_from_parent;
    }
    None
}

fn inverse(joint_from_bind: &Affine3A) -> Option<DAffine3> {
    let columns = joint_from_bind.to_cols_array().map(f64::from);
    let matrix = DAffine3::from_cols_array(&columns);
    let inverse = matrix.inverse();
    (matrix.matrix3.determinant().abs() > 1e-30 && inverse.is_finite()).then_some(inverse)
}
