//! The source beside its target: where it stands in the model's space, and how far each pair is apart.

use glam::{Affine3A, DAffine3, Quat};

use crate::anim::{JointIndex, Transform};
use crate::retarget::retargeting::Retargeting;

/// A joint that follows another. `target_rest` and `source_rest` are rotations of the aligned rests in the model's space:
/// both joints turn away from theirs alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StagePair {
    pub target: JointIndex,
    pub source: JointIndex,
    pub target_rest: Quat,
    pub source_rest: Quat,
}

impl StagePair {
    /// The angle between the turns of the two away from their rests, radians. Both worlds are seen in the model's space, or
    /// both turned alike; scales do not matter. None where a matrix is singular or mirrored.
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

impl Retargeting<'_> {
    /// Brings the source's world into the model's space: facing the same way, the hips as high above the ground and in the
    /// same place.
    pub fn model_from_source(&self) -> Affine3A {
        let turn = |rotation| DAffine3::from_quat(rotation);
        let (to_common, from_common) = (turn(self.alignment.source_turn), turn(self.alignment.target_turn.conjugate()));
        let between = self.hips.map_or(DAffine3::IDENTITY, |hips| {
            DAffine3::from_translation(hips.target_rest)
                * DAffine3::from_scale(glam::DVec3::splat(hips.scale))
                * DAffine3::from_translation(-hips.source_rest)
        });
        (from_common * between * to_common).as_affine3a()
    }

    /// All pairs of the map.
    pub fn stage_pairs(&self) -> Vec<StagePair> {
        let model_from_common = self.alignment.target_turn.conjugate();
        let pairs = self.map.pairs.iter().map(|pair| StagePair {
            target: pair.target,
            source: pair.source,
            target_rest: (model_from_common * self.alignment.target.rotations[pair.target.get()]).as_quat(),
            source_rest: (model_from_common * self.alignment.source.rotations[pair.source.get()]).as_quat(),
        });
        pairs.collect()
    }
}
