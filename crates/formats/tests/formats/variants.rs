//! KHR_materials_variants: names, the materials of primitives, and invalid mappings.

use gaitway_character::asset::Asset;
use gaitway_formats::{convert, load};
use serde_json::{Value, json};

use crate::build_gltf::{Build, one, warnings};

/// A triangle with the materials white, red and blue, which is white unless a variant says otherwise.
fn triangle(names: &[Value], mappings: Value) -> Build {
    let mut build = Build::triangle();
    let material = |name: &str| json!({ "name": name });
    build.json["materials"] = json!([material("white"), material("red"), material("blue")]);
    build.json["extensionsUsed"] = json!(["KHR_materials_variants"]);
    build.json["extensions"] = json!({ "KHR_materials_variants": { "variants": names } });
    let primitive = &mut build.json["meshes"][0]["primitives"][0];
    primitive["material"] = json!(0);
    primitive["extensions"] = json!({ "KHR_materials_variants": { "mappings": mappings } });
    build
}

fn named(name: &str) -> Value {
    json!({ "name": name })
}

fn read(names: &[Value], mappings: Value) -> (Asset, Vec<String>) {
    let asset = triangle(names, mappings).load().expect("variants never prevent loading");
    let warnings = warnings(&asset);
    (asset, warnings)
}

#[test]
fn a_primitive_has_a_material_per_variant() {
    let mappings = json!([{ "material": 1, "variants": [0, 2] }, { "material": 2, "variants": [1, 2] }]);
    let (asset, warnings) = read(&[named("Red"), named("Blue"), named("Night")], mappings);
    assert_eq!(warnings, [""; 0]);
    assert_eq!(asset.variants, ["Red", "Blue", "Night"]);
    // If two mappings name the same variant, the first one counts.
    let geometry = &asset.meshes[0].primitives[0];
    assert_eq!((geometry.material, &geometry.variants[..]), (Some(0), &[(0, 1), (2, 1), (1, 2)][..]));
}

#[test]
fn every_variant_has_a_unique_name() {
    let (asset, _) = read(&[named("a"), named("a"), json!({}), named(" "), json!(3)], json!([]));
    assert_eq!(asset.variants, ["a", "a (1)", "Variant 2", "Variant 3", "Variant 4"]);
    let (asset, _) = read(&[named("a (2)"), named("a"), named("a")], json!([]));
    assert_eq!(asset.variants, ["a (2)", "a", "a (3)"]);
}

#[test]
fn too_many_variants_are_left_out() {
    let (asset, warnings) = read(&vec![json!({}); 60_000], json!([]));
    assert_eq!(asset.variants.len(), 1024);
    assert!(warnings.len() == 1 && warnings[0].contains("expected at most 1024, found 60000"), "{warnings:?}");
}

#[test]
fn invalid_mappings_are_left_out() {
    let place = "meshes[0].primitives[0].extensions.KHR_materials_variants.mappings";
    for (mapping, at, expected) in [
        (json!({ "material": 9, "variants": [0] }), "[0].material", "expected an index into the 3 materials, found 9"),
        (json!({ "material": "red", "variants": [0] }), "[0].material", "expected an index, found \"red\""),
        (json!({ "variants": [0] }), "[0].material", "expected an index, found null"),
        (json!({ "material": 1 }), "[0].variants", "expected an array of variants"),
        (
            json!({ "material": 1, "variants": [1] }),
            "[0].variants[0]",
            "expected an index into the 1 variants, found 1",
        ),
        (json!({ "material": 1, "variants": [-1] }), "[0].variants[0]", "expected an index, found -1"),
        (json!(7), "[0].material", "expected an index, found null"),
    ] {
        let (asset, warnings) = read(&[named("Red")], json!([mapping, { "material": 2, "variants": [0] }]));
        assert!(
            matches!(&warnings[..], [warning] if warning.contains(&format!("{place}{at}")) && warning.contains(expected)),
            "{mapping}: {warnings:?}"
        );
        assert_eq!(asset.meshes[0].primitives[0].variants, [(0, 2)], "{mapping}");
    }
    let (asset, warnings) = read(&[named("Red")], json!("none"));
    assert!(asset.meshes[0].primitives[0].variants.is_empty() && warnings.len() == 1, "{warnings:?}");
}

#[test]
fn variants_survive_conversion() {
    let mappings = json!([{ "material": 1, "variants": [0] }]);
    let gltf = triangle(&[named("Red")], mappings).gltf("data.bin");
    let mut files = one("model.gltf", gltf);
    files.insert("data.bin", Build::triangle().bytes);
    let written = convert(&files, &Default::default()).expect("a GLB");
    let asset = load(&one("model.glb", written)).expect("readable");
    assert_eq!(
        (&asset.variants[..], &asset.meshes[0].primitives[0].variants[..]),
        (&["Red".to_owned()][..], &[(0, 1)][..])
    );
}
