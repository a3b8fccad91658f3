//! Animation channels: the keyframes of one property of one joint.

use glam::{Quat, Vec3};

use super::JointIndex;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Interpolation {
    Step,
    Linear,
    /// Hermite spline: each key has an in-tangent, a value and an out-tangent, with tangents per second.
    CubicSpline,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Property {
    Translation,
    Rotation,
    Scale,
    MorphWeights,
}

/// Key values of a channel. CUBICSPLINE has three entries per key: in-tangent, value, out-tangent.
#[derive(Debug, Clone, PartialEq)]
pub enum Keys {
    Translation(Vec<Vec3>),
    Rotation(Vec<Quat>),
    Scale(Vec<Vec3>),
    /// One weight per morph target in each entry, targets varying fastest.
    MorphWeights {
        values: Vec<f32>,
        targets: usize,
    },
}

impl Keys {
    pub fn property(&self) -> Property {
        match self {
            Self::Translation(_) => Property::Translation,
            Self::Rotation(_) => Property::Rotation,
            Self::Scale(_) => Property::Scale,
            Self::MorphWeights { .. } => Property::MorphWeights,
        }
    }

    /// Returns the number of values, and how many of them make an entry.
    pub(super) fn count(&self) -> (usize, usize) {
        match self {
            Self::Translation(values) | Self::Scale(values) => (values.len(), 1),
            Self::Rotation(values) => (values.len(), 1),
            Self::MorphWeights { values, targets } => (values.len(), *targets),
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    pub joint: JointIndex,
    pub interpolation: Interpolation,
    /// Index into [`Clip::timelines`](super::Clip::timelines).
    pub timeline: u32,
    pub keys: Keys,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChannelError {
    #[error("there are no keys")]
    NoKeys,
    #[error("key {key} at {time_secs} s does not come after the previous key at {before_secs} s")]
    TimesNotIncreasing { key: usize, time_secs: f32, before_secs: f32 },
    #[error("key {key}: expected a non-negative time in seconds, found {time_secs}")]
    BadTime { key: usize, time_secs: f32 },
    #[error("expected {expected} values for {keys} keys, found {found}")]
    ValueCount { keys: usize, expected: usize, found: usize },
    #[error("joint {joint} is out of range, the skeleton has {count} joints")]
    NoSuchJoint { joint: usize, count: usize },
    #[error("the keys have {found} morph targets, but the mesh on this joint has {expected}")]
    MorphTargetCount { expected: usize, found: usize },
}
