//! Transfers the motion: rotations, the hips' path, root motion, copied channels, detached limbs, and layered clips.

mod averaged;
mod copy;
mod detached;
mod expressions;
mod followers;
mod heading;
mod hips;
mod layers;
mod path;
mod path_channels;
mod removed_travel;
mod root_motion;
mod rotation;
mod turns;
mod twist;
mod yaw;

pub use copy::{CopyPolicy, copied_channels};
pub use detached::{detached_channels, detached_ends};
pub use expressions::expression_channels;
pub use followers::follower_channels;
pub use heading::rotation_laws;
pub use hips::{Hips, HipsInput, LEG_CHAINS, lowest_leg_joint, match_hips};
pub use layers::{Baking, LayerClip, bake_layers, baking, layer_clips};
pub use path_channels::hips_channels;
pub use removed_travel::{RemovedTravel, removed_travel};
pub use root_motion::extraction_joint;
pub use rotation::RotationLaw;
pub use turns::{Turn, Turns};
pub use twist::twist_channels;

use gaitway_character::anim::{Clip, JointIndex, Skeleton};
use gaitway_character::asset::{Asset, Slot};
use glam::DVec3;

use super::align::Alignment;
use super::body::{Anatomy, TwistJoint};
use super::keys::tracks::SourceTracks;
use super::map::{Pair, ResolvedMap};
use super::pose::{Scratch, WorldPose, clip_locals};
use turns::is_free;

/// Two skeletons aligned for one clip: what every step from here on reads.
#[derive(Debug, Clone, Copy)]
pub struct Transfer<'a> {
    pub map: &'a ResolvedMap,
    /// The file that the clip is from, for its mesh.
    pub source: &'a Asset,
    /// The source's skeleton and clip.
    pub tracks: &'a SourceTracks<'a>,
    pub target_skeleton: &'a Skeleton,
    /// The file that `target_skeleton` is from, for its mesh.
    pub target: &'a Asset,
    pub alignment: &'a Alignment,
    /// The target's chains; none unless the map shares them.
    pub anatomy: &'a Anatomy,
    /// Whose rotation each target joint takes.
    pub turns: &'a Turns,
    pub hips: Option<&'a Hips>,
}

impl<'a> Transfer<'a> {
    /// The pair that fills a slot.
    pub fn pair(&self, slot: Slot) -> Option<&'a Pair> {
        self.alignment.pair(self.map, slot)
    }

    /// The turn that a pair's target joint takes.
    pub fn turn(&self, pair: &Pair) -> Turn {
        self.turns.of(pair.target).unwrap_or(Turn::whole(pair.source))
    }

    /// The target joint that has the whole turn of its pair: the last twist joint between an upper arm and its elbow, or a thigh and
    /// its knee; otherwise the pair's own.
    pub fn turned(&self, pair: &Pair) -> JointIndex {
        let of_root = |twist: &&TwistJoint| {
            let root = self.anatomy.ends_of(twist.segment).map(|[root, _]| root);
            twist.in_chain && twist.segment.is_upper && root == Some(pair.target) && is_free(self.map, twist.joint)
        };
        self.anatomy.twists.iter().rfind(of_root).map_or(pair.target, |twist| twist.joint)
    }

    pub fn hips_pair(&self) -> Option<&'a Pair> {
        self.hips.map(|hips| &self.map.pairs[hips.pair])
    }

    /// Target units per source unit; 1 without hips.
    pub fn scale(&self) -> f64 {
        self.hips.map_or(1.0, |hips| hips.scale)
    }

    /// The target joint whose translation carries the hips.
    pub fn hips_carrier(&self) -> Option<JointIndex> {
        self.hips.map(|hips| hips.carrier)
    }

    /// Where a joint of the source is in the common frame.
    pub fn source_position(&self, joint: JointIndex, time_secs: f32) -> DVec3 {
        self.tracks.position(joint, time_secs, self.alignment.source.world_from_model)
    }

    /// Where the source's hips are in the common frame.
    pub fn source_hips(&self, time_secs: f32) -> Option<DVec3> {
        self.hips_pair().map(|pair| self.source_position(pair.source, time_secs))
    }

    /// The target in the common frame, as the player would play `clip`.
    pub fn target_pose(&self, clip: &Clip, time_secs: f32, scratch: &mut Scratch) -> WorldPose {
        let locals = clip_locals(self.target_skeleton, clip, time_secs, scratch);
        WorldPose::new(self.target_skeleton, locals, self.alignment.target.world_from_model)
    }
}
