//! `EXT_meshopt_compression`: files compressed here load like the originals.

use gaitway_formats::{FileSet, LoadError, convert, load, missing_files, next_preparation, prepare};
use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{IndexEncoding, VertexEncoding, encode_index_buffer, encode_vertex_buffer};
use serde_json::{Value, json};

use crate::build_gltf::{Build, U16, glb, one, shorts};

const EXTENSION: &str = "EXT_meshopt_compression";

/// A skinned triangle with indices.
fn plain() -> Build {
    let mut build =
        Build::skinned([0, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0], [0.5, 0.5, 0., 0., 1., 0., 0., 0., 0.25, 0.75, 0., 0.]);
    let indices = build.accessor(U16, "SCALAR", 3, &shorts(&[0, 1, 2]));
    build.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
    build
}

/// Compresses every view. The parent views refer to buffer 1, which has no data.
fn compressed(build: Build, extension: &str) -> (Value, Vec<u8>) {
    let Build { mut json, bytes } = build;
    let (mut data, mut workspace) = (Vec::new(), Workspace::default());
    let strides = [12, 4, 16, 2];
    for (view, stride) in json["bufferViews"].as_array_mut().unwrap().iter_mut().zip(strides) {
        let (start, length) =
            (view["byteOffset"].as_u64().unwrap() as usize, view["byteLength"].as_u64().unwrap() as usize);
        let (source, count) = (&bytes[start..start + length], length / stride);
        let (mode, encoded) = match stride {
            2 => {
                let indices: Vec<u32> =
                    source.chunks(2).map(|two| u32::from(u16::from_le_bytes([two[0], two[1]]))).collect();
                ("TRIANGLES", encode_index_buffer(&indices, IndexEncoding::DEFAULT, &mut workspace).unwrap())
            }
            _ => (
                "ATTRIBUTES",
                encode_vertex_buffer(source, count, stride, VertexEncoding::DEFAULT, &mut workspace).unwrap(),
            ),
        };
        view["buffer"] = json!(1);
        view["extensions"][extension] = json!({
            "buffer": 0, "byteOffset": data.len(), "byteLength": encoded.len(),
            "byteStride": stride, "count": count, "mode": mode,
        });
        data.extend(encoded);
    }
    json["buffers"] = json!([
        { "byteLength": data.len() },
        { "byteLength": bytes.len(), "extensions": { extension: { "fallback": true } } },
    ]);
    json["extensionsUsed"] = json!([extension]);
    json["extensionsRequired"] = json!([extension]);
    (json, data)
}

fn set(json: &Value, data: &[u8]) -> FileSet {
    one("a/model.glb", glb(json.to_string().as_bytes(), data))
}

#[test]
fn compressed_files_load_like_the_originals() {
    let original = plain().load().unwrap();
    for extension in [EXTENSION, "KHR_meshopt_compression"] {
        let (mut json, data) = compressed(plain(), extension);
        let mut glb = set(&json, &data);
        json["buffers"][0]["uri"] = json!("model.bin");
        let mut gltf = one("a/model.gltf", json.to_string().into_bytes());
        gltf.insert("a/model.bin", data);
        for files in [&mut glb, &mut gltf] {
            let name = files.names().next().unwrap().to_owned();
            let opened = files.get(&name).cloned();
            prepare(files).unwrap();
            assert_ne!(files.get(&name), opened.as_ref());
            assert_eq!(files.original(&name), opened.as_ref(), "kept for the validator");
            let asset = load(files).unwrap();
            assert_eq!(asset.meshes[0].primitives[0].positions, original.meshes[0].primitives[0].positions);
            assert_eq!(asset.meshes[0].primitives[0].indices, original.meshes[0].primitives[0].indices);
            assert_eq!(asset.extensions_used, [extension]);
            assert!(asset.warnings.is_empty(), "{:?}", asset.warnings);
        }
    }
}

#[test]
fn what_is_written_has_no_compression() {
    let (json, data) = compressed(plain(), EXTENSION);
    let mut files = set(&json, &data);
    prepare(&mut files).unwrap();
    let written = convert(&files, &Default::default()).unwrap();
    let text = String::from_utf8_lossy(&written);
    assert!(!text.contains("meshopt") && !text.contains("extensionsRequired"));
    assert_eq!(load(&one("b.glb", written)).unwrap().meshes[0].primitives[0].positions.len(), 3);
}

#[test]
fn a_fallback_buffer_is_not_asked_for() {
    let (mut json, _) = compressed(plain(), EXTENSION);
    json["buffers"][0]["uri"] = json!("model.bin");
    json["buffers"][1]["uri"] = json!("fallback.bin");
    let files = one("model.gltf", json.to_string().into_bytes());
    assert_eq!(missing_files(&files), ["model.bin"]);
    assert!(next_preparation(&files).unwrap().is_none(), "its data is not there yet");
    assert!(matches!(load(&files), Err(LoadError::MissingFile { .. })));
}

#[test]
fn damaged_views_are_errors() {
    let view = "/bufferViews/0/extensions/EXT_meshopt_compression";
    let cases: [(&str, Value, &str); 7] = [
        ("byteOffset", json!(1_000_000), "a range inside its buffer"),
        ("byteLength", json!(20), "damaged"),
        ("buffer", json!(9), "a buffer of the file"),
        ("mode", json!("POINTS"), "ATTRIBUTES"),
        ("filter", json!("SEPIA"), "OCTAHEDRAL"),
        ("count", json!(4_000_000_000_u32), "decoded bytes"),
        ("byteStride", json!("four"), "byteStride"),
    ];
    for (key, value, expected) in cases {
        let (mut json, data) = compressed(plain(), EXTENSION);
        json.pointer_mut(view).unwrap()[key] = value;
        let problem = prepare(&mut set(&json, &data)).unwrap_err().to_string();
        assert!(problem.starts_with("a/model.glb: ") && problem.contains(expected), "{key}: {problem}");
    }
    let (mut json, data) = compressed(plain(), EXTENSION);
    json["buffers"][1]["byteLength"] = json!(1_u64 << 40);
    let problem = prepare(&mut set(&json, &data)).unwrap_err().to_string();
    assert!(problem.contains("MiB of data"), "{problem}");
}
