//! `EXT_meshopt_compression` and `KHR_meshopt_compression`: decodes compressed buffer views before the file is loaded. A view
//! already says where its decoded bytes belong, in a buffer without data ("fallback"): that buffer becomes a file of the set.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;

use gaitway_meshopt::{Filter, Mode, View};
use gltf::json::Buffer;
use serde::Deserialize;
use serde_json::{Map, Value};

use super::accessor::{BUDGET_BYTES, Bytes};
use super::container::{self, Container};
use super::document::{Document, as_text, size};
use super::object::Object;
use super::{WriteError, resolve_buffer, write};
use crate::asset::Warnings;
use crate::formats::error::Problem;
use crate::formats::file_set::{Conversion, beside};
use crate::formats::{FileSet, LoadError};

const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// The extension's object in a buffer view.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Compressed {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: u16,
    count: u32,
    mode: String,
    filter: Option<String>,
}

/// Where decoded views belong.
#[derive(Debug, Default)]
pub struct Decoding {
    /// Each view's number, and its buffer and range there, in the order of the input.
    views: Vec<(usize, usize, Range<usize>)>,
    /// Length of each of these buffers.
    buffers: BTreeMap<usize, usize>,
}

/// Returns the decoder's input for a file with compressed views. `None` if it has none, or if loading it will say what is wrong
/// with the file around them.
pub fn start(files: &FileSet, file: &str, bytes: &[u8]) -> Result<Option<(Decoding, Vec<u8>)>, LoadError> {
    let Ok(container) = container::open(file, bytes) else { return Ok(None) };
    let mentions = |name: &str| container.json.windows(name.len()).any(|window| window == name.as_bytes());
    if !NAMES.into_iter().any(mentions) {
        return Ok(None);
    }
    let Ok(document) = Document::read(file, &container) else { return Ok(None) };
    match read_views(files, file, &container, &document) {
        Ok((decoding, input)) => Ok((!decoding.views.is_empty()).then_some((decoding, input))),
        Err(Problem::MissingFile { .. }) => Ok(None),
        Err(problem) => Err(problem.in_file(file)),
    }
}

fn read_views(
    files: &FileSet,
    file: &str,
    container: &Container,
    document: &Document,
) -> Result<(Decoding, Vec<u8>), Problem> {
    let (mut decoding, mut input) = (Decoding::default(), Vec::new());
    let mut sources: BTreeMap<usize, Option<Bytes>> = BTreeMap::new();
    let root = &document.root;
    for (index, view) in root.buffer_views.iter().enumerate() {
        let Some((name, value)) = view.extensions.as_ref().and_then(|extensions| find(&extensions.others)) else {
            continue;
        };
        let place = format!("bufferViews[{index}].extensions.{name}");
        let compressed = Compressed::deserialize(value)
            .map_err(|problem| Problem::new(&place, "buffer, byteLength, byteStride, count and mode", problem))?;
        let number = compressed.buffer;
        if number >= root.buffers.len() {
            return Err(Problem::new(&place, "a buffer of the file", number));
        }
        if let Entry::Vacant(new) = sources.entry(number) {
            new.insert(resolve_buffer(files, file, container, root, number, &mut Warnings::default())?);
        }
        let source = sources.get(&number).and_then(Option::as_ref).map_or(&[][..], Bytes::as_slice);
        compressed.view(&place, source)?.write(&mut input);
        decoding.add(document, index, usize::from(compressed.byte_stride) * compressed.count as usize)?;
    }
    Ok((decoding, input))
}

/// Returns the extension's name and value among an object's extensions.
fn find(extensions: &Map<String, Value>) -> Option<(&'static str, &Value)> {
    NAMES.into_iter().find_map(|name| Some((name, extensions.get(name)?)))
}

/// Whether a buffer has nothing but the decoded data of compressed views, for readers that cannot decode them.
pub fn is_fallback(buffer: &Buffer) -> bool {
    let extension = buffer.extensions.as_ref().and_then(|extensions| find(&extensions.others));
    extension.is_some_and(|(_, value)| value["fallback"] == true)
}

impl Compressed {
    fn view<'a>(&self, place: &str, source: &'a [u8]) -> Result<View<'a>, Problem> {
        let end = self.byte_offset.saturating_add(self.byte_length);
        let found = format!("bytes {}..{end} of {}", self.byte_offset, source.len());
        let source = source.get(self.byte_offset..end);
        let source = source.ok_or_else(|| Problem::new(place, "a range inside its buffer", found))?;
        let mode = Mode::from_name(&self.mode)
            .ok_or_else(|| Problem::new(place, "the mode ATTRIBUTES, TRIANGLES or INDICES", &self.mode))?;
        let filter = self.filter.as_deref().unwrap_or("NONE");
        let filter = Filter::from_name(filter).ok_or_else(|| {
            Problem::new(place, "the filter NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL or COLOR", filter)
        })?;
        Ok(View { mode, filter, count: self.count, stride: self.byte_stride, source })
    }
}

impl Decoding {
    /// Notes where `length` decoded bytes of a view belong.
    fn add(&mut self, document: &Document, index: usize, length: usize) -> Result<(), Problem> {
        let place = || format!("bufferViews[{index}]");
        let view = document.root.buffer_views.get(index);
        let view = view.ok_or_else(|| Problem::new(place(), "a buffer view", "none"))?;
        let buffer = view.buffer.value();
        let bytes = document.root.buffers.get(buffer).map(|buffer| size(buffer.byte_length));
        let bytes = bytes.ok_or_else(|| Problem::new(place(), "a buffer of the file", buffer))?;
        let (start, expected) = (view.byte_offset.map_or(0, size), size(view.byte_length));
        if length > expected || start.saturating_add(length) > bytes {
            let expected = format!("at most {expected} decoded bytes, inside a buffer of {bytes}");
            return Err(Problem::new(place(), expected, format!("{length} at {start}")));
        }
        self.views.push((index, buffer, start..start + length));
        self.buffers.insert(buffer, bytes);
        if self.buffers.values().fold(0_usize, |sum, &bytes| sum.saturating_add(bytes)) > BUDGET_BYTES {
            let expected = format!("at most {} MiB of decoded data in all", BUDGET_BYTES >> 20);
            return Err(Problem::new(format!("buffers[{buffer}].byteLength"), expected, bytes));
        }
        Ok(())
    }

    /// Replaces the file by one without compression. `decoded` has the views one after the other.
    pub fn finish(self, files: &mut FileSet, file: &str, bytes: &[u8], decoded: &[u8]) -> Result<(), LoadError> {
        let container = container::open(file, bytes)?;
        let document = Document::read(file, &container)?;
        let mut json: Object = serde_json::from_str(&as_text(container.json)).unwrap_or_default();
        let mut buffers: Vec<Object> = json.read("buffers").unwrap_or_default();
        let mut contents: BTreeMap<usize, Vec<u8>> = BTreeMap::new();
        for (&buffer, &length) in &self.buffers {
            // Views without compression may share the buffer.
            let data = resolve_buffer(files, file, &container, &document.root, buffer, &mut Warnings::default());
            let mut data = data.ok().flatten().map_or_else(Vec::new, |bytes| bytes.as_slice().to_vec());
            data.resize(length, 0);
            contents.insert(buffer, data);
        }
        let mut views: Vec<Object> = json.read("bufferViews").unwrap_or_default();
        let mut rest = decoded;
        for (index, buffer, range) in self.views {
            let piece = rest.split_off(..range.len());
            if let (Some(piece), Some(data), Some(view)) = (piece, contents.get_mut(&buffer), views.get_mut(index)) {
                data[range].copy_from_slice(piece);
                without_extension(view);
            }
        }
        buffers.iter_mut().for_each(without_extension);
        for (buffer, data) in contents {
            let (name, uri) = beside(file, &format!("buffer{buffer}"));
            buffers[buffer].set("uri", &uri);
            files.insert(name, data);
        }
        json.set("bufferViews", &views);
        json.set("buffers", &buffers);
        json.remove_strings("extensionsRequired", &NAMES);
        let extensions = json.remove_strings("extensionsUsed", &NAMES);
        let json = serde_json::to_vec(&json).unwrap_or_default();
        let too_large =
            |problem: WriteError| LoadError::Conversion { file: file.to_owned(), problem: problem.to_string() };
        let plain = match container.binary {
            Some(binary) => write::glb(json, binary.to_vec()).map_err(too_large)?,
            None => json,
        };
        files.convert(file, plain, Conversion { extensions, ..Conversion::default() });
        Ok(())
    }
}

fn without_extension(object: &mut Object) {
    let Some(mut extensions) = object.read::<Object>("extensions") else { return };
    NAMES.into_iter().for_each(|name| extensions.remove(name));
    match extensions.is_empty() {
        true => object.remove("extensions"),
        false => object.set("extensions", &extensions),
    }
}
