//! Statements of an .obj made into one mesh. A corner may pair a vertex with any texture coordinate and normal, so a
//! vertex is copied where it has several; each part has vertices of its own.

use std::collections::HashMap;

use glam::{Vec2, Vec3, Vec4};

use super::polygon::Cutter;
use super::text::{Corner, NONE, ObjText};
use crate::mesh::{Geometry, Influences, Mesh};

/// A mesh, and for each of its pieces the part of the text it is; the vertex of the file that each of its vertices is a
/// copy of.
pub struct Built {
    pub mesh: Mesh,
    pub parts: Vec<usize>,
    pub file_vertex: Vec<Vec<u32>>,
}

#[derive(Default)]
struct PieceBuilder {
    corners: Vec<Corner>,
    indices: Vec<u32>,
    uvs: usize,
    normals: usize,
    corner_count: usize,
}

/// With one part, its first vertices are those of the file in the file's order. With several, [`Mesh::file_vertices`]
/// says where each of the file's vertices is; those of no face are with the first part.
pub fn build(obj: &ObjText, name: &str) -> Built {
    let mut pieces: Vec<PieceBuilder> = Vec::new();
    pieces.resize_with(obj.parts.len().max(1), PieceBuilder::default);
    for (face, corners) in obj.faces() {
        let piece = &mut pieces[face.part as usize];
        piece.corner_count += corners.len();
        piece.uvs += corners.iter().filter(|corner| corner[1] != NONE).count();
        piece.normals += corners.iter().filter(|corner| corner[2] != NONE).count();
    }
    let one = pieces.len() == 1;
    if one {
        // What nothing was paired with yet: the first use of a vertex fills it in.
        pieces[0].corners = (0..obj.positions.len() as u32).map(|vertex| [vertex, NONE, NONE]).collect();
    }
    let mut used = vec![false; obj.positions.len()];
    let mut file_vertices = vec![[0, 0]; if one { 0 } else { obj.positions.len() }];
    let mut copies: HashMap<(u32, Corner), u32> = HashMap::new();
    let mut cutter = Cutter::default();
    let (mut points, mut vertices) = (Vec::new(), Vec::new());
    for (face, corners) in obj.faces() {
        let piece = &mut pieces[face.part as usize];
        // What only some corners of a part have cannot be drawn: without normals it is flat.
        let (has_uvs, has_normals) = (piece.uvs > 0, piece.normals == piece.corner_count);
        points.clear();
        vertices.clear();
        for corner in corners {
            let point = corner[0] as usize;
            let kept = [corner[0], if has_uvs { corner[1] } else { NONE }, if has_normals { corner[2] } else { NONE }];
            points.push(obj.point(corner));
            vertices.push(*copies.entry((face.part, kept)).or_insert_with(|| {
                let first_use = !std::mem::replace(&mut used[point], true);
                if one && first_use {
                    piece.corners[point] = kept;
                    return corner[0];
                }
                let vertex = piece.corners.len() as u32;
                piece.corners.push(kept);
                if first_use {
                    file_vertices[point] = [face.part, vertex];
                }
                vertex
            }));
        }
        let indices = &mut piece.indices;
        cutter.cut(&points, |triangle| indices.extend(triangle.map(|at| vertices[at])));
    }
    if !one {
        for (point, _) in used.iter().enumerate().filter(|(_, used)| !**used) {
            file_vertices[point] = [0, pieces[0].corners.len() as u32];
            pieces[0].corners.push([point as u32, NONE, NONE]);
        }
    }
    let parts: Vec<usize> = (0..pieces.len()).filter(|&part| !pieces[part].indices.is_empty()).collect();
    let part_names = match &parts[..] {
        [part] if obj.parts[*part].name().is_empty() => Vec::new(),
        parts => parts.iter().map(|&part| obj.parts[part].name()).collect(),
    };
    let primitives = parts.iter().map(|&part| geometry(obj, &pieces[part], one)).collect();
    let file_vertex = parts.iter().map(|&part| pieces[part].corners.iter().map(|corner| corner[0]).collect()).collect();
    let mesh = Mesh { name: name.to_owned(), primitives, part_names, file_vertices, ..Mesh::default() };
    Built { mesh, parts, file_vertex }
}

fn geometry(obj: &ObjText, piece: &PieceBuilder, one: bool) -> Geometry {
    let corners = &piece.corners;
    let has_normals = piece.normals == piece.corner_count;
    let positions = corners.iter().map(|corner| obj.positions[corner[0] as usize]).collect();
    let normal = |corner: &Corner| obj.normals.get(corner[2] as usize).copied().unwrap_or(Vec3::Y);
    let uv = |corner: &Corner| obj.uvs.get(corner[1] as usize).copied().unwrap_or(Vec2::ZERO);
    let color =
        |corner: &Corner| obj.colors.get(corner[0] as usize).map_or(Vec4::ONE, |color| linear(*color).extend(1.0));
    Geometry {
        positions,
        normals: if has_normals { corners.iter().map(normal).collect() } else { Vec::new() },
        uvs: [if piece.uvs > 0 { corners.iter().map(uv).collect() } else { Vec::new() }, Vec::new()],
        colors: if obj.colors.is_empty() { Vec::new() } else { corners.iter().map(color).collect() },
        indices: piece.indices.clone(),
        file_vertices: if one { obj.positions.len() } else { corners.len() },
        ..Geometry::default()
    }
}

/// Colours are given as a screen shows them (sRGB).
pub fn linear(color: Vec3) -> Vec3 {
    let part = |part: f32| {
        let part = part.clamp(0.0, 1.0);
        if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
    };
    Vec3::new(part(color.x), part(color.y), part(color.z))
}

/// The influences of the file's vertices, for a piece whose vertices are copies of these.
pub fn copied(influences: &Influences, file_vertex: &[u32]) -> Influences {
    let stride = influences.stride;
    let mut copy = Influences {
        stride,
        joints: Vec::with_capacity(stride * file_vertex.len()),
        weights: Vec::with_capacity(stride * file_vertex.len()),
    };
    for &vertex in file_vertex {
        let range = vertex as usize * stride..(vertex as usize + 1) * stride;
        copy.joints.extend_from_slice(&influences.joints[range.clone()]);
        copy.weights.extend_from_slice(&influences.weights[range]);
    }
    copy
}
