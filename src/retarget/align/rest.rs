//! The rest that motion is measured from, for every joint of a skeleton: of the nodes, of a skin's bind pose, or of a clip's
//! first key. Rotations are products of orthonormalised locals, so scaled or rotated ancestors do no harm.

use glam::{DAffine3, DMat3, DQuat, DVec3};

use crate::anim::{Clip, JointIndex, Pose, SampleCursor, Skeleton};
use crate::asset::{Humanoid, Slot};
use crate::mesh::Skin;
use crate::retarget::map::RestChoice;

/// A local transform in f64.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Local {
    pub translation: DVec3,
    pub rotation: DQuat,
    pub scale: DVec3,
}

impl Local {
    pub fn to_affine(self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

/// A reference pose in model space, one entry for each joint.
#[derive(Debug, Clone, Default)]
pub struct Reference {
    pub locals: Vec<Local>,
    /// Unit rotations.
    pub rotations: Vec<DQuat>,
    pub positions: Vec<DVec3>,
}

impl Reference {
    /// Walks down from the roots, which are placed by `world_from_model`.
    pub fn new(skeleton: &Skeleton, locals: Vec<Local>, world_from_model: DQuat) -> Self {
        let mut rotations = Vec::with_capacity(locals.len());
        let mut positions = Vec::with_capacity(locals.len());
        let mut affines: Vec<DAffine3> = Vec::with_capacity(locals.len());
        for (local, parent) in locals.iter().zip(skeleton.parents()) {
            let (above, turn) = match parent {
                Some(parent) => (affines[parent.get()], rotations[parent.get()]),
                None => (DAffine3::from_quat(world_from_model), world_from_model),
            };
            let affine = above * local.to_affine();
            positions.push(affine.translation);
            affines.push(affine);
            rotations.push(unit(turn * local.rotation));
        }
        Self { locals, rotations, positions }
    }
}

/// The rest pose's locals.
pub fn node_locals(skeleton: &Skeleton) -> Vec<Local> {
    locals_of(skeleton.rest())
}

/// The locals of a clip at a time.
pub fn clip_locals(skeleton: &Skeleton, clip: &Clip, time_secs: f32) -> Vec<Local> {
    let mut pose = skeleton.rest().clone();
    clip.sample(skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
    locals_of(&pose)
}

fn locals_of(pose: &Pose) -> Vec<Local> {
    pose.locals
        .iter()
        .map(|local| Local {
            translation: local.translation.as_dvec3(),
            rotation: unit(local.rotation.as_dquat()),
            scale: local.scale.as_dvec3(),
        })
        .collect()
}

/// The locals of the chosen rest. `Auto` is the bind pose where a skin covers a joint. Without a clip, the first frame is the
/// nodes' rest.
pub fn chosen_locals(skeleton: &Skeleton, skins: &[Skin], clip: Option<&Clip>, choice: RestChoice) -> Vec<Local> {
    match (choice, clip) {
        (RestChoice::Auto | RestChoice::Bind, _) => bind_locals(skeleton, skins),
        (RestChoice::FirstFrame, Some(clip)) => clip_locals(skeleton, clip, first_key_secs(clip)),
        (RestChoice::Node | RestChoice::FirstFrame, _) => node_locals(skeleton),
    }
}

/// Time of the first key of any channel; 0 without channels.
pub fn first_key_secs(clip: &Clip) -> f32 {
    let first = clip.timelines().iter().map(|times| times[0]).fold(f32::INFINITY, f32::min);
    if first.is_finite() { first } else { 0.0 }
}

/// A rest that no body stands in (all bones along one axis, say, as some motion capture writes them) says nothing on how
/// parts correspond: then the pose of the clip that stands best takes its place. Returned is its time, none when the rest
/// will do or nothing is better.
pub fn better_rest_secs(skeleton: &Skeleton, slots: &Humanoid, rest: &[Local], clip: &Clip) -> Option<f32> {
    let stands = |locals: Vec<Local>| standing(&Reference::new(skeleton, locals, DQuat::IDENTITY), slots);
    let at_rest = stands(rest.to_vec())?;
    if at_rest > LEAST_STANDING {
        return None;
    }
    let (first_secs, last_secs) = (first_key_secs(clip), clip.duration_secs());
    let mut cursor = SampleCursor::default();
    let mut best = (at_rest, None);
    for sample in 0..=REST_SAMPLES {
        let time_secs = first_secs + (last_secs - first_secs) * sample as f32 / REST_SAMPLES as f32;
        let mut pose = skeleton.rest().clone();
        clip.sample(skeleton, time_secs, &mut cursor, &mut pose);
        let found = stands(locals_of(&pose)).unwrap_or(-1.0);
        // Clearly better, or the first of much alike.
        if found > best.0 + 0.01 {
            best = (found, Some(time_secs));
        }
    }
    best.1
}

/// A body stands when its head is on the other side of the hips than its feet, with the legs stretched: the mean cosine of
/// those angles.
const LEAST_STANDING: f64 = 0.75;

/// How many moments of a clip are looked at.
const REST_SAMPLES: usize = 64;

/// From −1 to 1; none without hips, head and legs.
fn standing(pose: &Reference, slots: &Humanoid) -> Option<f64> {
    let at = |slot| slots.joint(slot).map(|joint| pose.positions[joint.get()]);
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

/// Bind poses are taken relative to the nearest ancestor in the same skin: bind space may be in other units and have another
/// axis up. Joints without such an ancestor keep their node's rest, and so does what a broken matrix belongs to. Only
/// rotations are taken: the translations that are played are the nodes'.
fn bind_locals(skeleton: &Skeleton, skins: &[Skin]) -> Vec<Local> {
    let mut locals = node_locals(skeleton);
    let nodes = locals.clone();
    let mut done = vec![false; locals.len()];
    let mut bind_from_joint: Vec<Option<DAffine3>> = vec![None; locals.len()];
    for skin in skins {
        bind_from_joint.fill(None);
        for (joint, joint_from_bind) in skin.joints().iter().zip(skin.joint_from_bind()) {
            bind_from_joint[joint.get()] = inverse(joint_from_bind);
        }
        for &joint in skin.joints() {
            let Some(bind) = bind_from_joint[joint.get()].filter(|_| !done[joint.get()]) else { continue };
            let mut between = DAffine3::IDENTITY;
            let mut ancestor = skeleton.parent(joint);
            let parent_bind = loop {
                let Some(at) = ancestor else { break None };
                if let Some(parent_bind) = bind_from_joint[at.get()] {
                    break Some(parent_bind);
                }
                between = nodes[at.get()].to_affine() * between;
                ancestor = skeleton.parent(at);
            };
            let Some(parent_bind) = parent_bind else { continue };
            if let Some(rotation) = orthonormalized(&((parent_bind * between).inverse() * bind).matrix3) {
                locals[joint.get()].rotation = rotation;
                done[joint.get()] = true;
            }
        }
    }
    locals
}

fn inverse(joint_from_bind: &glam::Affine3A) -> Option<DAffine3> {
    let columns = joint_from_bind.to_cols_array().map(f64::from);
    let matrix = DAffine3::from_cols_array(&columns);
    let inverse = matrix.inverse();
    (matrix.matrix3.determinant().abs() > 1e-30 && inverse.is_finite()).then_some(inverse)
}

/// The rotation nearest to a matrix without its scale, by the polar iteration of Higham 1986. None when it is singular.
fn orthonormalized(matrix: &DMat3) -> Option<DQuat> {
    let mirrored = if matrix.determinant() < 0.0 { -1.0 } else { 1.0 };
    let axis = |axis: DVec3| axis.try_normalize();
    let mut turned = DMat3::from_cols(axis(matrix.x_axis * mirrored)?, axis(matrix.y_axis)?, axis(matrix.z_axis)?);
    if turned.determinant().is_nan() || turned.determinant() < 1e-6 {
        return None;
    }
    for _ in 0..20 {
        let next = (turned + turned.inverse().transpose()) * 0.5;
        if next.abs_diff_eq(turned, 1e-15) {
            break;
        }
        turned = next;
    }
    let rotation = DQuat::from_mat3(&turned);
    rotation.is_finite().then(|| unit(rotation))
}

pub fn unit(rotation: DQuat) -> DQuat {
    let length = rotation.length();
    if length.is_finite() && length > 0.0 { rotation / length } else { DQuat::IDENTITY }
}

/// Joints from `joint` up to its root.
pub fn ancestry(skeleton: &Skeleton, joint: JointIndex) -> impl Iterator<Item = JointIndex> + '_ {
    std::iter::successors(Some(joint), |&joint| skeleton.parent(joint))
}
