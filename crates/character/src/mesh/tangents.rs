//! MikkTSpace tangents, which glTF 2.0 §3.7.2.1 specifies for meshes without tangents.

use glam::{Vec2, Vec3, Vec4};

use super::{Geometry, mikktspace};

/// Maximum number of a vertex's copies searched for a matching tangent. Corners that share a tangent are close to each
/// other; only hostile files have thousands of copies.
const MAX_COPIES_COMPARED: usize = 64;

/// Returns the tangent of every corner of a triangle list, which must have normals and these texture coordinates.
pub fn corner_tangents(geometry: &Geometry, uv_set: usize) -> Vec<Vec4> {
    let Geometry { positions, normals, uvs, indices, .. } = geometry;
    // MikkTSpace's V points up, glTF's down.
    let as_gltf = |tangent: Vec4| Vec4::new(tangent.x, tangent.y, tangent.z, -tangent.w);
    mikktspace::corner_tangents(positions, normals, &uvs[uv_set], indices)
        .into_iter()
        .map(|tangent| tangent.map_or(Vec4::new(1.0, 0.0, 0.0, 1.0), as_gltf))
        .collect()
}

/// Adds tangents to a triangle list. Does nothing without normals or the given texture coordinates. A vertex whose
/// corners need different tangents is duplicated; copies are appended, so the first `file_vertices` stay in place.
/// Copies take at most `max_copied_bytes`; beyond that, corners keep their vertex's tangent. Returns the bytes taken.
pub fn add_tangents(geometry: &mut Geometry, uv_set: usize, max_copied_bytes: usize) -> usize {
    if geometry.normals.is_empty() || geometry.uvs.get(uv_set).is_none_or(Vec::is_empty) {
        return 0;
    }
    let vertex_bytes = vertex_bytes(geometry);
    let max_copies = max_copied_bytes / vertex_bytes;
    let corner_tangents = corner_tangents(geometry, uv_set);
    let mut tangents: Vec<Option<Vec4>> = vec![None; geometry.positions.len()];
    // The original of each copy, and the copies of each vertex.
    let mut copies: Vec<u32> = Vec::new();
    let mut copies_of: std::collections::BTreeMap<u32, Vec<u32>> = std::collections::BTreeMap::new();
    for (corner, tangent) in corner_tangents.into_iter().enumerate() {
        let vertex = geometry.indices[corner];
        let same = |other: Vec4| other.distance_squared(tangent) < 1e-6;
        match tangents[vertex as usize] {
            None => tangents[vertex as usize] = Some(tangent),
            Some(other) if same(other) => {}
            Some(_) => {
                let made = copies_of.entry(vertex).or_default();
                let mut recent = made.iter().rev().take(MAX_COPIES_COMPARED).copied();
                if let Some(copy) = recent.find(|&copy| tangents[copy as usize].is_some_and(same)) {
                    geometry.indices[corner] = copy;
                } else if copies.len() < max_copies {
                    let copy = tangents.len() as u32;
                    made.push(copy);
                    copies.push(vertex);
                    tangents.push(Some(tangent));
                    geometry.indices[corner] = copy;
                }
            }
        }
    }
    if !copies.is_empty() && geometry.file_vertex.is_empty() {
        geometry.file_vertex = (0..geometry.positions.len() as u32).collect();
    }
    for &vertex in &copies {
        copy_vertex(geometry, vertex as usize);
    }
    geometry.tangents = tangents.into_iter().map(|tangent| tangent.unwrap_or(Vec4::new(1.0, 0.0, 0.0, 1.0))).collect();
    copies.len() * vertex_bytes
}

/// Upper bound of the memory of one vertex.
fn vertex_bytes(geometry: &Geometry) -> usize {
    let influence = size_of::<u16>() + size_of::<f32>();
    let target = 3 * size_of::<Vec3>();
    2 * size_of::<Vec3>()
        + 2 * size_of::<Vec2>()
        + 2 * size_of::<Vec4>()
        + size_of::<u32>()
        + geometry.influences.stride * influence
        + geometry.morph_targets.len() * target
}

fn copy_vertex(geometry: &mut Geometry, vertex: usize) {
    fn push_copy<T: Copy>(list: &mut Vec<T>, at: usize) {
        if let Some(&value) = list.get(at) {
            list.push(value);
        }
    }
    push_copy(&mut geometry.positions, vertex);
    push_copy(&mut geometry.normals, vertex);
    push_copy(&mut geometry.uvs[0], vertex);
    push_copy(&mut geometry.uvs[1], vertex);
    push_copy(&mut geometry.colors, vertex);
    push_copy(&mut geometry.file_vertex, vertex);
    let stride = geometry.influences.stride;
    geometry.influences.joints.extend_from_within(vertex * stride..(vertex + 1) * stride);
    geometry.influences.weights.extend_from_within(vertex * stride..(vertex + 1) * stride);
    for target in &mut geometry.morph_targets {
        push_copy(&mut target.positions, vertex);
        push_copy(&mut target.normals, vertex);
        push_copy(&mut target.tangents, vertex);
    }
}
