//! Builds one mesh from the statements of an .obj. A corner may pair a vertex with any texture coordinate and normal, so a
//! vertex is copied where it has several of them; each group of faces has vertices of its own.

use foldhash::{HashMap, HashMapExt};
use gaitway_character::mesh::{Geometry, Influences, Mesh};
use gaitway_polygon::Cutter;
use glam::{Vec2, Vec3, Vec4};

use super::text::{Corner, NONE, ObjText};
use crate::error::Problem;
use crate::limits::Budget;

/// A mesh, and the group of faces that each of its primitives was built from.
pub struct Built {
    pub mesh: Mesh,
    pub groups: Vec<usize>,
}

/// What a vertex takes at most: corner, position, normal, texture coordinates, colour and its number in the file.
const VERTEX_BYTES: usize =
    size_of::<Corner>() + 2 * size_of::<Vec3>() + size_of::<Vec2>() + size_of::<Vec4>() + size_of::<u32>();

/// One group of faces on its way to a primitive.
#[derive(Default)]
struct PrimitiveBuilder {
    corners: Vec<Corner>,
    indices: Vec<u32>,
    /// Corners with texture coordinates, with normals, and in all.
    uv_count: usize,
    normal_count: usize,
    corner_count: usize,
}

impl PrimitiveBuilder {
    fn has_uvs(&self) -> bool {
        self.uv_count > 0
    }

    /// A group in which some corner lacks a normal is flat-shaded.
    fn has_normals(&self) -> bool {
        self.normal_count == self.corner_count
    }
}

/// A single group begins with the file's vertices in the file's order. With several groups, vertices that no face uses
/// go to the first. [`Geometry::file_vertex`] maps back to the file.
pub fn build(obj: &ObjText, name: &str, budget: &Budget) -> Result<Built, Problem> {
    // Indices, and the table of the copies.
    let corner_bytes = size_of::<u32>() + 2 * size_of::<(u32, Corner, u32)>();
    budget.allocate(obj.corners.len(), corner_bytes, &"faces")?;
    let mut builders = count_corners(obj);
    let single = builders.len() == 1;
    if single {
        // Without texture coordinate and normal: the first use of a vertex adds them.
        builders[0].corners = (0..obj.positions.len() as u32).map(|vertex| [vertex, NONE, NONE]).collect();
    }
    add_faces(obj, &mut builders);
    let vertices = builders.iter().map(|builder| builder.corners.len()).sum();
    budget.allocate(vertices, VERTEX_BYTES, &"vertices")?;
    let groups: Vec<usize> = (0..builders.len()).filter(|&group| !builders[group].indices.is_empty()).collect();
    let part_names = match &groups[..] {
        [group] if obj.groups[*group].name().is_empty() => Vec::new(),
        groups => groups.iter().map(|&group| obj.groups[group].name()).collect(),
    };
    let primitives = groups.iter().map(|&group| geometry(obj, &builders[group], single)).collect();
    let file_vertices = if single { 0 } else { obj.positions.len() };
    let mesh = Mesh { name: name.to_owned(), primitives, part_names, file_vertices, ..Mesh::default() };
    Ok(Built { mesh, groups })
}

fn count_corners(obj: &ObjText) -> Vec<PrimitiveBuilder> {
    let mut builders: Vec<PrimitiveBuilder> = Vec::new();
    builders.resize_with(obj.groups.len().max(1), PrimitiveBuilder::default);
    for (face, corners) in obj.faces() {
        let builder = &mut builders[face.group as usize];
        builder.corner_count += corners.len();
        builder.uv_count += corners.iter().filter(|corner| corner[1] != NONE).count();
        builder.normal_count += corners.iter().filter(|corner| corner[2] != NONE).count();
    }
    builders
}

/// Triangulates all faces, copying vertices as needed.
fn add_faces(obj: &ObjText, builders: &mut [PrimitiveBuilder]) {
    let single = builders.len() == 1;
    let mut used = vec![false; obj.positions.len()];
    let mut copies: HashMap<(u32, Corner), u32> = HashMap::new();
    let mut cutter = Cutter::default();
    let (mut points, mut vertices) = (Vec::new(), Vec::new());
    for (face, corners) in obj.faces() {
        let builder = &mut builders[face.group as usize];
        let (has_uvs, has_normals) = (builder.has_uvs(), builder.has_normals());
        points.clear();
        vertices.clear();
        for corner in corners {
            let point = corner[0] as usize;
            let kept = [corner[0], if has_uvs { corner[1] } else { NONE }, if has_normals { corner[2] } else { NONE }];
            points.push(obj.point(corner));
            vertices.push(*copies.entry((face.group, kept)).or_insert_with(|| {
                let first_use = !std::mem::replace(&mut used[point], true);
                if single && first_use {
                    builder.corners[point] = kept;
                    return corner[0];
                }
                let vertex = builder.corners.len() as u32;
                builder.corners.push(kept);
                vertex
            }));
        }
        let indices = &mut builder.indices;
        cutter.cut(&points, |triangle| indices.extend(triangle.map(|at| vertices[at])));
    }
    if !single {
        let unused = used.iter().enumerate().filter(|(_, used)| !**used);
        builders[0].corners.extend(unused.map(|(point, _)| [point as u32, NONE, NONE]));
    }
}

fn geometry(obj: &ObjText, builder: &PrimitiveBuilder, single: bool) -> Geometry {
    let corners = &builder.corners;
    let positions = corners.iter().map(|corner| obj.positions[corner[0] as usize]).collect();
    let normal = |corner: &Corner| obj.normals.get(corner[2] as usize).copied().unwrap_or(Vec3::Y);
    let uv = |corner: &Corner| obj.uvs.get(corner[1] as usize).copied().unwrap_or(Vec2::ZERO);
    let color =
        |corner: &Corner| obj.colors.get(corner[0] as usize).map_or(Vec4::ONE, |color| linear(*color).extend(1.0));
    Geometry {
        positions,
        normals: if builder.has_normals() { corners.iter().map(normal).collect() } else { Vec::new() },
        uvs: [if builder.has_uvs() { corners.iter().map(uv).collect() } else { Vec::new() }, Vec::new()],
        colors: if obj.colors.is_empty() { Vec::new() } else { corners.iter().map(color).collect() },
        indices: builder.indices.clone(),
        file_vertices: if single { obj.positions.len() } else { corners.len() },
        file_vertex: corners.iter().map(|corner| corner[0]).collect(),
        ..Geometry::default()
    }
}

/// Converts from sRGB, the colour space of the files.
pub fn linear(color: Vec3) -> Vec3 {
    let channel = |value: f32| {
        let value = value.clamp(0.0, 1.0);
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    };
    Vec3::new(channel(color.x), channel(color.y), channel(color.z))
}

/// Returns the influences of a primitive whose vertices are copies of the file's.
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
