//! Poses in double precision: local transforms, and the rotation and position of every joint that follow from them.

use glam::{DAffine3, DQuat, DVec3};

use super::math::unit;
use crate::anim::{Clip, JointIndex, Pose, SampleCursor, Skeleton, Transform};

/// A joint's transform relative to its parent.
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

impl From<&Transform> for Local {
    fn from(local: &Transform) -> Self {
        Self {
            translation: local.translation.as_dvec3(),
            rotation: unit(local.rotation.as_dquat()),
            scale: local.scale.as_dvec3(),
        }
    }
}

/// A pose with one entry per joint. "World" is whatever `world_from_model` leads to, usually the frame that source and
/// target share.
#[derive(Debug, Clone)]
pub struct WorldPose {
    pub world_from_model: DQuat,
    pub locals: Vec<Local>,
    /// Products of the local rotations: unit quaternions, unaffected by scaled ancestors.
    pub rotations: Vec<DQuat>,
    pub positions: Vec<DVec3>,
}

impl WorldPose {
    pub fn new(skeleton: &Skeleton, locals: Vec<Local>, world_from_model: DQuat) -> Self {
        let mut rotations = Vec::with_capacity(locals.len());
        let mut positions = Vec::with_capacity(locals.len());
        let mut affines: Vec<DAffine3> = Vec::with_capacity(locals.len());
        for (local, parent) in locals.iter().zip(skeleton.parents()) {
            let (world_from_parent, parent_rotation) = match parent {
                Some(parent) => (affines[parent.get()], rotations[parent.get()]),
                None => (DAffine3::from_quat(world_from_model), world_from_model),
            };
            let affine = world_from_parent * local.to_affine();
            positions.push(affine.translation);
            affines.push(affine);
            rotations.push(unit(parent_rotation * local.rotation));
        }
        Self { world_from_model, locals, rotations, positions }
    }

    pub fn rotation(&self, joint: JointIndex) -> DQuat {
        self.rotations[joint.get()]
    }

    pub fn position(&self, joint: JointIndex) -> DVec3 {
        self.positions[joint.get()]
    }

    /// World rotation of the joint's parent.
    pub fn parent_rotation(&self, skeleton: &Skeleton, joint: JointIndex) -> DQuat {
        skeleton.parent(joint).map_or(self.world_from_model, |parent| self.rotation(parent))
    }

    /// `world_from_parent` of the joint, with scale.
    pub fn parent_frame(&self, skeleton: &Skeleton, joint: JointIndex) -> DAffine3 {
        parent_frame(skeleton, joint, self.world_from_model, |ancestor| self.locals[ancestor.get()])
    }
}

/// `world_from_parent` of a joint whose ancestors have the given local transforms.
pub fn parent_frame(
    skeleton: &Skeleton,
    joint: JointIndex,
    world_from_model: DQuat,
    local: impl Fn(JointIndex) -> Local,
) -> DAffine3 {
    let model_from_parent = ancestry(skeleton, joint)
        .skip(1)
        .fold(DAffine3::IDENTITY, |below, ancestor| local(ancestor).to_affine() * below);
    DAffine3::from_quat(world_from_model) * model_from_parent
}

/// The rest pose's local transforms.
pub fn node_locals(skeleton: &Skeleton) -> Vec<Local> {
    locals_of(skeleton.rest())
}

pub fn locals_of(pose: &Pose) -> Vec<Local> {
    pose.locals().map(|local| Local::from(&local)).collect()
}

/// Buffers reused between samples of one clip.
#[derive(Debug, Default)]
pub struct Scratch {
    cursor: SampleCursor,
    pose: Pose,
}

/// Samples the local transforms of a clip as the player would play it.
pub fn clip_locals(skeleton: &Skeleton, clip: &Clip, time_secs: f32, scratch: &mut Scratch) -> Vec<Local> {
    scratch.pose.copy_from(skeleton.rest());
    clip.sample(skeleton, time_secs, &mut scratch.cursor, &mut scratch.pose);
    locals_of(&scratch.pose)
}

/// The joint and its ancestors, up to the root.
pub fn ancestry(skeleton: &Skeleton, joint: JointIndex) -> impl Iterator<Item = JointIndex> + '_ {
    std::iter::successors(Some(joint), |&joint| skeleton.parent(joint))
}

/// Whether `joint` is `ancestor` or one of its descendants.
pub fn is_within(skeleton: &Skeleton, joint: JointIndex, ancestor: JointIndex) -> bool {
    ancestry(skeleton, joint).any(|other| other == ancestor)
}
