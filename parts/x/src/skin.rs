//! Skins: which joints a vertex follows.

use gaitway_glb::{Glb, MAX_INFLUENCES, Object, Warnings, push, strongest};
use glam::DAffine3;

use crate::document::{Document, short};
use crate::frame::Nodes;
use crate::transform::{columns, matrix};

const MAX_JOINTS: usize = 1 << 16;

/// Joint and weight of each influence on each vertex, strongest first, with sum 1.
pub type Influences = Vec<Vec<(u16, f32)>>;

/// The skin of a mesh.
pub struct Skin {
    pub influences: Influences,
    /// Node of each joint, with the matrix from the bind pose to it.
    joints: Vec<(usize, DAffine3)>,
    /// Whether there is another joint, the mesh's own node, for what no joint moves.
    has_unbound: bool,
}

/// Reads the skin of a mesh, if it has one.
pub fn read(
    document: &Document,
    mesh: usize,
    vertices: usize,
    nodes: &Nodes,
    warnings: &mut Warnings,
) -> Result<Option<Skin>, String> {
    let mut joints = Vec::new();
    let mut found: Vec<Vec<(u16, f64)>> = Vec::new();
    for (object, weights) in document.children(mesh, "SkinWeights") {
        let name = weights.strings.first().copied().unwrap_or_default();
        let mut numbers = document.numbers(object);
        let count = numbers.count(2, "weights")?;
        let ids = numbers.take(count, "vertices")?;
        let values = numbers.take(count, "weights")?;
        let joint_from_bind = matrix(numbers.array("a matrix")?);
        let Some(node) = nodes.named(name) else {
            warnings.add(format!("Joint \"{}\" left out: no frame has that name.", short(name)));
            continue;
        };
        if joints.len() + 1 == MAX_JOINTS {
            return Err(numbers.damaged(&format!("at most {MAX_JOINTS} joints"), "more"));
        }
        found.resize(vertices, Vec::new());
        for (&id, &weight) in ids.iter().zip(values).filter(|&(_, &weight)| weight > 0.0) {
            let own = if id >= 0.0 { found.get_mut(id as usize) } else { None };
            let expected = || numbers.damaged(&format!("numbers of the mesh's {vertices} vertices"), "another one");
            own.ok_or_else(expected)?.push((joints.len() as u16, weight));
        }
        joints.push((node, joint_from_bind));
    }
    if joints.is_empty() {
        return Ok(None);
    }
    let most = found.iter().map(Vec::len).max().unwrap_or(0);
    if most > MAX_INFLUENCES {
        let label = document.label(mesh);
        warnings.add(format!("{label}: a vertex follows {most} joints; the strongest {MAX_INFLUENCES} were kept."));
    }
    let mut influences: Influences = found.into_iter().map(strongest).collect();
    let mut has_unbound = false;
    for own in influences.iter_mut().filter(|own| own.is_empty()) {
        own.push((joints.len() as u16, 1.0));
        has_unbound = true;
    }
    Ok(Some(Skin { influences, joints, has_unbound }))
}

impl Skin {
    /// Writes the skin of a mesh on a node and returns its index.
    pub fn write(self, own_node: usize, nodes: &mut Nodes, glb: &mut Glb) -> usize {
        let own = self.has_unbound.then_some((own_node, DAffine3::IDENTITY));
        let mut used = vec![false; nodes.entries.len()];
        let (mut joints, mut matrices) = (Vec::new(), Vec::new());
        for (mut node, joint_from_bind) in self.joints.into_iter().chain(own) {
            // A glTF skin lists a node once: another joint there gets a leaf.
            if std::mem::replace(&mut used[node], true) {
                node = nodes.add(Some(node), String::new(), DAffine3::IDENTITY);
            }
            joints.push(node);
            matrices.extend(columns(&joint_from_bind).map(|element| element as f32));
        }
        nodes.join(&joints);
        let bind = glb.floats(&matrices, "MAT4", None, false);
        push(&mut glb.skins, Object::new().with("inverseBindMatrices", bind).with("joints", joints))
    }
}
