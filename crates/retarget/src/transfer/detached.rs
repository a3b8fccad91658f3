//! Rigs whose feet or hands hang beside the limb instead of at its end (left over from inverse kinematics in the authoring
//! tool). Rotations alone would leave them behind, so they get a translation that keeps them at the end of the limb.

use std::cell::RefCell;

use gaitway_character::anim::{Clip, JointIndex};
use gaitway_character::asset::Slot;

use super::Transfer;
use crate::keys::channel::NewChannel;
use crate::keys::limits::height_or_metre;
use crate::keys::resample::{resample_positions, union};
use crate::pose::{Scratch, is_within};

/// The end of a limb, and the joint that it should hang on.
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

/// Maximum error of resampled positions, as a share of the hips' height.
const TOLERANCE_OF_HEIGHT: f64 = 1e-3;

/// Mapped ends that are not descendants of their limb, each with that limb. Empty for most rigs.
pub fn detached_ends(transfer: &Transfer) -> Vec<(JointIndex, JointIndex)> {
    let joint = |slot| transfer.pair(slot).map(|pair| pair.target);
    let mapped = ENDS.iter().filter_map(|&(end, limb)| Some((joint(end)?, joint(limb)?)));
    mapped.filter(|&(end, limb)| !is_within(transfer.target_skeleton, end, limb)).collect()
}

/// Returns the translations of detached ends for a clip that has everything else.
pub fn detached_channels(transfer: &Transfer, ends: &[(JointIndex, JointIndex)], clip: &Clip) -> Vec<NewChannel> {
    let times = union(clip.timelines().iter().map(Vec::as_slice));
    let height = transfer.hips.map_or(1.0, |hips| hips.height);
    let reflection = transfer.target_skeleton.reflection();
    let scratch = RefCell::new(Scratch::default());
    let channel = |&(end, limb): &(JointIndex, JointIndex)| {
        let rest = &transfer.alignment.unaligned_target;
        let offset = rest.rotation(limb).conjugate() * (rest.position(end) - rest.position(limb));
        let translation = |time: f32| {
            let pose = transfer.target_pose(clip, time, &mut scratch.borrow_mut());
            let position = pose.position(limb) + pose.rotation(limb) * offset;
            let local = pose.parent_frame(transfer.target_skeleton, end).inverse().transform_point3(position);
            reflection.translation(end, local)
        };
        // The tolerance is in the units of the end's parent.
        let unit_length = rest.parent_frame(transfer.target_skeleton, end).matrix3.x_axis.length().max(1e-12);
        let tolerance = TOLERANCE_OF_HEIGHT * height_or_metre(height) / unit_length;
        NewChannel::resampled_translation(end, resample_positions(&times, &[], tolerance, translation))
    };
    ends.iter().map(channel).collect()
}
