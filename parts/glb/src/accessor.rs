//! Accessors and views. Typed, unlike the rest of the document: a clip with many joints has thousands of them, and each would take
//! a kilobyte as a [`Value`].

use serde::Serialize;
use serde_json::Value;

use crate::numbers;

pub const FLOAT: u32 = 5126;
pub const UNSIGNED_BYTE: u32 = 5121;
pub const UNSIGNED_SHORT: u32 = 5123;
pub const UNSIGNED_INT: u32 = 5125;

/// A part of the buffer.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct View {
    pub buffer: usize,
    pub byte_offset: usize,
    pub byte_length: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<u32>,
}

/// The elements of a view, or zeros.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Accessor {
    #[serde(skip_serializing_if = "Option::is_none")]
    buffer_view: Option<usize>,
    component_type: u32,
    count: usize,
    #[serde(rename = "type")]
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    min: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sparse: Option<Sparse>,
}

/// The elements that differ from the accessor's own.
#[derive(Serialize)]
struct Sparse {
    count: usize,
    indices: Indices,
    values: Values,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Indices {
    buffer_view: usize,
    component_type: u32,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Values {
    buffer_view: usize,
}

impl Accessor {
    /// Creates an accessor; without a view, its elements are zero.
    pub fn new(view: Option<usize>, component_type: u32, count: usize, kind: &'static str) -> Accessor {
        Accessor { buffer_view: view, component_type, count, kind, min: None, max: None, sparse: None }
    }

    /// Adds the bounds of floats with as many components as the kind has.
    pub fn add_bounds(&mut self, values: &[f32]) {
        let width = components(self.kind);
        let mut low = vec![f64::INFINITY; width];
        let mut high = vec![f64::NEG_INFINITY; width];
        for element in values.chunks_exact(width) {
            for (axis, &value) in element.iter().enumerate() {
                low[axis] = low[axis].min(f64::from(value));
                high[axis] = high[axis].max(f64::from(value));
            }
        }
        (self.min, self.max) = (Some(numbers(&low)), Some(numbers(&high)));
    }

    /// Replaces some elements: `indices` and `values` are views.
    pub fn replace(&mut self, count: usize, indices: usize, values: usize) {
        let indices = Indices { buffer_view: indices, component_type: UNSIGNED_INT };
        self.sparse = Some(Sparse { count, indices, values: Values { buffer_view: values } });
    }
}

/// Returns the number of components of an element.
pub fn components(kind: &str) -> usize {
    match kind {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        _ => 16,
    }
}
