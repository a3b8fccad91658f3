//! Meshes: from faces to triangles, a primitive for each material.
//!
//! A face has a vertex and a normal at each corner. Corners that agree in both become one vertex, in the file's order.

use gaitway_glb::{ARRAY_BUFFER, Glb, Object, Warnings, check_size, linear, push};
use gaitway_polygon::Cutter;
use glam::{DAffine3, DVec3};

use crate::declared::{self, Declared};
use crate::document::{Document, Names, Numbers, text};
use crate::frame::Nodes;
use crate::material::Materials;
use crate::skin::{self, Influences};
use crate::transform::mirrored;

/// Maximum size of a vertex in bytes: position, normal, texture coordinates, colour, and its influences.
const VERTEX_BYTES: usize = 12 + 12 + 8 + 16;
const INFLUENCE_BYTES: usize = 6;

/// Writes all meshes, and materials if there are any.
pub fn write(document: &Document, nodes: &mut Nodes, glb: &mut Glb, warnings: &mut Warnings) -> Result<(), String> {
    let materials = Materials::write(document, glb)?;
    let places = places(document, nodes);
    let mut cutter = Cutter::default();
    for (mesh, places) in places.iter().enumerate() {
        let Some(&node) = places.first() else { continue };
        let shape = Shape::read(document, mesh, &mut cutter, warnings)?;
        let skin = skin::read(document, mesh, shape.positions.len(), nodes, warnings)?;
        let influences = skin.as_ref().map(|skin| &skin.influences);
        let Some(written) = shape.write(document, mesh, &materials, influences, glb)? else { continue };
        let skin = skin.map(|skin| skin.write(node, nodes, glb));
        for &node in places {
            attach(nodes, node, written, skin);
        }
    }
    Ok(())
}

/// Returns for each object the nodes that show it, if it is a mesh: the frame that it is in, those that refer to it, or else one
/// of its own.
fn places(document: &Document, nodes: &mut Nodes) -> Vec<Vec<usize>> {
    let names = Names::of(document, "Mesh");
    let mut places = vec![Vec::new(); document.objects.len()];
    for (frame, object) in document.all("Frame") {
        let Some(node) = nodes.of(frame) else { continue };
        for &child in &object.children {
            let target = &document.objects[child];
            let mesh = if target.is_reference() { names.find(target.name) } else { target.is("Mesh").then_some(child) };
            if let Some(mesh) = mesh {
                places[mesh].push(node);
            }
        }
    }
    for (mesh, object) in document.all("Mesh") {
        if places[mesh].is_empty() {
            places[mesh].push(nodes.add(None, text(object.name), DAffine3::IDENTITY));
        }
    }
    places
}

/// Puts a mesh on a node, or on a leaf if the node has one already.
fn attach(nodes: &mut Nodes, node: usize, mesh: usize, skin: Option<usize>) {
    let taken = nodes.entries[node].mesh.is_some();
    let place = if taken { nodes.add(Some(node), String::new(), DAffine3::IDENTITY) } else { node };
    (nodes.entries[place].mesh, nodes.entries[place].skin) = (Some(mesh), skin);
}

/// A mesh as the file has it.
struct Shape {
    positions: Vec<DVec3>,
    /// Vertex number at each corner of all faces.
    corners: Vec<u32>,
    /// Corners of each triangle, and the face that it is part of.
    triangles: Vec<([u32; 3], u32)>,
    faces: usize,
    normals: Vec<DVec3>,
    /// Normal number at each corner; empty without normals.
    normal_corners: Vec<u32>,
    uvs: Vec<[f32; 2]>,
    colors: Vec<[f32; 4]>,
}

impl Shape {
    fn read(document: &Document, mesh: usize, cutter: &mut Cutter, warnings: &mut Warnings) -> Result<Shape, String> {
        let mut numbers = document.numbers(mesh);
        let positions = vectors(&mut numbers, "vertices")?;
        let (corners, ends) = faces(&mut numbers, positions.len())?;
        let triangles = triangles(&positions, &corners, &ends, cutter);
        let mut shape = Shape {
            faces: ends.len(),
            positions,
            corners,
            triangles,
            normals: Vec::new(),
            normal_corners: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
        };
        if let Some((object, _)) = document.children(mesh, "MeshNormals").next() {
            shape.read_normals(document, object, &ends, warnings)?;
        }
        if let Some((object, _)) = document.children(mesh, "MeshTextureCoords").next() {
            let mut numbers = document.numbers(object);
            let count = numbers.count(2, "texture coordinates")?;
            let values = numbers.take(2 * count, "texture coordinates")?;
            shape.uvs = values.as_chunks::<2>().0.iter().map(|uv| uv.map(|value| value as f32)).collect();
            // A vertex without any is at the image's corner.
            shape.uvs.resize(shape.positions.len(), [0.0; 2]);
        }
        if let Some((object, _)) = document.children(mesh, "DeclData").next() {
            shape.add_declared(declared::read(document, object, shape.positions.len())?);
        }
        if let Some((object, _)) = document.children(mesh, "MeshVertexColors").next() {
            shape.read_colors(document, object)?;
        }
        Ok(shape)
    }

    fn read_normals(
        &mut self,
        document: &Document,
        object: usize,
        ends: &[u32],
        warnings: &mut Warnings,
    ) -> Result<(), String> {
        let mut numbers = document.numbers(object);
        let normals = vectors(&mut numbers, "normals")?;
        let (corners, own_ends) = faces(&mut numbers, normals.len())?;
        if own_ends == ends {
            self.set_normals(normals, corners);
        } else {
            let label = document.label(object);
            warnings.add(format!("{label} left out: its faces are not those of the mesh."));
        }
        Ok(())
    }

    /// Takes normals, and the number of the one at each corner.
    fn set_normals(&mut self, mut normals: Vec<DVec3>, mut corners: Vec<u32>) {
        for normal in &mut normals {
            *normal = mirrored(normal.to_array()).try_normalize().unwrap_or(DVec3::Y);
        }
        let merged = merged(&normals);
        for corner in &mut corners {
            *corner = merged[*corner as usize];
        }
        (self.normals, self.normal_corners) = (normals, corners);
    }

    /// Takes what the mesh doesn't have yet.
    fn add_declared(&mut self, declared: Declared) {
        if self.normals.is_empty() && !declared.normals.is_empty() {
            self.set_normals(declared.normals, self.corners.clone());
        }
        if self.uvs.is_empty() {
            self.uvs = declared.uvs;
        }
    }

    fn read_colors(&mut self, document: &Document, object: usize) -> Result<(), String> {
        let mut numbers = document.numbers(object);
        let count = numbers.count(5, "vertex colours")?;
        self.colors = vec![[1.0; 4]; self.positions.len()];
        for _ in 0..count {
            let vertex = numbers.index(self.positions.len().saturating_sub(1), "a vertex")?;
            let [red, green, blue, alpha] = numbers.array("a colour")?;
            if let Some(color) = self.colors.get_mut(vertex) {
                *color = [linear(red), linear(green), linear(blue), alpha.clamp(0.0, 1.0) as f32];
            }
        }
        Ok(())
    }

    /// Returns what makes two corners the same vertex: vertex number and normal number.
    fn key(&self, corner: u32) -> u64 {
        let normal = self.normal_corners.get(corner as usize).copied().unwrap_or_default();
        u64::from(self.corners[corner as usize]) << 32 | u64::from(normal)
    }

    /// Writes the mesh; none if it has no triangle.
    fn write(
        &self,
        document: &Document,
        mesh: usize,
        materials: &Materials,
        influences: Option<&Influences>,
        glb: &mut Glb,
    ) -> Result<Option<usize>, String> {
        let list = document.children(mesh, "MeshMaterialList").next().map(|(list, _)| list);
        let of_list = list.map_or_else(Vec::new, |list| materials.of_list(document, list));
        let of_face = list.map_or_else(|| Ok(Vec::new()), |list| self.material_of_faces(document, list))?;
        let material = |face: u32| {
            let place = of_face.get(face as usize).or(of_face.last()).copied().unwrap_or_default();
            place.min(of_list.len() as u32)
        };
        // Triangles by material, in the file's order.
        let mut order: Vec<u64> = Vec::with_capacity(self.triangles.len());
        for (at, (_, face)) in self.triangles.iter().enumerate() {
            order.push(u64::from(material(*face)) << 32 | at as u64);
        }
        order.sort_unstable();
        let mut primitives = Vec::new();
        for group in order.chunk_by(|a, b| a >> 32 == b >> 32) {
            let mut primitive = self.primitive(group, influences, glb)?;
            let material = of_list.get((group[0] >> 32) as usize).copied().flatten();
            if let Some(material) = material {
                primitive.set("material", material);
            }
            push(&mut primitives, primitive);
        }
        if primitives.is_empty() {
            return Ok(None);
        }
        let json = gaitway_glb::mesh(&text(document.objects[mesh].name), primitives);
        Ok(Some(push(&mut glb.meshes, json)))
    }

    /// Returns the place of each face's material in the list. Faces beyond the end have the last one's.
    fn material_of_faces(&self, document: &Document, list: usize) -> Result<Vec<u32>, String> {
        let mut numbers = document.numbers(list);
        let materials = numbers.index(u32::MAX as usize, "the number of materials")?;
        let count = numbers.count(1, "faces' materials")?.min(self.faces);
        let most = materials.saturating_sub(1);
        (0..count).map(|_| numbers.index(most, "a face's material").map(|material| material as u32)).collect()
    }

    /// Writes the triangles with these numbers, in the lower halves.
    fn primitive(&self, group: &[u64], influences: Option<&Influences>, glb: &mut Glb) -> Result<Object, String> {
        check_size(glb.len().saturating_add(group.len().saturating_mul(3 * 4)))?;
        let corners = group.iter().flat_map(|&entry| self.triangles[(entry & 0xffff_ffff) as usize].0);
        let of_corner: Vec<u64> = corners.map(|corner| self.key(corner)).collect();
        let mut vertices = of_corner.clone();
        vertices.sort_unstable();
        vertices.dedup();
        let index = |key: &u64| vertices.partition_point(|other| other < key) as u32;
        let triangles: Vec<u32> = of_corner.iter().map(index).collect();
        let ids: Vec<usize> = vertices.iter().map(|key| (key >> 32) as usize).collect();
        let influences = influences.map(|influences| ids.iter().map(|&id| &*influences[id]).collect::<Vec<_>>());
        let most = influences.iter().flatten().map(|own| own.len()).max().unwrap_or(0).next_multiple_of(4);
        check_size(glb.len().saturating_add(ids.len().saturating_mul(VERTEX_BYTES + most * INFLUENCE_BYTES)))?;
        let mut attributes = Object::new();
        let positions = gathered(&ids, |&id| floats(mirrored(self.positions[id].to_array())));
        attributes.set("POSITION", glb.floats(&positions, "VEC3", Some(ARRAY_BUFFER), true));
        if !self.normals.is_empty() {
            let normals = gathered(&vertices, |key| floats(self.normals[(key & 0xffff_ffff) as usize]));
            attributes.set("NORMAL", glb.floats(&normals, "VEC3", Some(ARRAY_BUFFER), false));
        }
        if !self.uvs.is_empty() {
            let uvs = gathered(&ids, |&id| self.uvs[id]);
            attributes.set("TEXCOORD_0", glb.floats(&uvs, "VEC2", Some(ARRAY_BUFFER), false));
        }
        if !self.colors.is_empty() {
            let colors = gathered(&ids, |&id| self.colors[id]);
            attributes.set("COLOR_0", glb.floats(&colors, "VEC4", Some(ARRAY_BUFFER), false));
        }
        if let Some(influences) = influences {
            glb.add_influences(&influences, &mut attributes);
        }
        Ok(Object::new().with("attributes", attributes).with("indices", glb.triangles(&triangles, ids.len())))
    }
}

/// Returns the values of all vertices in a row.
fn gathered<T, const COUNT: usize>(vertices: &[T], value: impl Fn(&T) -> [f32; COUNT]) -> Vec<f32> {
    let mut all = Vec::with_capacity(COUNT * vertices.len());
    for vertex in vertices {
        all.extend_from_slice(&value(vertex));
    }
    all
}

fn floats(vector: DVec3) -> [f32; 3] {
    vector.to_array().map(|value| value as f32)
}

/// Reads a count, then as many vectors.
fn vectors(numbers: &mut Numbers, what: &str) -> Result<Vec<DVec3>, String> {
    let count = numbers.count(3, what)?;
    let values = numbers.take(3 * count, what)?;
    Ok(values.as_chunks::<3>().0.iter().map(|&vector| DVec3::from_array(vector)).collect())
}

/// Reads faces of `count` vertices: the vertex at each corner, and where each face's corners end.
fn faces(numbers: &mut Numbers, count: usize) -> Result<(Vec<u32>, Vec<u32>), String> {
    let faces = numbers.count(1, "faces")?;
    let (mut corners, mut ends) = (Vec::new(), Vec::with_capacity(faces));
    for _ in 0..faces {
        for _ in 0..numbers.count(1, "corners of a face")? {
            if count == 0 {
                return Err(numbers.damaged("vertices for its faces", "none"));
            }
            corners.push(numbers.index(count - 1, "an index")? as u32);
        }
        ends.push(corners.len() as u32);
    }
    Ok((corners, ends))
}

/// Cuts faces into triangles of corners, counter-clockwise in right-handed space.
fn triangles(positions: &[DVec3], corners: &[u32], ends: &[u32], cutter: &mut Cutter) -> Vec<([u32; 3], u32)> {
    let mut triangles = Vec::new();
    let mut polygon = Vec::new();
    let mut start = 0;
    for (face, &end) in ends.iter().enumerate() {
        polygon.clear();
        polygon.extend(corners[start as usize..end as usize].iter().map(|&vertex| positions[vertex as usize]));
        cutter.cut(&polygon, |[a, b, c]| {
            // The winding that one sees doesn't depend on handedness: mirroring Z doesn't change the image.
            triangles.push(([a, c, b].map(|corner| start + corner as u32), face as u32));
        });
        start = end;
    }
    triangles
}

/// Returns for each vector the number of the first one that is equal: many exporters repeat a normal for each corner.
fn merged(vectors: &[DVec3]) -> Vec<u32> {
    let bits = |at: u32| vectors[at as usize].to_array().map(|value| (value as f32).to_bits());
    let mut order: Vec<u32> = (0..vectors.len() as u32).collect();
    order.sort_unstable_by_key(|&at| (bits(at), at));
    let mut merged = vec![0; vectors.len()];
    for equal in order.chunk_by(|&a, &b| bits(a) == bits(b)) {
        for &at in equal {
            merged[at as usize] = equal[0];
        }
    }
    merged
}
