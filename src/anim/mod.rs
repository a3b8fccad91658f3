//! Skeletons, poses and clips: what moves and when. Knows no file, GPU, user interface or clock.

mod clip;
mod playback;
mod polar;
mod pose;
mod sampler;
mod skeleton;
mod transform;

pub use clip::{Channel, ChannelError, Clip, ClipBuilder, Interpolation, Keys, Property, SampleCursor};
pub use playback::{LoopMode, TimeRange, clip_time};
pub use polar::nearest_rotation;
pub use pose::{Pose, model_from_joint};
pub use skeleton::{Joint, JointIndex, Skeleton, SkeletonError};
pub use transform::Transform;
