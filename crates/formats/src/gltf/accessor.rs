//! Typed views of buffer bytes (glTF 2.0 §3.6). Every range is checked before it is read, and all decoded data counts towards
//! a [budget](Budget), so that a small file cannot make us allocate a lot of memory.

use std::fmt::Display;

use gltf::json::Accessor;
use gltf::json::accessor::{ComponentType, IndexComponentType};
use gltf::json::validation::Checked;

use gaitway_character::asset::SharedBytes;

use super::document::{Document, size};
use crate::error::Problem;
use crate::limits::Budget;

/// The buffers of one file and the views into them.
pub struct Accessors<'a> {
    pub document: &'a Document<'a>,
    /// One per buffer; `None` for a buffer without data (valid as long as nothing reads it).
    buffers: Vec<Option<Bytes<'a>>>,
    pub budget: Budget,
}

pub enum Bytes<'a> {
    Borrowed(&'a [u8]),
    Shared(SharedBytes),
    Owned(Vec<u8>),
}

impl Bytes<'_> {
    pub fn as_slice(&self) -> &[u8] {
        match self {
            Self::Borrowed(bytes) => bytes,
            Self::Shared(bytes) => bytes,
            Self::Owned(bytes) => bytes,
        }
    }
}

/// Where the elements of an accessor are.
struct Layout<'a> {
    /// `None` reads as zeros.
    bytes: Option<&'a [u8]>,
    stride: usize,
    count: usize,
    components: usize,
    component: ComponentType,
    normalized: bool,
}

/// Returns the component at the start of `bytes`, normalized as in §3.6.2.2.
#[inline]
fn to_f32(component: ComponentType, bytes: &[u8], normalized: bool) -> f32 {
    match (component, normalized) {
        (ComponentType::F32, _) => f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        (ComponentType::U8, false) => f32::from(bytes[0]),
        (ComponentType::U8, true) => f32::from(bytes[0]) / 255.0,
        (ComponentType::I8, false) => f32::from(bytes[0] as i8),
        (ComponentType::I8, true) => (f32::from(bytes[0] as i8) / 127.0).max(-1.0),
        (ComponentType::U16, false) => f32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
        (ComponentType::U16, true) => f32::from(u16::from_le_bytes([bytes[0], bytes[1]])) / 65535.0,
        (ComponentType::I16, false) => f32::from(i16::from_le_bytes([bytes[0], bytes[1]])),
        (ComponentType::I16, true) => (f32::from(i16::from_le_bytes([bytes[0], bytes[1]])) / 32767.0).max(-1.0),
        (ComponentType::U32, _) => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as f32,
    }
}

#[inline]
fn to_u32(component: ComponentType, bytes: &[u8]) -> u32 {
    match component.size() {
        1 => u32::from(bytes[0]),
        2 => u32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
        _ => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
    }
}

impl<'a> Accessors<'a> {
    pub fn new(document: &'a Document<'a>, buffers: Vec<Option<Bytes<'a>>>) -> Self {
        Self { document, buffers, budget: Budget::default() }
    }

    /// Returns the bytes of a buffer view, and its stride.
    pub fn view(&self, index: usize, place: &dyn Display) -> Result<(&[u8], Option<usize>), Problem> {
        let root = &self.document.root;
        let view = get(&root.buffer_views, index, place, "bufferViews")?;
        let here = format_args!("bufferViews[{index}]");
        let buffer = view.buffer.value();
        get(&root.buffers, buffer, &format_args!("{here}.buffer"), "buffers")?;
        let Some(Some(bytes)) = self.buffers.get(buffer) else {
            return Err(Problem::new(format!("buffers[{buffer}]"), "a URI or a binary chunk", "neither"));
        };
        let bytes = bytes.as_slice();
        let start = view.byte_offset.map_or(0, size);
        let range = start..start.saturating_add(size(view.byte_length));
        let viewed = bytes.get(range.clone()).ok_or_else(|| {
            let expected = format!("bytes {}..{} of buffer {buffer}", range.start, range.end);
            Problem::new(here.to_string(), expected, format!("only {} bytes", bytes.len()))
        })?;
        Ok((viewed, view.byte_stride.map(|stride| stride.0)))
    }

    fn accessor(&self, index: usize, place: &dyn Display) -> Result<&Accessor, Problem> {
        get(&self.document.root.accessors, index, place, "accessors")
    }

    /// Returns the number of elements of an accessor.
    pub fn count(&self, index: usize, place: &dyn Display) -> Result<usize, Problem> {
        Ok(size(self.accessor(index, place)?.count))
    }

    /// Returns the number of components of an element, and their type.
    pub fn kind(&self, index: usize, place: &dyn Display) -> Result<(usize, ComponentType), Problem> {
        let accessor = self.accessor(index, place)?;
        let unknown = |expected: &str, key: &str| {
            let here = format!("accessors[{index}]");
            let found = self.document.quoted_at(&format!("{here}.{key}"));
            Problem::new(here, expected, found)
        };
        match (accessor.type_, accessor.component_type) {
            (Checked::Valid(shape), Checked::Valid(component)) => Ok((shape.multiplicity(), component.0)),
            (Checked::Invalid, _) => Err(unknown("a known type such as VEC3", "type")),
            (_, Checked::Invalid) => Err(unknown("a known componentType", "componentType")),
        }
    }

    fn layout(&self, index: usize, place: &dyn Display, components: usize, what: &str) -> Result<Layout<'_>, Problem> {
        let accessor = self.accessor(index, place)?;
        let place_here = format_args!("accessors[{index}]");
        let here = || place_here.to_string();
        let (found, component) = self.kind(index, place)?;
        if found != components {
            let found = self.document.text_at(&format!("{place_here}.type"));
            return Err(Problem::new(format!("{place} (accessor {index})"), what, found));
        }
        let element_size = component.size() * components;
        let count = size(accessor.count);
        self.budget.allocate(count, components * 4, &place_here)?;
        let layout =
            |bytes, stride| Layout { bytes, stride, count, components, component, normalized: accessor.normalized };
        let Some(view) = accessor.buffer_view else { return Ok(layout(None, element_size)) };
        let (bytes, stride) = self.view(view.value(), &place_here)?;
        let stride = stride.unwrap_or(element_size);
        if stride < element_size && count > 1 {
            return Err(Problem::new(here(), format!("a byteStride of at least {element_size}"), stride));
        }
        let bytes = bytes.get(accessor.byte_offset.map_or(0, size)..).unwrap_or(&[]);
        check_range(bytes.len(), stride, element_size, count)
            .map_err(|needed| Problem::new(here(), format!("{needed} bytes in its buffer view"), bytes.len()))?;
        Ok(layout(Some(bytes), stride))
    }

    /// Calls `put(element, bytes)` for the elements that a sparse accessor replaces.
    fn sparse(&self, index: usize, layout: &Layout, mut put: impl FnMut(usize, &[u8])) -> Result<(), Problem> {
        let accessor = self.document.root.accessors.get(index);
        let Some(sparse) = accessor.and_then(|accessor| accessor.sparse.as_ref()) else { return Ok(()) };
        let here = format!("accessors[{index}].sparse");
        let count = size(sparse.count);
        if count > layout.count {
            return Err(Problem::new(here, format!("at most {} entries", layout.count), count));
        }
        let Checked::Valid(IndexComponentType(index_type)) = sparse.indices.component_type else {
            let found = self.document.quoted_at(&format!("{here}.indices.componentType"));
            return Err(Problem::new(here, "unsigned indices", found));
        };
        let value_size = layout.component.size() * layout.components;
        let (indices, _) = self.view(sparse.indices.buffer_view.value(), &here)?;
        let (values, _) = self.view(sparse.values.buffer_view.value(), &here)?;
        let indices = indices.get(size(sparse.indices.byte_offset)..).unwrap_or(&[]);
        let values = values.get(size(sparse.values.byte_offset)..).unwrap_or(&[]);
        for (bytes, size, what) in [(indices, index_type.size(), "indices"), (values, value_size, "values")] {
            check_range(bytes.len(), size, size, count)
                .map_err(|needed| Problem::new(format!("{here}.{what}"), format!("{needed} bytes"), bytes.len()))?;
        }
        for entry in 0..count {
            let element = to_u32(index_type, &indices[entry * index_type.size()..]) as usize;
            if element >= layout.count {
                return Err(Problem::new(here, format!("indices below {}", layout.count), element));
            }
            put(element, &values[entry * value_size..(entry + 1) * value_size]);
        }
        Ok(())
    }

    /// Decodes elements of `N` numbers. `what` describes the expected accessor in an error.
    pub fn floats<const N: usize>(
        &self,
        index: usize,
        place: &dyn Display,
        what: &str,
    ) -> Result<Vec<[f32; N]>, Problem> {
        let layout = self.layout(index, place, N, what)?;
        let (component, normalized, size) = (layout.component, layout.normalized, layout.component.size());
        let read = |bytes: &[u8]| std::array::from_fn(|at| to_f32(component, &bytes[at * size..], normalized));
        let mut out = match layout.bytes {
            None => vec![[0.0; N]; layout.count],
            // By far the most common case, fast because the type is not matched for each component.
            Some(bytes) if component == ComponentType::F32 => decoded(bytes, &layout, f32::from_le_bytes),
            Some(bytes) => elements(bytes, &layout).map(read).collect(),
        };
        self.sparse(index, &layout, |element, bytes| out[element] = read(bytes))?;
        Ok(out)
    }

    /// Like [`Self::floats`], but rejects numbers that are not finite.
    pub fn finite<const N: usize>(
        &self,
        index: usize,
        place: &dyn Display,
        what: &str,
    ) -> Result<Vec<[f32; N]>, Problem> {
        let values = self.floats::<N>(index, place, what)?;
        // Without early exit, so that the loop is vectorized.
        if values.as_flattened().iter().fold(true, |finite, number| finite & number.is_finite()) {
            return Ok(values);
        }
        match values.iter().position(|value| value.iter().any(|number| !number.is_finite())) {
            Some(at) => {
                Err(Problem::new(format!("{place}, element {at}"), "finite numbers", format!("{:?}", values[at])))
            }
            None => Ok(values),
        }
    }

    /// Decodes elements of `N` unsigned integers.
    pub fn integers<const N: usize>(
        &self,
        index: usize,
        place: &dyn Display,
        what: &str,
    ) -> Result<Vec<[u32; N]>, Problem> {
        let layout = self.layout(index, place, N, what)?;
        let (component, size) = (layout.component, layout.component.size());
        if !matches!(component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) {
            let place = format!("{place} (accessor {index})");
            return Err(Problem::new(place, "unsigned integers", format!("{component:?}")));
        }
        let read = |bytes: &[u8]| std::array::from_fn(|at| to_u32(component, &bytes[at * size..]));
        let mut out = match layout.bytes {
            None => vec![[0; N]; layout.count],
            Some(bytes) => match component {
                ComponentType::U8 => decoded(bytes, &layout, |[byte]: [u8; 1]| u32::from(byte)),
                ComponentType::U16 => decoded(bytes, &layout, |bytes: [u8; 2]| u32::from(u16::from_le_bytes(bytes))),
                _ => decoded(bytes, &layout, u32::from_le_bytes),
            },
        };
        self.sparse(index, &layout, |element, bytes| out[element] = read(bytes))?;
        Ok(out)
    }
}

/// Decodes elements of `N` components of `SIZE` bytes, which must match the layout.
fn decoded<T: Copy + Default, const N: usize, const SIZE: usize>(
    bytes: &[u8],
    layout: &Layout,
    value: impl Fn([u8; SIZE]) -> T,
) -> Vec<[T; N]> {
    if layout.stride == N * SIZE {
        // Without gaps, the loop is vectorized.
        let packed = bytes.as_chunks::<SIZE>().0.as_chunks::<N>().0;
        return packed[..layout.count].iter().map(|components| components.map(&value)).collect();
    }
    let read = |element: &[u8]| {
        let components = element.as_chunks::<SIZE>().0.first_chunk::<N>();
        components.map_or([T::default(); N], |components| components.map(&value))
    };
    elements(bytes, layout).map(read).collect()
}

fn elements<'a>(bytes: &'a [u8], layout: &Layout) -> impl Iterator<Item = &'a [u8]> + use<'a> {
    let (stride, size) = (layout.stride, layout.component.size() * layout.components);
    (0..layout.count).map(move |element| &bytes[element * stride..element * stride + size])
}

/// Checks that `count` elements fit; fails with the number of bytes needed.
fn check_range(available: usize, stride: usize, size: usize, count: usize) -> Result<(), usize> {
    if count == 0 {
        return Ok(());
    }
    let needed = (count - 1).checked_mul(stride).and_then(|bytes| bytes.checked_add(size)).unwrap_or(usize::MAX);
    if needed <= available { Ok(()) } else { Err(needed) }
}

/// Returns `list[index]`, or an error at `place` that says how many there are.
pub fn get<'a, T>(list: &'a [T], index: usize, place: &dyn Display, name: &str) -> Result<&'a T, Problem> {
    list.get(index)
        .ok_or_else(|| Problem::new(place.to_string(), format!("an index into the {} {name}", list.len()), index))
}
