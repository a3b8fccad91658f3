//! Writes a model that came from another format as GLB: nodes, meshes, skins, materials, images and clips. What only glTF files
//! have (morph targets, cameras, lights) is not written.

use gaitway_character::anim::{Clip, Skeleton};
use gaitway_character::asset::Asset;
use gaitway_character::mesh::{AlphaMode, Geometry, Material, Mesh, Skin, Texture, TextureRef, Topology};
use gaitway_character::sort::collect_set;
use glam::{Mat4, Vec3};
use serde_json::{Value, json};

use super::motion::nodes_and_scenes;
use super::{WriteError, clip, glb};
use crate::gltf::images::{AVIF, KTX2};

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The extensions for images; PNG and JPEG need none.
const IMAGE_EXTENSIONS: [(&str, &str); 3] =
    [("image/webp", "EXT_texture_webp"), (AVIF, "EXT_texture_avif"), (KTX2, "KHR_texture_basisu")];

const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// Writes `asset` with the joints of `skeleton`, which may have other names and another rest pose; the bind pose stays. The first
/// `own` of the clips are its own, the others are added. Nodes are numbered as in the source file. Skinned meshes get nodes of their
/// own after these, since the transform of such a node has no effect. Influences are written in sets of four.
pub fn asset(asset: &Asset, skeleton: &Skeleton, own: usize, clips: &[&Clip]) -> Result<Vec<u8>, WriteError> {
    let mut root = nodes_and_scenes(asset, skeleton);
    let mut data = Data::default();
    let meshes: Vec<Value> = asset.meshes.iter().map(|written| mesh(written, &mut data)).collect();
    let skins: Vec<Value> = asset.skins.iter().map(|written| skin(written, skeleton, &mut data)).collect();
    place_meshes(asset, skeleton, &mut root);
    let images: Vec<Value> = asset.images.iter().map(|image| data.image(image)).collect();
    let image_extension = |texture: &Texture| {
        let mime = asset.images[texture.image?].mime;
        IMAGE_EXTENSIONS.into_iter().find_map(|(of, name)| (of == mime).then_some(name))
    };
    let texture = |texture: &Texture| match image_extension(texture) {
        Some(name) => json!({ "extensions": { name: { "source": texture.image } } }),
        None => json!({ "source": texture.image }),
    };
    let needed = collect_set(asset.textures.iter().filter_map(image_extension));
    if !needed.is_empty() {
        root["extensionsUsed"] = json!(needed);
        root["extensionsRequired"] = json!(needed);
    }
    let textures: Vec<Value> = asset.textures.iter().map(texture).collect();
    let materials: Vec<Value> = asset.materials.iter().map(material).collect();
    let counts = clip::Counts { accessors: data.accessors.len(), buffer_views: data.views.len() };
    let Data { mut binary, mut views, mut accessors } = data;
    let added = clip::add(clips, own, skeleton, false, counts, &mut binary)?;
    accessors.extend(added.accessors.iter().map(|accessor| json!(accessor)));
    views.extend(added.buffer_views.iter().map(|view| json!(view)));
    let lists = [
        ("meshes", meshes),
        ("skins", skins),
        ("materials", materials),
        ("textures", textures),
        ("images", images),
        ("animations", added.animations.iter().map(|animation| json!(animation)).collect()),
        ("accessors", accessors),
        ("bufferViews", views),
    ];
    // An empty list is not allowed.
    for (key, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
        root[key] = Value::Array(list);
    }
    if !binary.is_empty() {
        root["buffers"] = json!([{ "byteLength": binary.len() }]);
    }
    glb::glb(root.to_string().into_bytes(), binary)
}

fn place_meshes(asset: &Asset, skeleton: &Skeleton, root: &mut Value) {
    for instance in &asset.instances {
        match instance.skin {
            None => root["nodes"][skeleton.source_index(instance.joint)]["mesh"] = json!(instance.mesh),
            Some(skin) => {
                let mut node = json!({ "mesh": instance.mesh, "skin": skin });
                if !asset.meshes[instance.mesh].name.is_empty() {
                    node["name"] = json!(asset.meshes[instance.mesh].name);
                }
                let Some(nodes) = root["nodes"].as_array_mut() else { continue };
                nodes.push(node);
                let index = nodes.len() - 1;
                if let Some(roots) = root["scenes"][asset.default_scene.unwrap_or(0)]["nodes"].as_array_mut() {
                    roots.push(json!(index));
                }
            }
        }
    }
}

/// The buffer as it grows, with its views and accessors.
#[derive(Default)]
struct Data {
    binary: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Data {
    fn view(&mut self, target: Option<u32>, bytes: impl IntoIterator<Item = u8>) -> usize {
        glb::pad(&mut self.binary, 0);
        let start = self.binary.len();
        self.binary.extend(bytes);
        let mut view = json!({ "buffer": 0, "byteOffset": start, "byteLength": self.binary.len() - start });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, view: usize, component: u32, shape: &str, count: usize) -> usize {
        self.accessors.push(json!({ "bufferView": view, "componentType": component, "count": count, "type": shape }));
        self.accessors.len() - 1
    }

    fn floats<const N: usize>(&mut self, target: Option<u32>, shape: &str, elements: &[[f32; N]]) -> usize {
        let bytes = elements.iter().flatten().flat_map(|number| number.to_le_bytes());
        let view = self.view(target, bytes);
        self.accessor(view, FLOAT, shape, elements.len())
    }

    fn attribute<const N: usize>(&mut self, shape: &str, elements: impl Iterator<Item = [f32; N]>) -> usize {
        self.floats(Some(ARRAY_BUFFER), shape, &elements.collect::<Vec<_>>())
    }

    fn image(&mut self, image: &gaitway_character::asset::Image) -> Value {
        let view = self.view(None, image.bytes.iter().copied());
        json!({ "name": image.name, "mimeType": image.mime, "bufferView": view })
    }
}

fn mesh(mesh: &Mesh, data: &mut Data) -> Value {
    let primitives = mesh.primitives.iter().enumerate();
    let primitives: Vec<Value> = primitives
        .map(|(index, geometry)| {
            let mut written = primitive(geometry, data);
            if let Some(name) = mesh.part_names.get(index).filter(|name| !name.is_empty()) {
                written["extras"] = json!({ "name": name });
            }
            written
        })
        .collect();
    json!({ "name": mesh.name, "primitives": primitives })
}

fn primitive(geometry: &Geometry, data: &mut Data) -> Value {
    let mut attributes = json!({});
    let positions = data.attribute("VEC3", geometry.positions.iter().map(|at| at.to_array()));
    let min = geometry.positions.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let max = geometry.positions.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    // With all digits, since validators compare them with the data.
    data.accessors[positions]["min"] = json!(min.as_dvec3().to_array());
    data.accessors[positions]["max"] = json!(max.as_dvec3().to_array());
    attributes["POSITION"] = json!(positions);
    if !geometry.normals.is_empty() {
        attributes["NORMAL"] = json!(data.attribute("VEC3", geometry.normals.iter().map(|normal| normal.to_array())));
    }
    if !geometry.uvs[0].is_empty() {
        attributes["TEXCOORD_0"] = json!(data.attribute("VEC2", geometry.uvs[0].iter().map(|uv| uv.to_array())));
    }
    if !geometry.colors.is_empty() {
        attributes["COLOR_0"] = json!(data.attribute("VEC4", geometry.colors.iter().map(|color| color.to_array())));
    }
    let influences = &geometry.influences;
    let sets = influences.stride / 4;
    let (joints, weights) = (influences.joints.as_chunks::<4>().0, influences.weights.as_chunks::<4>().0);
    for set in 0..sets {
        let of_set = joints.iter().skip(set).step_by(sets);
        let view = data.view(Some(ARRAY_BUFFER), of_set.flatten().flat_map(|joint| joint.to_le_bytes()));
        let accessor = data.accessor(view, UNSIGNED_SHORT, "VEC4", geometry.positions.len());
        attributes[format!("JOINTS_{set}")] = json!(accessor);
        let accessor = data.attribute("VEC4", weights.iter().skip(set).step_by(sets).copied());
        attributes[format!("WEIGHTS_{set}")] = json!(accessor);
    }
    let view = data.view(Some(ELEMENT_ARRAY_BUFFER), geometry.indices.iter().flat_map(|index| index.to_le_bytes()));
    let indices = data.accessor(view, UNSIGNED_INT, "SCALAR", geometry.indices.len());
    let mode = match geometry.topology {
        Topology::Points => 0,
        Topology::Lines => 1,
        Topology::Triangles => 4,
    };
    let mut primitive = json!({ "attributes": attributes, "indices": indices, "mode": mode });
    if let Some(material) = geometry.material {
        primitive["material"] = json!(material);
    }
    primitive
}

fn skin(skin: &Skin, skeleton: &Skeleton, data: &mut Data) -> Value {
    let matrices: Vec<[f32; 16]> =
        skin.joint_from_bind().iter().map(|matrix| Mat4::from(*matrix).to_cols_array()).collect();
    let matrices = data.floats(None, "MAT4", &matrices);
    let joints: Vec<usize> = skin.joints().iter().map(|&joint| skeleton.source_index(joint)).collect();
    json!({ "name": skin.name(), "joints": joints, "inverseBindMatrices": matrices })
}

/// Writes colours, alpha and the base colour texture; the source formats have nothing else.
fn material(material: &Material) -> Value {
    let mut surface = json!({
        "baseColorFactor": material.base_color.to_array(),
        "metallicFactor": material.metallic,
        "roughnessFactor": material.roughness,
    });
    if let Some(TextureRef { texture, uv_set, .. }) = material.base_color_texture {
        surface["baseColorTexture"] = json!({ "index": texture, "texCoord": uv_set });
    }
    let mut written = json!({ "name": material.name, "pbrMetallicRoughness": surface });
    if material.emissive != Vec3::ZERO {
        written["emissiveFactor"] = json!(material.emissive.to_array());
    }
    if material.alpha_mode == AlphaMode::Blend {
        written["alphaMode"] = json!("BLEND");
    }
    if material.double_sided {
        written["doubleSided"] = json!(true);
    }
    written
}
