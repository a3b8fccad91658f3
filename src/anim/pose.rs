//! Poses, and the conversion from local to model space.

use glam::Affine3A;

use super::{Skeleton, Transform};

/// The output of sampling and the input of skinning: one local transform per joint, and the morph weights of all meshes,
/// concatenated (see [`Skeleton::morph_range`]).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Pose {
    /// One per joint.
    pub locals: Vec<Transform>,
    /// Usually from 0 to 1, but not clamped.
    pub morph_weights: Vec<f32>,
}

impl Pose {
    /// Copies another pose, without allocating if the sizes match.
    pub fn copy_from(&mut self, other: &Pose) {
        self.locals.clone_from(&other.locals);
        self.morph_weights.clone_from(&other.morph_weights);
    }

    /// Blends towards another pose of the same skeleton: weight 1 keeps `self`, 0 gives `other`. Rotations take the
    /// shorter arc at nearly constant speed.
    pub fn blend(&mut self, other: &Pose, weight: f32) {
        for (local, other) in self.locals.iter_mut().zip(&other.locals) {
            local.translation = other.translation.lerp(local.translation, weight);
            local.scale = other.scale.lerp(local.scale, weight);
            // `Quat::lerp` takes the shorter arc and normalizes.
            local.rotation = other.rotation.lerp(local.rotation, weight);
        }
        for (own, other) in self.morph_weights.iter_mut().zip(&other.morph_weights) {
            *own = other + (*own - other) * weight;
        }
    }
}

/// Computes the transform of every joint. `locals` and `out` have one entry per joint. `world_from_model` is applied to
/// root joints; identity gives model space.
pub fn model_from_joint(
    skeleton: &Skeleton,
    locals: &[Transform],
    world_from_model: Affine3A,
    out: &mut Vec<Affine3A>,
) {
    debug_assert_eq!(skeleton.len(), locals.len());
    out.resize(skeleton.len(), Affine3A::IDENTITY);
    for (joint, (local, parent)) in locals.iter().zip(skeleton.parents()).enumerate() {
        let model_from_parent = parent.map_or(world_from_model, |parent| out[parent.get()]);
        out[joint] = local.below(&model_from_parent);
    }
}
