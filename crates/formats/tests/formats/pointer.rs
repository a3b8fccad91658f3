//! KHR_animation_pointer: which channels pointers create, and what happens to those that lead nowhere.

use gaitway_character::anim::{Channel, Clip, Interpolation, MaterialProperty, PropertyTarget};
use gaitway_character::asset::Asset;
use gaitway_formats::{LoadOptions, convert, load, pointer_to};
use serde_json::{Value, json};

use crate::build_gltf::{Build, U8, one};
use crate::examples::{MOVES, moving};

fn read(build: Build) -> Asset {
    build.loaded()
}

fn warnings(asset: &Asset, code: &str) -> Vec<String> {
    asset.warnings.iter().filter(|warning| warning.code() == code).map(ToString::to_string).collect()
}

/// Adds a channel of two keys and loads the file, in which everything else must still play.
#[track_caller]
fn with(pointer: &str, shape: &str, values: &[f32]) -> Asset {
    let mut build = moving();
    build.point(pointer, "LINEAR", shape, &[0.0, 1.0], values);
    let asset = read(build);
    assert_eq!((asset.clips.len(), asset.clips[0].channels().len()), (1, 1), "{pointer}");
    asset
}

#[test]
fn what_leads_nowhere_is_named_and_left_out() {
    for (pointer, shape, expected) in [
        ("/materials/1/alphaCutoff", "SCALAR", "1 materials, found 1"),
        ("/nodes/7/scale", "VEC3", "1 nodes, found 7"),
        ("/nodes/0/weights/0", "SCALAR", "0 weights, found 0"),
        ("/nodes/0/weights", "SCALAR", "no morph targets"),
        ("/meshes/2/weights", "SCALAR", "1 meshes, found 2"),
        ("/cameras/3/perspective/yfov", "SCALAR", "1 cameras, found 3"),
        ("/cameras/0/orthographic/ymag", "SCALAR", "not orthographic"),
        ("/extensions/KHR_lights_punctual/lights/9/color", "VEC3", "1 lights, found 9"),
        ("/extensions/KHR_lights_punctual/lights/0/spot/outerConeAngle", "SCALAR", "not a spot light"),
        ("/materials/0/normalTexture/extensions/KHR_texture_transform/offset", "VEC2", "no such texture"),
    ] {
        let width = if shape == "SCALAR" { 1 } else { usize::from(shape.as_bytes()[3] - b'0') };
        let asset = with(pointer, shape, &vec![0.0; 2 * width]);
        let ignored = warnings(&asset, "channel-ignored");
        assert!(ignored.len() == 1 && ignored[0].contains(expected), "{pointer}: {ignored:?}");
        assert!(ignored[0].contains("animations[0].channels[1]"), "{ignored:?}");
        assert!(asset.clips[0].properties().is_empty());
    }
}

#[test]
fn accessors_have_the_type_of_the_property() {
    for (pointer, shape, values) in [
        ("/materials/0/pbrMetallicRoughness/baseColorFactor", "VEC3", &[0.0; 6][..]),
        ("/materials/0/pbrMetallicRoughness/metallicFactor", "VEC2", &[0.0; 4]),
        ("/extensions/KHR_lights_punctual/lights/0/color", "SCALAR", &[0.0; 2]),
        ("/cameras/0/perspective/zfar", "SCALAR", &[f32::NAN; 2]),
        ("/cameras/0/perspective/zfar", "SCALAR", &[1.0; 3]),
    ] {
        let asset = with(pointer, shape, values);
        let ignored = warnings(&asset, "channel-ignored");
        assert_eq!((ignored.len(), asset.clips[0].properties().len()), (1, 0), "{pointer}: {ignored:?}");
    }
}

#[test]
fn one_warning_names_all_properties_that_are_not_shown() {
    let mut build = moving();
    let pointers = [
        "/materials/0/extensions/KHR_materials_ior/ior",
        "/cameras/0/perspective/aspectRatio",
        "/nodes/0/extras/mood",
        "/materials/00/alphaCutoff",
        "/materials/-1/alphaCutoff",
        "/materials/0/alphaCutoff/",
        "/materials/0/pbrMetallicRoughness/baseColorFactor/3",
        "/materials",
        "materials/0/alphaCutoff",
        "/",
        "/extensions/KHR_lights_punctual/lights.length",
        "/nodes/0/weights/x",
    ];
    for pointer in pointers {
        build.point(pointer, "LINEAR", "SCALAR", &[0.0, 1.0], &[0.0, 1.0]);
    }
    build.point("/materials/0/alphaCutoff", "LINEAR", "SCALAR", &[0.0, 1.0], &[0.0, 1.0]);
    let asset = read(build);
    let target = PropertyTarget::Material(0, MaterialProperty::AlphaCutoff);
    assert_eq!(asset.clips[0].properties().iter().map(|channel| channel.target).collect::<Vec<_>>(), [target]);
    assert_eq!(asset.clips[0].channels().len(), 1);
    let not_shown = warnings(&asset, "animation-pointer");
    assert_eq!(asset.warnings.len(), 1, "{:?}", asset.warnings);
    assert!(pointers.iter().all(|pointer| not_shown[0].contains(pointer)), "{not_shown:?}");
}

#[test]
fn many_properties_that_are_not_shown_are_counted() {
    let mut build = moving();
    for index in 0..50 {
        build.point(&format!("/nodes/0/extras/{index}"), "LINEAR", "SCALAR", &[0.0, 1.0], &[0.0, 1.0]);
    }
    let not_shown = warnings(&read(build), "animation-pointer");
    assert!(not_shown.len() == 1 && not_shown[0].ends_with("and 20 more"), "{not_shown:?}");
}

/// The keys, with their times, of everything that a clip animates.
fn channels(clip: &Clip) -> Vec<String> {
    let times = |channel: &Channel| &clip.timelines()[channel.timeline as usize];
    clip.channels()
        .iter()
        .map(|channel| format!("{:?} {:?} {:?}", channel.joint, times(channel), channel.keys))
        .collect()
}

#[test]
fn nodes_are_animated_as_without_the_extension() {
    for (path, shape, values) in
        [("translation", "VEC3", &MOVES[..]), ("rotation", "VEC4", &[0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0])]
    {
        let plain = read(Build::animated(path, &[0.0, 1.0], shape, 2, values));
        let mut pointed = Build::triangle();
        pointed.point(&format!("/nodes/0/{path}"), "LINEAR", shape, &[0.0, 1.0], values);
        let pointed = read(pointed);
        assert_eq!(channels(&pointed.clips[0]), channels(&plain.clips[0]));
        assert!(pointed.warnings.is_empty(), "{:?}", pointed.warnings);
    }
    // Also with a node, which the extension forbids.
    let mut build = moving();
    build.json["animations"][0]["channels"][0]["target"]["node"] = json!(0);
    assert_eq!(channels(&read(build).clips[0]), channels(&read(moving()).clips[0]));
}

#[test]
fn the_weights_of_a_mesh_are_those_of_its_nodes() {
    let mut build = Build::triangle();
    build.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 0 }, { "POSITION": 0 }]);
    build.json["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "weights": [1, 0] }, { "mesh": 0 }, {}]);
    let mut single = Build { json: build.json.clone(), bytes: build.bytes.clone() };
    build.point("/meshes/0/weights", "LINEAR", "SCALAR", &[0.0, 1.0], &[0.0, 0.25, 0.5, 0.75]);
    let asset = read(build);
    let nodes = |asset: &Asset, joints: Vec<gaitway_character::anim::JointIndex>| -> Vec<usize> {
        joints.into_iter().map(|joint| asset.skeleton.source_index(joint)).collect()
    };
    let joints = asset.clips[0].channels().iter().map(|channel| channel.joint).collect();
    assert_eq!(nodes(&asset, joints), [0, 2]);
    single.point("/meshes/0/weights/1", "LINEAR", "SCALAR", &[0.0, 1.0], &[0.0, 1.0]);
    let asset = read(single);
    let pointers: Vec<String> =
        asset.clips[0].properties().iter().map(|channel| pointer_to(channel.target, &asset)).collect();
    assert_eq!(pointers, ["/nodes/0/weights/1", "/nodes/2/weights/1"]);
}

#[test]
fn normalized_integers_are_converted() {
    let mut build = moving();
    build.point("/materials/0/alphaCutoff", "STEP", "SCALAR", &[0.0, 1.0], &[0.0; 2]);
    let bytes = build.accessor(U8, "SCALAR", 2, &[51, 255]);
    build.json["accessors"][bytes]["normalized"] = json!(true);
    build.json["animations"][0]["samplers"][1]["output"] = json!(bytes);
    let asset = read(build);
    assert_eq!(asset.clips[0].properties()[0].values, [0.2, 1.0]);
    assert_eq!(asset.clips[0].properties()[0].interpolation, Interpolation::Step);
}

#[test]
fn interpolated_visibility_is_played_in_steps_with_a_warning() {
    let asset = with("/nodes/0/extensions/KHR_node_visibility/visible", "SCALAR", &[1.0, 0.0]);
    assert_eq!(asset.clips[0].properties()[0].interpolation, Interpolation::Step);
    assert_eq!(warnings(&asset, "interpolation").len(), 1);
}

#[test]
fn files_may_require_both_extensions() {
    let mut build = moving();
    build.json["extensionsUsed"] = json!(["KHR_animation_pointer", "KHR_node_visibility"]);
    build.json["extensionsRequired"] = json!(["KHR_animation_pointer", "KHR_node_visibility"]);
    assert!(read(build).warnings.is_empty());
}

/// The writer keeps what it doesn't change as text, so unsupported pointers survive as well.
#[test]
fn exported_files_keep_their_pointers() {
    let mut build = moving();
    build.json["nodes"][0]["extensions"] = json!({ "KHR_node_visibility": { "visible": false } });
    build.json["extensionsUsed"] = json!(["KHR_animation_pointer", "KHR_node_visibility"]);
    build.point("/materials/0/alphaCutoff", "STEP", "SCALAR", &[0.0, 1.0], &[0.0, 1.0]);
    build.point("/materials/0/extensions/KHR_materials_ior/ior", "STEP", "SCALAR", &[0.0, 1.0], &[1.0, 2.0]);
    let (json, bytes) = (build.json.clone(), build.bytes.clone());
    let mut files = one("model.gltf", build.gltf("model.bin"));
    files.insert("model.bin", bytes);
    let glb = convert(&files, &LoadOptions::default()).expect("written");
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("a length")) as usize;
    let written: Value = serde_json::from_slice(&glb[20..20 + length]).expect("JSON");
    for key in ["animations", "nodes", "extensionsUsed"] {
        assert_eq!(written[key], json[key], "{key}");
    }
    let again = load(&one("model.glb", glb)).expect("readable");
    assert_eq!((again.clips[0].properties().len(), again.hidden.len()), (1, 1));
}
