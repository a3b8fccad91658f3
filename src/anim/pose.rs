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
