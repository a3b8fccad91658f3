//! Lenient reading: files that load although the types of the `gltf` crate reject them, and its limits.

use gaitway::asset::Asset;
use gaitway::formats::load;
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
    build.load().unwrap_or_else(|problem| panic!("{problem}"))
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

/// A channel that an extension aims at something else keeps its number, and so do the others.
#[test]
fn channels_without_a_node_are_set_aside() {
    let mut build = complete();
    let pointer = json!({ "sampler": 0, "target": { "path": "pointer", "extensions": { "KHR_animation_pointer": {
        "pointer": "/materials/0/alphaCutoff" } } } });
    build.json["animations"][0]["channels"].as_array_mut().unwrap().insert(0, pointer);
    let asset = read(build);
    assert_eq!(asset.clips[0].channels().len(), 1);
    let ignored =
        asset.warnings.iter().find(|warning| warning.code() == "channel-ignored").expect("a warning").to_string();
    assert!(ignored.contains("animations[0].channels[0]") && ignored.contains("“pointer”"), "{ignored}");
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
            ("/animations/0/channels/0/target/node", "animations[0].channels[0].target.node"),
            ("/textures/0/source", "textures[0].source"),
        ] {
            let problem = complete().with(pointer, json!(wide)).load().expect_err(pointer).to_string();
            assert!(problem.contains(place), "no {place} in {problem}");
        }
    }
    // Long numbers elsewhere are fine.
    check("/asset/extras", json!({ "time": 1_700_000_000_000_u64 }));
    check("/nodes/1/translation", json!([10_000_000_000_u64, 0, 0]));
    check("/nodes/1/name", json!("take 12345678901, 2"));
}

#[test]
fn an_error_behind_harmless_deviations_has_its_own_place() {
    let text = "{ \"asset\": { \"version\": \"2.0\" },\n  \"cameras\": [{}],\n  \"skins\": [{}, { \"joints\":\n [0, \"arm\"] }] }";
    let problem = load(&one("model.gltf", text.as_bytes().to_vec())).expect_err("must not load").to_string();
    for part in ["model.gltf", "line 4, column 6", "skins[1].joints[1]", "arm"] {
        assert!(problem.contains(part), "“{part}” is not in: {problem}");
    }
    let missing =
        r#"{ "asset": { "version": "2.0" }, "animations": [{ "channels": [{ "target": { "path": "scale" } }] }] }"#;
    let problem = load(&one("model.gltf", missing.as_bytes().to_vec())).expect_err("must not load").to_string();
    assert!(problem.contains("animations[0].channels[0]") && problem.contains("sampler"), "{problem}");
}

#[test]
fn an_error_names_its_place_past_names_that_look_like_json() {
    // The version must be patched, so the text is read a second time; the error is found there and named in the original.
    let text = "{\"asset\":{\"version\":2.0},\n\"nodes\":[{\"name\":\"a{[\\\",\\u0041é:\"},\n{\"mesh\":\"x\"}]}";
    let problem = load(&one("m.gltf", text.into())).expect_err("a mesh is not a name").to_string();
    assert!(problem.contains("line 3") && problem.contains("nodes[1].mesh"), "{problem}");
    let text = "{\"asset\":{\"version\":\"2.0\"},\"accessors\":[{\"type\":\"VEC3\"}]}";
    let problem = load(&one("m.gltf", text.into())).expect_err("members are missing").to_string();
    assert!(problem.contains("accessors[0]"), "{problem}");
}
