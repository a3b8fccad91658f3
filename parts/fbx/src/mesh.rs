//! Meshes with their skins and blend shapes.
//!
//! An FBX mesh has its attributes per face corner. Corners that agree in all of them become one vertex; each material
//! becomes a primitive. The geometric transform of the node is baked into an unskinned mesh, and into the inverse bind
//! matrices of a skinned one.

use gaitway_glb::{Glb, MAX_INFLUENCES, Object, Warnings, numbers, push, strongest};
use serde_json::Value;
use ufbx::{BlendShape, Matrix, Mesh, Node, Scene, SkinDeformer};

use crate::material::UvNames;
use crate::node::{Nodes, columns};
use crate::shape::{Influences, Shape};

const MAX_JOINTS: usize = 1 << 16;

/// A glTF node whose mesh has blend shapes.
pub struct Morph<'a> {
    pub node: usize,
    pub mesh: &'a Mesh,
}

/// Writes the meshes of all nodes and returns those with blend shapes.
pub fn write<'a>(
    scene: &'a Scene,
    materials: &[UvNames],
    nodes: &mut Nodes,
    glb: &mut Glb,
    warnings: &mut Warnings,
) -> Result<Vec<Morph<'a>>, String> {
    let written = (0..scene.meshes.count).map(|_| Vec::new()).collect();
    let mut meshes = Meshes { materials, written, skins: Vec::new(), nodes, glb, warnings };
    let mut morphs = Vec::new();
    for node in &scene.nodes {
        let attributes = node.all_attribs.into_iter().filter_map(ufbx::as_mesh);
        for mesh in attributes {
            let Some(place) = meshes.attach(node, mesh)? else { continue };
            if shapes(mesh).next().is_some() {
                morphs.push(Morph { node: place, mesh });
            }
        }
    }
    Ok(morphs)
}

/// Returns the shapes of a mesh in the order of its morph targets: name, shape and default weight.
pub fn shapes(mesh: &Mesh) -> impl Iterator<Item = (&str, &BlendShape, f64)> {
    let channels = mesh.blend_deformers.into_iter().flat_map(|deformer| &deformer.channels);
    channels.flat_map(|channel| {
        let many = channel.keyframes.count > 1;
        channel.keyframes.into_iter().map(move |key| {
            let shape = &*key.shape.element.name;
            let channel = &*channel.element.name;
            let name = if (many && !shape.is_empty()) || channel.is_empty() { shape } else { channel };
            (name, &*key.shape, key.effective_weight)
        })
    })
}

struct Meshes<'a> {
    materials: &'a [UvNames],
    /// What has been written of each mesh, or none if nothing in it is visible.
    written: Vec<Vec<(Identity, Option<Written>)>>,
    skins: Vec<(Vec<usize>, Vec<f32>, usize)>,
    nodes: &'a mut Nodes,
    glb: &'a mut Glb,
    warnings: &'a mut Warnings,
}

/// A glTF mesh and its skin.
#[derive(Clone, Copy)]
struct Written {
    mesh: usize,
    skin: Option<usize>,
}

/// What makes two instances of a mesh the same glTF mesh.
#[derive(PartialEq)]
struct Identity {
    geometry: Option<[f32; 16]>,
    materials: Vec<u32>,
}

impl Meshes<'_> {
    /// Puts a mesh on its node, or on a leaf if the node has one already, and returns where.
    fn attach(&mut self, node: &Node, mesh: &Mesh) -> Result<Option<usize>, String> {
        let Some(mut place) = self.nodes.index(node) else { return Ok(None) };
        let skin = mesh.skin_deformers.into_iter().find(|skin| skin.clusters.count > 0);
        let identity = Identity {
            geometry: skin.is_none().then(|| columns(&node.geometry_to_node)),
            materials: node.materials.into_iter().map(|material| material.element.typed_id).collect(),
        };
        let id = mesh.element.typed_id as usize;
        let known = self.written[id].iter().find(|(other, _)| *other == identity).map(|(_, written)| *written);
        let written = match known {
            Some(written) => written,
            None => {
                let written = self.write_skinned(node, mesh, skin)?;
                self.written[id].push((identity, written));
                written
            }
        };
        let Some(written) = written else { return Ok(None) };
        if self.nodes.entries.get(place).is_some_and(|entry| entry.mesh.is_some()) {
            place = self.nodes.add_leaf(place, ufbx::identity_quat());
        }
        if let Some(entry) = self.nodes.entries.get_mut(place) {
            (entry.mesh, entry.skin) = (Some(written.mesh), written.skin);
        }
        Ok(Some(place))
    }

    fn write_skinned(
        &mut self,
        node: &Node,
        mesh: &Mesh,
        skin: Option<&SkinDeformer>,
    ) -> Result<Option<Written>, String> {
        let Some(index) = self.write_mesh(node, mesh, skin)? else { return Ok(None) };
        let skin = skin.map(|skin| self.skin(node, mesh, skin)).transpose()?;
        Ok(Some(Written { mesh: index, skin }))
    }

    /// Writes a mesh; none if nothing in it is visible.
    fn write_mesh(&mut self, node: &Node, mesh: &Mesh, skin: Option<&SkinDeformer>) -> Result<Option<usize>, String> {
        let name = if mesh.element.name.is_empty() { &*node.element.name } else { &*mesh.element.name };
        let skipped = mesh.num_point_faces + mesh.num_line_faces;
        self.warnings.left_out(
            skipped,
            "point or line",
            "points or lines",
            "only triangles and polygons are converted",
        );
        if mesh.skin_deformers.count > 1 {
            self.warnings.add(format!("Mesh \"{name}\": only the first of several skins was used."));
        }
        let influences = skin.map(|skin| self.influences(mesh, skin, name));
        let geometry = if skin.is_some() { ufbx::identity_matrix() } else { finite(node.geometry_to_node) };
        let shape = Shape::new(mesh, geometry, influences);
        let mut primitives = Vec::new();
        for part in mesh.material_parts.into_iter().filter(|part| part.num_triangles > 0) {
            let material = node.materials.as_ref().get(part.index as usize);
            let material = material.map(|material| material.element.typed_id as usize);
            let uv_names = material.and_then(|material| self.materials.get(material)).map_or(&[][..], Vec::as_slice);
            if let Some(mut primitive) = shape.primitive(part, uv_names, self.glb)? {
                if let Some(material) = material {
                    primitive.set("material", material);
                }
                push(&mut primitives, primitive);
            }
        }
        if primitives.is_empty() {
            return Ok(None);
        }
        let mut json = gaitway_glb::mesh(name, primitives);
        add_targets(mesh, &mut json);
        Ok(Some(push(&mut self.glb.meshes, json)))
    }

    /// Returns the influences of each vertex, strongest first, with sum 1. Vertices without a cluster follow the mesh's
    /// own node.
    fn influences(&mut self, mesh: &Mesh, skin: &SkinDeformer, name: &str) -> Influences {
        if !matches!(skin.skinning_method, ufbx::SkinningMethod::Linear | ufbx::SkinningMethod::Rigid) {
            self.warnings.add(format!("Mesh \"{name}\": dual quaternion skinning became linear."));
        }
        let own_node = skin.clusters.count as u16;
        let mut most = 0;
        let influences = (0..mesh.num_vertices).map(|vertex| {
            let influences: Vec<(u16, f64)> = weights(skin, vertex).collect();
            most = most.max(influences.len());
            let kept = strongest(influences);
            if kept.is_empty() { vec![(own_node, 1.0)] } else { kept }
        });
        let influences = influences.collect();
        if most > MAX_INFLUENCES {
            self.warnings.add(format!(
                "Mesh \"{name}\": a vertex follows {most} joints; the strongest {MAX_INFLUENCES} were kept."
            ));
        }
        influences
    }

    /// Writes a skin: a joint per cluster, and the mesh's own node for vertices that no cluster moves.
    fn skin(&mut self, node: &Node, mesh: &Mesh, skin: &SkinDeformer) -> Result<usize, String> {
        if skin.clusters.count >= MAX_JOINTS {
            return Err(format!(
                "mesh \"{}\" is bound to too many joints: expected less than {MAX_JOINTS}, found {}.",
                &*mesh.element.name, skin.clusters.count
            ));
        }
        let own_node = mesh.element.instances.into_iter().next().unwrap_or(node);
        let clusters = skin
            .clusters
            .into_iter()
            .map(|cluster| (cluster.bone_node.as_deref().unwrap_or(own_node), finite(cluster.geometry_to_bone)));
        let unbound = (0..mesh.num_vertices).any(|vertex| weights(skin, vertex).next().is_none());
        let extra = unbound.then(|| (own_node, finite(own_node.geometry_to_node)));
        let (mut joints, mut matrices) = (Vec::new(), Vec::new());
        for (joint, joint_from_bind) in clusters.chain(extra) {
            joints.extend(self.nodes.index(joint));
            matrices.extend(columns(&joint_from_bind));
        }
        let known = self.skins.iter().find(|(others, bind, _)| *others == joints && *bind == matrices);
        if let Some((_, _, index)) = known {
            return Ok(*index);
        }
        let unique = self.unique_joints(&joints);
        self.nodes.join(&unique);
        let bind = self.glb.floats(&matrices, "MAT4", None, false);
        let mut json = Object::new();
        if !skin.element.name.is_empty() {
            json.set("name", &*skin.element.name);
        }
        json.set("inverseBindMatrices", bind);
        json.set("joints", unique);
        let index = push(&mut self.glb.skins, json);
        self.skins.push((joints, matrices, index));
        Ok(index)
    }

    /// A glTF skin lists a node once. Where two clusters bind to one joint differently, the second gets a leaf below it.
    fn unique_joints(&mut self, joints: &[usize]) -> Vec<usize> {
        let mut seen = vec![false; self.nodes.entries.len()];
        joints
            .iter()
            .map(|&joint| match std::mem::replace(&mut seen[joint], true) {
                true => self.nodes.add_leaf(joint, ufbx::identity_quat()),
                false => joint,
            })
            .collect()
    }
}

/// Returns cluster and weight of each influence on a vertex that has an effect.
fn weights(skin: &SkinDeformer, vertex: usize) -> impl Iterator<Item = (u16, f64)> {
    let (begin, count) =
        skin.vertices.get(vertex).map_or((0, 0), |vertex| (vertex.weight_begin as usize, vertex.num_weights as usize));
    let weights = skin.weights.get(begin..begin.saturating_add(count)).unwrap_or_default();
    weights
        .iter()
        .filter(|weight| weight.weight > 0.0 && weight.weight.is_finite())
        .map(|weight| (weight.cluster_index.min(u32::from(u16::MAX)) as u16, weight.weight))
}

/// Adds the default weights and names of the morph targets.
fn add_targets(mesh: &Mesh, json: &mut Object) {
    let weights: Vec<f64> = shapes(mesh).map(|(_, _, weight)| weight).collect();
    if weights.is_empty() {
        return;
    }
    let names: Value = shapes(mesh).map(|(name, _, _)| name).collect();
    json.set("weights", numbers(&weights));
    json.set("extras", Object::new().with("targetNames", names));
}

/// Returns the matrix, or the identity if an element isn't finite.
fn finite(matrix: Matrix) -> Matrix {
    if columns(&matrix).iter().all(|element| element.is_finite()) { matrix } else { ufbx::identity_matrix() }
}
