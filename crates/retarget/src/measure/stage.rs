//! The source shown beside its target: its placement in the model's space, and the error of each pair.

use gaitway_character::anim::{JointIndex, Skeleton, Transform};
use glam::{Affine3A, DAffine3, DVec3, Quat};

use crate::align::Alignment;
use crate::map::ResolvedMap;
use crate::pose::mirror_from_model;
use crate::transfer::Hips;

/// A pair of joints and the rotations of their aligned rests in the model's space, from which both turn away alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StagePair {
    /// Joint of the model.
    pub target: JointIndex,
    /// Joint of the motion.
    pub source: JointIndex,
    /// Aligned rest rotation of `target` in model space.
    pub target_rest: Quat,
    /// Rest rotation of `source`, turned into the target's model space.
    pub source_rest: Quat,
}

impl StagePair {
    /// Angle in radians between the rotations of the two joints away from their rests. Both matrices lead to the model's
    /// space, or to one turned from it by the same rotation; scale does not matter. None if either is singular or mirrored.
    pub fn error_radians(&self, world_from_target: &Affine3A, world_from_source: &Affine3A) -> Option<f32> {
        let rotation = |world: &Affine3A| {
            Some(Transform::from_matrix(&(*world).into())).filter(Transform::is_upright).map(|world| world.rotation)
        };
        let target = rotation(world_from_target)? * self.target_rest.conjugate();
        let source = rotation(world_from_source)? * self.source_rest.conjugate();
        let turn = target.conjugate() * source;
        Some(2.0 * turn.xyz().length().atan2(turn.w.abs()))
    }
}

/// Brings the source into the model's space: facing the same way, with the hips at the same place and height.
/// Takes the skeletons of the source and the model.
pub fn model_from_source(alignment: &Alignment, hips: Option<&Hips>, skeletons: [&Skeleton; 2]) -> Affine3A {
    let common_from_source = DAffine3::from_quat(alignment.source.world_from_model);
    let model_from_common = DAffine3::from_quat(alignment.target.world_from_model.conjugate());
    let target_from_source = hips.map_or(DAffine3::IDENTITY, |hips| {
        DAffine3::from_translation(hips.target_rest)
            * DAffine3::from_scale(DVec3::splat(hips.scale))
            * DAffine3::from_translation(-hips.source_rest)
    });
    // Mirroring twice changes nothing.
    let [mirror_source, mirror_model] = skeletons.map(|skeleton| mirror_from_model(skeleton).as_daffine3());
    (mirror_model * model_from_common * target_from_source * common_from_source * mirror_source).as_affine3a()
}

pub fn stage_pairs(map: &ResolvedMap, alignment: &Alignment) -> Vec<StagePair> {
    let model_from_common = alignment.target.world_from_model.conjugate();
    let pairs = map.pairs.iter().map(|pair| StagePair {
        target: pair.target,
        source: pair.source,
        target_rest: (model_from_common * alignment.target.rotation(pair.target)).as_quat(),
        source_rest: (model_from_common * alignment.source.rotation(pair.source)).as_quat(),
    });
    pairs.collect()
}
