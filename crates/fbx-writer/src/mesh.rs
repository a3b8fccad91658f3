//! Meshes: control points, what belongs to the corners of polygons, blend shapes, skins.
//!
//! glTF repeats a vertex wherever two corners differ in anything. Those that differ only in what FBX stores for corners become one
//! control point again, so that edges are as hard or soft as they were without being cuts.

use std::collections::HashMap;

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::MeshInstance;
use gaitway_character::mesh::{Geometry, Mesh, Topology, UvTransform};
use glam::{DMat4, DVec3, Vec2, Vec3, Vec4};

use crate::layout::{Contents, Layout};
use crate::names::Names;
use crate::objects::{Id, Objects};
use crate::record::{Properties, Record};

/// Names of the sets of texture coordinates.
pub const UV_SETS: [&str; 2] = ["UVMap", "UVMap2"];

/// Returns the primitives that FBX can hold: those of triangles.
pub fn triangles(mesh: &Mesh) -> impl Iterator<Item = &Geometry> {
    mesh.primitives.iter().filter(|geometry| geometry.topology == Topology::Triangles && !geometry.indices.is_empty())
}

/// Whether anything of a mesh can be written.
pub fn is_drawn(mesh: &Mesh) -> bool {
    triangles(mesh).next().is_some()
}

/// Returns the materials of a mesh in the order in which its polygons number them.
pub fn materials(mesh: &Mesh) -> Vec<Option<usize>> {
    let mut materials = Vec::new();
    for geometry in triangles(mesh) {
        if !materials.contains(&geometry.material) {
            materials.push(geometry.material);
        }
    }
    materials
}

/// A mesh under construction.
struct Shape<'a> {
    contents: Contents<'a>,
    primitives: Vec<&'a Geometry>,
    /// Control point of each vertex of each primitive.
    points: Vec<Vec<u32>>,
    /// Primitive and vertex of each control point.
    origins: Vec<(usize, usize)>,
    /// Units per glTF unit of the mesh's space.
    unit: f64,
}

/// Writes the mesh of an instance with its skin and blend shapes. Returns its number, and those of the channels of its blend
/// shapes.
pub fn write(
    contents: Contents,
    layout: &Layout,
    index: usize,
    (objects, names): (&mut Objects, &mut Names),
) -> (Id, Vec<Id>) {
    let Contents { asset, space, .. } = contents;
    let instance = &asset.instances[index];
    let mesh = &asset.meshes[instance.mesh];
    let unit = if instance.skin.is_some() { space.unit } else { space.of_joint(instance.joint.get()) };
    let shape = Shape::new(contents, mesh, unit);
    let name = names.unique(if mesh.name.is_empty() { "mesh" } else { &mesh.name });
    let geometry = objects.add("Geometry", (&name, "Geometry", "Mesh"), |record| shape.fill(record));
    let channels = shape.add_targets(mesh, instance, geometry, objects);
    if let Some(skin) = instance.skin {
        let world = layout.of_instances.get(&index).copied().unwrap_or(DMat4::IDENTITY);
        shape.add_skin(layout, skin, world, geometry, objects);
    }
    (geometry, channels)
}

impl<'a> Shape<'a> {
    fn new(contents: Contents<'a>, mesh: &'a Mesh, unit: f64) -> Shape<'a> {
        let primitives: Vec<&Geometry> = triangles(mesh).collect();
        let mut known: HashMap<Vec<u32>, u32> = HashMap::new();
        let (mut points, mut origins) = (Vec::new(), Vec::new());
        for (number, geometry) in primitives.iter().enumerate() {
            let of_vertices = (0..geometry.positions.len()).map(|vertex| {
                *known.entry(identity(geometry, vertex)).or_insert_with(|| {
                    origins.push((number, vertex));
                    origins.len() as u32 - 1
                })
            });
            points.push(of_vertices.collect());
        }
        Shape { contents, primitives, points, origins, unit }
    }

    fn vector(&self, v: Vec3) -> [f64; 3] {
        self.contents.space.turned(v.as_dvec3()).to_array()
    }

    fn place(&self, v: Vec3) -> [f64; 3] {
        (self.contents.space.turned(v.as_dvec3()) * self.unit).to_array()
    }

    /// Iterates over the corners of all triangles: primitive and vertex.
    fn corners(&self) -> impl Iterator<Item = (&'a Geometry, usize)> + '_ {
        self.primitives.iter().flat_map(|geometry| {
            // An incomplete triangle at the end isn't drawn.
            let whole = geometry.indices.len() / 3 * 3;
            geometry.indices[..whole].iter().map(|&index| (*geometry, index as usize))
        })
    }

    /// Iterates over the triangles' control points.
    fn polygons(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.primitives.iter().zip(&self.points).flat_map(|(geometry, points)| {
            geometry.indices.as_chunks::<3>().0.iter().map(|triangle| triangle.map(|index| points[index as usize]))
        })
    }

    fn fill(&self, record: Record) -> Record {
        let vertices: Vec<f64> = self
            .origins
            .iter()
            .flat_map(|&(number, vertex)| self.place(self.primitives[number].positions[vertex]))
            .collect();
        // The last corner of a polygon is inverted.
        let polygons: Vec<i32> = self.polygons().flat_map(|[a, b, c]| [a as i32, b as i32, !(c as i32)]).collect();
        let mut layers = Layers { record, sets: vec![Vec::new()] };
        layers.record.push(Properties::new().record());
        layers.record.push(Record::new("GeometryVersion").i32(124));
        layers.record.push(Record::new("Vertices").f64s(&vertices));
        layers.record.push(Record::new("PolygonVertexIndex").i32s(&polygons));
        let normals = Record::new("Normals").f64s(&self.normals());
        layers.push(element("LayerElementNormal", DIRECT).with(normals));
        self.add_tangents(&mut layers);
        self.add_colors(&mut layers);
        for set in 0..UV_SETS.len() {
            self.add_uvs(set, &mut layers);
        }
        self.add_materials(&mut layers);
        layers.finish()
    }

    /// Returns normals of all corners; without any in the file, those of the triangles, as glTF asks for.
    fn normals(&self) -> Vec<f64> {
        let mut normals = Vec::new();
        for geometry in &self.primitives {
            for triangle in geometry.indices.as_chunks::<3>().0 {
                let corners = triangle.map(|index| index as usize);
                if geometry.normals.is_empty() {
                    let [a, b, c] = corners.map(|vertex| geometry.positions[vertex]);
                    let normal = (b - a).cross(c - a).try_normalize().unwrap_or(Vec3::Y);
                    (0..3).for_each(|_| normals.extend(self.vector(normal)));
                } else {
                    corners.iter().for_each(|&vertex| normals.extend(self.vector(geometry.normals[vertex])));
                }
            }
        }
        normals
    }

    fn add_tangents(&self, layers: &mut Layers) {
        let has_both = |geometry: &&Geometry| !geometry.tangents.is_empty() && !geometry.normals.is_empty();
        if !self.primitives.iter().all(has_both) {
            return;
        }
        let (mut tangents, mut binormals) = (Vec::new(), Vec::new());
        for (geometry, vertex) in self.corners() {
            let (normal, tangent) = (geometry.normals[vertex], geometry.tangents[vertex]);
            tangents.extend(self.vector(tangent.truncate()));
            binormals.extend(self.vector(normal.cross(tangent.truncate()) * tangent.w));
        }
        layers.push(element("LayerElementTangent", DIRECT).with(Record::new("Tangents").f64s(&tangents)));
        layers.push(element("LayerElementBinormal", DIRECT).with(Record::new("Binormals").f64s(&binormals)));
    }

    /// Adds colours: FBX has them as they are painted, in sRGB.
    fn add_colors(&self, layers: &mut Layers) {
        if self.primitives.iter().all(|geometry| geometry.colors.is_empty()) {
            return;
        }
        let of_corners = self.corners().map(|(geometry, vertex)| {
            let color = geometry.colors.get(vertex).copied().unwrap_or(Vec4::ONE);
            [srgb(color.x), srgb(color.y), srgb(color.z), color.w.clamp(0.0, 1.0).into()]
        });
        let (values, indices) = indexed(of_corners);
        let colors = element("LayerElementColor", BY_INDEX).with(Record::new("Colors").f64s(&values));
        layers.push(colors.with(Record::new("ColorIndex").i32s(&indices)));
    }

    fn add_uvs(&self, set: usize, layers: &mut Layers) {
        if self.primitives.iter().all(|geometry| geometry.uvs[set].is_empty()) {
            return;
        }
        let transforms: Vec<UvTransform> = self
            .primitives
            .iter()
            .map(|geometry| crate::material::uv_transform(self.contents.asset, geometry, set))
            .collect();
        let of_corners = self.primitives.iter().zip(&transforms).flat_map(|(geometry, transform)| {
            geometry.indices.as_chunks::<3>().0.as_flattened().iter().map(move |&index| {
                let uv = geometry.uvs[set].get(index as usize).copied().unwrap_or_default();
                let uv = transformed(uv, transform);
                // V points up.
                [f64::from(uv.x), 1.0 - f64::from(uv.y)]
            })
        });
        let (values, indices) = indexed(of_corners);
        let uvs = named_element("LayerElementUV", set, UV_SETS[set], BY_INDEX).with(Record::new("UV").f64s(&values));
        layers.push_to(set, uvs.with(Record::new("UVIndex").i32s(&indices)));
    }

    fn add_materials(&self, layers: &mut Layers) {
        let mut materials = Vec::new();
        let mut of_polygons = Vec::new();
        for geometry in &self.primitives {
            let number = materials.iter().position(|&material| material == geometry.material);
            let number = number.unwrap_or_else(|| {
                materials.push(geometry.material);
                materials.len() - 1
            });
            of_polygons.resize(of_polygons.len() + geometry.indices.len() / 3, number as i32);
        }
        let (mapping, of_polygons) = match materials.len() {
            1 => ("AllSame", vec![0]),
            _ => ("ByPolygon", of_polygons),
        };
        let of_polygons = Record::new("Materials").i32s(&of_polygons);
        layers.push(element("LayerElementMaterial", [mapping, "IndexToDirect"]).with(of_polygons));
    }

    /// Adds the blend shapes and returns their channels.
    fn add_targets(&self, mesh: &Mesh, instance: &MeshInstance, geometry: Id, objects: &mut Objects) -> Vec<Id> {
        let count = self.primitives.iter().map(|geometry| geometry.morph_targets.len()).max().unwrap_or_default();
        if count == 0 {
            return Vec::new();
        }
        let rest = self.contents.asset.skeleton.rest();
        let weights = &rest.morph_weights[self.contents.asset.skeleton.morph_range(instance.joint)];
        let deformer = objects.add("Deformer", (&mesh.name, "Deformer", "BlendShape"), |record| {
            record.with(Record::new("Version").i32(100))
        });
        objects.connect(deformer, geometry);
        let mut names = Names::default();
        let add = |target: usize| {
            let wanted = mesh.target_names.get(target).map(String::as_str).filter(|name| !name.is_empty());
            let name = names.unique(wanted.unwrap_or(&format!("target_{target}")));
            let weight = 100.0 * f64::from(weights.get(target).copied().unwrap_or_default());
            let shape =
                objects.add("Geometry", (&name, "Geometry", "Shape"), |record| self.fill_target(record, target));
            let channel = objects.add("Deformer", (&name, "SubDeformer", "BlendShapeChannel"), |record| {
                record
                    .with(Record::new("Version").i32(100))
                    .with(Record::new("DeformPercent").f64(weight))
                    .with(Record::new("FullWeights").f64s(&[100.0]))
                    .with(Properties::new().number("DeformPercent", weight).record())
            });
            objects.connect(channel, deformer);
            objects.connect(shape, channel);
            channel
        };
        (0..count).map(add).collect()
    }

    fn fill_target(&self, record: Record, target: usize) -> Record {
        let (mut indices, mut offsets, mut normals) = (Vec::new(), Vec::new(), Vec::new());
        for (point, &(number, vertex)) in self.origins.iter().enumerate() {
            let Some(target) = self.primitives[number].morph_targets.get(target) else { continue };
            let offset = target.positions.get(vertex).copied().unwrap_or_default();
            let normal = target.normals.get(vertex).copied().unwrap_or_default();
            if offset != Vec3::ZERO || normal != Vec3::ZERO {
                indices.push(point as i32);
                offsets.extend(self.place(offset));
                normals.extend(self.vector(normal));
            }
        }
        if indices.is_empty() {
            // Some readers take a shape that moves nothing for a damaged one.
            (indices, offsets, normals) = (vec![0], vec![0.0; 3], vec![0.0; 3]);
        }
        let record = record
            .with(Properties::new().record())
            .with(Record::new("Version").i32(100))
            .with(Record::new("Indexes").i32s(&indices))
            .with(Record::new("Vertices").f64s(&offsets));
        let has_normals = normals.iter().any(|&component| component != 0.0);
        if has_normals { record.with(Record::new("Normals").f64s(&normals)) } else { record }
    }

    /// Adds a cluster for each joint of the skin, with all weights that there are. `world` is where the mesh was bound.
    fn add_skin(&self, layout: &Layout, skin: usize, world: DMat4, geometry: Id, objects: &mut Objects) {
        let Contents { asset, space, .. } = self.contents;
        let skin = &asset.skins[skin];
        let mut clusters = vec![(Vec::new(), Vec::new()); skin.joints().len()];
        for (point, &(number, vertex)) in self.origins.iter().enumerate() {
            let influences = &self.primitives[number].influences;
            if influences.is_empty() {
                continue;
            }
            for (joint, weight) in influences.of_vertex(vertex).filter(|&(_, weight)| weight > 0.0) {
                let (points, weights): &mut (Vec<i32>, Vec<f64>) = &mut clusters[usize::from(joint)];
                // A file may name a joint of a vertex twice.
                match weights.last_mut().filter(|_| points.last() == Some(&(point as i32))) {
                    Some(last) => *last += f64::from(weight),
                    None => {
                        points.push(point as i32);
                        weights.push(weight.into());
                    }
                }
            }
        }
        let deformer = objects.add("Deformer", (skin.name(), "Deformer", "Skin"), |record| {
            record
                .with(Record::new("Version").i32(101))
                .with(Record::new("Link_DeformAcuracy").f64(50.0))
                .with(Record::new("SkinningType").text("Linear"))
        });
        objects.connect(deformer, geometry);
        let bound = skin.joints().iter().zip(skin.joint_from_bind());
        for ((joint, joint_from_bind), (points, weights)) in bound.zip(clusters) {
            let model = &layout.models[joint.get()];
            let bone_from_mesh = space.matrix(joint_from_bind, space.unit, space.of_joint(joint.get()));
            let link = world * bone_from_mesh.inverse();
            let link = if link.is_finite() { link } else { layout.worlds[joint.get()] };
            let cluster = objects.add("Deformer", (&model.name, "SubDeformer", "Cluster"), |record| {
                let mut record =
                    record.with(Record::new("Version").i32(100)).with(Record::new("UserData").text("").text(""));
                if !points.is_empty() {
                    record =
                        record.with(Record::new("Indexes").i32s(&points)).with(Record::new("Weights").f64s(&weights));
                }
                record
                    .with(Record::new("Transform").f64s(&bone_from_mesh.to_cols_array()))
                    .with(Record::new("TransformLink").f64s(&link.to_cols_array()))
            });
            objects.connect(cluster, deformer);
            objects.connect(model.id, cluster);
        }
    }
}

/// Returns what makes vertices the same control point.
fn identity(geometry: &Geometry, vertex: usize) -> Vec<u32> {
    // Adding zero turns -0 into 0.
    let bits = |v: Vec3| v.to_array().map(|component| (component + 0.0).to_bits());
    let mut identity = bits(geometry.positions[vertex]).to_vec();
    if !geometry.influences.is_empty() {
        for (joint, weight) in geometry.influences.of_vertex(vertex).filter(|&(_, weight)| weight > 0.0) {
            identity.extend([joint.into(), weight.to_bits()]);
        }
    }
    // Weights and offsets can't be mixed up.
    identity.push(u32::MAX);
    for target in &geometry.morph_targets {
        for offsets in [&target.positions, &target.normals] {
            identity.extend(bits(offsets.get(vertex).copied().unwrap_or_default()));
        }
    }
    identity
}

/// Returns the distinct values and the number of each corner's.
fn indexed<const N: usize>(corners: impl Iterator<Item = [f64; N]>) -> (Vec<f64>, Vec<i32>) {
    let mut known: HashMap<[u64; N], i32> = HashMap::new();
    let mut values: Vec<f64> = Vec::new();
    let indices = corners.map(|value| {
        *known.entry(value.map(f64::to_bits)).or_insert_with(|| {
            values.extend(value);
            (values.len() / N) as i32 - 1
        })
    });
    let indices = indices.collect();
    (values, indices)
}

fn transformed(uv: Vec2, transform: &UvTransform) -> Vec2 {
    if *transform == UvTransform::IDENTITY {
        return uv;
    }
    let (sin, cos) = libm::sincosf(transform.rotation_radians);
    let uv = uv * transform.scale;
    // Counter-clockwise where V points down, as KHR_texture_transform has it.
    Vec2::new(cos * uv.x + sin * uv.y, cos * uv.y - sin * uv.x) + transform.offset
}

/// Returns the sRGB value of a linear one.
pub fn srgb(value: f32) -> f64 {
    let value = f64::from(value).clamp(0.0, 1.0);
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * libm::pow(value, 1.0 / 2.4) - 0.055 }
}

/// How an element maps to the mesh and refers to its values.
const DIRECT: [&str; 2] = ["ByPolygonVertex", "Direct"];
const BY_INDEX: [&str; 2] = ["ByPolygonVertex", "IndexToDirect"];

fn element(name: &'static str, mapping: [&str; 2]) -> Record {
    named_element(name, 0, "", mapping)
}

fn named_element(name: &'static str, set: usize, label: &str, [mapping, reference]: [&str; 2]) -> Record {
    Record::new(name)
        .i32(set as i32)
        .with(Record::new("Version").i32(101))
        .with(Record::new("Name").text(label))
        .with(Record::new("MappingInformationType").text(mapping))
        .with(Record::new("ReferenceInformationType").text(reference))
}

/// The layers of a mesh: which elements belong together.
struct Layers {
    record: Record,
    /// Names of the elements of each layer.
    sets: Vec<Vec<&'static str>>,
}

impl Layers {
    fn push(&mut self, element: Record) {
        self.push_to(0, element);
    }

    fn push_to(&mut self, set: usize, element: Record) {
        while self.sets.len() <= set {
            self.sets.push(Vec::new());
        }
        self.sets[set].push(element.name());
        self.record.push(element);
    }

    fn finish(self) -> Record {
        let layers = self.sets.iter().enumerate().map(|(set, names)| {
            let layer = Record::new("Layer").i32(set as i32).with(Record::new("Version").i32(100));
            layer.with_all(names.iter().map(|name| {
                let element = Record::new("LayerElement").with(Record::new("Type").text(name));
                element.with(Record::new("TypedIndex").i32(set as i32))
            }))
        });
        self.record.with_all(layers)
    }
}

/// Calls `add` with all vertices at rest in the file's space, and a joint that moves them: each of those of the skin.
pub fn for_each_point(contents: Contents, layout: &Layout, add: &mut dyn FnMut(JointIndex, DVec3)) {
    let Contents { asset, space, .. } = contents;
    for (&index, world) in &layout.of_instances {
        let instance = &asset.instances[index];
        let unit = if instance.skin.is_some() { space.unit } else { space.of_joint(instance.joint.get()) };
        for geometry in triangles(&asset.meshes[instance.mesh]) {
            for (vertex, &position) in geometry.positions.iter().enumerate() {
                let point = world.transform_point3(space.turned(position.as_dvec3()) * unit);
                let skin = instance.skin.filter(|_| !geometry.influences.is_empty()).map(|skin| &asset.skins[skin]);
                let Some(skin) = skin else {
                    add(instance.joint, point);
                    continue;
                };
                let influences = geometry.influences.of_vertex(vertex).filter(|&(_, weight)| weight > 0.0);
                influences.for_each(|(joint, _)| add(skin.joints()[usize::from(joint)], point));
            }
        }
    }
}
