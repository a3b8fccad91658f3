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

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SkinError {
    #[error("{joints} joints but {matrices} inverse bind matrices")]
    MatrixCount { joints: usize, matrices: usize },
    #[error("joint {joint} is out of range, the skeleton has {count} joints")]
    NoSuchJoint { joint: usize, count: usize },
    #[error("the inverse bind matrix of joint {joint} is not finite")]
    NotFinite { joint: usize },
    #[error("a skin needs at least one joint")]
    NoJoints,
    #[error("{joints} joints, but influences can address at most {}", u16::MAX)]
    TooManyJoints { joints: usize },
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

    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn joints(&self) -> &[JointIndex] {
        &self.joints
    }

    pub fn joint_from_bind(&self) -> &[Affine3A] {
        &self.joint_from_bind
    }

    pub(super) fn joint_from_bind_rows(&self) -> &[[Vec4; 3]] {
        &self.joint_from_bind_rows
    }
}
