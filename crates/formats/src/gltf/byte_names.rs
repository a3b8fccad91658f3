//! Names in a converted file whose encoding the part couldn't decode.

use serde_json::Value;

use super::container;
use super::write::glb;
use crate::encoding::{decode_bytes, is_byte};

/// Decodes such names in a GLB, and in the warnings that come with it. A GLB without any stays as it is.
pub fn decode_names(bytes: Vec<u8>, warnings: &mut [String]) -> Vec<u8> {
    decoded(&bytes, warnings).unwrap_or(bytes)
}

fn decoded(bytes: &[u8], warnings: &mut [String]) -> Option<Vec<u8>> {
    let container = container::open("", bytes).ok()?;
    let text = str::from_utf8(container.json).ok().filter(|text| text.contains(is_byte))?;
    let mut json: Value = serde_json::from_str(text).ok()?;
    let mut texts: Vec<&mut String> = warnings.iter_mut().collect();
    add_strings(&mut json, &mut texts);
    decode_bytes(&mut texts);
    glb(serde_json::to_vec(&json).ok()?, container.binary.unwrap_or_default().to_vec()).ok()
}

/// Collects the strings in a value. The parser limits how deeply values nest.
fn add_strings<'a>(value: &'a mut Value, strings: &mut Vec<&'a mut String>) {
    match value {
        Value::String(text) => strings.push(text),
        Value::Array(list) => list.iter_mut().for_each(|value| add_strings(value, strings)),
        Value::Object(members) => members.values_mut().for_each(|value| add_strings(value, strings)),
        _ => {}
    }
}
