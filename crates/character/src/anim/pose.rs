//! Poses: one local transform per joint.

use std::sync::Arc;

use glam::{Quat, Vec3};

use super::joint::JointIndex;
use super::kernels::{LANES, Transformx4};
use super::transform::Transform;

/// The output of sampling and the input of skinning: one local transform per joint, and the morph weights of all meshes,
/// concatenated (see [`Skeleton::morph_range`](super::Skeleton::morph_range)). A pose of a skeleton starts as a copy of its rest pose.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Pose {
    /// Four joints each, sorted by depth, so that a joint rarely has to wait for the parent just before it. The last
    /// group is padded.
    pub(super) groups: Vec<Transformx4>,
    /// Each joint's lane, counted over all groups.
    lane_of_joint: Arc<[u32]>,
    /// Usually from 0 to 1, but not clamped.
    pub morph_weights: Vec<f32>,
}

impl Pose {
    /// `by_depth` has all joints in the order of their lanes.
    pub(super) fn new(
        locals: &[Transform],
        morph_weights: Vec<f32>,
        by_depth: impl Iterator<Item = JointIndex>,
    ) -> Self {
        let mut lanes = vec![0; locals.len()];
        for (lane, joint) in by_depth.enumerate() {
            lanes[joint.get()] = lane as u32;
        }
        let groups = vec![Transformx4::IDENTITY; locals.len().div_ceil(LANES)];
        let mut pose = Self { groups, lane_of_joint: lanes.into(), morph_weights };
        for (joint, &local) in locals.iter().enumerate() {
            pose.set_local(JointIndex(joint as u32), local);
        }
        pose
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.lane_of_joint.len()
    }

    /// Whether there are no joints.
    pub fn is_empty(&self) -> bool {
        self.lane_of_joint.is_empty()
    }

    /// Local transforms of all joints.
    pub fn locals(&self) -> impl ExactSizeIterator<Item = Transform> + '_ {
        (0..self.len() as u32).map(|joint| self.local(JointIndex(joint)))
    }

    /// Returns a joint's local transform; `None` if there is no such joint.
    pub fn get(&self, joint: JointIndex) -> Option<Transform> {
        (joint.get() < self.len()).then(|| self.local(joint))
    }

    /// Returns the local transform of one of the skeleton's joints.
    pub fn local(&self, joint: JointIndex) -> Transform {
        let (group, lane) = self.place(joint);
        self.groups[group].get(lane)
    }

    /// Sets a joint's local transform. The rotation is normalized.
    pub fn set_local(&mut self, joint: JointIndex, local: Transform) {
        self.set_translation(joint, local.translation);
        self.set_rotation(joint, local.rotation);
        self.set_scale(joint, local.scale);
    }

    /// Sets a joint's local translation.
    pub fn set_translation(&mut self, joint: JointIndex, translation: Vec3) {
        let (group, lane) = self.place(joint);
        self.groups[group].translation.set(lane, translation);
    }

    /// Sets a joint's local rotation, normalized.
    pub fn set_rotation(&mut self, joint: JointIndex, rotation: Quat) {
        let (group, lane) = self.place(joint);
        self.groups[group].rotation.set(lane, rotation);
    }

    /// Sets a joint's local scale.
    pub fn set_scale(&mut self, joint: JointIndex, scale: Vec3) {
        let (group, lane) = self.place(joint);
        self.groups[group].scale.set(lane, scale);
    }

    /// Returns a joint's group and its lane.
    pub(super) fn place(&self, joint: JointIndex) -> (usize, usize) {
        let lane = self.lane_of_joint[joint.get()] as usize;
        (lane / LANES, lane % LANES)
    }

    /// Copies another pose, without allocating if the sizes match.
    pub fn copy_from(&mut self, other: &Pose) {
        self.groups.clone_from(&other.groups);
        self.lane_of_joint.clone_from(&other.lane_of_joint);
        self.morph_weights.clone_from(&other.morph_weights);
    }

    /// Blends towards another pose of the same skeleton: weight 1 keeps `self`, 0 gives `other`. Rotations take the
    /// shorter arc at nearly constant speed.
    pub fn blend(&mut self, other: &Pose, weight: f32) {
        for joint in (0..self.len().min(other.len()) as u32).map(JointIndex) {
            let (own, other) = (self.local(joint), other.local(joint));
            let blended = Transform {
                translation: other.translation.lerp(own.translation, weight),
                // `Quat::lerp` takes the shorter arc and normalizes.
                rotation: other.rotation.lerp(own.rotation, weight),
                scale: other.scale.lerp(own.scale, weight),
            };
            self.set_local(joint, blended);
        }
        for (own, other) in self.morph_weights.iter_mut().zip(&other.morph_weights) {
            *own = other + (*own - other) * weight;
        }
    }
}
