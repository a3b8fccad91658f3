//! Small skeletons and clips built in code.

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, Joint, JointIndex, Keys, Skeleton, Transform};
use glam::{Quat, Vec3};

use crate::skeletons::joint;

/// A chain of `count` joints, each 0.1 m above its parent and slightly rotated.
pub fn chain(count: usize) -> Skeleton {
    let rest = Transform { translation: Vec3::Y * 0.1, rotation: Quat::from_rotation_z(0.05), scale: Vec3::ONE };
    let joints = (0..count).map(|at| joint(&format!("joint {at}"), at.checked_sub(1), rest)).collect();
    Skeleton::new(joints).unwrap()
}

/// One joint with two morph targets at rest weights 0.25 and 0.5.
pub fn one_joint() -> Skeleton {
    let joint = Joint { morph_weights: vec![0.25, 0.5], ..joint("only", None, Transform::IDENTITY) };
    Skeleton::new(vec![joint]).unwrap()
}

/// A clip with one channel on joint 0.
pub fn one_channel(skeleton: &Skeleton, interpolation: Interpolation, times_secs: &[f32], keys: Keys) -> Clip {
    let mut builder = ClipBuilder::new("clip", skeleton);
    builder.channel(JointIndex(0), interpolation, times_secs, keys).unwrap();
    builder.build()
}
