//! The pose document: the drawn vertices as computed by the CPU reference.

use serde_json::{Value, json};

use super::{Frame, evaluate};
use crate::anim::Clip;
use crate::library::{Library, Model, warning_documents};
use crate::mesh::{DeformedVertices, Geometry, Mesh, deform, smooth_normals};
use crate::state::{Display, Inspect, Show, ViewerState, clip_secs};

/// Builds the document of `gaitway pose --json`: world-space positions and normals of every mesh in the chosen scene.
pub fn pose_document(library: &Library, state: &ViewerState) -> Value {
    let Some(model) = library.active() else {
        return json!({ "clip": null, "time_secs": 0.0, "nodes": [], "meshes": [], "warnings": [] });
    };
    let mut frame = Frame::default();
    // Only the model, with the chosen skinning method, even if the viewport shows a comparison.
    let show = Show { source: false, ..state.display.show };
    let (inspect, display) = (Inspect { split: false, ..state.inspect }, Display { show, ..state.display });
    let state = &ViewerState { inspect, display, ..state.clone() };
    evaluate(library, state, 1.0, &mut frame);
    json!({
        "clip": frame.clip.and_then(|clip| model.clip(clip)).map(Clip::name),
        "time_secs": frame.clip.map_or(0.0, |clip| clip_secs(model, clip, state)),
        "nodes": nodes(model, &frame),
        "meshes": meshes(model, state, &frame),
        "warnings": warning_documents(&model.asset.warnings),
    })
}

/// Nodes in the file's order.
fn nodes(model: &Model, frame: &Frame) -> Vec<Value> {
    let skeleton = &model.asset.skeleton;
    let world_from_joint = frame.characters.first().map_or(&[][..], |character| &character.world_from_joint);
    (0..skeleton.len())
        .filter_map(|node| {
            let joint = skeleton.joint_of_source(node)?;
            let world = glam::Mat4::from(*world_from_joint.get(joint.get())?).to_cols_array();
            Some(json!({ "node": node, "name": skeleton.name(joint), "world": world }))
        })
        .collect()
}

fn meshes(model: &Model, state: &ViewerState, frame: &Frame) -> Vec<Value> {
    let asset = &model.asset;
    let Some(character) = frame.characters.first() else { return Vec::new() };
    let mut deformed = DeformedVertices::default();
    let mut documents = Vec::new();
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
            documents.push(json!({
                "node": node,
                "mesh": draw.mesh,
                "primitive": primitive,
                "positions": flat(&deformed.positions, geometry.file_vertices),
                "normals": flat(&deformed.normals, geometry.file_vertices),
            }));
        }
        if mesh.file_vertices > 0 {
            documents.push(json!({
                "node": node,
                "mesh": draw.mesh,
                "primitive": 0,
                "positions": flat(&in_file_order.positions, in_file_order.positions.len()),
                "normals": flat(&in_file_order.normals, in_file_order.normals.len()),
            }));
        }
    }
    documents
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
