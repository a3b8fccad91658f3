//! `DeclData`: what newer exporters write in place of `MeshNormals` and `MeshTextureCoords`, vertices as Direct3D 9 holds them.

use glam::DVec3;

use crate::document::Document;

/// How many 32-bit words each of Direct3D's types takes (`D3DDECLTYPE`): FLOAT1 to FLOAT4, then packed ones.
const WORDS: [usize; 17] = [1, 2, 3, 4, 1, 1, 1, 2, 1, 1, 2, 1, 2, 1, 1, 1, 2];
const FLOAT2: usize = 1;
const FLOAT3: usize = 2;
/// `D3DDECLUSAGE`.
const NORMAL: usize = 3;
const TEXCOORD: usize = 5;

/// Attributes of vertices; empty if there are none.
#[derive(Default)]
pub struct Declared {
    pub normals: Vec<DVec3>,
    pub uvs: Vec<[f32; 2]>,
}

/// Reads the normals and the first texture coordinates of a mesh's vertices.
pub fn read(document: &Document, object: usize, vertices: usize) -> Result<Declared, String> {
    let mut numbers = document.numbers(object);
    let (mut stride, mut normal, mut uv) = (0, None, None);
    for _ in 0..numbers.count(4, "elements")? {
        let kind = numbers.index(WORDS.len() - 1, "a type")?;
        let [_method, usage, set] = numbers.array("an element")?;
        match (kind, usage as usize, set as usize) {
            (FLOAT3, NORMAL, 0) => normal = Some(stride),
            (FLOAT2, TEXCOORD, 0) => uv = Some(stride),
            _ => {}
        }
        stride += WORDS[kind];
    }
    let count = numbers.count(1, "values")?;
    if count != vertices.saturating_mul(stride) {
        return Err(numbers.damaged(&format!("{stride} values for each of {vertices} vertices"), &count.to_string()));
    }
    let mut declared = Declared::default();
    if stride == 0 {
        return Ok(declared);
    }
    for vertex in numbers.take(count, "values")?.chunks_exact(stride) {
        // Floats as the integers that have the same bits.
        let float = |at: usize| {
            let value = f32::from_bits(vertex[at] as u32);
            if value.is_finite() { value } else { 0.0 }
        };
        if let Some(at) = normal {
            declared.normals.push(DVec3::from_array([at, at + 1, at + 2].map(|at| f64::from(float(at)))));
        }
        if let Some(at) = uv {
            declared.uvs.push([float(at), float(at + 1)]);
        }
    }
    Ok(declared)
}
