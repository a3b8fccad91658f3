//! What a set of files is taken for: model, motions, joint map.

use gaitway::files::{Role, SortError, sort};
use gaitway::formats::FileSet;
use gaitway::retarget::MapError;

const BVH: &str = "HIERARCHY\nROOT hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation \
                   Yrotation\n End Site\n {\n OFFSET 0 10 0\n }\n}\nMOTION\nFrames: 2\nFrame Time: 0.1\n0 0 0 0 0 0\n\
                   0 1 0 0 0 0\n";
const MESH: &str = r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0,
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[0,0,0]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],
    "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA"}]}"#;
const SKELETON: &str = r#"{"asset":{"version":"2.0"},"nodes":[{"name":"hips"}]}"#;
const MAP: &str = r#"{"gaitway_map":1,"joints":{"hips":{"source":0}}}"#;

fn set(files: &[(&str, &str)]) -> FileSet {
    let mut set = FileSet::default();
    files.iter().for_each(|(name, text)| set.insert(*name, text.as_bytes()));
    set
}

/// Model, motions and whether there is a map.
fn check(role: Role, files: &[(&str, &str)], expected: (Option<&str>, &[&str], bool)) {
    let sorted = sort(&set(files), role).unwrap_or_else(|error| panic!("{error}"));
    let model = sorted.models.first().map(|(name, _)| name.as_str());
    let motions: Vec<&str> = sorted.motions.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!((model, &motions[..], sorted.map.is_some()), expected, "{role:?}");
}

#[test]
fn what_has_a_mesh_is_the_model() {
    let files = [("a.bvh", BVH), ("m.gltf", MESH), ("map.json", MAP), ("s.gltf", SKELETON), ("package.json", "{}")];
    check(Role::Any, &files, (Some("m.gltf"), &["a.bvh", "s.gltf"], true));
    check(Role::Model, &files, (Some("m.gltf"), &["a.bvh", "s.gltf"], true));
    check(Role::Motion, &files, (None, &["a.bvh", "m.gltf", "s.gltf"], true));
    check(Role::Any, &[("map.json", MAP)], (None, &[], true));
}

#[test]
fn a_motion_alone_is_what_it_was_opened_for() {
    check(Role::Any, &[("a.bvh", BVH)], (None, &["a.bvh"], false));
    check(Role::Model, &[("a.bvh", BVH)], (Some("a.bvh"), &[], false));
    check(Role::Motion, &[("a.bvh", BVH)], (None, &["a.bvh"], false));
}

#[test]
fn several_models_are_several_models() {
    let sorted = sort(&set(&[("m.gltf", MESH), ("a.bvh", BVH), ("n.gltf", MESH)]), Role::Any).unwrap();
    let names: Vec<&str> = sorted.models.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!((&names[..], sorted.motions.len()), (&["m.gltf", "n.gltf"][..], 1));
}

#[test]
fn what_cannot_be_sorted_says_what_to_do() {
    let fails = |role, files: &[(&str, &str)]| match sort(&set(files), role) {
        Ok(sorted) => panic!("{sorted:?}"),
        Err(error) => error,
    };
    let names: Vec<String> = (0..9).map(|index| format!("{index}.gltf")).collect();
    let nine: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), MESH)).collect();
    assert!(matches!(fails(Role::Any, &nine), SortError::TooManyModels { most: 8 }));
    let none = fails(Role::Model, &[("a.bvh", BVH), ("b.bvh", BVH)]);
    assert!(matches!(&none, SortError::NoModel { .. }), "{none}");
    let maps = fails(Role::Any, &[("a.bvh", BVH), ("a.json", MAP), ("b.json", MAP)]);
    assert!(matches!(&maps, SortError::SeveralMaps { .. }), "{maps}");
    let typo = MAP.replace("source", "sauce");
    let bad = fails(Role::Any, &[("a.bvh", BVH), ("map.json", &typo)]);
    assert!(matches!(&bad, SortError::Map { file, problem: MapError::Json { .. } } if file == "map.json"), "{bad}");
    assert!(bad.to_string().contains("sauce"), "{bad}");
    assert!(matches!(fails(Role::Any, &[("notes.txt", "hello")]), SortError::Load(_)));
    let many: Vec<(String, &str)> = (0..65).map(|index| (format!("{index}.bvh"), BVH)).collect();
    let many: Vec<(&str, &str)> = many.iter().map(|(name, text)| (name.as_str(), *text)).collect();
    assert!(matches!(fails(Role::Any, &many), SortError::TooManyMotions { found: 65, .. }));
}
