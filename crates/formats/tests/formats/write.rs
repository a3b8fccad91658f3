//! Written files load again: clips bit by bit, and nothing of the original is lost.

use gaitway_character::anim::{Clip, ClipBuilder, Interpolation, JointIndex, Keys};
use gaitway_character::asset::Asset;
use gaitway_formats::{
    FileSet, LoadError, LoadOptions, WriteError, convert, load, load_named, write_model, write_motion,
};
use glam::{Mat4, Quat, Vec3};
use serde_json::{Value, json};

use crate::build_gltf::{Build, F32, floats, glb, one};
use crate::data_folder::data_folder;
use crate::examples::{PNG, TWO_JOINTS};
use crate::file_set::file_set;
use crate::model_files::models_under;
use crate::sweep::GLTF;

/// Returns JSON and binary chunk of a GLB, after checking the container.
pub fn chunks_of(file: &[u8]) -> (String, &[u8]) {
    let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().expect("four bytes")) as usize;
    assert_eq!((&file[..4], word(4), word(8)), (&b"glTF"[..], 2, file.len()));
    let json = 20..20 + word(12);
    assert!(json.end.is_multiple_of(4) && file.len().is_multiple_of(4), "chunks are aligned");
    let binary = if json.end < file.len() { &file[json.end + 8..json.end + 8 + word(json.end)] } else { &[] };
    (String::from_utf8(file[json].to_vec()).expect("UTF-8"), binary)
}

pub fn json_of(file: &[u8]) -> Value {
    serde_json::from_str(&chunks_of(file).0).expect("JSON")
}

fn loaded(file: Vec<u8>) -> Asset {
    load(&one("written.glb", file)).unwrap_or_else(|problem| panic!("{problem}"))
}

/// A clip's name; for each channel the joint, the interpolation, the bits of its key times, and the keys.
type Contents = (String, Vec<(JointIndex, Interpolation, Vec<u32>, Keys)>);

/// Everything that a file stores of a clip.
fn contents(clip: &Clip) -> Contents {
    let bits = |times: &[f32]| times.iter().map(|secs| secs.to_bits()).collect();
    let channel = |channel: &gaitway_character::anim::Channel| {
        let times = bits(&clip.timelines()[channel.timeline as usize]);
        (channel.joint, channel.interpolation, times, channel.keys.clone())
    };
    (clip.name().to_owned(), clip.channels().iter().map(channel).collect())
}

/// Every kind of channel, some with the same key times.
fn clip_of_all_kinds(asset: &Asset) -> Clip {
    let joint = JointIndex(0);
    let mut builder = ClipBuilder::new("all kinds", &asset.skeleton);
    let mut add = |interpolation, times: &[f32], keys| {
        builder.channel(joint, interpolation, times, keys).expect("a good channel");
    };
    let turns = [Quat::from_rotation_x(0.3), -Quat::from_rotation_y(1.1), Quat::from_xyzw(0.1, 0.2, 0.3, 0.92736185)];
    add(Interpolation::Linear, &[0.0, 0.1, 0.3], Keys::Rotation(turns.to_vec()));
    add(Interpolation::Step, &[0.0, 0.1, 0.3], Keys::Translation(vec![Vec3::X, Vec3::NEG_Y * 1e-20, Vec3::MAX]));
    let spline: Vec<Vec3> = (0..6).map(|index| Vec3::splat(index as f32 / 7.0)).collect();
    add(Interpolation::CubicSpline, &[0.25, 0.5], Keys::Scale(spline));
    if asset.skeleton.morph_range(joint).len() == 2 {
        add(Interpolation::Linear, &[0.0], Keys::MorphWeights { values: vec![0.25, 0.75], targets: 2 });
    }
    builder.build()
}

fn morphing_triangle() -> Build {
    let mut build = Build::triangle();
    build.accessor(F32, "VEC3", 3, &floats(&[0.5; 9]));
    build.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 1 }, { "POSITION": 1 }]);
    build
}

#[test]
fn added_clips_load_bit_by_bit_after_the_models_own() {
    let mut build = Build::animated("translation", &[0.0, 1.0, 2.0], "VEC3", 3, &[0.5; 9]);
    build.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 0 }, { "POSITION": 0 }]);
    let files = one("model.glb", build.glb());
    let asset = load(&files).expect("readable");
    let clip = clip_of_all_kinds(&asset);
    let written = write_model(&files, "model.glb", &asset.skeleton, &[&clip, &clip]).expect("writable");
    let json = json_of(&written);
    let again = loaded(written);
    assert_eq!(again.clips.len(), 3);
    assert_eq!(contents(&again.clips[0]), contents(&asset.clips[0]));
    assert_eq!(contents(&again.clips[1]), contents(&clip));
    assert_eq!(contents(&again.clips[2]), contents(&clip));
    // Three distinct lists of key times and four of values for each of the two; the first list serves two channels.
    let accessors = json["accessors"].as_array().expect("accessors");
    assert_eq!(accessors.len(), 3 + 2 * (3 + 4));
    let samplers = &json["animations"][1]["samplers"];
    assert_eq!((&samplers[0]["input"], &samplers[1]["input"]), (&json!(3), &json!(3)));
    assert_eq!((&accessors[3]["min"], &accessors[3]["max"]), (&json!([0.0]), &json!([f64::from(0.3_f32)])));
}

/// §3.11 asks for two keys of a spline; a trimmed one may keep a single one.
#[test]
fn a_spline_with_one_key_is_written_as_a_step() {
    let files = one("model.glb", morphing_triangle().glb());
    let asset = load(&files).expect("readable");
    let mut builder = ClipBuilder::new("still", &asset.skeleton);
    let keys = Keys::Translation(vec![Vec3::ONE, Vec3::X, Vec3::NEG_ONE]);
    builder.channel(JointIndex(0), Interpolation::CubicSpline, &[0.0], keys).expect("valid");
    let keys = Keys::MorphWeights { values: vec![9.0, 9.0, 0.25, 0.75, 9.0, 9.0], targets: 2 };
    builder.channel(JointIndex(0), Interpolation::CubicSpline, &[0.0], keys).expect("valid");
    let written = write_model(&files, "model.glb", &asset.skeleton, &[&builder.build()]).expect("writable");
    let again = loaded(written);
    let channels = again.clips[0].channels();
    assert!(channels.iter().all(|channel| channel.interpolation == Interpolation::Step), "{channels:?}");
    assert_eq!(channels[0].keys, Keys::Translation(vec![Vec3::X]));
    assert_eq!(channels[1].keys, Keys::MorphWeights { values: vec![0.25, 0.75], targets: 2 });
}

#[test]
fn nothing_of_the_original_is_lost() {
    let text = r#"{ "extras": {"z": 1, "a": [1.0000000000000000000001, 1E+2, -0.0, 12345678901234567890123]},
        "nodes":[{"name":"tab\u0009","translation":[ 0.10, 2e-1, 3 ],"extras":{"matrix":null}}, {"extensions":{"NOBODY_knows":{"it":7}}}],
        "asset":{"version":"2.0","copyright":"me"}, "extensionsUsed":["NOBODY_knows"],
        "buffers":[{"name":"all","byteLength":5,"extras":[]}],
        "extensions":{"NOBODY_knows":{"buffer":0}} }"#;
    let files = one("model.glb", glb(text.as_bytes(), &[1, 2, 3, 4, 5]));
    let asset = load(&files).expect("readable");
    let clip = clip_of_all_kinds(&asset);
    let written = write_model(&files, "model.glb", &asset.skeleton, &[&clip]).expect("writable");
    let (json, binary) = chunks_of(&written);
    assert!(binary.starts_with(&[1, 2, 3, 4, 5]));
    for kept in [
        r#""extras":{"z": 1, "a": [1.0000000000000000000001, 1E+2, -0.0, 12345678901234567890123]}"#,
        r#"{"name":"tab\u0009","translation":[ 0.10, 2e-1, 3 ],"extras":{"matrix":null}}"#,
        r#""extensions":{"NOBODY_knows":{"buffer":0}}"#,
        r#"{"name":"all","byteLength":"#,
    ] {
        assert!(json.contains(kept), "no {kept} in {json}");
    }
    // In the original order, new members last.
    let keys = "extras nodes asset extensionsUsed buffers extensions accessors bufferViews animations";
    let root: serde_json::Map<String, Value> = serde_json::from_str(&json).expect("JSON");
    assert_eq!(root.keys().map(String::as_str).collect::<Vec<_>>().join(" "), keys);
    assert_eq!(root["buffers"][0]["byteLength"], json!(binary.len()));
    // With nothing to add, the bytes are the same.
    let same = write_model(&files, "model.glb", &asset.skeleton, &[]).expect("writable");
    assert_eq!(Some(&same[..]), files.get("model.glb").map(|bytes| &bytes[..]));
}

#[test]
fn a_gltf_with_its_files_becomes_one_glb() {
    let data = |kind: &str, bytes: &[u8]| {
        use base64::Engine;
        format!("data:{kind};base64,{}", base64::engine::general_purpose::STANDARD.encode(bytes))
    };
    let mut build =
        Build::skinned([0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0], [1.0, 0.0, 0.0, 0.0].repeat(3).try_into().expect("12"));
    let (json, bytes) = (&mut build.json, build.bytes.clone());
    // Three buffers: positions in a file that is longer than needed, the rest in another and in a data URI.
    let ends: Vec<(usize, usize)> = (0..3)
        .map(|view| {
            (json["bufferViews"][view]["byteOffset"].as_u64(), json["bufferViews"][view]["byteLength"].as_u64())
        })
        .map(|(offset, length)| (offset.expect("a number") as usize, length.expect("a number") as usize))
        .collect();
    let slice = |view: usize| bytes[ends[view].0..ends[view].0 + ends[view].1].to_vec();
    let shifted = [vec![9, 9, 9, 9], slice(1), vec![7]].concat();
    json["bufferViews"] = json!([
        { "buffer": 0, "byteLength": 36 },
        { "buffer": 1, "byteOffset": 4, "byteLength": 12, "extras": "kept" },
        { "buffer": 2, "byteLength": 48 },
    ]);
    json["buffers"] = json!([
        { "uri": "a%20b.bin", "byteLength": 36 },
        { "uri": "sub/second.bin", "byteLength": 17 },
        { "uri": data("application/octet-stream", &slice(2)), "byteLength": 48 },
    ]);
    json["images"] = json!([
        { "uri": "picture.png", "name": "p" },
        { "uri": data("image/png", PNG) },
        { "uri": "missing.png" },
    ]);
    let mut files = one("model.gltf", json.to_string().into_bytes());
    files.insert("a b.bin", [slice(0), vec![5; 9]].concat());
    files.insert("sub/second.bin", shifted);
    files.insert("picture.png", PNG.to_vec());
    let asset = load(&files).expect("readable");
    let clip = clip_of_all_kinds(&asset);
    for clips in [vec![], vec![&clip]] {
        let written = write_model(&files, "model.gltf", &asset.skeleton, &clips).expect("writable");
        let (_, binary) = chunks_of(&written);
        assert!(binary.starts_with(&slice(0)));
        let json = json_of(&written);
        assert_eq!((json["buffers"].as_array().map(Vec::len), &json["buffers"][0]["uri"]), (Some(1), &Value::Null));
        assert_eq!((&json["bufferViews"][1]["extras"], &json["images"][0]["name"]), (&json!("kept"), &json!("p")));
        assert_eq!(json["images"][2], json!({ "uri": "missing.png" }));
        assert_eq!(json["images"][1]["mimeType"], json!("image/png"));
        let again = loaded(written);
        assert_eq!(again.meshes[0].primitives[0].positions, asset.meshes[0].primitives[0].positions);
        assert_eq!(again.meshes[0].primitives[0].influences, asset.meshes[0].primitives[0].influences);
        for (image, old) in again.images.iter().zip(&asset.images) {
            assert_eq!((&image.bytes, image.mime), (&old.bytes, old.mime));
        }
        assert_eq!(again.clips.len(), clips.len());
    }
}

#[test]
fn buffers_that_extensions_refer_to_stay_separate() {
    let mut build = Build::triangle();
    build.json["bufferViews"].as_array_mut().expect("views").push(json!({
        "buffer": 1, "byteLength": 4, "extensions": { "NOBODY_compresses": { "buffer": 2, "byteLength": 4 } },
    }));
    build.json["buffers"] = json!([
        { "uri": "a.bin", "byteLength": 36 }, { "byteLength": 4 }, { "uri": "b.bin", "byteLength": 4 },
    ]);
    let mut files = one("model.gltf", build.json.to_string().into_bytes());
    files.insert("a.bin", build.bytes);
    files.insert("b.bin", vec![1, 2, 3, 4]);
    let json = json_of(&convert(&files, &LoadOptions::default()).expect("writable"));
    assert_eq!(json["buffers"][1], json!({ "byteLength": 4 }));
    assert_eq!(json["buffers"][2]["uri"], json!("data:application/octet-stream;base64,AQIDBA=="));
    assert_eq!(json["bufferViews"][1]["extensions"]["NOBODY_compresses"]["buffer"], json!(2));
}

#[test]
fn an_animated_matrix_becomes_trs() {
    let matrix = Mat4::from_scale_rotation_translation(Vec3::new(1.0, 2.0, 3.0), Quat::from_rotation_x(0.5), Vec3::ONE);
    let mut build = Build::triangle();
    build.json["nodes"] =
        json!([{ "name": "a", "matrix": matrix.to_cols_array(), "mesh": 0 }, { "matrix": matrix.to_cols_array() }]);
    let files = one("model.glb", build.glb());
    let asset = load(&files).expect("readable");
    let clip = clip_of_all_kinds(&asset);
    let written = write_model(&files, "model.glb", &asset.skeleton, &[&clip]).expect("writable");
    let json = json_of(&written);
    let keys: Vec<&String> = json["nodes"][0].as_object().expect("a node").keys().collect();
    assert_eq!(keys, ["name", "translation", "rotation", "scale", "mesh"]);
    assert_eq!(json["nodes"][1], json_of(files.get("model.glb").expect("there"))["nodes"][1]);
    assert_eq!(loaded(written).skeleton.rest(), asset.skeleton.rest());
}

#[test]
fn written_channels_are_unique_and_valid() {
    let asset = Build::triangle().load().expect("readable");
    let mut builder = ClipBuilder::new("", &asset.skeleton);
    for far in [1.0, 2.0] {
        let keys = Keys::Translation(vec![Vec3::X * far]);
        builder.channel(JointIndex(0), Interpolation::Linear, &[0.0], keys).expect("a good channel");
    }
    let turns = vec![Quat::from_xyzw(0.0, 0.0, 0.0, 2.0), Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)];
    builder.channel(JointIndex(0), Interpolation::Step, &[0.0, 1.0], Keys::Rotation(turns)).expect("a good channel");
    let clip = builder.build();
    let written = write_motion(&asset, &asset.skeleton, &[&clip]).expect("writable");
    assert_eq!(json_of(&written)["animations"][0].get("name"), None);
    let again = loaded(written);
    let keys: Vec<Keys> = again.clips[0].channels().iter().map(|channel| channel.keys.clone()).collect();
    assert_eq!(keys, [Keys::Translation(vec![Vec3::X * 2.0]), Keys::Rotation(vec![Quat::IDENTITY; 2])]);
    let named = asset.skeleton.with_names([(0, "Hips")].into_iter());
    assert_eq!(json_of(&write_motion(&asset, &named, &[&clip]).expect("writable"))["nodes"][0]["name"], "Hips");
}

#[test]
fn unwritable_input_is_an_error() {
    let files = one("model.glb", Build::triangle().glb());
    let asset = load(&files).expect("readable");
    let empty = ClipBuilder::new("empty", &asset.skeleton).build();
    let error = write_model(&files, "model.glb", &asset.skeleton, &[&empty]).unwrap_err();
    assert_eq!(error, WriteError::EmptyClip { clip: "empty".to_owned() });
    let mut builder = ClipBuilder::new("bad", &asset.skeleton);
    let keys = Keys::Scale(vec![Vec3::NAN]);
    builder.channel(JointIndex(0), Interpolation::Linear, &[0.0], keys).expect("values are not checked there");
    let error = write_motion(&asset, &asset.skeleton, &[&builder.build()]).unwrap_err();
    assert_eq!(error, WriteError::NotFinite { clip: "bad".to_owned(), joint: "#0".to_owned() });
    let other = load(&one("walk.bvh", TWO_JOINTS.into())).expect("readable");
    let error = write_model(&files, "model.glb", &other.skeleton, &[]).unwrap_err();
    assert!(matches!(error, WriteError::OtherSkeleton { nodes: 1, joints: 2, .. }), "{error}");
    let error = write_model(&files, "other.glb", &asset.skeleton, &[]).unwrap_err();
    assert_eq!(error.to_string(), "“other.glb” is not among the files (model.glb)");
    let error = load_named(&files, "other.glb", &LoadOptions::default()).unwrap_err();
    assert!(matches!(&error, LoadError::NoSuchFile { name, .. } if name == "other.glb"), "{error}");
}

/// Nothing can be read from such a buffer, so it is left unchanged; additions get their own buffer.
#[test]
fn a_first_buffer_without_data_stays_without() {
    let text =
        br#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":4},{"byteLength":1,"uri":"data:,a"}],"nodes":[{}],
        "bufferViews":[{"buffer":0,"byteLength":4},{"buffer":1.0,"byteLength":1,"extensions":{"ANY":{"buffer":0}}}],
        "images":[{"uri":"skin.tga"}]}"#;
    let mut files = one("model.gltf", text.to_vec());
    let empty = convert(&files, &LoadOptions::default()).expect("writable");
    assert_eq!((&json_of(&empty)["buffers"][0], chunks_of(&empty).1), (&json!({ "byteLength": 4 }), &[][..]));
    files.insert("skin.tga", *b"an image");
    let asset = load(&files).expect("readable");
    let clip = clip_of_all_kinds(&asset);
    let written = write_model(&files, "model.gltf", &asset.skeleton, &[&clip]).expect("writable");
    let json = json_of(&written);
    assert_eq!(json["buffers"][0], json!({ "byteLength": chunks_of(&written).1.len() }));
    assert_eq!(json["buffers"][1], json!({ "byteLength": 4 }));
    let buffers: Vec<_> = json["bufferViews"].as_array().expect("views").iter().map(|view| &view["buffer"]).collect();
    assert_eq!(buffers, [1, 2, 0, 0]);
    assert_eq!(json["bufferViews"][1]["extensions"]["ANY"]["buffer"], 1);
    assert_eq!(contents(&loaded(written).clips[0]), contents(&clip));
}

/// Even if nothing here can decode it: the GLB may travel without the original file.
#[test]
fn images_of_all_kinds_are_embedded() {
    let ktx2 = b"\xABKTX 20\xBB\r\n\x1A\n rest";
    let text = br#"{"asset":{"version":"2.0"},"images":[{"uri":"a.tga"},{"uri":"b"},{"uri":"c.ktx2"}],
        "textures":[{"source":0},{"source":2}]}"#;
    let mut files = one("model.gltf", text.to_vec());
    for (name, bytes) in [("a.tga", &b"a"[..]), ("b", b"b"), ("c.ktx2", ktx2)] {
        files.insert(name, bytes);
    }
    let json = json_of(&convert(&files, &LoadOptions::default()).expect("writable"));
    let images = json["images"].as_array().expect("images");
    assert!(images.iter().all(|image| image["uri"].is_null() && image["bufferView"].is_u64()), "{json}");
    let kinds: Vec<_> = images.iter().map(|image| image["mimeType"].as_str().expect("a type")).collect();
    assert_eq!(kinds, ["image/x-tga", "application/octet-stream", "image/ktx2"]);
    // Only readers that know the extension treat an image inside a GLB as KTX2.
    assert_eq!(json["textures"][0], json!({ "source": 0 }));
    assert_eq!(json["textures"][1], json!({ "extensions": { "KHR_texture_basisu": { "source": 2 } } }));
    assert_eq!(json["extensionsUsed"], json!(["KHR_texture_basisu"]));
}

#[test]
fn a_skeleton_and_its_clip() {
    let mut build = morphing_triangle();
    // The child precedes its parent in the file.
    build.json["nodes"] = json!([
        { "mesh": 0, "name": "child", "scale": [1, 1, 2] },
        { "name": "root", "children": [2, 0], "rotation": [0, 1, 0, 0] },
        { "translation": [0, 0, 3] },
    ]);
    build.json["scenes"] = json!([{ "name": "other" }, { "nodes": [1] }]);
    build.json["scene"] = json!(1);
    let asset = build.load().expect("readable");
    let clip = clip_of_all_kinds(&asset);
    let written = write_motion(&asset, &asset.skeleton, &[&clip]).expect("writable");
    let json = json_of(&written);
    assert_eq!(json["nodes"][0], json!({ "name": "child", "scale": [1.0, 1.0, 2.0] }));
    assert_eq!(json["nodes"][1], json!({ "name": "root", "rotation": [0.0, 1.0, 0.0, 0.0], "children": [0, 2] }));
    assert_eq!((&json["scene"], &json["scenes"]), (&json!(1), &json!([{ "name": "other" }, { "nodes": [1] }])));
    let again = loaded(written);
    for source in 0..3 {
        let (old, new) = (asset.skeleton.joint_of_source(source), again.skeleton.joint_of_source(source));
        let (old, new) = (old.expect("a joint"), new.expect("a joint"));
        assert_eq!(again.skeleton.name(new), asset.skeleton.name(old));
        assert_eq!(again.skeleton.rest().local(new), asset.skeleton.rest().local(old));
    }
    // Morph weights need the mesh, which is left out. (Joint 0 of both is the root, the only one that the clip
    // animates.)
    assert_eq!(contents(&again.clips[0]), contents(&clip));
    assert!(again.meshes.is_empty());
}

#[test]
fn bvh_as_glb() {
    let files = one("walk.bvh", TWO_JOINTS.into());
    let asset = load(&files).expect("readable");
    let again = loaded(convert(&files, &LoadOptions::default()).expect("writable"));
    assert_eq!(contents(&again.clips[0]), contents(&asset.clips[0]));
    assert_eq!(again.skeleton.rest(), asset.skeleton.rest());
    assert_eq!((again.skeleton.name(JointIndex(1)), again.clips[0].name()), ("leg", "walk"));
}

/// Members of `old` that `new` lacks or has changed. Arrays may grow: only the old elements are compared.
fn lost(old: &Value, new: &Value) -> Vec<String> {
    let old = old.as_object().expect("an object");
    let same = |key: &str, value: &Value| match key {
        "buffers" => {
            let without_length = |value: &Value| {
                let mut buffer = value[0].clone();
                buffer["byteLength"] = Value::Null;
                buffer
            };
            without_length(value) == without_length(&new[key])
        }
        "accessors" | "bufferViews" | "animations" => {
            let (old, new) = (value.as_array().expect("an array"), new[key].as_array().expect("an array"));
            new.starts_with(old)
        }
        _ => new.get(key) == Some(value),
    };
    old.iter().filter(|(key, value)| !same(key, value)).map(|(key, _)| key.clone()).collect()
}

#[test]
fn real_models_lose_nothing() {
    let Some(data) = data_folder() else { return };
    let mut paths = Vec::new();
    for folder in ["asset-generator/Positive", "khronos", "threejs", "misc", "vrm", "blender-io", "cosc422", "kaykit"] {
        models_under(&data.join(folder), &GLTF, &mut paths);
    }
    let (mut written_files, mut with_clips) = (0, 0);
    for path in &paths {
        let files = file_set(path);
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let Ok(asset) = load(&files) else { continue };
        written_files += 1;
        let own: Vec<&Clip> = asset.clips.iter().filter(|clip| !clip.channels().is_empty()).take(2).collect();
        let written = match write_model(&files, &name, &asset.skeleton, &own) {
            Ok(written) => written,
            Err(problem) => panic!("{name}: {problem}"),
        };
        let original = files.get(&name).expect("read").clone();
        let new = json_of(&written);
        if original.starts_with(b"glTF") {
            let (old, binary) = (json_of(&original), chunks_of(&original).1);
            let moved_matrix = own.iter().any(|clip| {
                clip.channels()
                    .iter()
                    .any(|channel| old["nodes"][asset.skeleton.source_index(channel.joint)].get("matrix").is_some())
            });
            let lost = lost(&old, &new);
            assert!(lost.is_empty() || (moved_matrix && lost == ["nodes"]), "{name}: {lost:?} changed");
            assert!(chunks_of(&written).1.starts_with(binary), "{name}: the buffer changed");
        }
        let again = loaded(written);
        assert_eq!(again.clips.len(), asset.clips.len() + own.len(), "{name}");
        for (old, new) in asset.clips.iter().chain(own.iter().copied()).zip(&again.clips) {
            with_clips += 1;
            if !all_unit(old) {
                continue;
            }
            assert_eq!(last_of_each(old), last_of_each(new), "{name}: clip “{}”", old.name());
        }
        assert_eq!(again.skeleton.rest(), asset.skeleton.rest(), "{name}");
        assert_eq!(again.meshes.len(), asset.meshes.len(), "{name}");
        for (old, new) in asset.meshes.iter().zip(&again.meshes) {
            for (old, new) in old.primitives.iter().zip(&new.primitives) {
                assert_eq!((&old.positions, &old.indices), (&new.positions, &new.indices), "{name}");
            }
        }
        for (old, new) in asset.images.iter().zip(&again.images) {
            assert_eq!((&old.bytes, old.mime), (&new.bytes, new.mime), "{name}");
        }
    }
    println!("{written_files} models, {with_clips} clips");
    assert!(written_files > 100 && with_clips > 200, "{written_files} models, {with_clips} clips");
}

/// Whether all rotations are unit quaternions already.
fn all_unit(clip: &Clip) -> bool {
    clip.channels().iter().all(|channel| match &channel.keys {
        Keys::Rotation(keys) => keys.iter().all(|key| (key.length_squared() - 1.0).abs() <= 1e-5),
        _ => true,
    })
}

/// [`contents`] of the channels that are written: the last one per property.
fn last_of_each(clip: &Clip) -> Contents {
    let (name, mut channels) = contents(clip);
    let keys: Vec<_> = channels.iter().map(|channel| (channel.0, channel.3.property())).collect();
    let mut index = 0;
    channels.retain(|_| {
        index += 1;
        !keys[index..].contains(&keys[index - 1])
    });
    (name, channels)
}

#[test]
fn real_bvh_as_glb() {
    let Some(data) = data_folder() else { return };
    let mut paths = Vec::new();
    models_under(&data.join("bvh"), &["bvh"], &mut paths);
    for path in paths {
        let mut files = FileSet::default();
        files.insert(path.file_name().expect("a name").to_string_lossy(), std::fs::read(&path).expect("readable"));
        let asset = load(&files).unwrap_or_else(|problem| panic!("{problem}"));
        let again = loaded(convert(&files, &LoadOptions::default()).expect("writable"));
        assert_eq!(contents(&again.clips[0]), contents(&asset.clips[0]), "{}", path.display());
        assert_eq!(again.skeleton.rest(), asset.skeleton.rest(), "{}", path.display());
    }
}

#[test]
fn a_name_in_another_encoding_is_read_and_written() {
    // “é” in Latin-1, which is not UTF-8.
    let json =
        b"{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [{\"name\": \"Andr\xE9\"}], \"scenes\": [{\"nodes\": [0]}]}";
    let files = one("model.gltf", json.to_vec());
    let asset = load(&files).expect("loads");
    assert_eq!(asset.skeleton.name(JointIndex(0)), "Andr\u{FFFD}");
    let mut clip = ClipBuilder::new("Nod", &asset.skeleton);
    clip.channel(JointIndex(0), Interpolation::Linear, &[0.0, 1.0], Keys::Translation(vec![Vec3::ZERO, Vec3::Y]))
        .expect("two keys");
    let written = write_model(&files, "model.gltf", &asset.skeleton, &[&clip.build()]).expect("writable");
    assert_eq!(load(&one("model.glb", written)).expect("loads").clips[0].name(), "Nod");
}
