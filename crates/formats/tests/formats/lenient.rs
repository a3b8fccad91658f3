//! Lenient reading: files that load although the types of the `gltf` crate reject them, and its limits.

use gaitway_character::asset::Asset;
use gaitway_formats::load;
use serde_json::{Value, json};

use crate::build_gltf::{Build, one};

/// Every kind of list, and nothing that a strict reader would reject.
fn complete() -> Build {
    let mut build = Build::animated("translation", &[0.0, 1.0], "VEC3", 2, &[0.0; 6]);
    build.json["nodes"] = json!([{ "mesh": 0, "skin": 0, "camera": 0 }, { "name": "arm" }]);
    build.json["skins"] = json!([{ "joints": [1] }]);
    build.json["scenes"] = json!([{ "nodes": [0, 1] }]);
    build.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } }]);
    build.json["materials"] = json!([{ "extensions": { "KHR_materials_unlit": {} } }]);
    build.json["images"] = json!([{ "uri": "data:,", "mimeType": "image/png" }]);
    build.json["textures"] = json!([{}]);
    build.json["samplers"] = json!([{}]);
    build
}

fn read(build: Build) -> Asset {
    build.loaded()
}

/// Loads `complete` with a harmless change, and checks that nothing is lost.
#[track_caller]
fn check(pointer: &str, value: Value) -> Asset {
    let asset = read(complete().with(pointer, value));
    assert_eq!((asset.skeleton.len(), asset.meshes.len(), asset.clips.len()), (2, 1, 1), "{pointer}");
    assert_eq!((asset.scenes.len(), asset.skins.len(), asset.cameras.len()), (1, 1, 1), "{pointer}");
    asset
}

#[test]
fn members_that_are_not_needed_may_be_missing_or_of_another_type() {
    let changes = [
        ("/asset/version", json!(2.0)),
        ("/asset/minVersion", json!(2.0)),
        ("/asset/copyright", json!(7)),
        ("/cameras/0/type", Value::Null),
        ("/cameras/0/type", json!(3)),
        ("/cameras/0/perspective/aspectRatio", Value::Null),
        ("/scenes/0", json!({})),
        ("/animations/0", json!({ "name": "empty" })),
        ("/animations/0/samplers/0/interpolation", Value::Null),
        ("/bufferViews/0/target", json!("vertices")),
        ("/bufferViews/0/byteOffset", Value::Null),
        ("/accessors/0/name", json!(1)),
        ("/images/0/mimeType", json!(1)),
        ("/textures/0/source", Value::Null),
        ("/samplers/0/wrapS", Value::Null),
        ("/meshes/0/primitives/0/attributes/TEXCOORD_7", json!("none")),
        ("/meshes/0/primitives/0/mode", Value::Null),
        ("/meshes/0/extensions", json!([])),
    ];
    for (pointer, value) in changes {
        check(pointer, value);
    }
    let asset = check("/meshes/0", json!({}));
    assert!(asset.meshes[0].primitives.is_empty());
    let asset = check("/materials/0/extensions/KHR_materials_unlit", json!(true));
    assert!(asset.materials[0].unlit);
}

/// A channel whose target an extension defines keeps its index, and so do the others.
#[test]
fn channels_without_a_node_are_set_aside() {
    let mut build = complete();
    let other = json!({ "sampler": 0, "target": { "path": "mood", "extensions": { "EXT_moods": { "mood": 1 } } } });
    build.json["animations"][0]["channels"].as_array_mut().unwrap().insert(0, other);
    let asset = read(build);
    assert_eq!(asset.clips[0].channels().len(), 1);
    let ignored =
        asset.warnings.iter().find(|warning| warning.code() == "channel-ignored").expect("a warning").to_string();
    assert!(ignored.contains("animations[0].channels[0]") && ignored.contains("“mood”"), "{ignored}");
}

/// The crate would read 2³² as 0.
#[test]
fn indices_of_more_than_32_bits_are_not_truncated() {
    for wide in [u64::from(u32::MAX), 1 << 32, u64::MAX] {
        for (pointer, place) in [
            ("/nodes/0/mesh", "nodes[0].mesh"),
            ("/scenes/0/nodes/1", "scenes[0].nodes[1]"),
            ("/meshes/0/primitives/0/attributes/POSITION", "meshes[0].primitives[0].attributes.POSITION"),
            ("/accessors/0/componentType", "accessors[0].componentType"),
        ] {
            let problem = complete().with(pointer, json!(wide)).load().expect_err(pointer).to_string();
            assert!(problem.contains(place), "no {place} in {problem}");
        }
        for (pointer, place) in [
            ("/animations/0/channels/0/target/node", "animations[0].channels[0]"),
            ("/textures/0/source", "textures[0]"),
        ] {
            crate::invalid::check_left_out(complete().with(pointer, json!(wide)), place, "left out");
        }
    }
    // Long numbers elsewhere are fine.
    check("/asset/extras", json!({ "time": 1_700_000_000_000_u64 }));
    check("/nodes/1/translation", json!([10_000_000_000_u64, 0, 0]));
    check("/nodes/1/name", json!("take 12345678901, 2"));
}

/// §2.7: "integer numbers may be written as 100, 100.0 or 1e2".
#[test]
fn whole_numbers_are_integers_however_they_are_written() {
    let text = String::from_utf8(Build::triangle().gltf("data:,")).expect("text");
    let text = text.replace("\"count\":3", "\"count\":COUNT").replace("\"mesh\":0", "\"mesh\":0.0");
    let text =
        text.replace("\"uri\":\"data:,\"", "\"uri\":\"m.bin\"").replace("\"byteLength\":36", "\"byteLength\":3.6e1");
    let with_count = |count: &str| {
        let mut files = one("m.gltf", text.replace("COUNT", count).into_bytes());
        files.insert("m.bin", [0; 36]);
        load(&files)
    };
    for count in ["3", "3.0", "0.3e1", "30e-1", "3E0"] {
        let asset = with_count(count).unwrap_or_else(|problem| panic!("{count}: {problem}"));
        assert_eq!(asset.meshes[0].primitives[0].positions.len(), 3, "{count}");
    }
    for count in ["2.5", "-3.0", "1e40"] {
        let problem = with_count(count).expect_err(count).to_string();
        assert!(problem.contains("accessors[0].count"), "{problem}");
    }
    let bone = json!({ "humanoid": { "humanBones": { "hips": { "node": 1.0 } } } });
    let asset = check("/extensions", json!({ "VRMC_vrm": bone }));
    assert!(asset.humanoid.is_some());
}

/// Serde would read the elements by position.
#[test]
fn an_array_is_not_an_object() {
    for (pointer, place) in [
        ("/asset", "asset"),
        ("/nodes/1", "nodes[1]"),
        ("/meshes/0", "meshes[0]"),
        ("/meshes/0/primitives/0", "meshes[0].primitives[0]"),
        ("/accessors/0", "accessors[0]"),
        ("/bufferViews/0", "bufferViews[0]"),
        ("/skins/0", "skins[0]"),
        ("/scenes/0", "scenes[0]"),
    ] {
        // As many elements as the largest struct has members.
        let problem = complete().with(pointer, json!(vec![0; 16])).load().expect_err(pointer).to_string();
        assert!(problem.contains(place), "no {place} in {problem}");
    }
}

/// Parts that geometry and skeleton don't need are left out with one warning, and keep their indices.
#[test]
fn unreadable_parts_are_left_out() {
    let cases = [
        ("/cameras/0", "cameras[0]"),
        ("/cameras/0/perspective", "cameras[0]"),
        ("/cameras/0/perspective/yfov", "cameras[0]"),
        ("/nodes/0/camera", "nodes[0].camera"),
        ("/images/0", "images[0]"),
        ("/images/0/uri", "images[0]"),
        ("/textures/0", "textures[0]"),
        ("/textures/0/sampler", "textures[0]"),
        ("/samplers/0", "samplers[0]"),
        ("/materials/0", "materials[0]"),
        ("/materials/0/alphaCutoff", "materials[0]"),
        ("/animations/0", "animations[0]"),
        ("/animations/0/samplers/0", "animations[0].samplers[0]"),
        ("/animations/0/samplers/0/input", "animations[0].samplers[0]"),
        ("/animations/0/channels/0", "animations[0].channels[0]"),
        ("/animations/0/channels/0/target", "animations[0].channels[0]"),
        ("/extensions/KHR_lights_punctual/lights/0", "extensions.KHR_lights_punctual.lights[0]"),
        ("/nodes/1/extensions/KHR_lights_punctual", "nodes[1].extensions.KHR_lights_punctual"),
    ];
    for (pointer, place) in cases {
        let mut build = complete();
        build.json["images"][0]["uri"] = json!("data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJ");
        build.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
        build.json["nodes"][1]["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
        assert!(build.json["textures"][0].is_object());
        crate::invalid::check_left_out(build.with(pointer, json!([vec![0; 16]])), place, "left out");
    }
}

/// Viewers that silently drop one of the two show different things.
#[test]
fn contradictions_are_reported() {
    let code = |build: Build| -> Vec<&str> { read(build).warnings.iter().map(|warning| warning.code()).collect() };
    let quarter = [0.0, 0.0, -1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 5.0, 0.0, 0.0, 1.0];
    let moved = Build::animated("translation", &[0.0, 1.0], "VEC3", 2, &[0.0; 6]);
    let with_matrix = moved.with("/nodes/0/matrix", json!(quarter));
    assert_eq!(code(with_matrix), ["animated-matrix"]);
    let both = || Build::triangle().with("/nodes/0/matrix", json!(quarter)).with("/nodes/0/scale", json!([2, 2, 2]));
    assert_eq!(code(both()), ["matrix-and-trs"]);
    let rest = read(both()).skeleton.rest().locals().next().expect("one node");
    assert_eq!((rest.translation.x, rest.scale), (5.0, glam::Vec3::ONE));
}

#[test]
fn repeated_chunks_are_reported() {
    let mut file = Build::triangle().glb();
    let first = load(&one("m.glb", file.clone())).expect("readable");
    assert!(first.warnings.is_empty());
    let end = file.len();
    for kind in [*b"BIN\0", *b"JSON", *b"ANY "] {
        file.extend([4, 0, 0, 0]);
        file.extend(kind);
        file.extend(*b"{}  ");
    }
    let length = (file.len() as u32).to_le_bytes();
    file[8..12].copy_from_slice(&length);
    let again = load(&one("m.glb", file)).expect("readable");
    let warnings: Vec<String> = again.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].starts_with(&format!("GLB chunk at byte {end}")), "{warnings:?}");
    assert_eq!(again.meshes[0].primitives[0].positions, first.meshes[0].primitives[0].positions);
}

#[test]
fn an_error_behind_harmless_deviations_has_its_own_place() {
    let text = "{ \"asset\": { \"version\": \"2.0\" },\n  \"cameras\": [{}],\n  \"skins\": [{}, { \"joints\":\n [0, \"arm\"] }] }";
    let problem = load(&one("model.gltf", text.as_bytes().to_vec())).expect_err("must not load").to_string();
    for part in ["model.gltf", "line 4, column 6", "skins[1].joints[1]", "arm"] {
        assert!(problem.contains(part), "“{part}” is not in: {problem}");
    }
    let missing = r#"{ "asset": { "version": "2.0" }, "scenes": [{}], "accessors": [{ "type": "VEC3", "componentType": 5126 }] }"#;
    let problem = load(&one("model.gltf", missing.as_bytes().to_vec())).expect_err("must not load").to_string();
    assert!(problem.contains("accessors[0]") && problem.contains("count"), "{problem}");
}

#[test]
fn an_error_names_its_place_past_names_that_look_like_json() {
    // The version must be patched, so the text is read a second time; the error is found there and named in the
    // original.
    let text = "{\"asset\":{\"version\":2.0},\n\"nodes\":[{\"name\":\"a{[\\\",\\u0041é:\"},\n{\"mesh\":\"x\"}]}";
    let problem = load(&one("m.gltf", text.into())).expect_err("a mesh is not a name").to_string();
    assert!(problem.contains("line 3") && problem.contains("nodes[1].mesh"), "{problem}");
    let text = "{\"asset\":{\"version\":\"2.0\"},\"accessors\":[{\"type\":\"VEC3\"}]}";
    let problem = load(&one("m.gltf", text.into())).expect_err("members are missing").to_string();
    assert!(problem.contains("accessors[0]"), "{problem}");
}
