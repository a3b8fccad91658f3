//! `KHR_draco_mesh_compression`: files compressed here load like the originals.

use draco_core::{DataType, EncoderBuffer, EncoderOptions, GeometryAttributeType, Mesh, MeshEncoder, PointAttribute};
use gaitway_character::asset::Asset;
use gaitway_formats::{FileSet, LoadError, Part, convert, load, missing_files, next_preparation, prepare};
use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{VertexEncoding, encode_vertex_buffer};
use serde_json::{Value, json};

use crate::build_gltf::{Build, F32, U8, U16, U32, floats, glb, one, shorts};
use crate::data_folder::data_folder;
use crate::random::Random;

const EXTENSION: &str = "KHR_draco_mesh_compression";
const PRIMITIVE: &str = "/meshes/0/primitives/0";

/// Two skinned triangles with indices.
fn plain() -> Build {
    let mut build = Build::new();
    let positions = [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.25];
    build.accessor(F32, "VEC3", 4, &floats(&positions));
    build.accessor(U8, "VEC4", 4, &[0, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0]);
    build.accessor(F32, "VEC4", 4, &floats(&[0.5, 0.5, 0., 0., 1., 0., 0., 0., 0.25, 0.75, 0., 0., 1., 0., 0., 0.]));
    build.accessor(U16, "SCALAR", 6, &shorts(&[0, 1, 2, 2, 1, 3]));
    let attributes = json!({ "POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2 });
    build.json["meshes"] = json!([{ "primitives": [{ "attributes": attributes, "indices": 3 }] }]);
    build.json["nodes"] = json!([{ "mesh": 0, "skin": 0 }, { "children": [2] }, {}]);
    build.json["skins"] = json!([{ "joints": [1, 2] }]);
    build
}

/// The bytes of an accessor that has a buffer view of its own.
fn data<'a>(build: &'a Build, accessor: &Value) -> &'a [u8] {
    let view = &build.json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let range = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
    &build.bytes[range[0]..][..range[1]]
}

/// Encodes the first primitive as it is, without quantization and in its order.
fn encoded(build: &Build) -> Vec<u8> {
    let primitive = build.json.pointer(PRIMITIVE).unwrap();
    let accessor = |index: &Value| build.json["accessors"][index.as_u64().unwrap() as usize].clone();
    let mut mesh = Mesh::new();
    for index in primitive["attributes"].as_object().unwrap().values() {
        let accessor = accessor(index);
        let components = accessor["type"].as_str().unwrap().strip_prefix("VEC").unwrap().parse().unwrap();
        let (kind, data_type) = match accessor["componentType"].as_u64().unwrap() as u32 {
            U8 => (GeometryAttributeType::Generic, DataType::Uint8),
            _ if components == 3 => (GeometryAttributeType::Position, DataType::Float32),
            _ => (GeometryAttributeType::Generic, DataType::Float32),
        };
        let mut attribute = PointAttribute::new();
        attribute.init(kind, components, data_type, false, accessor["count"].as_u64().unwrap() as usize);
        attribute.buffer_mut().write(0, data(build, &accessor));
        mesh.add_attribute(attribute);
    }
    let indices = data(build, &accessor(&primitive["indices"]));
    let indices: Vec<u32> = indices.as_chunks().0.iter().map(|two| u32::from(u16::from_le_bytes(*two))).collect();
    mesh.set_num_faces(indices.len() / 3);
    mesh.set_faces_from_flat_indices(&indices);
    let (mut encoder, mut source) = (MeshEncoder::new(), EncoderBuffer::new());
    let mut options = EncoderOptions::new();
    options.set_encoding_method(0);
    encoder.set_mesh(mesh);
    encoder.encode(&options, &mut source).unwrap();
    source.data().to_vec()
}

/// Gives the first primitive the extension, and takes the data from its accessors.
fn compressed(mut build: Build) -> Build {
    let view = build.view(&encoded(&build));
    let primitive = build.json.pointer_mut(PRIMITIVE).unwrap();
    let semantics = primitive["attributes"].as_object().unwrap().keys();
    let ids: Value = semantics.enumerate().map(|(id, semantic)| (semantic.clone(), json!(id))).collect();
    primitive["extensions"][EXTENSION] = json!({ "bufferView": view, "attributes": ids });
    for accessor in build.json["accessors"].as_array_mut().unwrap() {
        accessor.as_object_mut().unwrap().remove("bufferView");
    }
    build.json["extensionsUsed"] = json!([EXTENSION]);
    build.json["extensionsRequired"] = json!([EXTENSION]);
    build
}

fn prepared(build: Build) -> Result<FileSet, LoadError> {
    let mut files = one("a/model.glb", build.glb());
    prepare(&mut files)?;
    Ok(files)
}

fn assert_same(asset: &Asset, original: &Asset) {
    let [found, expected] = [asset, original].map(|asset| &asset.meshes[0].primitives[0]);
    assert_eq!(found.positions, expected.positions);
    assert_eq!(found.indices, expected.indices);
    assert_eq!(found.influences, expected.influences);
    assert_eq!(asset.extensions_used, [EXTENSION]);
    assert!(asset.warnings.is_empty(), "{:?}", asset.warnings);
}

#[test]
fn compressed_files_load_like_the_originals() {
    let original = plain().load().unwrap();
    let build = compressed(plain());
    let mut gltf = FileSet::default();
    gltf.insert("a/model.bin", build.bytes.clone());
    gltf.insert("a/model.gltf", build.gltf("model.bin"));
    prepare(&mut gltf).unwrap();
    for files in [prepared(compressed(plain())).unwrap(), gltf] {
        assert_same(&load(&files).unwrap(), &original);
    }
}

#[test]
fn what_is_written_has_no_compression() {
    let mut build = compressed(plain());
    build.json["accessors"][0]["min"] = json!([-9, 0, 0]);
    build.json["accessors"][0]["max"] = json!([9, 1, 0.25]);
    let written = convert(&prepared(build).unwrap(), &Default::default()).unwrap();
    let text = String::from_utf8_lossy(&written);
    assert!(!text.contains("draco") && !text.contains("extensions"));
    assert!(text.contains(r#""min":[0,0,0]"#) && text.contains(r#""max":[1,1,0.25]"#), "{text}");
    let written = load(&one("b.glb", written)).unwrap();
    assert_eq!(written.meshes[0].primitives[0].positions, plain().load().unwrap().meshes[0].primitives[0].positions);
}

/// Encoders may drop degenerate triangles and split vertices; the declared counts may be the original ones.
#[test]
fn counts_are_those_of_the_decoded_data() {
    let mut build = compressed(plain());
    for (accessor, count) in [(0, 5), (1, 5), (2, 5), (3, 9)] {
        build.json["accessors"][accessor]["count"] = json!(count);
    }
    build.json["accessors"][3]["componentType"] = json!(U32);
    assert_same(&load(&prepared(build).unwrap()).unwrap(), &plain().load().unwrap());
}

#[test]
fn strips_and_primitives_without_indices_become_lists() {
    let original = plain().load().unwrap();
    let strip = compressed(plain()).with(&format!("{PRIMITIVE}/mode"), json!(5)).with("/accessors/3/count", json!(4));
    assert_same(&load(&prepared(strip).unwrap()).unwrap(), &original);
    let mut bare = compressed(plain());
    bare.json.pointer_mut(PRIMITIVE).unwrap().as_object_mut().unwrap().remove("indices");
    assert_same(&load(&prepared(bare).unwrap()).unwrap(), &original);
}

/// Two primitives name the same accessors but each has its own compressed data; a third shares the first one's data.
#[test]
fn shared_accessors_get_the_data_of_their_primitive() {
    let mut other = plain();
    other.bytes[..4].copy_from_slice(&(-3.0_f32).to_le_bytes());
    let mut build = compressed(plain());
    let view = build.view(&encoded(&other));
    let first = build.json.pointer(PRIMITIVE).unwrap().clone();
    let mut second = first.clone();
    second["extensions"][EXTENSION]["bufferView"] = json!(view);
    build.json["meshes"][0]["primitives"] = json!([first, second, first]);
    let files = prepared(build).unwrap();
    let asset = load(&files).unwrap();
    let primitives = &asset.meshes[0].primitives;
    assert_eq!(primitives[1].positions[0].x, -3.0);
    assert_eq!(primitives[0].positions[0].x, 0.0);
    assert_eq!(primitives[2].positions, primitives[0].positions);
    let names: Vec<&str> = files.names().collect();
    assert_eq!(names, ["a/model.glb", "a/model.glb.draco"]);
    // Indices, positions, joints and weights of two meshes, each decoded once.
    assert_eq!(files.get("a/model.glb.draco").unwrap().len(), 2 * (12 + 4 * (12 + 4 + 16)));
}

#[test]
fn the_original_data_of_an_optional_extension_is_used() {
    let mut build = compressed(plain());
    build.json["accessors"] = plain().json["accessors"].clone();
    build.json.as_object_mut().unwrap().remove("extensionsRequired");
    let files = one("a/model.glb", build.glb());
    assert!(next_preparation(&files).unwrap().is_none());
    assert_same(&load(&files).unwrap(), &plain().load().unwrap());

    let mut empty = compressed(plain());
    empty.json.as_object_mut().unwrap().remove("extensionsRequired");
    assert_same(&load(&prepared(empty).unwrap()).unwrap(), &plain().load().unwrap());
}

#[test]
fn a_file_may_have_both_extensions() {
    let mut build = compressed(plain());
    let (times, moves) = (floats(&[0.0, 1.0]), floats(&[0.0, 0.0, 0.0, 1.0, 2.0, 3.0]));
    for (shape, stride, bytes) in [("SCALAR", 4, &times), ("VEC3", 12, &moves)] {
        let source =
            encode_vertex_buffer(bytes, 2, stride, VertexEncoding::DEFAULT, &mut Workspace::default()).unwrap();
        let view = build.view(&source);
        let view = &mut build.json["bufferViews"][view];
        view["extensions"]["EXT_meshopt_compression"] = json!({
            "buffer": 0, "byteOffset": view["byteOffset"], "byteLength": source.len(),
            "byteStride": stride, "count": 2, "mode": "ATTRIBUTES",
        });
        let offset = if stride == 4 { 0 } else { 8 };
        (view["buffer"], view["byteOffset"], view["byteLength"]) = (json!(1), json!(offset), json!(bytes.len()));
        let view = build.json["bufferViews"].as_array().unwrap().len() - 1;
        let accessor = json!({ "bufferView": view, "componentType": F32, "type": shape, "count": 2 });
        build.json["accessors"].as_array_mut().unwrap().push(accessor);
    }
    build.json["animations"] = json!([{
        "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }],
        "samplers": [{ "input": 4, "output": 5 }],
    }]);
    build.json["buffers"] = json!([
        { "byteLength": build.bytes.len() },
        { "byteLength": 32, "extensions": { "EXT_meshopt_compression": { "fallback": true } } },
    ]);
    build.json["extensionsUsed"] = json!([EXTENSION, "EXT_meshopt_compression"]);
    build.json["extensionsRequired"] = build.json["extensionsUsed"].clone();
    let mut files = one("model.glb", glb(build.json.to_string().as_bytes(), &build.bytes));
    prepare(&mut files).unwrap();
    let asset = load(&files).unwrap();
    assert_eq!(asset.clips[0].duration_secs(), 1.0);
    assert_eq!(asset.meshes[0].primitives[0].positions.len(), 4);
    assert_eq!(asset.extensions_used, ["EXT_meshopt_compression", EXTENSION]);
    let written = convert(&files, &Default::default()).unwrap();
    assert_eq!(load(&one("b.glb", written)).unwrap().clips[0].duration_secs(), 1.0);
}

#[test]
fn a_file_that_is_not_prepared_is_an_error() {
    let files = one("model.gltf", compressed(plain()).gltf("model.bin"));
    assert_eq!(missing_files(&files), ["model.bin"]);
    assert!(next_preparation(&files).unwrap().is_none(), "its data is not there yet");
    assert!(matches!(load(&files), Err(LoadError::MissingFile { .. })));
    let files = one("model.glb", compressed(plain()).glb());
    assert_eq!(next_preparation(&files).unwrap().unwrap().part, Part::Draco);
    let problem = load(&files).unwrap_err().to_string();
    assert!(problem.contains("meshes[0].primitives[0]") && problem.contains("`prepare`"), "{problem}");
}

#[test]
fn damaged_meshes_are_errors() {
    let extension = format!("{PRIMITIVE}/extensions/{EXTENSION}");
    let cases: [(String, Value, &str); 10] = [
        (format!("{extension}/bufferView"), json!(9), "an index into the 5 bufferViews"),
        (format!("{extension}/bufferView"), json!("four"), "a bufferView and attributes"),
        (format!("{extension}/bufferView"), json!(0), "compressed mesh 0"),
        (format!("{extension}/attributes"), json!([0]), "attributes of the primitive"),
        (format!("{extension}/attributes/POSITION"), json!(7), "no attribute 7"),
        (format!("{PRIMITIVE}/indices"), json!(77), "an index into the 4 accessors"),
        ("/accessors/0/type".to_owned(), json!("VEC2"), "3 components, 2 declared"),
        ("/accessors/0/componentType".to_owned(), json!(1), "componentType"),
        ("/bufferViews/4/byteLength".to_owned(), json!(20), "compressed mesh 0"),
        ("/bufferViews/4/byteOffset".to_owned(), json!(1_000_000), "of buffer 0"),
    ];
    for (pointer, value, expected) in cases {
        let problem = prepared(compressed(plain()).with(&pointer, value)).unwrap_err().to_string();
        assert!(problem.starts_with("a/model.glb: ") && problem.contains(expected), "{pointer}: {problem}");
    }
    let mut build = compressed(plain());
    for accessor in 0..4 {
        build.json["accessors"][accessor]["count"] = json!(3);
    }
    let problem = prepared(build).unwrap_err().to_string();
    assert!(problem.contains("4 vertices"), "{problem}");
}

/// Damages the compressed data of real files; other tests damage the JSON. A panic would be caught, so only the message
/// reveals one.
#[test]
fn damaged_real_files_never_panic() {
    let Some(folder) = data_folder() else { return };
    let mut random = Random(0x5851_F42D_4C95_7F2D);
    let mut loaded = 0;
    for name in ["Monster", "CesiumMan"] {
        let folder = folder.join(format!("khronos/{name}/glTF-Draco"));
        let model = std::fs::read(folder.join(format!("{name}.gltf"))).unwrap();
        let json: Value = serde_json::from_slice(&model).unwrap();
        let view = &json["meshes"][0]["primitives"][0]["extensions"][EXTENSION]["bufferView"];
        let view = &json["bufferViews"][view.as_u64().unwrap() as usize];
        let [start, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap() as usize);
        let original = std::fs::read(folder.join("0.bin")).unwrap();
        for case in 0..150 {
            let mut bytes = original.clone();
            for _ in 0..=random.below(2) {
                // The headers are at the beginning.
                let within = if random.below(2) == 0 { 64 } else { length };
                let at = start + random.below(within);
                bytes[at] ^= 1 << random.below(8);
            }
            let mut files = one("model.gltf", model.clone());
            files.insert("0.bin", bytes);
            match prepare(&mut files).and_then(|()| load(&files)) {
                Ok(_) => loaded += 1,
                Err(problem) => assert!(!problem.to_string().contains("unexpectedly"), "{name}, case {case}"),
            }
        }
    }
    assert!((10..290).contains(&loaded), "{loaded} of 300 were loaded");
}
