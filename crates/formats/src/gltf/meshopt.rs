//! `EXT_meshopt_compression` and `KHR_meshopt_compression`: decodes compressed buffer views before the file is loaded. A view
//! already says where its decoded bytes belong, in a buffer without data ("fallback"): that buffer becomes a file of the set.

use std::ops::Range;

use gaitway_character::asset::Warnings;
use gaitway_meshopt::{Filter, Mode, View};
use gltf::json::Buffer;
use serde_json::{Map, Value};

use super::accessor::Bytes;
use super::container::Container;
use super::document::{Document, size};
use super::object::Object;
use super::resolve_buffer;
use crate::error::Problem;
use crate::file_set::beside;
use crate::limits::Budget;
use crate::{FileSet, LoadError};

pub const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Where decoded views belong, in the order of the input.
#[derive(Debug, Default)]
pub struct Decoding(Vec<Place>);

#[derive(Debug)]
struct Place {
    view: usize,
    buffer: usize,
    range: Range<usize>,
}

/// Returns the decoder's input for a file with compressed views.
pub fn read(
    files: &FileSet,
    file: &str,
    container: &Container,
    document: &Document,
) -> Result<Option<(Decoding, Vec<u8>)>, Problem> {
    let (mut decoding, mut input) = (Decoding::default(), Vec::new());
    let root = &document.root;
    // The buffer read last; nearly every file has all compressed views in one.
    let mut source: (usize, Option<Bytes>) = (usize::MAX, None);
    for (index, view) in root.buffer_views.iter().enumerate() {
        let Some((name, extension)) = view.extensions.as_ref().and_then(|all| find(&all.others)) else { continue };
        let place = format!("bufferViews[{index}].extensions.{name}");
        let compressed = Compressed { place: &place, extension };
        let buffer = compressed.number("buffer", None)?;
        if buffer >= root.buffers.len() {
            return Err(Problem::new(&place, "a buffer of the file", buffer));
        }
        if source.0 != buffer {
            source = (buffer, resolve_buffer(files, file, container, root, buffer, &mut Warnings::default())?);
        }
        let view = compressed.view(source.1.as_ref().map_or(&[], Bytes::as_slice))?;
        view.write(&mut input);
        decoding.add(document, index, usize::from(view.stride) * view.count as usize)?;
    }
    Ok((!decoding.0.is_empty()).then_some((decoding, input)))
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

/// The extension's object in a buffer view.
struct Compressed<'a> {
    place: &'a str,
    extension: &'a Value,
}

impl Compressed<'_> {
    fn number(&self, key: &str, default: Option<usize>) -> Result<usize, Problem> {
        let value = &self.extension[key];
        let number = value.as_u64().and_then(|number| usize::try_from(number).ok());
        let number = if value.is_null() { default } else { number };
        number.ok_or_else(|| Problem::new(format!("{}.{key}", self.place), "a whole number", value))
    }

    fn view<'a>(&self, source: &'a [u8]) -> Result<View<'a>, Problem> {
        let expected = |expected: &str, found: &str| Problem::new(self.place, expected, found);
        let start = self.number("byteOffset", Some(0))?;
        let end = start.saturating_add(self.number("byteLength", None)?);
        let range = source.get(start..end);
        let source = range.ok_or_else(|| {
            expected("a range inside its buffer", &format!("bytes {start}..{end} of {}", source.len()))
        })?;
        let mode = self.extension["mode"].as_str().unwrap_or_default();
        let filter = self.extension["filter"].as_str().unwrap_or("NONE");
        let [count, stride] = [self.number("count", None)?, self.number("byteStride", None)?];
        Ok(View {
            mode: Mode::from_name(mode).ok_or_else(|| expected("a known mode, such as ATTRIBUTES", mode))?,
            filter: Filter::from_name(filter).ok_or_else(|| expected("a known filter, such as OCTAHEDRAL", filter))?,
            count: u32::try_from(count).unwrap_or(u32::MAX),
            stride: u16::try_from(stride).unwrap_or(u16::MAX),
            source,
        })
    }
}

impl Decoding {
    /// Records where `length` decoded bytes of a view belong.
    fn add(&mut self, document: &Document, index: usize, length: usize) -> Result<(), Problem> {
        let Document { root, .. } = document;
        let place = || format!("bufferViews[{index}]");
        let view = &root.buffer_views[index];
        let buffer = view.buffer.value();
        let bytes = root.buffers.get(buffer).map(|buffer| size(buffer.byte_length));
        let bytes = bytes.ok_or_else(|| Problem::new(place(), "a buffer of the file", buffer))?;
        let (start, expected) = (view.byte_offset.map_or(0, size), size(view.byte_length));
        if length > expected || start.saturating_add(length) > bytes {
            let expected = format!("at most {expected} decoded bytes, inside a buffer of {bytes}");
            return Err(Problem::new(place(), expected, format!("{length} at {start}")));
        }
        let all = root.buffers.iter().fold(0_usize, |sum, buffer| sum.saturating_add(size(buffer.byte_length)));
        Budget::default().allocate(all, 1, &"buffers")?;
        self.0.push(Place { view: index, buffer, range: start..start + length });
        Ok(())
    }

    /// Adds the decoded data to the set and to the file's `json`. `decoded` has the views one after the other.
    pub fn finish(
        self,
        files: &mut FileSet,
        file: &str,
        container: &Container,
        json: &mut Object,
        mut decoded: &[u8],
    ) -> Result<(), LoadError> {
        let root = Document::read(file, container)?.root;
        let mut buffers: Vec<Object> = json.read("buffers").unwrap_or_default();
        let mut views: Vec<Object> = json.read("bufferViews").unwrap_or_default();
        let mut contents: Vec<Vec<u8>> = vec![Vec::new(); root.buffers.len()];
        for Place { view, buffer, range } in self.0 {
            let data = &mut contents[buffer];
            if data.is_empty() {
                // Views without compression may share the buffer.
                let own = resolve_buffer(files, file, container, &root, buffer, &mut Warnings::default());
                data.extend(own.ok().flatten().as_ref().map_or(&[][..], Bytes::as_slice));
                data.resize(size(root.buffers[buffer].byte_length), 0);
            }
            if let Some(piece) = decoded.split_off(..range.len()) {
                data[range].copy_from_slice(piece);
            }
            if let Some(view) = views.get_mut(view) {
                view.remove_extensions(&NAMES);
            }
        }
        buffers.iter_mut().for_each(|buffer| buffer.remove_extensions(&NAMES));
        for (index, data) in contents.into_iter().enumerate().filter(|(_, data)| !data.is_empty()) {
            let (name, uri) = beside(file, &format!("buffer{index}"));
            if let Some(buffer) = buffers.get_mut(index) {
                buffer.set("uri", &uri);
            }
            files.insert(name, data);
        }
        json.set("bufferViews", &views);
        json.set("buffers", &buffers);
        Ok(())
    }
}
