//! A finished clip as the player plays it, for what is measured on it.

use gaitway_character::anim::{Clip, JointIndex, Pose, Reflection, Skeleton};

use crate::pose::{Local, PartialPose, Scratch, WorldPose};
use crate::transfer::Transfer;

/// The measured joints of the target, in the common frame.
pub struct PlayedClip<'a> {
    skeleton: &'a Skeleton,
    reflection: &'a Reflection,
    scratch: Scratch,
    pose: PartialPose<'a>,
}

impl<'a> PlayedClip<'a> {
    pub fn new(transfer: &Transfer<'a>, joints: &[JointIndex]) -> Self {
        let skeleton = transfer.target_skeleton;
        let pose = PartialPose::new(skeleton, transfer.alignment.target.world_from_model, joints.iter().copied());
        Self { skeleton, reflection: skeleton.reflection(), scratch: Scratch::default(), pose }
    }

    /// Poses the joints as the player would play a clip; those of a mirrored skeleton in the mirror, as its source is.
    pub fn pose(&mut self, clip: &Clip, time_secs: f32) -> &WorldPose {
        let sampled = self.scratch.sample(self.skeleton, clip, time_secs);
        self.pose.update(|joint| Local::from(&sampled.local(joint)).in_mirror(self.reflection, joint))
    }

    /// The same as a pose of the clip that has been sampled.
    pub fn in_pose(&mut self, sampled: &Pose) -> &WorldPose {
        self.pose.update(|joint| Local::from(&sampled.local(joint)).in_mirror(self.reflection, joint))
    }
}
