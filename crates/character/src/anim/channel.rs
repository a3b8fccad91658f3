//! Animation channels: the keyframes of one property of one joint.

use glam::{Quat, Vec3};

use super::JointIndex;

/// How values between two keys are computed (glTF 2.0 appendix C).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// Holds the previous key's value until the next key.
    Step,
    /// Straight line between keys; slerp along the shorter arc for rotations.
    Linear,
    /// Hermite spline: each key has an in-tangent, a value and an out-tangent, with tangents per second.
    CubicSpline,
}

/// The animated property of a joint, `path` in a glTF channel target.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Property {
    /// Local translation.
    Translation,
    /// Local rotation.
    Rotation,
    /// Local scale.
    Scale,
    /// Weights of all morph targets of the mesh on the joint; `weights` in glTF.
    MorphWeights,
}

/// Key values of a channel. CUBICSPLINE has three entries per key: in-tangent, value, out-tangent.
#[derive(Debug, Clone, PartialEq)]
pub enum Keys {
    /// Local translations.
    Translation(Vec<Vec3>),
    /// Local rotations, not necessarily normalized.
    Rotation(Vec<Quat>),
    /// Local scales, one factor per axis.
    Scale(Vec<Vec3>),
    /// One weight per morph target in each entry, targets varying fastest.
    MorphWeights {
        /// `targets` values per entry.
        values: Vec<f32>,
        /// Number of morph targets of the mesh on the joint.
        targets: usize,
    },
}

impl Keys {
    /// The property that these keys animate.
    pub fn property(&self) -> Property {
        match self {
            Self::Translation(_) => Property::Translation,
            Self::Rotation(_) => Property::Rotation,
            Self::Scale(_) => Property::Scale,
            Self::MorphWeights { .. } => Property::MorphWeights,
        }
    }

    /// Returns the number of values and the number per entry.
    pub(super) fn count(&self) -> (usize, usize) {
        match self {
            Self::Translation(values) | Self::Scale(values) => (values.len(), 1),
            Self::Rotation(values) => (values.len(), 1),
            Self::MorphWeights { values, targets } => (values.len(), *targets),
        }
    }
}

/// The keys of one property of one joint, added by [`ClipBuilder::channel`](super::ClipBuilder::channel).
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// The animated joint.
    pub joint: JointIndex,
    /// How values between the keys are computed.
    pub interpolation: Interpolation,
    /// Index into [`Clip::timelines`](super::Clip::timelines).
    pub timeline: u32,
    /// Key values, matching the timeline's times.
    pub keys: Keys,
}

/// Why a channel cannot be added to a clip. Keys are counted from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChannelError {
    /// The list of key times is empty.
    #[error("there are no keys")]
    NoKeys,
    /// Key times must be strictly increasing.
    #[error("key {key} at {time_secs} s does not come after the previous key at {before_secs} s")]
    TimesNotIncreasing {
        /// Index of the key that is too early.
        key: usize,
        /// Time of that key.
        time_secs: f32,
        /// Time of the key before it.
        before_secs: f32,
    },
    /// A key time is negative or not finite.
    #[error("key {key}: expected a non-negative time in seconds, found {time_secs}")]
    BadTime {
        /// Index of the key.
        key: usize,
        /// Its time.
        time_secs: f32,
    },
    /// The number of values does not match the number of keys.
    #[error("expected {expected} values for {keys} keys, found {found}")]
    ValueCount {
        /// Number of key times.
        keys: usize,
        /// Number of values they need, including tangents for CUBICSPLINE and one value per morph target.
        expected: usize,
        /// Number of values given.
        found: usize,
    },
    /// The joint is not in the skeleton.
    #[error("joint {joint} is out of range, the skeleton has {count} joints")]
    NoSuchJoint {
        /// The joint's index.
        joint: usize,
        /// Number of joints in the skeleton.
        count: usize,
    },
    /// The number of morph targets does not match the mesh, or the joint has none.
    #[error("the keys have {found} morph targets, but the mesh on this joint has {expected}")]
    MorphTargetCount {
        /// Number of morph targets of the mesh on the joint, 0 if it has none.
        expected: usize,
        /// Number of morph targets of the keys.
        found: usize,
    },
}
