//! The triangles of a mesh: from corners of polygons to vertices and indices.

use gaitway_glb::{ARRAY_BUFFER, Glb, Object, check_size, linear, push};
use ufbx::{Face, Matrix, Mesh, MeshPart, Vec3};

use crate::mesh::shapes;
use crate::raw;

/// Joint and weight of each influence on each vertex, strongest first.
pub type Influences = Vec<Vec<(u16, f32)>>;

/// A mesh prepared for writing its primitives.
pub struct Shape<'a> {
    mesh: &'a Mesh,
    /// Applied to positions and offsets.
    geometry: Matrix,
    normals: Matrix,
    mirrored: bool,
    influences: Option<Influences>,
}

/// Attributes per corner, then per vertex.
struct Vertices {
    /// Place of each vertex in the mesh's own list.
    ids: Vec<u32>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<Vec<[f32; 2]>>,
    colors: Vec<[f32; 4]>,
}

impl<'a> Shape<'a> {
    /// Prepares a mesh: `geometry` is applied to positions and offsets.
    pub fn new(mesh: &'a Mesh, geometry: Matrix, influences: Option<Influences>) -> Shape<'a> {
        let normals = ufbx::matrix_for_normals(&geometry);
        Shape { mesh, geometry, normals, mirrored: ufbx::matrix_determinant(&geometry) < 0.0, influences }
    }

    /// Writes what belongs to one material; none if it has no triangle.
    pub fn primitive(&self, part: &MeshPart, uv_names: &[String], glb: &mut Glb) -> Result<Option<Object>, String> {
        let corners = self.corners(part);
        if corners.is_empty() {
            return Ok(None);
        }
        check_size(glb.len().saturating_add(corners.len().saturating_mul(4)))?;
        let mut vertices = self.at_corners(&corners, uv_names);
        let triangles = vertices.merge()?;
        check_size(glb.len().saturating_add(vertices.bytes(self.influences.is_some())))?;
        let mut attributes = Object::new();
        let positions: Vec<f32> = vertices.ids.iter().flat_map(|&id| self.position(id)).collect();
        attributes.set("POSITION", glb.floats(&positions, "VEC3", Some(ARRAY_BUFFER), true));
        if !vertices.normals.is_empty() {
            let accessor = glb.floats(vertices.normals.as_flattened(), "VEC3", Some(ARRAY_BUFFER), false);
            attributes.set("NORMAL", accessor);
        }
        for (set, uvs) in vertices.uvs.iter().enumerate() {
            let accessor = glb.floats(uvs.as_flattened(), "VEC2", Some(ARRAY_BUFFER), false);
            attributes.set(&format!("TEXCOORD_{set}"), accessor);
        }
        if !vertices.colors.is_empty() {
            let accessor = glb.floats(vertices.colors.as_flattened(), "VEC4", Some(ARRAY_BUFFER), false);
            attributes.set("COLOR_0", accessor);
        }
        if let Some(influences) = &self.influences {
            let of = |id: &u32| influences.get(*id as usize).map_or(&[][..], Vec::as_slice);
            glb.add_influences(&vertices.ids.iter().map(of).collect::<Vec<_>>(), &mut attributes);
        }
        let indices = glb.triangles(&triangles, vertices.ids.len());
        let mut primitive = Object::new().with("attributes", attributes).with("indices", indices);
        self.add_shapes(&vertices.ids, &mut primitive, glb)?;
        Ok(Some(primitive))
    }

    /// Returns the corners of the part's triangles.
    fn corners(&self, part: &MeshPart) -> Vec<u32> {
        let mesh = self.mesh;
        let mut corners = Vec::with_capacity(3 * part.num_triangles);
        let mut polygon = vec![0; 3 * mesh.max_face_triangles];
        for &index in &part.face_indices {
            let hole = mesh.face_hole.get(index as usize).copied().unwrap_or(false);
            let Some(&face) = mesh.faces.get(index as usize).filter(|face| face.num_indices >= 3 && !hole) else {
                continue;
            };
            let start = corners.len();
            if face.num_indices == 3 {
                corners.extend(face.index_begin..face.index_begin + 3);
            } else {
                corners.extend_from_slice(triangulated(mesh, face, &mut polygon));
            }
            if self.mirrored {
                corners[start..].chunks_exact_mut(3).for_each(|triangle| triangle.swap(1, 2));
            }
        }
        corners
    }

    fn at_corners(&self, corners: &[u32], uv_names: &[String]) -> Vertices {
        let mesh = self.mesh;
        let id = |corner: u32| mesh.vertex_indices.get(corner as usize).copied().unwrap_or(0);
        let normals = &mesh.vertex_normal;
        let uv_set = |name: &str| {
            let named = mesh.uv_sets.into_iter().find(|set| &*set.name == name);
            named.or(mesh.uv_sets.first()).map(|set| &set.vertex_uv)
        };
        let mut sets: Vec<_> = uv_names.iter().filter_map(|name| uv_set(name)).collect();
        if sets.is_empty() {
            sets.extend(mesh.uv_sets.first().map(|set| &set.vertex_uv));
        }
        let uvs = sets.into_iter().map(|set| {
            let uv = |&corner| value(&set.values, &set.indices, corner).unwrap_or_default();
            corners.iter().map(uv).map(|uv| [real(uv.x), real(1.0 - uv.y)]).collect()
        });
        let color = mesh.color_sets.first().map(|set| &set.vertex_color);
        Vertices {
            ids: corners.iter().map(|&corner| id(corner)).collect(),
            normals: if normals.exists {
                let normal = |&corner| value(&normals.values, &normals.indices, corner).unwrap_or_default();
                corners.iter().map(normal).map(|normal| self.normal(normal)).collect()
            } else {
                Vec::new()
            },
            uvs: uvs.collect(),
            // Painted in sRGB, as Blender and three.js take them; glTF has them linear.
            colors: color.map_or_else(Vec::new, |set| {
                let color = |&corner| value(&set.values, &set.indices, corner).unwrap_or_default();
                let rgba = |c: ufbx::Vec4| [linear(c.x), linear(c.y), linear(c.z), real(c.w).clamp(0.0, 1.0)];
                corners.iter().map(color).map(rgba).collect()
            }),
        }
    }

    fn position(&self, id: u32) -> [f32; 3] {
        let position = self.mesh.vertices.get(id as usize).copied().unwrap_or_default();
        let position = ufbx::transform_position(&self.geometry, position);
        [position.x, position.y, position.z].map(real)
    }

    fn normal(&self, normal: Vec3) -> [f32; 3] {
        let normal = ufbx::vec3_normalize(ufbx::transform_direction(&self.normals, normal));
        let normal = [normal.x, normal.y, normal.z].map(real);
        if normal == [0.0; 3] { [0.0, 1.0, 0.0] } else { normal }
    }

    fn add_shapes(&self, ids: &[u32], primitive: &mut Object, glb: &mut Glb) -> Result<(), String> {
        let mut targets = Vec::new();
        let mut offsets = vec![[0.0; 3]; self.mesh.num_vertices];
        for (_, shape, _) in shapes(self.mesh) {
            check_size(glb.len().saturating_add(ids.len() * 16))?;
            let mut changed = Vec::new();
            // Blender stores a factor per vertex, ufbx applies it.
            let factors = shape.offset_weights.into_iter().copied().chain(std::iter::repeat(1.0));
            let moved = shape.offset_vertices.into_iter().zip(&shape.position_offsets).zip(factors);
            for ((&vertex, &offset), factor) in moved {
                if let Some(place) = offsets.get_mut(vertex as usize) {
                    let offset = ufbx::transform_direction(&self.geometry, offset);
                    *place = [offset.x, offset.y, offset.z].map(|component| real(component * factor));
                    changed.push(vertex as usize);
                }
            }
            let (mut elements, mut values) = (Vec::new(), Vec::new());
            for (element, &id) in ids.iter().enumerate() {
                let offset = offsets.get(id as usize).copied().unwrap_or_default();
                if offset != [0.0; 3] {
                    elements.push(element as u32);
                    values.extend(offset);
                }
            }
            push(&mut targets, Object::new().with("POSITION", glb.sparse(ids.len(), &elements, &values)));
            for vertex in changed {
                offsets[vertex] = [0.0; 3];
            }
        }
        if !targets.is_empty() {
            primitive.set("targets", targets);
        }
        Ok(())
    }
}

impl Vertices {
    /// Merges corners with the same attributes and returns a vertex number per corner.
    fn merge(&mut self) -> Result<Vec<u32>, String> {
        let mut triangles = vec![0; self.ids.len()];
        let mut streams = vec![raw::stream(&mut self.ids)];
        if !self.normals.is_empty() {
            streams.push(raw::stream(&mut self.normals));
        }
        streams.extend(self.uvs.iter_mut().map(|uvs| raw::stream(uvs)));
        if !self.colors.is_empty() {
            streams.push(raw::stream(&mut self.colors));
        }
        let count = raw::merge(&mut streams, &mut triangles)?;
        self.ids.truncate(count);
        self.normals.truncate(count);
        self.uvs.iter_mut().for_each(|uvs| uvs.truncate(count));
        self.colors.truncate(count);
        Ok(triangles)
    }

    /// Returns about how many bytes the vertices take.
    fn bytes(&self, skinned: bool) -> usize {
        let width = 6 + 2 * self.uvs.len() + if self.colors.is_empty() { 0 } else { 4 } + if skinned { 6 } else { 0 };
        self.ids.len().saturating_mul(4 * width)
    }
}

fn triangulated<'a>(mesh: &Mesh, face: Face, polygon: &'a mut [u32]) -> &'a [u32] {
    if polygon.len() / 3 + 2 < face.num_indices as usize {
        return &[];
    }
    let triangles = ufbx::triangulate_face(polygon, mesh, face) as usize;
    polygon.get(..3 * triangles).unwrap_or_default()
}

fn value<T: Copy>(values: &[T], indices: &[u32], corner: u32) -> Option<T> {
    indices.get(corner as usize).and_then(|&index| values.get(index as usize)).copied()
}

fn real(value: f64) -> f32 {
    let value = value as f32;
    if value.is_finite() { value } else { 0.0 }
}
