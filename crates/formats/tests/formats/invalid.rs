//! Invalid files: each is rejected with the place in the file, what was expected and what was found.

use gaitway_formats::{FileSet, LoadError, load};
use serde_json::{Value, json};

use crate::build_gltf::{Build, F32, U8, U32, floats, glb, one};

/// Checks that loading fails with a message that contains all `parts`.
#[track_caller]
fn check(build: Build, parts: &[&str]) {
    check_bytes("model.glb", build.glb(), parts);
}

/// Loads a file whose only warning, besides those about placeholders for images and weights, is about `place`.
#[track_caller]
pub fn check_left_out(build: Build, place: &str, found: &str) {
    let asset = build.load().unwrap_or_else(|problem| panic!("{place}: {problem}"));
    assert_eq!(asset.meshes[0].primitives[0].positions.len(), 3, "{place}");
    let of_placeholder = ["image-unreadable", "weights-normalized"];
    let warnings: Vec<_> = asset.warnings.iter().filter(|warning| !of_placeholder.contains(&warning.code())).collect();
    assert!(matches!(warnings[..], [warning] if warning.place() == place), "{place}: {warnings:?}");
    assert!(warnings[0].to_string().contains(found), "{}", warnings[0]);
}

#[track_caller]
fn check_bytes(name: &str, bytes: Vec<u8>, parts: &[&str]) {
    let problem = load(&one(name, bytes)).expect_err("must not load").to_string();
    for part in parts.iter().chain([&name]) {
        assert!(problem.contains(part), "“{part}” is not in: {problem}");
    }
}

#[test]
fn foreign_formats() {
    check_bytes("model.dae", b"<COLLADA/>".to_vec(), &["COLLADA", "File › Import"]);
    check_bytes("scene.blend", b"BLENDER-v300".to_vec(), &["Blender's own", "File › Open"]);
    check_bytes("download", b"\n<!DOCTYPE HTML>".to_vec(), &["HTML", "web page"]);
    check_bytes("sky.exr", b"\x76\x2f\x31\x01".to_vec(), &["OpenEXR", ".hdr"]);
}

#[test]
fn truncated_glb() {
    let whole = Build::triangle().glb();
    for length in [4, 8, 11] {
        check_bytes("model.glb", whole[..length].to_vec(), &["GLB header", "12 bytes", &length.to_string()]);
    }
    for length in 12..whole.len() {
        check_bytes("model.glb", whole[..length].to_vec(), &["GLB header", "cut short"]);
    }
}

#[test]
fn invalid_chunks() {
    let mut too_big = Build::triangle().glb();
    too_big[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    check_bytes("model.glb", too_big, &["GLB chunk at byte 12", "4294967295 bytes"]);
    let mut no_json = Build::triangle().glb();
    no_json[16..20].copy_from_slice(b"what");
    check_bytes("model.glb", no_json, &["a JSON chunk"]);
    check_bytes("model.glb", glb(b"{\"asset\":", &[]), &["not valid JSON, asset: it ends too soon"]);
    check_bytes("notes.glb", b"notes on a rig".to_vec(), &["expected a GLB", "found text that begins with “n”"]);
    check_bytes("cat.glb", b"\x89PNG\r\n\x1a\n\0\0".to_vec(), &["cat.glb: expected a GLB", "found a PNG image"]);
    check_bytes("rig.glb", b"PK\x03\x04".to_vec(), &["a .zip archive; name it .zip"]);
    check_bytes("rig.glb", b"<!DOCTYPE html>".to_vec(), &["a web page or XML"]);
    check_bytes("rig.glb", vec![0, 1, 2, 3], &["binary data that begins with byte 0x00"]);
}

#[test]
fn other_versions() {
    let mut old = Build::triangle().glb();
    old[4..8].copy_from_slice(&1_u32.to_le_bytes());
    check_bytes("model.glb", old, &["glTF 1.0", "2.0"]);
    check(Build::triangle().with("/asset/version", json!("1.0")), &["glTF 1.0"]);
    check(Build::triangle().with("/asset/version", json!(2)), &["glTF 2;"]);
    check(Build::triangle().with("/asset/minVersion", json!("2.1")), &["2.1", "minVersion"]);
    check(Build::triangle().with("/asset", json!({})), &["asset.version is missing"]);
}

#[test]
fn invalid_json_is_located_by_line_and_column() {
    let text = "{ \"asset\": { \"version\": \"2.0\" },\n  \"nodes\": [{ \"mesh\": -1 }] }";
    check_bytes("model.gltf", text.as_bytes().to_vec(), &["line 2", "column", "-1"]);
    let deep = format!("{{\"asset\":{{\"version\":\"2.0\"}},\"extras\":{}", "[".repeat(100_000));
    check_bytes("model.gltf", deep.into_bytes(), &["not valid JSON"]);
    check_bytes("model.gltf", Vec::new(), &["the file is empty"]);
}

/// No editor shows the JSON inside a GLB, so line numbers would help nobody.
#[test]
fn places_in_a_glb_are_json_paths() {
    for (nodes, problem) in [
        ("{},{\"mesh\":-1}", "model.glb: nodes[1].mesh: expected an index (0, 1, …), found -1"),
        ("{},{\"children\":3}", "model.glb: nodes[1].children: expected an array, found 3"),
        ("{},{\"scale\":[1,2]}", "model.glb: nodes[1].scale: expected an array of length 3, found 2 elements"),
        ("{},{]", "model.glb: not valid JSON, nodes[1]: expected the name of a member"),
        ("{ \"name\" : tail }", "model.glb: not valid JSON, nodes[0].name: expected"),
    ] {
        let text = format!("{{\"asset\":{{\"version\":\"2.0\"}},\n\"nodes\":[{nodes}]}}");
        check_bytes("model.glb", glb(text.as_bytes(), &[]), &[problem]);
    }
}

#[test]
fn indices_out_of_range_name_their_place() {
    let moved = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let base = || {
        let mut build = Build::animated("translation", &[0.0, 1.0], "VEC3", 2, &moved);
        build.accessor(U8, "VEC4", 3, &[0; 12]);
        build.accessor(F32, "VEC4", 3, &floats(&[1.0; 12]));
        build.attribute("JOINTS_0", 3);
        build.attribute("WEIGHTS_0", 4);
        build.json["nodes"] = json!([{ "mesh": 0, "skin": 0, "camera": 0, "children": [1] }, {}]);
        build.json["skins"] = json!([{ "joints": [1] }]);
        build.json["cameras"] = json!([{ "perspective": { "yfov": 1.0, "znear": 0.1 } }]);
        build.json["scenes"] = json!([{ "nodes": [0] }]);
        build.json["materials"] = json!([{ "normalTexture": { "index": 0 } }]);
        build.json["textures"] = json!([{ "source": 0, "sampler": 0 }]);
        build.json["samplers"] = json!([{}]);
        build.json["images"] = json!([{ "bufferView": 0 }]);
        build.json["meshes"][0]["primitives"][0]["material"] = json!(0);
        build
    };
    base().load().expect("the valid file loads");
    let places = [
        ("/nodes/0/mesh", "nodes[0].mesh"),
        ("/nodes/0/skin", "nodes[0].skin"),
        ("/nodes/0/children/0", "nodes[0].children[0]"),
        ("/skins/0/joints/0", "skins[0].joints[0]"),
        ("/skins/0/skeleton", "skins[0].skeleton"),
        ("/skins/0/inverseBindMatrices", "skins[0].inverseBindMatrices"),
        ("/meshes/0/primitives/0/indices", "meshes[0].primitives[0].indices"),
        ("/meshes/0/primitives/0/attributes/POSITION", "meshes[0].primitives[0].attributes.POSITION"),
        ("/meshes/0/primitives/0/attributes/NORMAL", "meshes[0].primitives[0].attributes.NORMAL"),
        ("/meshes/0/primitives/0/attributes/JOINTS_0", "meshes[0].primitives[0].attributes.JOINTS_0"),
        ("/accessors/0/bufferView", "accessors[0]"),
        ("/bufferViews/0/buffer", "bufferViews[0].buffer"),
    ];
    for (pointer, place) in places {
        check(base().with(pointer, json!(99)), &[&format!(": {place}: "), "99"]);
    }
    // Parts that geometry and skeleton don't need are left out.
    let places = [
        ("/nodes/0/camera", "nodes[0].camera"),
        ("/scenes/0/nodes/0", "scenes[0].nodes[0]"),
        ("/scene", "scene"),
        ("/meshes/0/primitives/0/material", "meshes[0].primitives[0].material"),
        ("/materials/0/normalTexture/index", "materials[0].normalTexture.index"),
        ("/textures/0/source", "textures[0].source"),
        ("/textures/0/sampler", "textures[0].sampler"),
        ("/images/0/bufferView", "images[0].bufferView"),
        ("/animations/0/channels/0/sampler", "animations[0].channels[0].sampler"),
        ("/animations/0/channels/0/target/node", "animations[0].channels[0].target.node"),
        ("/animations/0/samplers/0/input", "animations[0].samplers[0].input"),
        ("/animations/0/samplers/0/output", "animations[0].samplers[0].output"),
    ];
    for (pointer, place) in places {
        check_left_out(base().with(pointer, json!(99)), place, "found 99");
    }
}

#[test]
fn vertex_index_out_of_range() {
    let mut build = Build::triangle();
    let indices = [0_u32, 1, 3].iter().flat_map(|index| index.to_le_bytes()).collect::<Vec<u8>>();
    let accessor = build.accessor(U32, "SCALAR", 3, &indices);
    build.json["meshes"][0]["primitives"][0]["indices"] = json!(accessor);
    check(build, &["meshes[0].primitives[0].indices[2]", "an index below 3", "found 3"]);
}

#[test]
fn joint_index_out_of_range() {
    let build =
        Build::skinned([0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0], [1.0, 0.0, 0.0, 0.0].repeat(3).try_into().unwrap());
    check(build, &["meshes[0].primitives[0].attributes.JOINTS_n, vertex 2", "a joint below 2"]);
}

#[test]
fn data_beyond_its_view_or_buffer() {
    check(Build::triangle().with("/accessors/0/count", json!(4)), &["accessors[0]", "48 bytes", "found 36"]);
    check(Build::triangle().with("/accessors/0/byteOffset", json!(4)), &["accessors[0]", "36 bytes", "found 32"]);
    check(Build::triangle().with("/accessors/0/byteOffset", json!(u64::MAX)), &["accessors[0]", "found 0"]);
    check(Build::triangle().with("/bufferViews/0/byteLength", json!(100)), &["bufferViews[0]", "only 36 bytes"]);
    check(Build::triangle().with("/bufferViews/0/byteOffset", json!(u64::MAX)), &["bufferViews[0]"]);
    check(Build::triangle().with("/bufferViews/0/byteLength", json!(u64::MAX)), &["bufferViews[0]"]);
    check(Build::triangle().with("/bufferViews/0/byteStride", json!(u64::MAX)), &["accessors[0]"]);
    check(
        Build::triangle().with("/bufferViews/0/byteStride", json!(4)),
        &["accessors[0]", "a byteStride of at least 12"],
    );
    check(
        Build::triangle().with("/bufferViews/0/byteStride", json!(0)),
        &["accessors[0]", "a byteStride of at least 12"],
    );
}

#[test]
fn counts_beyond_the_budget() {
    let zeros = |count: u64| json!({ "componentType": 5126, "type": "VEC3", "count": count });
    for count in [200_000_000, 1 << 40, u64::MAX] {
        check(Build::triangle().with("/accessors/0", zeros(count)), &["accessors[0]", "1024 MiB of data in all"]);
    }
}

/// A few bytes of JSON that would expand beyond any memory.
#[test]
fn products_beyond_the_budget() {
    // Every node of a mesh has a weight for each morph target.
    let mut weights = Build::triangle();
    weights.json["meshes"][0]["primitives"][0]["targets"] = Value::Array(vec![json!({}); 20_000]);
    weights.json["nodes"] = Value::Array(vec![json!({ "mesh": 0 }); 20_000]);
    check(weights, &["nodes[", "morph weights in all"]);
    // Many images share one view.
    let mut images = Build::triangle();
    let view = images.view(&vec![0; 1 << 20]);
    images.json["images"] = Value::Array(vec![json!({ "bufferView": view }); 3_000]);
    check(images, &["images[", "MiB of data in all"]);
}

#[test]
fn accessors_of_the_wrong_type() {
    let place = "meshes[0].primitives[0].attributes.POSITION (accessor 0)";
    check(Build::triangle().with("/accessors/0/type", json!("VEC2")), &[place, "expected VEC3", "found VEC2"]);
    check(Build::triangle().with("/accessors/0/type", json!("VEC9")), &["accessors[0]", "“VEC9”"]);
    check(
        Build::triangle().with("/accessors/0/componentType", json!(5124)),
        &["accessors[0]", "componentType", "5124"],
    );
    let mut floating_indices = Build::triangle();
    let accessor = floating_indices.accessor(F32, "SCALAR", 3, &floats(&[0.0, 1.0, 2.0]));
    floating_indices.json["meshes"][0]["primitives"][0]["indices"] = json!(accessor);
    check(floating_indices, &["meshes[0].primitives[0].indices", "unsigned integers"]);
    let mut short_normals = Build::triangle();
    let accessor = short_normals.accessor(F32, "VEC3", 2, &floats(&[0.0; 6]));
    short_normals.attribute("NORMAL", accessor);
    check(short_normals, &["attributes.NORMAL", "3 elements, as POSITION has", "found 2"]);
}

#[test]
fn numbers_that_are_not_finite() {
    for bad in [f32::NAN, f32::INFINITY] {
        let mut build = Build::triangle();
        build.bytes[12..16].copy_from_slice(&bad.to_le_bytes());
        check(build, &["attributes.POSITION, element 1", "finite numbers"]);
    }
    check(Build::triangle().with("/nodes/0/translation", json!([0, 0, 1e39])), &["nodes[0]", "finite"]);
}

#[test]
fn invalid_sparse_accessors() {
    let sparse = |indices: &[u8], count: usize| {
        let mut build = Build::triangle();
        let index_view = build.view(indices);
        let value_view = build.view(&floats(&[0.0; 6]));
        build.json["accessors"][0]["sparse"] = json!({
            "count": count,
            "indices": { "bufferView": index_view, "componentType": U8 },
            "values": { "bufferView": value_view },
        });
        build
    };
    sparse(&[0, 2], 2).load().expect("a valid one loads");
    check(sparse(&[0, 3], 2), &["accessors[0].sparse", "indices below 3", "found 3"]);
    check(sparse(&[0, 1, 2, 0], 4), &["accessors[0].sparse", "at most 3 entries", "found 4"]);
    check(sparse(&[0], 2), &["accessors[0].sparse.indices", "2 bytes"]);
    check(sparse(&[0, 1, 2], 3), &["accessors[0].sparse.values", "36 bytes", "found 24"]);
    let signed = sparse(&[0, 2], 2).with("/accessors/0/sparse/indices/componentType", json!(5120));
    check(signed, &["accessors[0].sparse", "unsigned indices"]);
}

#[test]
fn nodes_that_are_not_a_tree() {
    let nodes = |nodes: Value| Build::new().with("/nodes", nodes);
    check(nodes(json!([{ "children": [0] }])), &["nodes[0]", "a tree of nodes"]);
    check(
        nodes(json!([{ "children": [1] }, { "children": [2] }, { "children": [0] }])),
        &["nodes[", "a tree of nodes"],
    );
    check(
        nodes(json!([{ "children": [2] }, { "children": [2] }, {}])),
        &["nodes[1].children[0]", "node 2, which is a child of node 0 already"],
    );
}

#[test]
fn invalid_clips() {
    let moved = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    let clip =
        |times: &[f32], count: usize, values: &[f32]| Build::animated("translation", times, "VEC3", count, values);
    let good = || clip(&[0.0, 1.0], 2, &moved);
    good().load().expect("a valid one loads");
    let cubic = "/animations/0/samplers/0/interpolation";
    let ignored = |build: Build, place: &str, found: &str| {
        check_left_out(build, place, found);
    };
    let sampler = "animations[0].samplers[0]";
    ignored(clip(&[1.0, 0.0], 2, &moved), sampler, "usable keys");
    ignored(clip(&[0.0, f32::NAN], 2, &moved), "animations[0].samplers[0].input, element 1", "finite");
    ignored(clip(&[0.0, 1.0, 2.0], 2, &moved), sampler, "usable keys");
    ignored(good().with(cubic, json!("CUBICSPLINE")), sampler, "usable keys");
    let rotation = good().with("/animations/0/channels/0/target/path", json!("rotation"));
    ignored(rotation, "animations[0].samplers[0].output (accessor 2)", "VEC4");
    // An unknown interpolation falls back to linear.
    for unknown in [json!("BEZIER"), json!(0)] {
        let build = good().with(cubic, unknown.clone());
        let asset = build.load().expect("readable");
        assert_eq!(asset.clips[0].channels()[0].interpolation, gaitway_character::anim::Interpolation::Linear);
        let warnings: Vec<String> = asset.warnings.iter().map(ToString::to_string).collect();
        let place = "animations[0].samplers[0].interpolation";
        assert!(matches!(&warnings[..], [warning] if warning.starts_with(place)), "{warnings:?}");
    }
    // The other channels of a clip stay.
    let mut two = good();
    two.json["animations"][0]["channels"] = json!([
        { "sampler": 9, "target": { "node": 0, "path": "scale" } },
        { "sampler": 0, "target": { "node": 0, "path": "translation" } },
    ]);
    assert_eq!(two.load().expect("readable").clips[0].channels().len(), 1);
}

#[test]
fn too_few_bind_matrices() {
    let mut build = Build::skinned([0; 12], [1.0, 0.0, 0.0, 0.0].repeat(3).try_into().unwrap());
    let accessor = build.accessor(F32, "MAT4", 1, &floats(&glam::Mat4::IDENTITY.to_cols_array()));
    build.json["skins"][0]["inverseBindMatrices"] = json!(accessor);
    check(build, &["skins[0].inverseBindMatrices", "2 matrices, one for each joint", "found 1"]);
}

#[test]
fn joints_without_weights() {
    let mut build = Build::skinned([0; 12], [0.25; 12]);
    build.json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("WEIGHTS_0");
    check(build, &["WEIGHTS_0", "only JOINTS_0"]);
}

#[test]
fn primitives_with_different_numbers_of_morph_targets() {
    let primitive = json!({ "attributes": { "POSITION": 0 } });
    let with_target = json!({ "attributes": { "POSITION": 0 }, "targets": [{ "POSITION": 0 }] });
    let primitives = json!([with_target, primitive]);
    check(Build::triangle().with("/meshes/0/primitives", primitives), &["primitives[1].targets", "1 morph target"]);
    let weights = json!([1.0, 0.0]);
    check(Build::triangle().with("/meshes/0/weights", weights.clone()), &["meshes[0].weights", "found 2"]);
    check(Build::triangle().with("/nodes/0/weights", weights), &["nodes[0].weights", "found 2"]);
}

#[test]
fn unavailable_buffers() {
    let missing = Build::triangle().gltf("mesh%20data.bin");
    check_bytes("model.gltf", missing, &["buffers[0].uri", "“mesh data.bin”", "open them together"]);
    check_bytes("model.gltf", Build::triangle().gltf("data:text/plain;base64,%%%"), &["buffers[0].uri", "base64"]);
    check_bytes("model.gltf", Build::triangle().gltf("data:"), &["buffers[0].uri", "comma"]);
    check_bytes("model.gltf", Build::triangle().gltf("data:;base64,AAAA"), &["buffers[0]", "36 bytes", "found 3"]);
    check(Build::new().with("/meshes", Build::triangle().json["meshes"].clone()), &["POSITION", "0 accessors"]);
}

#[test]
fn unsupported_required_extensions() {
    let build = |name: &str| Build::triangle().with("/extensionsRequired", json!([name]));
    check(build("ACME_teapot"), &["ACME_teapot"]);
    build("KHR_mesh_quantization").load().expect("supported");
}

#[test]
fn sets_without_a_model_or_with_several() {
    let empty = load(&FileSet::default()).unwrap_err();
    assert!(matches!(&empty, LoadError::NoModel { found } if found.is_empty()), "{empty}");
    let mut files = one("readme.txt", b"hello".to_vec());
    let none = load(&files).unwrap_err().to_string();
    assert!(none.contains("readme.txt") && none.contains(".glb"), "{none}");
    let buffer = load(&one("a/Fox.bin", vec![0; 4])).unwrap_err();
    assert!(matches!(&buffer, LoadError::MissingFile { uri, .. } if uri == "Fox.gltf"), "{buffer}");
    files.insert("a.glb", Build::triangle().glb());
    load(&files).expect("other files do no harm");
    files.insert("b/c.gltf", Build::triangle().gltf("x.bin"));
    let several = load(&files).unwrap_err().to_string();
    assert!(several.contains("a.glb") && several.contains("b/c.gltf"), "{several}");
}
