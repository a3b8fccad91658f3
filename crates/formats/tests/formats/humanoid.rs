//! Humanoid bones that a file declares.

use gaitway_character::asset::{Asset, Slot};
use gaitway_formats::load;
use serde_json::{Value, json};

use crate::build_gltf::Build;
use crate::data_folder::data_folder;
use crate::file_set::file_set;

fn with_extension(name: &str, extension: Value) -> Asset {
    let mut build = Build::triangle();
    build.json["nodes"] = json!([{ "name": "a", "children": [1] }, { "name": "b", "children": [2] }, { "name": "c" }]);
    build.json["extensionsUsed"] = json!([name]);
    build.json["extensions"] = json!({ name: extension });
    build.loaded()
}

fn joint_name(asset: &Asset, slot: Slot) -> &str {
    let humanoid = asset.humanoid.as_ref().expect("a humanoid");
    humanoid.joint(slot).map_or("none", |joint| asset.skeleton.name(joint))
}

#[test]
fn bones_of_vrm_1_and_its_animations() {
    for (extension, format) in [("VRMC_vrm", "vrm"), ("VRMC_vrm_animation", "vrma")] {
        let bones =
            json!({ "hips": { "node": 1 }, "leftThumbMetacarpal": { "node": 2 }, "leftThumbProximal": { "node": 0 } });
        let asset = with_extension(extension, json!({ "humanoid": { "humanBones": bones } }));
        assert_eq!(asset.format, format);
        assert_eq!(joint_name(&asset, Slot::Hips), "b");
        assert_eq!(joint_name(&asset, Slot::LeftThumbMetacarpal), "c");
        assert_eq!(joint_name(&asset, Slot::LeftThumbProximal), "a");
        assert!(asset.warnings.is_empty(), "{:?}", asset.warnings);
    }
}

#[test]
fn vrm_0_thumbs_are_renamed() {
    let bones = json!([
        { "bone": "hips", "node": 0 },
        { "bone": "leftThumbProximal", "node": 1 },
        { "bone": "leftThumbIntermediate", "node": 2 },
        { "bone": "jaw", "node": -1 },
    ]);
    let asset = with_extension("VRM", json!({ "humanoid": { "humanBones": bones } }));
    assert_eq!(asset.format, "vrm");
    assert_eq!(joint_name(&asset, Slot::Hips), "a");
    assert_eq!(joint_name(&asset, Slot::LeftThumbMetacarpal), "b");
    assert_eq!(joint_name(&asset, Slot::LeftThumbProximal), "c");
    assert_eq!(joint_name(&asset, Slot::Jaw), "none");
    assert!(asset.warnings.is_empty(), "{:?}", asset.warnings);
}

#[test]
fn invalid_bones_are_skipped_with_a_warning() {
    let invalid = [
        json!({ "hips": { "node": 1 }, "tail": { "node": 2 } }),
        json!({ "hips": { "node": 1 }, "spine": { "node": 3 } }),
        json!({ "hips": { "node": 1 }, "spine": { "node": "b" } }),
        json!({ "hips": { "node": 1 }, "spine": 2 }),
        json!({ "hips": { "node": 1 }, "spine": { "node": 1e300 } }),
    ];
    for bones in invalid {
        let asset = with_extension("VRMC_vrm", json!({ "humanoid": { "humanBones": bones } }));
        assert_eq!(joint_name(&asset, Slot::Hips), "b");
        let codes: Vec<_> = asset.warnings.iter().map(|warning| warning.code()).collect();
        assert_eq!(codes, ["humanoid-bone-ignored"], "{bones}");
    }
    let twice = json!([{ "bone": "hips", "node": 0 }, { "bone": "hips", "node": 1 }]);
    let asset = with_extension("VRM", json!({ "humanoid": { "humanBones": twice } }));
    assert_eq!((joint_name(&asset, Slot::Hips), asset.warnings.len()), ("a", 1));
    for nothing in [json!({}), json!([]), json!({ "humanoid": 3 }), json!({ "humanoid": { "humanBones": 7 } })] {
        assert_eq!(with_extension("VRMC_vrm", nothing.clone()).humanoid, None);
        assert_eq!(with_extension("VRM", nothing).humanoid, None);
    }
}

#[test]
fn real_avatars_have_all_their_bones() {
    let Some(data) = data_folder() else { return };
    let cases = [
        ("vrm0_cryptovoxels.vrm", 43, "vrm"),
        ("vrm0_EmissionMigration_v0.107.0.vrm", 52, "vrm"),
        ("vrm1_VRMC_materials_mtoon_UV_Animation_Test.vrm", 53, "vrm"),
        ("vrm1_VRMC_vrm_expressions_isBinary_Overridden.vrm", 22, "vrm"),
        ("three-vrm_test.vrma", 51, "vrma"),
        ("chatvrm_idle_loop.vrma", 22, "vrma"),
    ];
    for (name, bones, format) in cases {
        let asset = load(&file_set(&data.join("vrm").join(name))).unwrap_or_else(|problem| panic!("{problem}"));
        let found = asset.humanoid.as_ref().map(|humanoid| humanoid.0.len());
        assert_eq!((found, asset.format), (Some(bones), format), "{name}");
        assert!(asset.warnings.iter().all(|warning| warning.code() != "humanoid-bone-ignored"), "{name}");
    }
}
