//! Small compressed files, made by encoders: seeds of the decoders' fuzzing.

use draco_core::{DataType, EncoderBuffer, EncoderOptions, GeometryAttributeType, Mesh, MeshEncoder, PointAttribute};
use gaitway_formats::next_preparation;
use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{VertexEncoding, encode_vertex_buffer};
use serde_json::json;

use crate::build_gltf::{Build, floats, glb, one};

const POSITIONS: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.25];

/// Two triangles, and the decoder's input for them.
pub fn draco() -> Vec<Vec<u8>> {
    let mut positions = PointAttribute::new();
    positions.init(GeometryAttributeType::Position, 3, DataType::Float32, false, 4);
    positions.buffer_mut().write(0, &floats(&POSITIONS));
    let mut mesh = Mesh::new();
    mesh.add_attribute(positions);
    mesh.set_num_faces(2);
    mesh.set_faces_from_flat_indices(&[0, 1, 2, 2, 1, 3]);
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    // As a list of triangles, and by the edges that they share.
    let encoded = [0, 1].map(|method| {
        let (mut options, mut encoded) = (EncoderOptions::new(), EncoderBuffer::new());
        options.set_encoding_method(method);
        encoder.encode(&options, &mut encoded).expect("a mesh of two triangles");
        encoded.data().to_vec()
    });
    let file = |encoded: &Vec<u8>| {
        let mut build = Build::new();
        let view = build.view(encoded);
        build.json["accessors"] = json!([
            { "componentType": 5126, "type": "VEC3", "count": 4 },
            { "componentType": 5125, "type": "SCALAR", "count": 6 },
        ]);
        let extension = json!({ "bufferView": view, "attributes": { "POSITION": 0 } });
        let extensions = json!({ "KHR_draco_mesh_compression": extension });
        let primitive = json!({ "attributes": { "POSITION": 0 }, "indices": 1, "extensions": extensions });
        build.json["meshes"] = json!([{ "primitives": [primitive] }]);
        build.json["nodes"] = json!([{ "mesh": 0 }]);
        build.glb()
    };
    encoded.iter().map(file).flat_map(with_input).collect()
}

/// Four vertices, and the decoder's input for them.
pub fn meshopt() -> Vec<Vec<u8>> {
    let encoded = encode_vertex_buffer(&floats(&POSITIONS), 4, 12, VertexEncoding::DEFAULT, &mut Workspace::default())
        .expect("four vertices");
    let compression =
        json!({ "buffer": 0, "byteLength": encoded.len(), "byteStride": 12, "count": 4, "mode": "ATTRIBUTES" });
    let file = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": encoded.len() }, { "byteLength": 48 }],
        "bufferViews": [{ "buffer": 1, "byteLength": 48, "extensions": { "EXT_meshopt_compression": compression } }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "mode": 0 }] }],
        "nodes": [{ "mesh": 0 }],
    });
    with_input(glb(file.to_string().as_bytes(), &encoded))
}

/// Returns a file, and what its decoder gets of it.
fn with_input(file: Vec<u8>) -> Vec<Vec<u8>> {
    let next = next_preparation(&one("model.glb", file.clone())).expect("a whole file").expect("compressed data");
    vec![file, next.input.to_vec()]
}
