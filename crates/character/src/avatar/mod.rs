//! What an avatar format (VRM) adds to a model: expressions, node constraints, gaze, spring bones and metadata. Plain
//! data and the arithmetic that applies it to a pose. Reading it from files is left to the loaders.

mod constraint;
mod expression;
mod look_at;
mod spring;
mod spring_cache;

use glam::Quat;

use crate::anim::{JointIndex, Pose, Skeleton, model_from_single_joint};

pub use constraint::{Constraint, ConstraintKind, sort_constraints};
pub use expression::{
    Expression, ExpressionGroup, MaterialBind, MorphBind, Override, apply_expressions, resolve_weights,
};
pub use look_at::{LookAt, LookAtKind, RangeMaps};
pub use spring::{Collider, SpringJoint, Springs};
pub use spring_cache::{SpringCache, SpringMotion};

/// The avatar part of a model; empty for most files.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Avatar {
    /// Named facial expressions, in the file's order.
    pub expressions: Vec<Expression>,
    /// How the eyes follow a target.
    pub look_at: Option<LookAt>,
    /// Sorted by [`sort_constraints`].
    pub constraints: Vec<Constraint>,
    /// The spring bones of hair, clothes and the like.
    pub springs: Springs,
    /// Version of the VRM specification; empty for other files.
    pub spec_version: String,
    /// Title, authors and terms of use, under the file's own keys, in its order.
    pub meta: Vec<(String, String)>,
    /// How first-person cameras treat the mesh at each joint, in the file's words. Shown to the user, never applied.
    pub first_person: Vec<(JointIndex, String)>,
}

impl Avatar {
    /// Returns every joint that the avatar refers to.
    pub fn joints(&self) -> impl Iterator<Item = JointIndex> + '_ {
        let constraints = self.constraints.iter().flat_map(|constraint| [constraint.joint, constraint.source]);
        let look_at = self.look_at.iter().flat_map(LookAt::joints);
        let first_person = self.first_person.iter().map(|&(joint, _)| joint);
        constraints.chain(look_at).chain(first_person).chain(self.springs.all_joints())
    }

    /// Returns the index of the expression with this name.
    pub fn expression(&self, name: &str) -> Option<usize> {
        self.expressions.iter().position(|expression| expression.name == name)
    }
}

/// Returns the rotation of a joint's parent in model space; the identity for a root.
fn model_from_parent(skeleton: &Skeleton, pose: &Pose, joint: JointIndex) -> Quat {
    match skeleton.parent(joint) {
        Some(parent) => model_from_single_joint(skeleton, pose, parent).to_scale_rotation_translation().1,
        None => Quat::IDENTITY,
    }
}
