//! `KHR_draco_mesh_compression`: decodes compressed meshes before the file is loaded. The decoded data becomes a buffer of its
//! own, a file of the set, and the accessors, which have no data without the extension, are pointed at it.

use gaitway_character::asset::Warnings;
use gaitway_draco::{Attribute, Decoded, Mesh};
use gltf::json::mesh::Primitive;
use gltf::json::validation::Checked;
use gltf::json::{Index, Root};
use serde_json::Value;

use super::accessor::Accessors;
use super::container::Container;
use super::document::Document;
use super::object::{Array, Object, raw};
use super::resolve_buffers;
use crate::error::Problem;
use crate::file_set::beside;
use crate::limits::Limit;
use crate::{FileSet, LoadError};

pub const NAME: &str = "KHR_draco_mesh_compression";
pub const NAMES: [&str; 1] = [NAME];

/// glTF's codes of the index types.
const U16: usize = 5123;
const U32: usize = 5125;

/// Where decoded meshes belong.
#[derive(Debug, Default)]
pub struct Decoding {
    /// Compressed buffer view and attributes of each, in the order of the input.
    meshes: Vec<(usize, Vec<Attribute>)>,
    /// Sorted by mesh.
    primitives: Vec<Target>,
}

/// A primitive that gets decoded data.
#[derive(Debug)]
struct Target {
    mesh: usize,
    primitive: usize,
    /// Index into [`Decoding::meshes`].
    decoded: usize,
    /// Semantics of the decoded attributes, in their order.
    semantics: Vec<String>,
}

fn extension(primitive: &Primitive) -> Option<&Value> {
    primitive.extensions.as_ref()?.others.get(NAME)
}

/// Whether a primitive has only compressed data. Where the extension is optional, the accessors usually have the
/// original.
pub fn is_needed(root: &Root, primitive: &Primitive) -> bool {
    let is_required = || root.extensions_required.iter().any(|name| name == NAME);
    let is_empty = |accessor: &Index<_>| root.accessors.get(accessor.value()).is_some_and(|a| a.buffer_view.is_none());
    let has_empty = || primitive.attributes.values().chain(&primitive.indices).any(is_empty);
    extension(primitive).is_some() && (is_required() || has_empty())
}

/// Returns the decoder's input for a file with compressed meshes.
pub fn read(
    files: &FileSet,
    file: &str,
    container: &Container,
    document: &Document,
) -> Result<Option<(Decoding, Vec<u8>)>, Problem> {
    let root = &document.root;
    if !root.meshes.iter().flat_map(|mesh| &mesh.primitives).any(|primitive| is_needed(root, primitive)) {
        return Ok(None);
    }
    let buffers = resolve_buffers(files, file, container, root, &mut Warnings::default())?;
    let accessors = Accessors::new(document, buffers);
    let (mut decoding, mut meshes) = (Decoding::default(), Vec::new());
    // The meshes of each view, of which there is nearly always one.
    let mut of_view: Vec<Vec<usize>> = vec![Vec::new(); root.buffer_views.len()];
    for (mesh, of_mesh) in root.meshes.iter().enumerate() {
        for (at, primitive) in of_mesh.primitives.iter().enumerate() {
            let Some(value) = extension(primitive) else { continue };
            let place = format!("meshes[{mesh}].primitives[{at}].extensions.{NAME}");
            let (view, semantics, attributes) = compressed(value, &accessors, primitive, &place)?;
            let (source, _) = accessors.view(view, &place)?;
            let max_count = max_count(&accessors, primitive, &place)?;
            let own = (view, attributes);
            let same_view = &mut of_view[view];
            let known = same_view.iter().copied().find(|&known| decoding.meshes[known] == own);
            let decoded = known.unwrap_or_else(|| {
                meshes.push(Mesh { source, max_count, attributes: own.1.clone() });
                decoding.meshes.push(own);
                same_view.push(meshes.len() - 1);
                meshes.len() - 1
            });
            decoding.primitives.push(Target { mesh, primitive: at, decoded, semantics });
        }
    }
    Ok(Some((decoding, gaitway_draco::write(Limit::DataBytes.max() as u32, &meshes))))
}

/// The decoder may return fewer vertices than the accessors declare, or more (it splits them along seams), but no more
/// than there are corners.
fn max_count(accessors: &Accessors, primitive: &Primitive, place: &str) -> Result<u32, Problem> {
    primitive.attributes.values().chain(&primitive.indices).try_fold(0, |max, index| {
        let count = accessors.count(index.value(), &place)?;
        Ok(max.max(u32::try_from(count).unwrap_or(u32::MAX)))
    })
}

/// Returns the compressed buffer view, the semantics of its attributes, and what their accessors declare.
fn compressed(
    extension: &Value,
    accessors: &Accessors,
    primitive: &Primitive,
    place: &str,
) -> Result<(usize, Vec<String>, Vec<Attribute>), Problem> {
    let (mut semantics, mut attributes) = (Vec::new(), Vec::new());
    for (semantic, accessor) in &primitive.attributes {
        let Checked::Valid(semantic) = semantic else { continue };
        let semantic = semantic.to_string();
        let id = extension["attributes"][&semantic].as_u64().and_then(|id| u32::try_from(id).ok());
        let Some(id) = id else { continue };
        let (components, component) = accessors.kind(accessor.value(), &place)?;
        attributes.push(Attribute { id, component_type: component.as_gl_enum(), components: components as u32 });
        semantics.push(semantic);
    }
    match extension["bufferView"].as_u64().map(usize::try_from) {
        Some(Ok(view)) if !attributes.is_empty() => Ok((view, semantics, attributes)),
        _ => Err(Problem::new(place, "a bufferView and attributes of the primitive", extension)),
    }
}

impl Decoding {
    /// Adds the decoded data to the set and to the file's `json`.
    pub fn finish(self, files: &mut FileSet, file: &str, json: &mut Object, decoded: &[u8]) -> Result<(), LoadError> {
        let unknown = || {
            let problem = "the Draco decoder returned invalid data".to_owned();
            LoadError::Conversion { file: file.to_owned(), problem }
        };
        let attributes = self.meshes.iter().map(|(_, attributes)| attributes.as_slice());
        let (facts, data) = Decoded::read_all(decoded, attributes).ok_or_else(unknown)?;

        let mut added = Added::new(json);
        let first_views: Vec<usize> =
            facts.iter().zip(&self.meshes).map(|(facts, (_, attributes))| added.mesh(facts, attributes)).collect();
        self.point(json, &facts, &first_views);
        json.extend("bufferViews", added.views);
        let (name, uri) = beside(file, "draco");
        let mut buffer = Object::default();
        buffer.set("uri", &uri);
        buffer.set("byteLength", &data.len());
        json.extend("buffers", vec![raw(&buffer)]);
        files.insert(name, data);
        Ok(())
    }

    /// Points the accessors of the primitives at the decoded data: for each mesh one view of the indices, then one per attribute.
    fn point(&self, json: &mut Object, facts: &[Decoded], first_views: &[usize]) {
        let list: Vec<Object> = json.read("accessors").unwrap_or_default();
        let mut accessors = Rewritten { views: vec![None; list.len()], list };
        let mut meshes: Vec<Object> = json.read("meshes").unwrap_or_default();
        for targets in self.primitives.chunk_by(|one, other| one.mesh == other.mesh) {
            let Some(mesh) = meshes.get_mut(targets[0].mesh) else { continue };
            let mut primitives: Vec<Object> = mesh.read("primitives").unwrap_or_default();
            for target in targets {
                let (facts, first_view) = (&facts[target.decoded], first_views[target.decoded]);
                if let Some(primitive) = primitives.get_mut(target.primitive) {
                    accessors.point(primitive, target, facts, first_view);
                }
            }
            mesh.set("primitives", &primitives);
        }
        json.set("accessors", &accessors.list);
        json.set("meshes", &meshes);
    }
}

/// The buffer views of decoded data.
struct Added {
    buffer: usize,
    first: usize,
    views: Array,
    end: usize,
}

impl Added {
    fn new(json: &Object) -> Self {
        Self { buffer: json.count("buffers"), first: json.count("bufferViews"), views: Vec::new(), end: 0 }
    }

    /// Adds the views of one mesh and returns the number of the first.
    fn mesh(&mut self, facts: &Decoded, attributes: &[Attribute]) -> usize {
        let (first, start) = (self.first + self.views.len(), self.end);
        for (at, range) in facts.ranges(attributes).into_iter().enumerate() {
            self.end = start + range.end;
            let mut view = Object::default();
            view.set("buffer", &self.buffer);
            view.set("byteOffset", &(start + range.start));
            view.set("byteLength", &range.len());
            // The indices, which come first, have none.
            if let Some(attribute) = at.checked_sub(1).and_then(|at| attributes.get(at)) {
                view.set("byteStride", &attribute.stride());
            }
            self.views.push(raw(&view));
        }
        first
    }
}

/// The accessors of a file.
struct Rewritten {
    list: Vec<Object>,
    /// The decoded buffer view that each was pointed at.
    views: Vec<Option<usize>>,
}

impl Rewritten {
    /// Points the accessors of a primitive at decoded data.
    fn point(&mut self, primitive: &mut Object, target: &Target, facts: &Decoded, first_view: usize) {
        let indices = self.at(primitive.read("indices"), first_view, facts.indices as usize);
        primitive.set("indices", &indices);
        let indices = &mut self.list[indices];
        indices.set("componentType", &(if facts.index_bytes() == 2 { U16 } else { U32 }));
        indices.set("type", &"SCALAR");
        indices.remove("min");
        indices.remove("max");

        let mut attributes: Object = primitive.read("attributes").unwrap_or_default();
        for ((semantic, view), bounds) in target.semantics.iter().zip(first_view + 1..).zip(&facts.bounds) {
            let index = self.at(attributes.read(semantic), view, facts.vertices as usize);
            attributes.set(semantic, &index);
            // The file's bounds describe the data before it was compressed.
            for (key, bound) in ["min", "max"].into_iter().zip(bounds) {
                if self.list[index].read::<Array>(key).is_some() {
                    self.list[index].set(key, &bound.iter().copied().map(number).collect::<Value>());
                }
            }
        }
        primitive.set("attributes", &attributes);
        // A strip is decoded into a list, which is the default.
        primitive.remove("mode");
        primitive.remove_extensions(&NAMES);
    }

    /// Points an accessor, or a new one, at a view. An accessor that already has another view is copied. Returns the
    /// index.
    fn at(&mut self, index: Option<usize>, view: usize, count: usize) -> usize {
        let existing = index.filter(|&index| index < self.list.len());
        let own = existing.filter(|&index| *self.views[index].get_or_insert(view) == view);
        let index = own.unwrap_or_else(|| {
            let copy = existing.map(|index| self.list[index].clone()).unwrap_or_default();
            self.list.push(copy);
            self.views.push(Some(view));
            self.list.len() - 1
        });
        let accessor = &mut self.list[index];
        accessor.remove("byteOffset");
        accessor.remove("sparse");
        accessor.set("bufferView", &view);
        accessor.set("count", &count);
        index
    }
}

/// Writes a whole number as an integer: the bounds of integer accessors must not have a fraction, not even `.0`.
fn number(bound: f32) -> Value {
    let integer = bound as i64;
    // As f64: readers that go through f64 may parse the shortest form of an f32 as its neighbour.
    if integer as f32 == bound { integer.into() } else { f64::from(bound).into() }
}
