//! The clip that the frames of a file make: one key per frame, in metres and Y up.

use std::ops::Range;

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, Keys, Skeleton};
use gaitway_character::asset::{Warning, Warnings};
use glam::{DVec3, Quat, Vec3};

use super::frame_of_reference::FrameOfReference;
use super::hierarchy::{BvhJoint, Channel, Hierarchy};
use super::motion::Frames;
use crate::error::Problem;
use crate::limits::Budget;
use crate::lines::text;

impl Frames {
    /// Builds a clip with at most one rotation channel and one translation channel per joint.
    pub fn into_clip(
        self,
        name: &str,
        hierarchy: &Hierarchy,
        reference: &FrameOfReference,
        skeleton: &Skeleton,
        budget: &Budget,
        warnings: &mut Warnings,
    ) -> Result<Option<Clip>, Problem> {
        let times_secs: Vec<f32> = (0..self.frame_count).map(|frame| (frame as f64 * self.frame_secs) as f32).collect();
        let mut builder = ClipBuilder::new(name, skeleton);
        let mut first = 0;
        for (index, joint) in hierarchy.joints.iter().enumerate() {
            let channels = first..first + joint.channels.len();
            first = channels.end;
            let Some(target) = skeleton.joint_of_source(index) else { continue };
            let has = |kind: fn(&Channel) -> bool| joint.channels.iter().any(kind);
            let mut add = |keys: Keys| {
                builder.channel(target, Interpolation::Linear, &times_secs, keys).map_err(|problem| {
                    Problem::new(format!("line {}", self.line), "usable key times", problem.to_string())
                })
            };
            let place = format_args!("line {}", self.line);
            if has(|channel| matches!(channel, Channel::Rotation(_))) {
                budget.allocate(self.frame_count, size_of::<Quat>(), &place)?;
                add(Keys::Rotation(self.rotations(joint, &channels, reference)))?;
            }
            if has(|channel| matches!(channel, Channel::Position(_))) {
                budget.allocate(self.frame_count, size_of::<Vec3>(), &place)?;
                match self.translations(index, joint, &channels, reference)? {
                    Some(keys) => add(Keys::Translation(keys))?,
                    None => {
                        let problem =
                            "its positions are all zero, which would collapse it onto its parent; its OFFSET is used"
                                .to_owned();
                        let place = format!("joint {index} “{}”", text(joint.name.as_bytes()));
                        warnings.push(Warning::ChannelIgnored { clip: name.to_owned(), place, problem });
                    }
                }
            }
        }
        Ok(Some(builder.build()))
    }

    /// The numbers of some channels, frame by frame.
    fn values(&self, channels: &Range<usize>) -> impl Iterator<Item = &[f64]> + Clone {
        (0..self.frame_count).map(|frame| self.frame(frame).get(channels.clone()).unwrap_or_default())
    }

    /// Rotation keys, each with the sign that is closer to the previous key.
    fn rotations(&self, joint: &BvhJoint, channels: &Range<usize>, reference: &FrameOfReference) -> Vec<Quat> {
        let mut keys: Vec<Quat> = Vec::with_capacity(self.frame_count);
        for values in self.values(channels) {
            let key = reference.rotation(joint.rotation(values));
            keys.push(if keys.last().is_some_and(|before| before.dot(key) < 0.0) { -key } else { key });
        }
        keys
    }

    /// Translation keys. `None` if all are zero although the joint has an OFFSET.
    fn translations(
        &self,
        index: usize,
        joint: &BvhJoint,
        channels: &Range<usize>,
        reference: &FrameOfReference,
    ) -> Result<Option<Vec<Vec3>>, Problem> {
        let positions = self.values(channels).map(|values| joint.position(values));
        if joint.parent.is_some() && joint.offset != DVec3::ZERO && positions.clone().all(|at| at == DVec3::ZERO) {
            return Ok(None);
        }
        let keys: Vec<Vec3> = positions.map(|at| reference.point(at)).collect();
        match keys.iter().position(|key| !key.is_finite()) {
            None => Ok(Some(keys)),
            Some(frame) => {
                let place = format!("frame {frame}, position of joint {index}");
                Err(Problem::new(place, "numbers that fit into 32 bits", keys[frame]))
            }
        }
    }
}
