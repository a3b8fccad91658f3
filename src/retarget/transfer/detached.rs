//! Rigs whose feet or hands hang beside the limb instead of at its end (left over from inverse kinematics in the authoring
//! tool): rotations alone would leave them behind, so they get a translation that keeps them where the limb ends.

use std::cell::RefCell;

use glam::{DAffine3, DVec3};

use crate::anim::{Clip, Interpolation, JointIndex, Keys, Pose, SampleCursor};
use crate::asset::Slot;
use crate::retarget::align::rest::{Reference, ancestry};
use crate::retarget::keys::resample::{Resampled, resample, union};
use crate::retarget::retargeting::Retargeting;
use crate::retarget::transfer::rotation::NewChannel;

/// A limb's end, and the joint that it should hang on.
const ENDS: [(Slot, Slot); 8] = [
    (Slot::LeftFoot, Slot::LeftLowerLeg),
    (Slot::RightFoot, Slot::RightLowerLeg),
    (Slot::LeftLowerLeg, Slot::LeftUpperLeg),
    (Slot::RightLowerLeg, Slot::RightUpperLeg),
    (Slot::LeftHand, Slot::LeftLowerArm),
    (Slot::RightHand, Slot::RightLowerArm),
    (Slot::LeftLowerArm, Slot::LeftUpperArm),
    (Slot::RightLowerArm, Slot::RightUpperArm),
];

/// Straight interpolation stays this near, as a share of the hips' height.
const TOLERANCE_OF_HEIGHT: f64 = 1e-3;

impl Retargeting<'_> {
    /// Ends and the limbs that they do not hang on.
    fn detached_ends(&self) -> Vec<(JointIndex, JointIndex)> {
        let skeleton = &self.model.asset.skeleton;
        let joint_of = |slot| self.alignment.pair_of_slot.get(&slot).map(|&pair: &usize| self.map.pairs[pair].target);
        let mapped = ENDS.iter().filter_map(|&(end, limb)| Some((joint_of(end)?, joint_of(limb)?)));
        mapped.filter(|&(end, limb)| !ancestry(skeleton, end).any(|joint| joint == limb)).collect()
    }

    pub fn has_detached_ends(&self) -> bool {
        !self.detached_ends().is_empty()
    }

    /// Translations of the mapped ends that do not hang on their limbs, for a clip that has all else. Empty for most rigs.
    pub fn detached_channels(&self, clip: &Clip) -> Vec<NewChannel> {
        let times = union(clip.timelines().iter().map(Vec::as_slice));
        let scratch = RefCell::new((SampleCursor::default(), Pose::default()));
        let at = |time: f32| {
            let (cursor, pose) = &mut *scratch.borrow_mut();
            self.target_at(clip, time, cursor, pose)
        };
        let height = self.hips.map_or(1.0, |hips| hips.height);
        self.detached_ends()
            .into_iter()
            .map(|(end, limb)| {
                let rest = &self.alignment.target_as_built;
                let offset =
                    rest.rotations[limb.get()].conjugate() * (rest.positions[end.get()] - rest.positions[limb.get()]);
                let place = |time: f32| {
                    let now = at(time);
                    let place = now.positions[limb.get()] + now.rotations[limb.get()] * offset;
                    self.frame_above(end, &now).inverse().transform_point3(place)
                };
                let unit = self.frame_above(end, rest).matrix3.x_axis.length().max(1e-12);
                let tolerance = TOLERANCE_OF_HEIGHT * height / unit;
                let mix = |a: DVec3, b: DVec3, factor| a.lerp(b, factor);
                let Resampled { times, values } = resample(&times, &[], tolerance, place, mix, |a, b| a.distance(b));
                NewChannel {
                    joint: end,
                    interpolation: Interpolation::Linear,
                    times,
                    keys: Keys::Translation(values.into_iter().map(DVec3::as_vec3).collect()),
                    resampled: true,
                }
            })
            .collect()
    }

    /// The frame that a target joint hangs in, common frame.
    pub fn frame_above(&self, joint: JointIndex, now: &Reference) -> DAffine3 {
        let skeleton = &self.model.asset.skeleton;
        let frame = ancestry(skeleton, joint)
            .skip(1)
            .fold(DAffine3::IDENTITY, |below, ancestor| now.locals[ancestor.get()].to_affine() * below);
        DAffine3::from_quat(self.alignment.target_turn) * frame
    }
}
