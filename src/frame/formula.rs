//! The formula of linear blend skinning at one vertex, with its numbers: `p' = Σ w_j · T_j · B_j⁻¹ · p`.

use glam::{Affine3A, Vec3};

use super::Character;
use crate::anim::JointIndex;
use crate::library::Model;
use crate::mesh::{DeformedVertices, deform_vertex};
use crate::state::VertexChoice;

/// What moves one vertex. Reused from frame to frame.
#[derive(Debug, Clone, Default)]
pub struct VertexFormula {
    /// `p`: where the vertex is bound, after morphing, in mesh space.
    pub bound: Vec3,
    /// Strongest first; those of weight 0 are left out.
    pub parts: Vec<FormulaPart>,
    /// `p'`: the sum of the parts, in world space.
    pub sum: Vec3,
    /// Where the vertex is drawn, as the chosen way of skinning has it.
    pub drawn: Vec3,
    scratch: DeformedVertices,
}

/// What one joint does to the vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FormulaPart {
    pub joint: JointIndex,
    pub weight: f32,
    /// `T_j · B_j⁻¹ · p`: where this joint alone would put the vertex, in world space.
    pub alone: Vec3,
    /// `w_j` times that.
    pub share: Vec3,
}

/// The three matrices of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointMatrices {
    /// `B_j⁻¹`: from where the mesh was bound to the joint.
    pub joint_from_bind: Affine3A,
    /// `T_j`: from the joint to where it is now.
    pub world_from_joint: Affine3A,
}

impl JointMatrices {
    /// `T_j · B_j⁻¹`.
    pub fn world_from_bind(&self) -> Affine3A {
        self.world_from_joint * self.joint_from_bind
    }
}

/// The matrices of a joint in the first skin that names it; none when none does.
pub fn joint_matrices(model: &Model, character: &Character, joint: JointIndex) -> Option<JointMatrices> {
    let world_from_joint = *character.world_from_joint.get(joint.get())?;
    model.asset.skins.iter().find_map(|skin| {
        let at = skin.joints().iter().position(|&other| other == joint)?;
        Some(JointMatrices { joint_from_bind: *skin.joint_from_bind().get(at)?, world_from_joint })
    })
}

/// Works out the formula at a vertex; false when it is not drawn. A mesh without a skin follows its node alone.
pub fn vertex_formula(model: &Model, character: &Character, choice: VertexChoice, out: &mut VertexFormula) -> bool {
    out.parts.clear();
    let asset = &model.asset;
    let Some(draw) = character.draws.iter().find(|draw| draw.instance == choice.instance) else { return false };
    if !model.has_vertex(choice.instance, choice.primitive, choice.vertex) {
        return false;
    }
    let geometry = &asset.meshes[draw.mesh].primitives[choice.primitive];
    let weights = &character.morph_weights[draw.morph_weights.start as usize..draw.morph_weights.end as usize];
    let palette = &character.palette[draw.palette.start as usize..draw.palette.end as usize];
    [out.bound, out.drawn] =
        deform_vertex(geometry, choice.vertex, weights, palette, character.skinning, &mut out.scratch);
    let instance = &asset.instances[choice.instance];
    let mut add = |joint: JointIndex, weight: f32, joint_from_bind: &Affine3A| {
        let Some(world_from_joint) = character.world_from_joint.get(joint.get()) else { return };
        let alone = world_from_joint.transform_point3(joint_from_bind.transform_point3(out.bound));
        out.parts.push(FormulaPart { joint, weight, alone, share: weight * alone });
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
        None => add(instance.joint, 1.0, &Affine3A::IDENTITY),
    }
    out.sum = out.parts.iter().map(|part| part.share).sum();
    true
}
