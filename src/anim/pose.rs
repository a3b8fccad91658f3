//! One local transform per joint, and the walk from local to model space.

use glam::Affine3A;

use super::{Skeleton, Transform};

/// What a clip writes and skinning reads: local transforms, and the weights of all morph targets one mesh after the
/// other (see [`Skeleton::morph_range`]).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Pose {
    pub locals: Vec<Transform>,
    pub morph_weights: Vec<f32>,
}

impl Pose {
    /// Copies another pose without allocating when the sizes agree.
    pub fn copy_from(&mut self, other: &Pose) {
        self.locals.clone_from(&other.locals);
        self.morph_weights.clone_from(&other.morph_weights);
    }

    /// Turns `self` into a mixture: `weight` 1 leaves it as it is, 0 makes it `other`. Rotations take the shorter way, at
    /// nearly constant speed. Both have the same skeleton.
    pub fn blend(&mut self, other: &Pose, weight: f32) {
        for (local, other) in self.locals.iter_mut().zip(&other.locals) {
            local.translation = other.translation.lerp(local.translation, weight);
            local.scale = other.scale.lerp(local.scale, weight);
            // Rotations may be unnormalised splines by a hair; `lerp` minds the sign and makes them unit again.
            local.rotation = other.rotation.lerp(local.rotation, weight);
        }
        for (own, other) in self.morph_weights.iter_mut().zip(&other.morph_weights) {
            *own = other + (*own - other) * weight;
        }
    }
}

/// Model-space transform of every joint. `locals` and `out` have one entry per joint; joints without a parent are
/// placed by `world_from_model`, so passing identity gives model space.
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
