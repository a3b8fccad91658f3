//! The pose document: the drawn vertices as computed by the CPU reference.

use std::fmt;

use gaitway_character::mesh::{DeformedVertices, Geometry, Mesh, deform, smooth_normals};
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

use super::{Frame, evaluate};
use crate::library::{Library, Model, warning_documents};
use crate::state::{Display, Inspect, Show, ViewerState, active_clip, clip_secs};

/// The document of `gaitway pose --json`. Typed: as a `serde_json::Value`, each number would take 70 bytes.
#[derive(Debug, Serialize)]
pub struct PoseDocument {
    /// Name of the clip; none at rest.
    pub clip: Option<String>,
    /// Time in the clip.
    pub time_secs: f64,
    /// Nodes in the file's order.
    pub nodes: Vec<NodePose>,
    meshes: Vec<MeshPose>,
    warnings: Value,
}

/// World transform of a node.
#[derive(Debug, Serialize)]
pub struct NodePose {
    /// Index in the file's list of nodes.
    pub node: usize,
    /// May be empty.
    pub name: String,
    /// Column by column.
    #[serde(serialize_with = "as_f64")]
    pub world: Vec<f32>,
}

#[derive(Debug, Serialize)]
struct MeshPose {
    node: usize,
    mesh: usize,
    primitive: usize,
    #[serde(serialize_with = "as_f64")]
    positions: Vec<f32>,
    #[serde(serialize_with = "as_f64")]
    normals: Vec<f32>,
}

/// Writes all digits: the shortest decimal form of an f32 is that of another f64. What is not finite becomes null.
fn as_f64<S: Serializer>(numbers: &[f32], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(numbers.iter().map(|&number| f64::from(number)))
}

impl fmt::Display for PoseDocument {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&serde_json::to_string(self).map_err(|_| fmt::Error)?)
    }
}

impl PoseDocument {
    /// Computes the world-space positions and normals of every mesh in the chosen scene.
    pub fn new(library: &Library, state: &ViewerState) -> Self {
        let Some(model) = library.active() else {
            let (nodes, meshes) = (Vec::new(), Vec::new());
            return Self { clip: None, time_secs: 0.0, nodes, meshes, warnings: json!([]) };
        };
        let mut frame = Frame::default();
        // Only the model, with the chosen skinning method, even if the viewport shows a comparison.
        let show = Show { source: false, ..state.display.show };
        let (inspect, display) = (Inspect { split: false, ..state.inspect }, Display { show, ..state.display });
        let state = &ViewerState { inspect, display, ..state.clone() };
        evaluate(library, state, 1.0, &mut frame);
        let clip = active_clip(model, state);
        Self {
            clip: clip.map(|clip| clip.name().to_owned()),
            time_secs: clip.map_or(0.0, |clip| clip_secs(clip, state)),
            nodes: nodes(model, &frame),
            meshes: meshes(model, state, &frame),
            warnings: warning_documents(&model.asset.warnings),
        }
    }
}

/// Returns the document as a value, to look something up in it.
pub fn pose_document(library: &Library, state: &ViewerState) -> Value {
    serde_json::to_value(PoseDocument::new(library, state)).unwrap_or_default()
}

fn nodes(model: &Model, frame: &Frame) -> Vec<NodePose> {
    let skeleton = &model.asset.skeleton;
    let world_from_joint = frame.characters.first().map_or(&[][..], |character| &character.world_from_joint);
    (0..skeleton.len())
        .filter_map(|node| {
            let joint = skeleton.joint_of_source(node)?;
            let world = glam::Mat4::from(*world_from_joint.get(joint.get())?).to_cols_array().to_vec();
            Some(NodePose { node, name: skeleton.name(joint).to_owned(), world })
        })
        .collect()
}

fn meshes(model: &Model, state: &ViewerState, frame: &Frame) -> Vec<MeshPose> {
    let asset = &model.asset;
    let Some(character) = frame.characters.first() else { return Vec::new() };
    let mut deformed = DeformedVertices::default();
    let mut poses = Vec::new();
    for draw in &character.draws {
        let (palette, weights) = (character.palette_of(draw), character.morph_weights_of(draw));
        let node = asset.skeleton.source_index(asset.instances[draw.instance].joint);
        let mesh = &asset.meshes[draw.mesh];
        let mut in_file_order = FileVertices::new(mesh, state.display.show.smooth);
        let mut smooth = if state.display.show.smooth { smooth_normals(&mesh.primitives) } else { Vec::new() };
        for (primitive, geometry) in mesh.primitives.iter().enumerate() {
            let normals = smooth.get_mut(primitive).map(std::mem::take).filter(|normals| !normals.is_empty());
            let smoothed = normals.map(|normals| Geometry { normals, ..geometry.clone() });
            let geometry = smoothed.as_ref().unwrap_or(geometry);
            deform(geometry, weights, palette, state.display.skinning, &mut deformed);
            if mesh.file_vertices > 0 {
                in_file_order.add(&geometry.file_vertex, &deformed);
                continue;
            }
            let positions = flat(&deformed.positions, geometry.file_vertices);
            let normals = flat(&deformed.normals, geometry.file_vertices);
            poses.push(MeshPose { node, mesh: draw.mesh, primitive, positions, normals });
        }
        if mesh.file_vertices > 0 {
            let positions = flat(&in_file_order.positions, in_file_order.positions.len());
            let normals = flat(&in_file_order.normals, in_file_order.normals.len());
            poses.push(MeshPose { node, mesh: draw.mesh, primitive: 0, positions, normals });
        }
    }
    poses
}

/// Vertices of a mesh whose file has one list for all primitives, back in the file's order.
struct FileVertices {
    positions: Vec<glam::Vec3>,
    /// Empty unless every primitive has normals.
    normals: Vec<glam::Vec3>,
}

impl FileVertices {
    fn new(mesh: &Mesh, smooth: bool) -> Self {
        let count = mesh.file_vertices;
        let has_normals = smooth || mesh.primitives.iter().all(|geometry| !geometry.normals.is_empty());
        Self {
            positions: vec![glam::Vec3::ZERO; count],
            normals: vec![glam::Vec3::ZERO; if has_normals { count } else { 0 }],
        }
    }

    /// Copies of a vertex share its position; the first copy's normal is kept.
    fn add(&mut self, file_vertex: &[u32], deformed: &DeformedVertices) {
        for (&at, &position) in file_vertex.iter().zip(&deformed.positions) {
            self.positions[at as usize] = position;
        }
        for (&at, &normal) in file_vertex.iter().zip(&deformed.normals) {
            if let Some(first) = self.normals.get_mut(at as usize).filter(|first| **first == glam::Vec3::ZERO) {
                *first = normal;
            }
        }
    }
}

fn flat(vectors: &[glam::Vec3], count: usize) -> Vec<f32> {
    vectors.iter().take(count).flat_map(|vector| vector.to_array()).collect()
}
