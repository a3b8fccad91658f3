//! Skins: the joints that deform a mesh, with their inverse bind matrices.

use glam::{Affine3A, Mat4, Vec4};

use crate::anim::JointIndex;

/// Joints, each with an inverse bind matrix. Immutable once built.
#[derive(Debug, Clone)]
pub struct Skin {
    name: String,
    joints: Vec<JointIndex>,
    joint_from_bind: Vec<Affine3A>,
    /// The same matrices as rows, the form the palette needs.
    joint_from_bind_rows: Vec<[Vec4; 3]>,
}

/// Why a skin cannot be built.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SkinError {
    /// Joints and inverse bind matrices must have the same count.
    #[error("{joints} joints but {matrices} inverse bind matrices")]
    MatrixCount {
        /// Number of joints.
        joints: usize,
        /// Number of inverse bind matrices.
        matrices: usize,
    },
    /// A joint is not in the skeleton.
    #[error("joint {joint} is out of range, the skeleton has {count} joints")]
    NoSuchJoint {
        /// Index in the skeleton.
        joint: usize,
        /// Number of joints in the skeleton.
        count: usize,
    },
    /// An inverse bind matrix has an infinite or NaN component.
    #[error("the inverse bind matrix of joint {joint} is not finite")]
    NotFinite {
        /// Index in the skin's list of joints.
        joint: usize,
    },
    /// The list of joints is empty.
    #[error("a skin needs at least one joint")]
    NoJoints,
    /// Joint indices of vertices are `u16`.
    #[error("{joints} joints, but influences can address at most {}", u16::MAX)]
    TooManyJoints {
        /// Number of joints.
        joints: usize,
    },
}

impl Skin {
    /// `joint_from_bind` has one inverse bind matrix per joint; `skeleton_len` bounds the joint indices.
    pub fn new(
        name: String,
        joints: Vec<JointIndex>,
        joint_from_bind: Vec<Affine3A>,
        skeleton_len: usize,
    ) -> Result<Self, SkinError> {
        if joints.is_empty() {
            return Err(SkinError::NoJoints);
        }
        if joints.len() > u16::MAX as usize {
            return Err(SkinError::TooManyJoints { joints: joints.len() });
        }
        if joints.len() != joint_from_bind.len() {
            return Err(SkinError::MatrixCount { joints: joints.len(), matrices: joint_from_bind.len() });
        }
        if let Some(joint) = joints.iter().find(|joint| joint.get() >= skeleton_len) {
            return Err(SkinError::NoSuchJoint { joint: joint.get(), count: skeleton_len });
        }
        if let Some(joint) = joint_from_bind.iter().position(|matrix| !matrix.is_finite()) {
            return Err(SkinError::NotFinite { joint });
        }
        let rows = |matrix: &Affine3A| {
            let rows = Mat4::from(*matrix).transpose();
            [rows.x_axis, rows.y_axis, rows.z_axis]
        };
        let joint_from_bind_rows = joint_from_bind.iter().map(rows).collect();
        Ok(Self { name, joints, joint_from_bind, joint_from_bind_rows })
    }

    /// The name in the file; may be empty.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The joints in palette order, which influences index.
    pub fn joints(&self) -> &[JointIndex] {
        &self.joints
    }

    /// Inverse bind matrices, one per joint of the skin.
    pub fn joint_from_bind(&self) -> &[Affine3A] {
        &self.joint_from_bind
    }

    pub(super) fn joint_from_bind_rows(&self) -> &[[Vec4; 3]] {
        &self.joint_from_bind_rows
    }
}
