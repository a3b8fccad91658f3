//! How everything past the readers names a joint.

/// Index of a joint in its skeleton.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct JointIndex(pub u32);

impl JointIndex {
    /// The index as a `usize`, for slices with one entry per joint.
    pub fn get(self) -> usize {
        self.0 as usize
    }
}
