//! What the converters of other formats share: a glTF document under construction, written as GLB, and the rules by which values
//! become glTF's.
//!
//! No serializer: a converter has to stay small as a wasm module, and its JSON is a few dozen fixed shapes, assembled member by
//! member.

#![warn(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![forbid(unsafe_code)]

mod animation;
mod sort;
mod values;
mod warnings;

use std::fmt::Write;

pub use animation::Animation;
pub use sort::sort;
pub use values::{MAX_INFLUENCES, base_name, linear, percent_encoded, roughness_of_exponent, strongest};
pub use warnings::Warnings;

/// Largest GLB that is written. Its header counts bytes with 32 bits.
const MAX_BYTES: usize = 1 << 29;

const FLOAT: u32 = 5126;
const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
/// Buffer view target for vertex attributes.
pub const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// A JSON array of the document, such as `nodes`.
#[derive(Default)]
pub struct List {
    text: String,
    count: usize,
}

impl List {
    /// Appends an element and returns its index.
    pub fn push(&mut self, json: &str) -> usize {
        if self.count > 0 {
            self.text.push(',');
        }
        self.text.push_str(json);
        self.count += 1;
        self.count - 1
    }

    /// Returns whether nothing was appended.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Returns the JSON array.
    pub fn json(&self) -> String {
        format!("[{}]", self.text)
    }
}

/// A JSON object, member by member.
pub struct Object(String);

impl Default for Object {
    fn default() -> Self {
        Self("{".to_owned())
    }
}

impl Object {
    /// Creates an object without members.
    pub fn new() -> Object {
        Object::default()
    }

    /// Adds a member whose value is JSON already.
    pub fn raw(&mut self, key: &str, json: &str) -> &mut Object {
        if self.0.len() > 1 {
            self.0.push(',');
        }
        self.0.push('"');
        self.0.push_str(key);
        self.0.push_str("\":");
        self.0.push_str(json);
        self
    }

    /// Adds a string.
    pub fn string(&mut self, key: &str, value: &str) -> &mut Object {
        self.raw(key, &quoted(value))
    }

    /// Adds an index or a count.
    pub fn index(&mut self, key: &str, value: usize) -> &mut Object {
        self.raw(key, &value.to_string())
    }

    /// Adds a number.
    pub fn number(&mut self, key: &str, value: f64) -> &mut Object {
        self.raw(key, &number(value))
    }

    /// Adds an array of numbers.
    pub fn numbers(&mut self, key: &str, values: &[f64]) -> &mut Object {
        self.raw(key, &numbers(values))
    }

    /// Returns whether nothing was added.
    pub fn is_empty(&self) -> bool {
        self.0.len() == 1
    }

    /// Returns the JSON object.
    pub fn end(&self) -> String {
        format!("{}}}", self.0)
    }
}

/// Returns a JSON string.
pub fn quoted(text: &str) -> String {
    let mut json = String::with_capacity(text.len() + 2);
    json.push('"');
    for character in text.chars() {
        match character {
            '"' | '\\' => {
                json.push('\\');
                json.push(character);
            }
            '\u{0}'..='\u{1f}' => {
                let _ = write!(json, "\\u{:04x}", u32::from(character));
            }
            _ => json.push(character),
        }
    }
    json.push('"');
    json
}

/// Returns a JSON array of numbers.
pub fn numbers(values: &[f64]) -> String {
    let mut list = List::default();
    for &value in values {
        list.push(&number(value));
    }
    list.json()
}

/// Returns a JSON array of indices.
pub fn indices(values: &[usize]) -> String {
    let mut list = List::default();
    for value in values {
        list.push(&value.to_string());
    }
    list.json()
}

/// Returns a JSON number with the fewest digits that give back the value as 32-bit float; 0 for what isn't finite.
///
/// The standard library's conversion would be a tenth of our own part of the wasm module.
fn number(value: f64) -> String {
    let value = value as f32;
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let sign = if value < 0.0 { "-" } else { "" };
    let value = value.abs();
    let mut digits = 0;
    let mut exponent = 0;
    for count in 6..=9 {
        (digits, exponent) = decimal(value, count);
        if (digits as f64 * power_of_ten(exponent)) as f32 == value {
            break;
        }
    }
    while digits % 10 == 0 {
        digits /= 10;
        exponent += 1;
    }
    let text = digits.to_string();
    let point = text.len() as i32 + exponent;
    let mut json = String::from(sign);
    if !(-4..=15).contains(&point) {
        let _ = write!(json, "{text}e{exponent}");
        return json;
    }
    if point <= 0 {
        json.push_str("0.");
        (point..0).for_each(|_| json.push('0'));
    }
    for (place, digit) in text.chars().enumerate() {
        if place > 0 && place as i32 == point {
            json.push('.');
        }
        json.push(digit);
    }
    (0..exponent).for_each(|_| json.push('0'));
    json
}

/// Rounds to `count` significant digits: value ≈ digits · 10^exponent.
fn decimal(value: f32, count: u32) -> (u64, i32) {
    let end = 10_u64.pow(count) as f64;
    let mut scaled = f64::from(value);
    let mut exponent = 0;
    while scaled >= end {
        scaled /= 10.0;
        exponent += 1;
    }
    while scaled < end / 10.0 {
        scaled *= 10.0;
        exponent -= 1;
    }
    ((scaled + 0.5) as u64, exponent)
}

fn power_of_ten(exponent: i32) -> f64 {
    let mut power = 1.0;
    for _ in 0..exponent.abs() {
        power *= 10.0;
    }
    if exponent < 0 { 1.0 / power } else { power }
}

/// Returns a mesh's JSON object, to which the caller can add morph targets. Omits an empty name.
pub fn mesh(name: &str, primitives: &List) -> Object {
    let mut mesh = Object::new();
    if !name.is_empty() {
        mesh.string("name", name);
    }
    mesh.raw("primitives", &primitives.json());
    mesh
}

/// The document.
#[derive(Default)]
pub struct Glb {
    /// The format that it is converted from.
    source: &'static str,
    bytes: Vec<u8>,
    views: List,
    accessors: List,
    /// `nodes`
    pub nodes: List,
    /// Nodes of the only scene.
    pub scene_roots: Vec<usize>,
    /// `meshes`
    pub meshes: List,
    /// `skins`
    pub skins: List,
    /// `materials`
    pub materials: List,
    /// `textures`
    pub textures: List,
    /// `samplers` of textures
    pub samplers: List,
    /// `images`
    pub images: List,
    /// `cameras`
    pub cameras: List,
    /// Lights of `KHR_lights_punctual`.
    pub lights: List,
    /// `animations`
    pub animations: List,
    extensions: Vec<&'static str>,
}

impl Glb {
    /// Creates an empty document. `source` is the format that it is converted from, for `asset.generator`.
    pub fn new(source: &'static str) -> Glb {
        Glb { source, ..Glb::default() }
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
        let mut view = Object::new();
        view.index("buffer", 0);
        view.index("byteOffset", self.bytes.len());
        view.index("byteLength", bytes.len());
        if let Some(target) = target {
            view.index("target", target as usize);
        }
        self.bytes.extend_from_slice(bytes);
        self.views.push(&view.end())
    }

    /// Appends an accessor of floats with as many components as `kind` has. `bounds` adds `min` and `max`.
    pub fn floats(&mut self, values: &[f32], kind: &str, target: Option<u32>, bounds: bool) -> usize {
        let width = components(kind);
        let view = self.view(&bytes_of(values, f32::to_le_bytes), target);
        let mut accessor = accessor(view, FLOAT, values.len() / width, kind);
        if bounds {
            add_bounds(&mut accessor, values, width);
        }
        self.accessors.push(&accessor.end())
    }

    /// Appends an accessor that is zero but for the given elements, which are in ascending order.
    pub fn sparse(&mut self, count: usize, elements: &[u32], values: &[f32]) -> usize {
        let mut accessor = Object::new();
        accessor.index("componentType", FLOAT as usize).index("count", count).string("type", "VEC3");
        let mut reached = values.to_vec();
        if elements.len() < count {
            reached.extend([0.0; 3]);
        }
        add_bounds(&mut accessor, &reached, 3);
        if !elements.is_empty() {
            let places = self.view(&bytes_of(elements, u32::to_le_bytes), None);
            let values = self.view(&bytes_of(values, f32::to_le_bytes), None);
            accessor.raw(
                "sparse",
                &format!(
                    "{{\"count\":{},\"indices\":{{\"bufferView\":{places},\"componentType\":{UNSIGNED_INT}}},\
                     \"values\":{{\"bufferView\":{values}}}}}",
                    elements.len()
                ),
            );
        }
        self.accessors.push(&accessor.end())
    }

    /// Appends the indices of triangles.
    pub fn triangles(&mut self, indices: &[u32], vertices: usize) -> usize {
        let (bytes, kind) = if vertices < usize::from(u16::MAX) {
            (bytes_of(indices, |index| (index as u16).to_le_bytes()), UNSIGNED_SHORT)
        } else {
            (bytes_of(indices, u32::to_le_bytes), UNSIGNED_INT)
        };
        let view = self.view(&bytes, Some(ELEMENT_ARRAY_BUFFER));
        self.accessors.push(&accessor(view, kind, indices.len(), "SCALAR").end())
    }

    /// Appends four joint numbers per vertex.
    fn joints(&mut self, joints: &[u16]) -> usize {
        let (bytes, kind) = if joints.iter().all(|&joint| joint < 256) {
            (bytes_of(joints, |joint| [joint as u8]), UNSIGNED_BYTE)
        } else {
            (bytes_of(joints, u16::to_le_bytes), UNSIGNED_SHORT)
        };
        let view = self.view(&bytes, Some(ARRAY_BUFFER));
        self.accessors.push(&accessor(view, kind, joints.len() / 4, "VEC4").end())
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
            attributes.index(&format!("JOINTS_{set}"), self.joints(&joints));
            attributes.index(&format!("WEIGHTS_{set}"), self.floats(&weights, "VEC4", Some(ARRAY_BUFFER), false));
        }
    }

    /// Returns about how many bytes the file has so far.
    pub fn len(&self) -> usize {
        let lists = [&self.views, &self.accessors, &self.meshes, &self.animations];
        self.bytes.len() + lists.iter().map(|list| list.text.len()).sum::<usize>()
    }

    /// Returns whether nothing with a size was appended.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the file's bytes.
    pub fn write(mut self) -> Result<Vec<u8>, String> {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut json = self.json().into_bytes();
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

    fn json(&self) -> String {
        let mut document = Object::new();
        document.raw("asset", &format!("{{\"version\":\"2.0\",\"generator\":\"Gaitway, from {}\"}}", self.source));
        if !self.extensions.is_empty() {
            let mut names = List::default();
            for name in &self.extensions {
                names.push(&quoted(name));
            }
            document.raw("extensionsUsed", &names.json());
        }
        if !self.lights.is_empty() {
            document.raw("extensions", &format!("{{\"KHR_lights_punctual\":{{\"lights\":{}}}}}", self.lights.json()));
        }
        let mut scene = Object::new();
        if !self.scene_roots.is_empty() {
            scene.raw("nodes", &indices(&self.scene_roots));
        }
        document.index("scene", 0).raw("scenes", &format!("[{}]", scene.end()));
        for (key, list) in [
            ("nodes", &self.nodes),
            ("meshes", &self.meshes),
            ("skins", &self.skins),
            ("materials", &self.materials),
            ("textures", &self.textures),
            ("samplers", &self.samplers),
            ("images", &self.images),
            ("cameras", &self.cameras),
            ("animations", &self.animations),
            ("accessors", &self.accessors),
            ("bufferViews", &self.views),
        ] {
            if !list.is_empty() {
                document.raw(key, &list.json());
            }
        }
        if !self.bytes.is_empty() {
            document.raw("buffers", &format!("[{{\"byteLength\":{}}}]", self.bytes.len()));
        }
        document.end()
    }
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

fn components(kind: &str) -> usize {
    match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        _ => 16,
    }
}

fn accessor(view: usize, component: u32, count: usize, kind: &str) -> Object {
    let mut accessor = Object::new();
    accessor.index("bufferView", view).index("componentType", component as usize);
    accessor.index("count", count).string("type", kind);
    accessor
}

fn add_bounds(accessor: &mut Object, values: &[f32], width: usize) {
    let mut low = vec![f64::INFINITY; width];
    let mut high = vec![f64::NEG_INFINITY; width];
    for element in values.chunks_exact(width) {
        for (axis, &value) in element.iter().enumerate() {
            low[axis] = low[axis].min(f64::from(value));
            high[axis] = high[axis].max(f64::from(value));
        }
    }
    accessor.numbers("min", &low).numbers("max", &high);
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

    #[test]
    fn numbers_read_back_as_the_same_float() {
        let cases =
            [0.1_f32, 1.0, -2.5, 1e-38, 1e-45, 3.4e38, 1234567.0, 16777216.0, 0.001, 9.999_999, -1e10, 123_456.79];
        let more = (0..2000_u32).map(|seed| f32::from_bits(seed.wrapping_mul(2_654_435_761)));
        for value in cases.into_iter().chain(more.filter(|value| value.is_finite())) {
            let text = number(f64::from(value));
            let read: f32 = text.parse().unwrap();
            assert_eq!(read, value, "{text}");
            assert_eq!(text.parse::<f64>().unwrap() as f32, value, "{text} through 64 bits");
        }
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in [(0.1, "0.1"), (1.0, "1"), (-250.0, "-250"), (0.00025, "0.00025"), (f64::NAN, "0")] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn strings_are_escaped() {
        assert_eq!(quoted("a\"\\\n\u{e9}"), "\"a\\\"\\\\\\u000a\u{e9}\"");
    }
}
