//! A model's own clips in a written copy of its file: renamed, and left out with their keys.

use std::collections::BTreeSet;

use gaitway_character::anim::{Clip, Keys};
use gaitway_character::asset::Asset;
use gaitway_formats::{FileSet, OwnClips, load, write_edited_model};
use serde_json::json;

use crate::build_gltf::{Build, F32, floats, one};

const NAMES: [&str; 3] = ["first", "second", "third"];

/// The triangle with three clips of different lengths; the accessors of a second mesh are between those of the clips, and the first
/// two clips share their key times.
fn three_clips() -> Build {
    let mut build = Build::triangle();
    let times = build.accessor(F32, "SCALAR", 2, &floats(&[0.0, 1.0]));
    let mut animations = Vec::new();
    for (index, name) in NAMES.into_iter().enumerate() {
        let count = 2 + index / 2;
        let input = match index {
            2 => build.accessor(F32, "SCALAR", 3, &floats(&[0.0, 1.0, 3.0])),
            _ => times,
        };
        let keys: Vec<f32> = (0..3 * count).map(|number| (100 * index + number) as f32).collect();
        let output = build.accessor(F32, "VEC3", count, &floats(&keys));
        if index == 0 {
            let positions = build.accessor(F32, "VEC3", 3, &floats(&[0.0, 0.0, 5.0, 1.0, 0.0, 5.0, 0.0, 1.0, 5.0]));
            build.json["meshes"] = json!([
                { "primitives": [{ "attributes": { "POSITION": 0 } }] },
                { "primitives": [{ "attributes": { "POSITION": positions } }] },
            ]);
            build.json["nodes"] = json!([{ "mesh": 0 }, { "mesh": 1 }]);
        }
        animations.push(json!({
            "name": name,
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }],
            "samplers": [{ "input": input, "output": output }],
        }));
    }
    build.json["animations"] = json!(animations);
    build
}

fn without(left_out: &[usize]) -> OwnClips {
    OwnClips { left_out: left_out.iter().copied().collect(), ..OwnClips::default() }
}

/// The written file, loaded, and the length of its data.
fn written(files: &FileSet, own: &OwnClips, added: &[&Clip]) -> (Asset, usize) {
    let asset = load(files).expect("a model");
    let name = files.names().next().expect("a file").to_owned();
    let bytes = write_edited_model(files, &name, &asset.skeleton, own, added).expect("is written");
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize;
    // The header of the binary chunk follows the JSON.
    let length = word(20 + word(12));
    (load(&one("written.glb", bytes)).unwrap_or_else(|error| panic!("{error}")), length)
}

fn keys(clip: &Clip) -> Vec<(&[f32], &Keys)> {
    clip.channels().iter().map(|channel| (&*clip.timelines()[channel.timeline as usize], &channel.keys)).collect()
}

fn names(asset: &Asset) -> Vec<&str> {
    asset.clips.iter().map(Clip::name).collect()
}

#[test]
fn clips_that_are_left_out_take_their_keys_with_them() {
    let files = one("model.glb", three_clips().glb());
    let original = load(&files).expect("a model");
    let (_, whole) = written(&files, &OwnClips::default(), &[]);
    for left_out in [&[0][..], &[1], &[2], &[0, 1], &[0, 2], &[1, 2], &[0, 1, 2]] {
        let (asset, length) = written(&files, &without(left_out), &[]);
        let kept: Vec<usize> = (0..3).filter(|index| !left_out.contains(index)).collect();
        assert_eq!(names(&asset), kept.iter().map(|&index| NAMES[index]).collect::<Vec<_>>());
        for (clip, &index) in asset.clips.iter().zip(&kept) {
            assert_eq!(keys(clip), keys(&original.clips[index]), "{left_out:?}");
        }
        for (mesh, before) in asset.meshes.iter().zip(&original.meshes) {
            assert_eq!(mesh.primitives[0].positions, before.primitives[0].positions, "{left_out:?}");
        }
        let outputs: usize = left_out.iter().map(|&index| [24, 24, 36 + 12][index]).sum();
        let shared_times = if left_out.starts_with(&[0, 1]) { 8 } else { 0 };
        assert_eq!(length, whole - outputs - shared_times, "{left_out:?}");
    }
}

#[test]
fn other_clips_are_added_after_those_that_stay() {
    let files = one("model.glb", three_clips().glb());
    let original = load(&files).expect("a model");
    let added = original.clips[1].clone().with_name("again".to_owned());
    let own = OwnClips { names: [(2, "last".to_owned())].into(), left_out: BTreeSet::from([0, 1]) };
    let (asset, _) = written(&files, &own, &[&added]);
    assert_eq!(names(&asset), ["last", "again"]);
    assert_eq!(keys(&asset.clips[0]), keys(&original.clips[2]));
    assert_eq!(keys(&asset.clips[1]), keys(&original.clips[1]));
}

/// Views that meshes and clips share keep their bytes, whichever clips are left out.
#[test]
fn keys_in_a_shared_view_stay() {
    let mut build = three_clips();
    let length = build.bytes.len();
    let offsets: Vec<_> =
        build.json["bufferViews"].as_array().expect("views").iter().map(|view| view["byteOffset"].clone()).collect();
    for accessor in build.json["accessors"].as_array_mut().expect("accessors") {
        let view = accessor["bufferView"].as_u64().expect("an index") as usize;
        accessor["byteOffset"] = json!(offsets[view].as_u64().unwrap_or(0));
        accessor["bufferView"] = json!(0);
    }
    build.json["bufferViews"] = json!([{ "buffer": 0, "byteLength": length }]);
    let files = one("model.glb", build.glb());
    let original = load(&files).expect("a model");
    let (asset, _) = written(&files, &without(&[0, 2]), &[]);
    assert_eq!(names(&asset), ["second"]);
    assert_eq!(keys(&asset.clips[0]), keys(&original.clips[1]));
    assert_eq!(asset.meshes[1].primitives[0].positions, original.meshes[1].primitives[0].positions);
}

/// Extensions may use the accessors of a clip: those of copies, and any whose meaning isn't known.
#[test]
fn keys_that_extensions_use_stay() {
    let mut build = three_clips();
    let length_of = |index: usize| [24, 24, 36][index];
    let output = |build: &Build, clip: usize| build.json["animations"][clip]["samplers"][0]["output"].clone();
    let whole = written(&one("model.glb", three_clips().glb()), &OwnClips::default(), &[]).1;
    build.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing", "ACME_trail", "KHR_materials_unlit"]);
    build.json["nodes"][0]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": output(&build, 0) } } });
    build.json["extensions"] = json!({ "ACME_trail": { "paths": [{ "points": output(&build, 2) }] } });
    build.json["materials"] = json!([{ "extensions": { "KHR_materials_unlit": { "unused": output(&build, 1) } } }]);
    let files = one("model.glb", build.glb());
    let original = load(&files).expect("a model");
    let (asset, length) = written(&files, &without(&[0, 1, 2]), &[]);
    let copies = |asset: &Asset| asset.instances.iter().map(|copy| copy.joint_from_mesh).collect::<Vec<_>>();
    assert_eq!(copies(&asset), copies(&original));
    // Of the third clip, its times go; of the first two, their times and the second one's keys.
    assert_eq!(length, whole - length_of(1) - 8 - 12);
}
