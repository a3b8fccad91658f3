//! Keys as the file has them, read and interpolated in double precision.

use std::collections::BTreeMap;

use glam::DQuat;
use serde_json::Value;

use crate::build_gltf::{F32, U8};

/// The keys of a channel as the file has them.
pub struct Curve {
    interpolation: String,
    times_secs: Vec<f64>,
    /// One per key; with cubic splines three: in-tangent, value and out-tangent.
    entries: Vec<Vec<f64>>,
}

impl Curve {
    /// Interpolates as glTF 2.0, appendix C says; rotations take the shorter arc.
    pub fn at(&self, time_secs: f64, is_rotation: bool) -> Vec<f64> {
        let times = &self.times_secs;
        let key = times.iter().rposition(|&start| start <= time_secs).unwrap_or(0);
        let next = if time_secs > times[key] { (key + 1).min(times.len() - 1) } else { key };
        let length = times[next] - times[key];
        let u = if length > 0.0 { (time_secs - times[key]) / length } else { 0.0 };
        let mix = |parts: &[(f64, usize)]| -> Vec<f64> {
            let width = self.entries[0].len();
            (0..width).map(|at| parts.iter().map(|&(share, entry)| share * self.entries[entry][at]).sum()).collect()
        };
        let value = match &*self.interpolation {
            "STEP" => mix(&[(1.0, key)]),
            "LINEAR" if is_rotation => {
                let [from, to] = [key, next].map(|key| DQuat::from_slice(&self.entries[key]).normalize());
                from.slerp(to, u).to_array().to_vec()
            }
            "LINEAR" => mix(&[(1.0 - u, key), (u, next)]),
            _ => mix(&[
                (2.0 * u * u * u - 3.0 * u * u + 1.0, 3 * key + 1),
                (length * (u * u * u - 2.0 * u * u + u), 3 * key + 2),
                (3.0 * u * u - 2.0 * u * u * u, 3 * next + 1),
                (length * (u * u * u - u * u), 3 * next),
            ]),
        };
        match is_rotation {
            true => DQuat::from_slice(&value).normalize().to_array().to_vec(),
            false => value,
        }
    }
}

fn number(value: &Value) -> usize {
    value.as_u64().unwrap_or(0) as usize
}

/// The elements of an accessor.
fn elements(json: &Value, buffers: &[Vec<u8>], accessor: usize) -> Vec<Vec<f64>> {
    let accessor = &json["accessors"][accessor];
    let view = &json["bufferViews"][number(&accessor["bufferView"])];
    let start = number(&view["byteOffset"]) + number(&accessor["byteOffset"]);
    let width = match accessor["type"].as_str() {
        Some("SCALAR") => 1,
        Some(vector) => vector.trim_start_matches("VEC").parse().expect("a vector"),
        None => panic!("no type"),
    };
    let bytes = &buffers[number(&view["buffer"])][start..];
    let size = if accessor["componentType"] == F32 { 4 } else { 1 };
    let stride = view["byteStride"].as_u64().map_or(size * width, |stride| stride as usize);
    let at = |offset: usize| match number(&accessor["componentType"]) as u32 {
        F32 => f64::from(f32::from_le_bytes(bytes[offset..offset + 4].try_into().expect("four bytes"))),
        U8 => f64::from(bytes[offset]),
        other => panic!("component type {other}"),
    };
    (0..number(&accessor["count"]))
        .map(|element| (0..width).map(|part| at(element * stride + part * size)).collect())
        .collect()
}

/// The curves of the first animation by pointer. If several have the same pointer, the last one counts.
pub fn curves(json: &Value, buffers: &[Vec<u8>]) -> BTreeMap<String, Curve> {
    let animation = &json["animations"][0];
    let mut curves = BTreeMap::new();
    for channel in animation["channels"].as_array().expect("channels") {
        let pointer = channel["target"]["extensions"]["KHR_animation_pointer"]["pointer"].as_str().expect("a pointer");
        let sampler = &animation["samplers"][number(&channel["sampler"])];
        let times_secs = elements(json, buffers, number(&sampler["input"])).concat();
        let mut entries = elements(json, buffers, number(&sampler["output"]));
        // The weights of all morph targets together are one value.
        if pointer.ends_with("/weights") {
            let per_key = if sampler["interpolation"] == "CUBICSPLINE" { 3 } else { 1 };
            let width = entries.len() / times_secs.len() / per_key;
            entries = entries.concat().chunks(width).map(<[f64]>::to_vec).collect();
        }
        let interpolation = sampler["interpolation"].as_str().unwrap_or("LINEAR").to_owned();
        curves.insert(pointer.to_owned(), Curve { interpolation, times_secs, entries });
    }
    curves
}
