//! Loading a GLB before its images have arrived.

use gaitway_character::asset::Asset;
use gaitway_formats::{Early, LoadOptions, early, load, load_with};
use serde_json::json;

use crate::build_gltf::{Build, F32, U16, floats, glb, one, shorts};
use crate::data_folder::data_folder;
use crate::examples::{large_image, textured_square};

const AWAITING: LoadOptions = LoadOptions { bvh_unit_metres: None, bvh_z_up: None, awaits_images: true };

/// Feeds as much of a file as is asked for; returns the GLB, and how many bytes that took.
fn arrived(file: &[u8]) -> Option<(Vec<u8>, usize)> {
    let mut length = 0;
    loop {
        match early(&file[..length.min(file.len())])? {
            Early::Ready(glb) => return Some((glb, length)),
            Early::Wait(needed) => {
                assert!(needed > length, "{needed} bytes are there already");
                assert!(needed <= file.len(), "{needed} bytes never arrive");
                assert_eq!(early(&file[..needed - 1]), Some(Early::Wait(needed)), "one byte less isn't enough");
                length = needed;
            }
        }
    }
}

/// Everything that the loader has made of a file but images and warnings.
fn without_images(asset: &Asset) -> String {
    format!(
        "{:?} {:?} {:?} {:?} {:?} {:?} {:?}",
        asset.skeleton, asset.clips, asset.skins, asset.meshes, asset.instances, asset.materials, asset.textures
    )
}

#[test]
fn a_file_that_is_cut_short_or_is_no_glb_has_to_be_complete() {
    assert_eq!(early(b"{}"), None);
    assert_eq!(early(b"glTX"), None);
    assert_eq!(early(b"Kaydara FBX Binary"), None);
    // The lengths are not believed: nothing is allocated for them.
    let mut absurd = large_image().glb();
    absurd[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
    let (small, _) = arrived(&absurd).expect("the images are last");
    assert!(small.len() < 10_000, "{} bytes", small.len());
    absurd[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(early(&absurd), None);
    absurd[8..12].copy_from_slice(&20_u32.to_le_bytes());
    assert_eq!(early(&absurd), None);
    // Without a binary chunk, or with something else in its place.
    let json = br#"{ "asset": { "version": "2.0" } }"#;
    assert_eq!(early(&glb(json, &[])), None);
    let mut other = large_image().glb();
    let kind = 24 + u32::from_le_bytes(other[12..16].try_into().expect("four")) as usize;
    other[kind] ^= 1;
    assert_eq!(early(&other), None);
    assert_eq!(early(&glb(&json[..20], &[0; 200_000])), None);
}

#[test]
fn images_that_are_last_are_not_waited_for() {
    let file = large_image().glb();
    let (glb, needed) = arrived(&file).expect("the images are last");
    assert!(needed < 2000 && glb.len() == needed, "{needed} bytes needed, {} given", glb.len());
    let asset = load_with(&one("model.glb", glb), &AWAITING).expect("all but the images is there");
    let complete = load(&one("model.glb", file)).expect("a good file");
    assert_eq!(without_images(&asset), without_images(&complete));
    assert!(asset.images.len() == 1 && asset.images[0].bytes.is_empty());
    assert!(asset.warnings.is_empty(), "none is reported missing");
    assert!(complete.warnings.is_empty() && !complete.images[0].bytes.is_empty());
}

#[test]
fn images_that_something_follows_are_waited_for() {
    let mut between = large_image();
    between.accessor(F32, "SCALAR", 2, &floats(&[0.0, 1.0]));
    assert_eq!(arrived(&between.glb()), None, "in between");
    let mut first = large_image();
    // The image's view, which is last in the list, comes first in the buffer.
    let length = first.bytes.len();
    for view in first.json["bufferViews"].as_array_mut().expect("a list") {
        let start = view["byteOffset"].as_u64().expect("a number") as usize;
        view["byteOffset"] = json!(if view["byteLength"].as_u64() > Some(100_000) { 0 } else { length + start });
    }
    first.bytes.resize(length + 1000, 0);
    assert_eq!(arrived(&first.glb()), None, "first");
    let sparse = {
        let mut build = large_image();
        let indices = build.view(&shorts(&[0]));
        let values = build.view(&floats(&[0.0; 3]));
        build.json["accessors"][0]["sparse"] = json!({
            "count": 1,
            "indices": { "bufferView": indices, "componentType": U16 },
            "values": { "bufferView": values },
        });
        build
    };
    assert_eq!(arrived(&sparse.glb()), None, "sparse values");
}

#[test]
fn an_image_that_is_also_read_as_numbers_is_waited_for() {
    let image = large_image().json["images"][0]["bufferView"].clone();
    let shared = large_image().with("/accessors/0/bufferView", image.clone());
    assert_eq!(arrived(&shared.glb()), None);
    let sparse =
        json!({ "count": 1, "indices": { "bufferView": image, "componentType": U16 }, "values": { "bufferView": 0 } });
    assert_eq!(arrived(&large_image().with("/accessors/0/sparse", sparse).glb()), None);
}

#[test]
fn only_images_that_take_a_while_are_worth_it() {
    assert_eq!(arrived(&textured_square().glb()), None, "small");
    assert_eq!(arrived(&Build::triangle().glb()), None, "none");
    let external = large_image().with("/images/0", json!({ "uri": "image.png" }));
    assert_eq!(arrived(&external.glb()), None, "in a file of its own");
    let compressed = large_image().with("/extensionsUsed", json!(["EXT_meshopt_compression"]));
    assert_eq!(arrived(&compressed.glb()), None, "a decoder is needed");
}

/// Whatever a real file has, nothing but images and warnings differs once it is complete.
#[test]
fn real_files_are_the_same_without_their_images() {
    let Some(data) = data_folder() else { return };
    let mut found = 0;
    for name in
        ["threejs/Soldier.glb", "khronos/Fox/glTF-Binary/Fox.glb", "khronos/CesiumMan/glTF-Binary/CesiumMan.glb"]
    {
        let file = std::fs::read(data.join(name)).unwrap_or_else(|problem| panic!("{name}: {problem}"));
        let Some((glb, needed)) = arrived(&file) else { continue };
        found += 1;
        assert!(needed + 100_000 < file.len(), "{name}: {needed} of {} bytes", file.len());
        let asset = load_with(&one("model.glb", glb), &AWAITING).unwrap_or_else(|problem| panic!("{name}: {problem}"));
        let complete = load(&one("model.glb", file)).unwrap_or_else(|problem| panic!("{name}: {problem}"));
        assert_eq!(without_images(&asset), without_images(&complete), "{name}");
    }
    assert!(found > 0, "Soldier's images are last");
}
