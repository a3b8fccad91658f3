//! What is set manually and overrides the clip: rotations of joints, morph weights, expressions.
//!
//! Rotations are Euler angles from the rest pose, so that sliders show what was set and links stay short. Exported clips
//! hold all of it still, before pins are baked in.

use std::collections::BTreeMap;

use gaitway_character::anim::{Clip, JointIndex, Pose};
use gaitway_retarget::{HeldValues, hold_values};
use glam::{EulerRot, Quat};

use crate::library::Model;

/// Values that hold still whatever the clip does. What the model lacks is ignored.
#[derive(Debug, Clone, Copy)]
pub struct Held<'a> {
    /// Euler angles of joints in degrees, by index in the file; see [`manual_rotation`].
    pub rotations: &'a BTreeMap<usize, [f32; 3]>,
    /// By index in [`Pose::morph_weights`].
    pub morph_weights: &'a BTreeMap<usize, f32>,
    /// By [`Expression::name`](gaitway_character::avatar::Expression::name).
    pub expressions: &'a BTreeMap<String, f32>,
}

/// Returns a manually posed joint's local rotation: from its rest rotation about its own X, then its new Y, then its new Z.
pub fn manual_rotation(rest: Quat, degrees: [f32; 3]) -> Quat {
    let [x, y, z] = degrees.map(f32::to_radians);
    (rest * Quat::from_euler(EulerRot::XYZ, x, y, z)).normalize()
}

/// Returns the angles of [`manual_rotation`] for a local rotation.
pub fn manual_degrees(rest: Quat, rotation: Quat) -> [f32; 3] {
    let (x, y, z) = (rest.conjugate() * rotation).normalize().to_euler(EulerRot::XYZ);
    [x, y, z].map(f32::to_degrees)
}

static NO_ROTATIONS: BTreeMap<usize, [f32; 3]> = BTreeMap::new();
static NO_MORPH_WEIGHTS: BTreeMap<usize, f32> = BTreeMap::new();
static NO_EXPRESSIONS: BTreeMap<String, f32> = BTreeMap::new();

impl<'a> Held<'a> {
    /// Nothing is held.
    pub const NOTHING: Self =
        Self { rotations: &NO_ROTATIONS, morph_weights: &NO_MORPH_WEIGHTS, expressions: &NO_EXPRESSIONS };

    /// Only the rotations.
    pub(super) fn joints(self) -> Self {
        Self { rotations: self.rotations, ..Self::NOTHING }
    }

    fn rotations(&self, model: &'a Model) -> impl Iterator<Item = (JointIndex, Quat)> + use<'a> {
        let skeleton = &model.asset.skeleton;
        self.rotations.iter().filter_map(|(&joint, &degrees)| {
            let joint = skeleton.joint_of_source(joint)?;
            Some((joint, manual_rotation(skeleton.rest().local(joint).rotation, degrees)))
        })
    }

    fn morph_weights(&self, model: &Model) -> impl Iterator<Item = (usize, f32)> + use<'a> {
        let count = model.asset.skeleton.rest().morph_weights.len();
        self.morph_weights.range(..count).map(|(&index, &weight)| (index, weight))
    }

    /// The weights of expressions by their index.
    pub(super) fn expressions(&self, model: &'a Model) -> impl Iterator<Item = (usize, f32)> + use<'a> {
        let avatar = &model.asset.avatar;
        self.expressions.iter().filter_map(|(name, &weight)| Some((avatar.expression(name)?, weight)))
    }

    /// Whether anything that the model has is held.
    pub fn is_any(&self, model: &'a Model) -> bool {
        self.rotations(model).next().is_some()
            || self.morph_weights(model).next().is_some()
            || self.expressions(model).next().is_some()
    }

    /// Poses the joints.
    pub(super) fn pose_joints(&self, model: &'a Model, pose: &mut Pose) {
        for (joint, rotation) in self.rotations(model) {
            pose.set_rotation(joint, rotation);
        }
    }

    /// Sets the morph weights.
    pub(super) fn set_morph_weights(&self, model: &Model, pose: &mut Pose) {
        for (index, weight) in self.morph_weights(model) {
            if let Some(slot) = pose.morph_weights.get_mut(index) {
                *slot = weight;
            }
        }
    }

    /// Returns a clip that holds them; `None` if there are none.
    pub(super) fn hold(&self, model: &'a Model, clip: &Clip) -> Option<Clip> {
        self.is_any(model).then(|| {
            let held = HeldValues {
                rotations: self.rotations(model).collect(),
                morph_weights: self.morph_weights(model).collect(),
                expressions: self.expressions(model).collect(),
            };
            hold_values(&model.asset.skeleton, clip, &held)
        })
    }
}
