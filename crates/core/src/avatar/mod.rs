//! What an avatar format (VRM) adds to a model: expressions, node constraints, where the eyes look, spring bones, and
//! the licence. Plain data with the arithmetic that applies it to a pose; reading it from files is left to the loaders.

mod constraint;
mod expression;
mod look_at;
mod spring;
mod spring_cache;

use crate::anim::JointIndex;

pub use constraint::{Constraint, ConstraintKind, in_order};
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
    /// How the eyes turn.
    pub look_at: Option<LookAt>,
    /// Sorted by [`in_order`].
    pub constraints: Vec<Constraint>,
    /// Hair, clothes and the like.
    pub springs: Springs,
    /// Version of the VRM specification; empty for other files.
    pub spec_version: String,
    /// Title, authors and terms of use, under the file's own keys, in its order.
    pub meta: Vec<(String, String)>,
    /// How first-person cameras treat meshes, by the joint that holds the mesh: the file's words. Not applied here.
    pub first_person: Vec<(JointIndex, String)>,
}

impl Avatar {
    /// All joints that the avatar refers to.
    pub fn joints(&self) -> impl Iterator<Item = JointIndex> + '_ {
        let constraints = self.constraints.iter().flat_map(|constraint| [constraint.joint, constraint.source]);
        let look_at = self.look_at.iter().flat_map(LookAt::joints);
        let first_person = self.first_person.iter().map(|&(joint, _)| joint);
        constraints.chain(look_at).chain(first_person).chain(self.springs.all_joints())
    }

    /// Returns the index of an expression.
    pub fn expression(&self, name: &str) -> Option<usize> {
        self.expressions.iter().position(|expression| expression.name == name)
    }
}
