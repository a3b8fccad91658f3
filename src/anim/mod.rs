//! Skeletons, poses and clips. Independent of files, GPU, user interface and clock.

mod channel;
mod clip;
mod playback;
mod polar;
mod pose;
mod sampler;
mod skeleton;
mod transform;

pub use channel::{Channel, ChannelError, Interpolation, Keys, Property};
pub use clip::{Clip, ClipBuilder, SampleCursor};
pub use playback::{LoopMode, TimeRange, clip_time};
pub use polar::nearest_rotation;
pub use pose::{Pose, model_from_joint};
pub use skeleton::{Joint, JointIndex, Skeleton, SkeletonError};
pub use transform::Transform;
