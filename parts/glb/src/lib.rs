//! Shared by the converters of other formats: a glTF document under construction, written as GLB, and the conversion of
//! values to glTF's.
//!
//! What a file has many of is typed, and the rest are [`serde_json::Value`]s, built member by member.

#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![forbid(unsafe_code)]

mod accessor;
mod animation;
mod values;
mod warnings;

use std::io;

use serde::Serialize;
use serde::ser::SerializeMap;
use serde_json::ser::{Formatter, Serializer};
use serde_json::{Map, Value};

use accessor::{Accessor, FLOAT, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT, View, components};
pub use animation::Animation;
pub use values::{MAX_INFLUENCES, base_name, linear, percent_encoded, roughness_of_exponent, strongest};
pub use warnings::Warnings;

/// Maximum size of the GLB. Its header counts bytes with 32 bits.
const MAX_BYTES: usize = 1 << 29;

/// About how long the JSON of an accessor or a view is.
const JSON_BYTES: usize = 100;

/// Buffer view target for vertex attributes.
pub const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// A JSON object under construction; its members keep their order.
#[derive(Clone, Default)]
pub struct Object(Map<String, Value>);

impl Object {
    /// Creates an object without members.
    pub fn new() -> Object {
        Object::default()
    }

    /// Adds a member and returns the object.
    #[must_use]
    pub fn with(mut self, key: &str, value: impl Into<Value>) -> Object {
        self.set(key, value);
        self
    }

    /// Adds a member.
    pub fn set(&mut self, key: &str, value: impl Into<Value>) {
        self.0.insert(key.to_owned(), value.into());
    }

    /// Returns whether nothing was added.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl From<Object> for Value {
    fn from(object: Object) -> Value {
        object.0.into()
    }
}

/// Appends an element to a list and returns its index.
pub fn push(list: &mut Vec<Value>, element: impl Into<Value>) -> usize {
    list.push(element.into());
    list.len() - 1
}

/// Returns a number as a 32-bit float; 0 for what isn't finite, which JSON can't express.
pub fn number(value: f64) -> Value {
    let value = value as f32;
    // Adding 0 leaves -0 out.
    Value::from(if value.is_finite() { f64::from(value + 0.0) } else { 0.0 })
}

/// Returns an array of numbers.
pub fn numbers(values: &[f64]) -> Value {
    values.iter().copied().map(number).collect()
}

/// Returns a mesh, to which the caller can add morph targets. Omits an empty name.
pub fn mesh(name: &str, primitives: Vec<Value>) -> Object {
    let mut mesh = Object::new();
    if !name.is_empty() {
        mesh.set("name", name);
    }
    mesh.set("primitives", primitives);
    mesh
}

/// Writes numbers with the fewest digits that give back the 32-bit floats that they are.
struct Floats;

impl Formatter for Floats {
    fn write_f64<W: ?Sized + io::Write>(&mut self, writer: &mut W, value: f64) -> io::Result<()> {
        let mut buffer = ryu::Buffer::new();
        let text = buffer.format_finite(value as f32);
        writer.write_all(text.strip_suffix(".0").unwrap_or(text).as_bytes())
    }
}

/// The document.
#[derive(Default)]
pub struct Glb {
    /// The format that it is converted from, and how it was read.
    source: String,
    bytes: Vec<u8>,
    views: Vec<View>,
    accessors: Vec<Accessor>,
    /// `nodes`
    pub nodes: Vec<Value>,
    /// Nodes of the only scene.
    pub scene_roots: Vec<usize>,
    /// `meshes`
    pub meshes: Vec<Value>,
    /// `skins`
    pub skins: Vec<Value>,
    /// `materials`
    pub materials: Vec<Value>,
    /// `textures`
    pub textures: Vec<Value>,
    /// `samplers` of textures
    pub samplers: Vec<Value>,
    /// `images`
    pub images: Vec<Value>,
    /// `cameras`
    pub cameras: Vec<Value>,
    /// Lights of `KHR_lights_punctual`.
    pub lights: Vec<Value>,
    animations: Vec<Animation>,
    extensions: Vec<&'static str>,
}

impl Glb {
    /// Creates an empty document. `source` is the format that it is converted from and how it was read, for `asset.generator`.
    pub fn new(source: impl Into<String>) -> Glb {
        Glb { source: source.into(), ..Glb::default() }
    }

    /// Declares that the document uses an extension.
    pub fn use_extension(&mut self, name: &'static str) {
        if !self.extensions.contains(&name) {
            self.extensions.push(name);
        }
    }

    /// Appends bytes to the buffer and returns the index of their view.
    pub fn view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let (byte_offset, byte_length) = (self.bytes.len(), bytes.len());
        self.bytes.extend_from_slice(bytes);
        self.views.push(View { buffer: 0, byte_offset, byte_length, target });
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Accessor) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Appends an accessor of floats with as many components as `kind` has. `bounds` adds `min` and `max`.
    pub fn floats(&mut self, values: &[f32], kind: &'static str, target: Option<u32>, bounds: bool) -> usize {
        let view = self.view(&bytes_of(values, f32::to_le_bytes), target);
        let mut accessor = Accessor::new(Some(view), FLOAT, values.len() / components(kind), kind);
        if bounds {
            accessor.add_bounds(values);
        }
        self.accessor(accessor)
    }

    /// Appends an accessor that is zero but for the given elements, which are in ascending order.
    pub fn sparse(&mut self, count: usize, elements: &[u32], values: &[f32]) -> usize {
        let mut accessor = Accessor::new(None, FLOAT, count, "VEC3");
        let mut reached = values.to_vec();
        if elements.len() < count {
            reached.extend([0.0; 3]);
        }
        accessor.add_bounds(&reached);
        if !elements.is_empty() {
            let places = self.view(&bytes_of(elements, u32::to_le_bytes), None);
            let values = self.view(&bytes_of(values, f32::to_le_bytes), None);
            accessor.replace(elements.len(), places, values);
        }
        self.accessor(accessor)
    }

    /// Appends the indices of triangles.
    pub fn triangles(&mut self, indices: &[u32], vertices: usize) -> usize {
        let (bytes, kind) = if vertices < usize::from(u16::MAX) {
            (bytes_of(indices, |index| (index as u16).to_le_bytes()), UNSIGNED_SHORT)
        } else {
            (bytes_of(indices, u32::to_le_bytes), UNSIGNED_INT)
        };
        let view = self.view(&bytes, Some(ELEMENT_ARRAY_BUFFER));
        self.accessor(Accessor::new(Some(view), kind, indices.len(), "SCALAR"))
    }

    /// Appends four joint numbers per vertex.
    fn joints(&mut self, joints: &[u16]) -> usize {
        let (bytes, kind) = if joints.iter().all(|&joint| joint < 256) {
            (bytes_of(joints, |joint| [joint as u8]), UNSIGNED_BYTE)
        } else {
            (bytes_of(joints, u16::to_le_bytes), UNSIGNED_SHORT)
        };
        let view = self.view(&bytes, Some(ARRAY_BUFFER));
        self.accessor(Accessor::new(Some(view), kind, joints.len() / 4, "VEC4"))
    }

    /// Appends the influences of vertices, joint and weight, as many sets of four as they need.
    pub fn add_influences(&mut self, vertices: &[&[(u16, f32)]], attributes: &mut Object) {
        let most = vertices.iter().map(|influences| influences.len()).max().unwrap_or(0);
        for set in 0..most.div_ceil(4).max(1) {
            let (mut joints, mut weights) =
                (Vec::with_capacity(4 * vertices.len()), Vec::with_capacity(4 * vertices.len()));
            for influences in vertices {
                for place in 4 * set..4 * set + 4 {
                    let (joint, weight) = influences.get(place).copied().unwrap_or_default();
                    joints.push(joint);
                    weights.push(weight);
                }
            }
            attributes.set(&format!("JOINTS_{set}"), self.joints(&joints));
            attributes.set(&format!("WEIGHTS_{set}"), self.floats(&weights, "VEC4", Some(ARRAY_BUFFER), false));
        }
    }

    /// Returns about how many bytes the file has so far. Meshes and clips are as long as their accessors are many.
    pub fn len(&self) -> usize {
        self.bytes.len() + JSON_BYTES * (self.views.len() + self.accessors.len())
    }

    /// Returns whether nothing with a size was appended.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the file's bytes.
    pub fn write(mut self) -> Result<Vec<u8>, String> {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut json = Vec::new();
        let mut serializer = Serializer::with_formatter(&mut json, Floats);
        self.serialize_into(&mut serializer).map_err(|problem| problem.to_string())?;
        json.resize(json.len().next_multiple_of(4), b' ');
        let total = 12 + 8 + json.len() + if self.bytes.is_empty() { 0 } else { 8 + self.bytes.len() };
        check_size(total)?;
        let mut glb = Vec::with_capacity(total);
        glb.extend_from_slice(b"glTF");
        for word in [2, total as u32, json.len() as u32] {
            glb.extend_from_slice(&word.to_le_bytes());
        }
        glb.extend_from_slice(b"JSON");
        glb.append(&mut json);
        if !self.bytes.is_empty() {
            glb.extend_from_slice(&(self.bytes.len() as u32).to_le_bytes());
            glb.extend_from_slice(b"BIN\0");
            glb.append(&mut self.bytes);
        }
        Ok(glb)
    }

    /// Writes the JSON.
    fn serialize_into<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let generator = format!("Gaitway, from {}", self.source);
        let mut document = serializer.serialize_map(None)?;
        document.serialize_entry(
            "asset",
            &Value::from(Object::new().with("version", "2.0").with("generator", generator)),
        )?;
        if !self.extensions.is_empty() {
            document.serialize_entry("extensionsUsed", &self.extensions)?;
        }
        if !self.lights.is_empty() {
            let lights = Object::new().with("lights", self.lights.clone());
            document.serialize_entry("extensions", &Value::from(Object::new().with("KHR_lights_punctual", lights)))?;
        }
        let mut scene = Object::new();
        if !self.scene_roots.is_empty() {
            scene.set("nodes", &*self.scene_roots);
        }
        document.serialize_entry("scene", &0)?;
        document.serialize_entry("scenes", &[Value::from(scene)])?;
        for (key, list) in [
            ("nodes", &self.nodes),
            ("meshes", &self.meshes),
            ("skins", &self.skins),
            ("materials", &self.materials),
            ("textures", &self.textures),
            ("samplers", &self.samplers),
            ("images", &self.images),
            ("cameras", &self.cameras),
        ] {
            serialize_list(&mut document, key, list)?;
        }
        serialize_list(&mut document, "animations", &self.animations)?;
        serialize_list(&mut document, "accessors", &self.accessors)?;
        serialize_list(&mut document, "bufferViews", &self.views)?;
        if !self.bytes.is_empty() {
            document.serialize_entry("buffers", &[Value::from(Object::new().with("byteLength", self.bytes.len()))])?;
        }
        document.end()
    }
}

/// Writes a list as a member of the document. glTF has no empty ones.
fn serialize_list<M: SerializeMap>(document: &mut M, key: &str, list: &[impl Serialize]) -> Result<(), M::Error> {
    if list.is_empty() { Ok(()) } else { document.serialize_entry(key, list) }
}

/// Rejects a file larger than a GLB may become.
pub fn check_size(bytes: usize) -> Result<(), String> {
    if bytes <= MAX_BYTES {
        return Ok(());
    }
    Err(format!(
        "the converted model is too large: expected at most {MAX_BYTES} bytes, found {bytes}. Export fewer meshes, \
         morph targets or animations."
    ))
}

/// A loop, since the standard library's adapters take several times the code.
fn bytes_of<T: Copy, const SIZE: usize>(values: &[T], bytes: impl Fn(T) -> [u8; SIZE]) -> Vec<u8> {
    let mut all = Vec::with_capacity(SIZE * values.len());
    for &value in values {
        all.extend_from_slice(&bytes(value));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(value: &Value) -> String {
        let mut text = Vec::new();
        value.serialize(&mut Serializer::with_formatter(&mut text, Floats)).unwrap();
        String::from_utf8(text).unwrap()
    }

    #[test]
    fn numbers_read_back_as_the_same_float() {
        let cases =
            [0.1_f32, 1.0, -2.5, 1e-38, 1e-45, 3.4e38, 1234567.0, 16777216.0, 0.001, 9.999_999, -1e10, 123_456.79];
        let more = (0..2000_u32).map(|seed| f32::from_bits(seed.wrapping_mul(2_654_435_761)));
        for value in cases.into_iter().chain(more.filter(|value| value.is_finite())) {
            let text = text(&number(f64::from(value)));
            let read: f32 = text.parse().unwrap();
            assert_eq!(read, value, "{text}");
            assert_eq!(text.parse::<f64>().unwrap() as f32, value, "{text} through 64 bits");
        }
    }

    #[test]
    fn numbers_are_short() {
        let numbers = [
            (0.1, "0.1"),
            (1.0, "1"),
            (-250.0, "-250"),
            (0.00025, "0.00025"),
            (f64::NAN, "0"),
            (1e300, "0"),
            (-0.0, "0"),
            (-1e-300, "0"),
        ];
        for (value, expected) in numbers {
            assert_eq!(text(&number(value)), expected);
        }
    }
}
