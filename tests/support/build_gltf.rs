//! Builds small glTF files: JSON and the buffer that it refers to.

use gaitway_character::asset::Asset;
use gaitway_formats::{FileSet, LoadError, load};
use serde_json::{Value, json};

/// A glTF file under construction. Tests change `json` at will; `accessor` adds data.
pub struct Build {
    pub json: Value,
    pub bytes: Vec<u8>,
}

pub const F32: u32 = 5126;
pub const U32: u32 = 5125;
pub const U16: u32 = 5123;
pub const I16: u32 = 5122;
pub const U8: u32 = 5121;
pub const I8: u32 = 5120;

pub fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

pub fn shorts(values: &[u16]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// The texts of all warnings.
pub fn warnings(asset: &Asset) -> Vec<String> {
    asset.warnings.iter().map(ToString::to_string).collect()
}

impl Build {
    pub fn new() -> Self {
        let json = json!({ "asset": { "version": "2.0" }, "accessors": [], "bufferViews": [] });
        Self { json, bytes: Vec::new() }
    }

    /// One triangle in the XY plane, drawn by node 0: accessor 0 holds the positions.
    pub fn triangle() -> Self {
        let mut build = Self::new();
        build.accessor(F32, "VEC3", 3, &floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]));
        build.json["meshes"] = json!([{ "primitives": [{ "attributes": { "POSITION": 0 } }] }]);
        build.json["nodes"] = json!([{ "mesh": 0 }]);
        build
    }

    /// The triangle, skinned to nodes 1 and 2: JOINTS_0 is accessor 1, WEIGHTS_0 accessor 2.
    pub fn skinned(joints: [u8; 12], weights: [f32; 12]) -> Self {
        let mut build = Self::triangle();
        build.accessor(U8, "VEC4", 3, &joints);
        build.accessor(F32, "VEC4", 3, &floats(&weights));
        build.attribute("JOINTS_0", 1);
        build.attribute("WEIGHTS_0", 2);
        build.json["nodes"] = json!([{ "mesh": 0, "skin": 0 }, { "children": [2] }, {}]);
        build.json["skins"] = json!([{ "joints": [1, 2] }]);
        build
    }

    /// The triangle, its node animated: input is accessor 1, output accessor 2.
    pub fn animated(path: &str, times: &[f32], shape: &str, count: usize, values: &[f32]) -> Self {
        let mut build = Self::triangle();
        build.accessor(F32, "SCALAR", times.len(), &floats(times));
        build.accessor(F32, shape, count, &floats(values));
        build.json["animations"] = json!([{
            "name": "move",
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": path } }],
            "samplers": [{ "input": 1, "output": 2 }],
        }]);
        build
    }

    /// Adds a channel to the first animation, which is created if there is none: KHR_animation_pointer.
    pub fn point(&mut self, pointer: &str, interpolation: &str, shape: &str, times_secs: &[f32], values: &[f32]) {
        let width = if shape == "SCALAR" { 1 } else { shape[3..].parse().expect("a vector") };
        let input = self.accessor(F32, "SCALAR", times_secs.len(), &floats(times_secs));
        let output = match pointer.ends_with("/visible") {
            true => {
                let bytes: Vec<u8> = values.iter().map(|&value| value as u8).collect();
                self.accessor(U8, shape, bytes.len(), &bytes)
            }
            false => self.accessor(F32, shape, values.len() / width, &floats(values)),
        };
        if self.json["animations"].is_null() {
            self.json["animations"] = json!([{ "name": "pointers", "channels": [], "samplers": [] }]);
        }
        let animation = &mut self.json["animations"][0];
        let sampler = json!({ "input": input, "output": output, "interpolation": interpolation });
        let sampler = push(&mut animation["samplers"], sampler);
        let target = json!({ "path": "pointer", "extensions": { "KHR_animation_pointer": { "pointer": pointer } } });
        push(&mut animation["channels"], json!({ "sampler": sampler, "target": target }));
    }

    /// Adds a buffer view of these bytes, aligned to 4, and returns its index.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        self.bytes.extend_from_slice(bytes);
        push(&mut self.json["bufferViews"], view)
    }

    pub fn accessor(&mut self, component: u32, shape: &str, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        let accessor = json!({ "bufferView": view, "componentType": component, "type": shape, "count": count });
        push(&mut self.json["accessors"], accessor)
    }

    /// Sets an attribute of the first primitive.
    pub fn attribute(&mut self, semantic: &str, accessor: usize) {
        self.json["meshes"][0]["primitives"][0]["attributes"][semantic] = json!(accessor);
    }

    /// Loads a file that is expected to be readable.
    pub fn loaded(self) -> Asset {
        self.load().unwrap_or_else(|problem| panic!("{problem}"))
    }

    /// Replaces the value at a JSON pointer; the parent must exist.
    pub fn with(mut self, pointer: &str, value: Value) -> Self {
        let (parent, key) = pointer.rsplit_once('/').expect("a JSON pointer");
        match self.json.pointer_mut(parent).expect("the parent exists") {
            Value::Array(list) => list[key.parse::<usize>().expect("an index")] = value,
            parent => parent[key] = value,
        }
        self
    }

    /// Returns a GLB with the buffer as binary chunk.
    pub fn glb(mut self) -> Vec<u8> {
        if !self.bytes.is_empty() {
            self.json["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        }
        glb(self.json.to_string().as_bytes(), &self.bytes)
    }

    /// Returns JSON text with one external buffer.
    pub fn gltf(mut self, buffer_uri: &str) -> Vec<u8> {
        self.json["buffers"] = json!([{ "byteLength": self.bytes.len(), "uri": buffer_uri }]);
        self.json.to_string().into_bytes()
    }

    pub fn load(self) -> Result<Asset, LoadError> {
        load(&one("model.glb", self.glb()))
    }
}

fn push(list: &mut Value, value: Value) -> usize {
    let list = list.as_array_mut().expect("an array");
    list.push(value);
    list.len() - 1
}

pub fn one(name: &str, bytes: Vec<u8>) -> FileSet {
    let mut files = FileSet::default();
    files.insert(name, bytes);
    files
}

pub fn glb(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let mut json = json.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut binary = binary.to_vec();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut file = b"glTF".to_vec();
    let binary_length = if binary.is_empty() { 0 } else { 8 + binary.len() };
    for word in [2, (12 + 8 + json.len() + binary_length) as u32, json.len() as u32, 0x4E4F_534A] {
        file.extend(word.to_le_bytes());
    }
    file.extend(json);
    if !binary.is_empty() {
        file.extend((binary.len() as u32).to_le_bytes());
        file.extend(0x004E_4942_u32.to_le_bytes());
        file.extend(binary);
    }
    file
}
