//! Skeletons, poses and clips. Independent of files, GPU, user interface and clock.
//!
//! ```
//! use gaitway_character::anim::{ClipBuilder, Interpolation, Joint, Keys, SampleCursor, Skeleton};
//! use glam::Vec3;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let skeleton = Skeleton::new(vec![Joint { name: "hips".to_owned(), ..Joint::default() }])?;
//! let hips = skeleton.find("hips").ok_or("no hips")?;
//!
//! let mut builder = ClipBuilder::new("step", &skeleton);
//! let path = Keys::Translation(vec![Vec3::ZERO, Vec3::X]);
//! builder.channel(hips, Interpolation::Linear, &[0.0, 1.0], path)?;
//! let clip = builder.build();
//!
//! let mut pose = skeleton.rest().clone();
//! clip.sample(&skeleton, 0.25, &mut SampleCursor::default(), &mut pose);
//! assert_eq!(pose.local(hips).translation, Vec3::new(0.25, 0.0, 0.0));
//! # Ok(())
//! # }
//! ```

mod channel;
mod clip;
mod joint;
mod kernels;
mod layer;
mod model_space;
mod playback;
mod polar;
mod pose;
mod property;
mod reflection;
mod sampler;
mod skeleton;
mod transform;

pub use channel::{Channel, ChannelError, Interpolation, Keys, Property};
pub use clip::{Clip, ClipBuilder, ClipQuery, SampleCursor, find_clip};
pub use joint::JointIndex;
pub use layer::JointMask;
pub use model_space::{model_from_joint, model_from_single_joint};
pub use playback::{LoopMode, TimeRange, clip_time};
pub use polar::nearest_rotation;
pub use pose::Pose;
pub use property::{
    CameraProperty, LightProperty, LobeFactor, MaterialProperty, PropertyChannel, PropertyTarget, PropertyValues,
    TextureSlot, ToonColor,
};
pub use reflection::Reflection;
pub use skeleton::{Joint, Skeleton, SkeletonError};
pub use transform::Transform;
