//! The terms of linear blend skinning at one vertex: `p' = Σ w_j · T_j · B_j⁻¹ · p`.
//!
//! Computed from the same matrices as the palette but not from the palette, so that tests can compare the two.

use gaitway_character::anim::JointIndex;
use gaitway_character::mesh::{DeformedVertices, deform_vertex};
use glam::{Affine3A, Vec3};

use super::Character;
use crate::library::Model;
use crate::state::VertexChoice;

/// The formula evaluated at a vertex. Reused between frames.
#[derive(Debug, Clone, Default)]
pub struct VertexFormula {
    /// `p`: the morphed bind position, in mesh space.
    pub bound: Vec3,
    /// Strongest first, without zero weights.
    pub terms: Vec<FormulaTerm>,
    /// `p'`: the sum of the terms, in world space.
    pub sum: Vec3,
    /// The drawn position, by the chosen skinning method.
    pub drawn: Vec3,
    scratch: DeformedVertices,
}

/// The contribution of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FormulaTerm {
    /// `j`. For an unskinned mesh, its node.
    pub joint: JointIndex,
    /// `w_j`, above 0; 1 for an unskinned mesh.
    pub weight: f32,
    /// `T_j · B_j⁻¹ · p`: the position by this joint alone, in world space.
    pub alone: Vec3,
    /// `alone`, weighted by `w_j`.
    pub share: Vec3,
}

/// The three matrices of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointMatrices {
    /// `B_j⁻¹`: the inverse bind matrix.
    pub joint_from_bind: Affine3A,
    /// `T_j`: the joint's current transform.
    pub world_from_joint: Affine3A,
}

impl JointMatrices {
    /// `T_j · B_j⁻¹`.
    pub fn world_from_bind(&self) -> Affine3A {
        self.world_from_joint * self.joint_from_bind
    }
}

/// Returns the joint's matrices in the first skin that contains it.
pub fn joint_matrices(model: &Model, character: &Character, joint: JointIndex) -> Option<JointMatrices> {
    let world_from_joint = *character.world_from_joint.get(joint.get())?;
    model.asset.skins.iter().find_map(|skin| {
        let at = skin.joints().iter().position(|&other| other == joint)?;
        Some(JointMatrices { joint_from_bind: *skin.joint_from_bind().get(at)?, world_from_joint })
    })
}

/// Evaluates the formula at a vertex; false if it is not drawn. An unskinned vertex has a single term, its node.
pub fn vertex_formula(model: &Model, character: &Character, choice: VertexChoice, out: &mut VertexFormula) -> bool {
    out.terms.clear();
    let asset = &model.asset;
    let Some(deformed) = deformed(model, character, choice, &mut out.scratch) else { return false };
    [out.bound, out.drawn] = deformed;
    let instance = &asset.instances[choice.instance];
    let geometry = &asset.meshes[instance.mesh].primitives[choice.primitive];
    let mut add = |joint: JointIndex, weight: f32, joint_from_bind: &Affine3A| {
        let Some(world_from_joint) = character.world_from_joint.get(joint.get()) else { return };
        let alone = world_from_joint.transform_point3(joint_from_bind.transform_point3(out.bound));
        out.terms.push(FormulaTerm { joint, weight, alone, share: weight * alone });
    };
    match instance.skin.and_then(|skin| asset.skins.get(skin)).filter(|_| !geometry.influences.is_empty()) {
        Some(skin) => {
            for (joint, weight) in geometry.influences.of_vertex(choice.vertex).filter(|(_, weight)| *weight > 0.0) {
                let at = usize::from(joint);
                if let (Some(&joint), Some(matrix)) = (skin.joints().get(at), skin.joint_from_bind().get(at)) {
                    add(joint, weight, matrix);
                }
            }
        }
        None => add(instance.joint, 1.0, &instance.joint_from_mesh),
    }
    out.sum = out.terms.iter().map(|term| term.share).sum();
    true
}

impl VertexFormula {
    /// Returns where another character of the frame draws the same vertex, in world space; `None` if it doesn't.
    pub fn drawn_by(&mut self, model: &Model, character: &Character, choice: VertexChoice) -> Option<Vec3> {
        deformed(model, character, choice, &mut self.scratch).map(|[_, drawn]| drawn)
    }
}

/// Returns a vertex in the bind pose, in mesh space, and as the character draws it, in world space; `None` if it is not drawn.
fn deformed(
    model: &Model,
    character: &Character,
    choice: VertexChoice,
    scratch: &mut DeformedVertices,
) -> Option<[Vec3; 2]> {
    let draw = character.draws.iter().find(|draw| draw.instance == choice.instance)?;
    if !model.has_vertex(choice.instance, choice.primitive, choice.vertex) {
        return None;
    }
    let geometry = &model.asset.meshes[draw.mesh].primitives[choice.primitive];
    let (weights, palette) = (character.morph_weights_of(draw), character.palette_of(draw));
    Some(deform_vertex(geometry, choice.vertex, weights, palette, character.skinning, scratch))
}
