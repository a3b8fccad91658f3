//! Poses in double precision: local transforms, and the rotation and position of every joint that follow from them.

use gaitway_character::anim::{Clip, JointIndex, Pose, Reflection, SampleCursor, Skeleton, Transform};
use glam::{Affine3A, DAffine3, DQuat, DVec3, Vec3};

use super::math::unit;

/// A joint's transform relative to its parent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Local {
    pub translation: DVec3,
    pub rotation: DQuat,
    pub scale: DVec3,
}

impl Local {
    /// Returns the local transform of a joint of a mirrored skeleton in the mirror.
    pub fn in_mirror(self, reflection: &Reflection, joint: JointIndex) -> Self {
        Self {
            translation: reflection.translation(joint, self.translation),
            rotation: reflection.rotation(joint, self.rotation),
            scale: reflection.scale(joint, self.scale),
        }
    }

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
        let (rotations, positions) = (vec![DQuat::IDENTITY; locals.len()], vec![DVec3::ZERO; locals.len()]);
        let mut pose = Self { world_from_model, locals, rotations, positions };
        let mut affines = vec![DAffine3::IDENTITY; pose.locals.len()];
        for joint in skeleton.joints() {
            pose.place(skeleton, joint, &mut affines);
        }
        pose
    }

    /// Places a joint by its local transform. `affines` has the matrices of its ancestors, and gets its own.
    fn place(&mut self, skeleton: &Skeleton, joint: JointIndex, affines: &mut [DAffine3]) {
        let (world_from_parent, parent_rotation) = match skeleton.parent(joint) {
            Some(parent) => (affines[parent.get()], self.rotation(parent)),
            None => (DAffine3::from_quat(self.world_from_model), self.world_from_model),
        };
        let (joint, local) = (joint.get(), self.locals[joint.get()]);
        affines[joint] = world_from_parent * local.to_affine();
        self.positions[joint] = affines[joint].translation;
        self.rotations[joint] = unit(parent_rotation * local.rotation);
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

/// A pose of some joints and their ancestors, for looking at many times of a clip. Other joints stay as they rest and have no
/// meaning.
#[derive(Debug)]
pub struct PartialPose<'a> {
    skeleton: &'a Skeleton,
    joints: Vec<JointIndex>,
    affines: Vec<DAffine3>,
    pose: WorldPose,
}

impl<'a> PartialPose<'a> {
    pub fn new(skeleton: &'a Skeleton, world_from_model: DQuat, joints: impl IntoIterator<Item = JointIndex>) -> Self {
        Self {
            skeleton,
            joints: with_ancestors(skeleton, joints),
            affines: vec![DAffine3::IDENTITY; skeleton.len()],
            pose: WorldPose::new(skeleton, node_locals(skeleton), world_from_model),
        }
    }

    /// Poses the joints by their local transforms.
    pub fn update(&mut self, mut local: impl FnMut(JointIndex) -> Local) -> &WorldPose {
        for &joint in &self.joints {
            self.pose.locals[joint.get()] = local(joint);
            self.pose.place(self.skeleton, joint, &mut self.affines);
        }
        &self.pose
    }
}

/// Translations of a joint, as its file has them, that is moved in each pose, from where it is there.
pub fn moved(skeleton: &Skeleton, joint: JointIndex, poses: &[WorldPose], moves: &[DVec3]) -> Vec<Vec3> {
    let reflection = skeleton.reflection();
    let translation = |(pose, by): (&WorldPose, &DVec3)| {
        let local = pose.parent_frame(skeleton, joint).inverse().transform_point3(pose.position(joint) + by);
        reflection.translation(joint, local).as_vec3()
    };
    poses.iter().zip(moves).map(translation).collect()
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

/// The space in which bodies are recognized and retargeted: model space, or for a mirrored skeleton its mirror.
pub fn mirror_from_model(skeleton: &Skeleton) -> Affine3A {
    let is_mirrored = !skeleton.reflection().is_identity();
    if is_mirrored { Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0)) } else { Affine3A::IDENTITY }
}

/// The rest pose's local transforms; those of a mirrored skeleton in the mirror.
pub fn node_locals(skeleton: &Skeleton) -> Vec<Local> {
    locals_in_mirror(skeleton, skeleton.rest())
}

fn locals_in_mirror(skeleton: &Skeleton, pose: &Pose) -> Vec<Local> {
    let reflection = skeleton.reflection();
    let locals = skeleton.joints().zip(pose.locals());
    locals.map(|(joint, local)| Local::from(&local).in_mirror(reflection, joint)).collect()
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

impl Scratch {
    /// Samples a clip as the player would play it.
    pub fn sample(&mut self, skeleton: &Skeleton, clip: &Clip, time_secs: f32) -> &Pose {
        self.pose.copy_from(skeleton.rest());
        clip.sample(skeleton, time_secs, &mut self.cursor, &mut self.pose);
        &self.pose
    }
}

/// Samples the local transforms of a clip as the player would play it; those of a mirrored skeleton in the mirror.
pub fn clip_locals(skeleton: &Skeleton, clip: &Clip, time_secs: f32, scratch: &mut Scratch) -> Vec<Local> {
    locals_in_mirror(skeleton, scratch.sample(skeleton, clip, time_secs))
}

/// The joint and its ancestors, up to the root.
pub fn ancestry(skeleton: &Skeleton, joint: JointIndex) -> impl Iterator<Item = JointIndex> + '_ {
    std::iter::successors(Some(joint), |&joint| skeleton.parent(joint))
}

/// Returns the joints and all their ancestors, parents first.
pub fn with_ancestors(skeleton: &Skeleton, joints: impl IntoIterator<Item = JointIndex>) -> Vec<JointIndex> {
    let mut is_included = vec![false; skeleton.len()];
    for joint in joints {
        for joint in ancestry(skeleton, joint) {
            is_included[joint.get()] = true;
        }
    }
    skeleton.joints().filter(|joint| is_included[joint.get()]).collect()
}

/// Whether `joint` is `ancestor` or one of its descendants.
pub fn is_within(skeleton: &Skeleton, joint: JointIndex, ancestor: JointIndex) -> bool {
    ancestry(skeleton, joint).any(|other| other == ancestor)
}
