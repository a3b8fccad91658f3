//! Warnings and lints of whole models, and where they lead.

use gaitway_character::asset::{Asset, AssetParts, Warning};
use gaitway_scene::library::{Model, inspect};
use serde_json::Value;

use crate::data::walker;

fn codes(model: &Model) -> Vec<&str> {
    model.findings().iter().map(|finding| finding.warning.code()).collect()
}

/// The walker with each left joint named right and the other way round.
fn with_swapped_names() -> Model {
    let library = walker();
    let asset = &library.active().expect("a model").asset;
    let swapped = |name: &str| match (name.strip_prefix("Left"), name.strip_prefix("Right")) {
        (Some(rest), _) => format!("Right{rest}"),
        (_, Some(rest)) => format!("Left{rest}"),
        _ => name.to_owned(),
    };
    let names: Vec<(usize, String)> = asset
        .skeleton
        .joints()
        .map(|joint| (asset.skeleton.source_index(joint), swapped(asset.skeleton.name(joint))))
        .collect();
    let names = names.iter().map(|(number, name)| (*number, name.as_str()));
    let parts = AssetParts {
        skeleton: asset.skeleton.with_names(names),
        skins: asset.skins.clone(),
        meshes: asset.meshes.clone(),
        instances: asset.instances.clone(),
        materials: asset.materials.clone(),
        ..AssetParts::default()
    };
    Model::new("walker".to_owned(), Asset::new(parts).expect("indices in range"), Vec::new())
}

#[test]
fn the_walker_is_free_of_lints() {
    assert_eq!(codes(walker().active().expect("a model")), Vec::<&str>::new());
}

#[test]
fn names_on_the_wrong_side_are_found() {
    let model = with_swapped_names();
    assert_eq!(codes(&model), ["side-names"]);
    let finding = &model.findings()[0];
    let name = finding.joint.map(|joint| model.asset.skeleton.name(joint));
    assert!(name.is_some_and(|name| name.starts_with("Left") || name.starts_with("Right")), "{finding:?}");
}

#[test]
fn the_inspect_document_has_the_readers_warnings_first_and_then_lints() {
    let mut model = with_swapped_names();
    let asset = std::sync::Arc::get_mut(&mut model.asset).expect("nobody else has it");
    asset.warnings.push(Warning::MatrixNotDecomposable { node: "nodes[4]".to_owned() });
    let document = inspect(&model, &[]);
    let warnings: Vec<[&str; 2]> = document["warnings"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|warning| [&warning["code"], &warning["where"]].map(|text| text.as_str().expect("text")))
        .collect();
    assert_eq!(warnings[0], ["matrix-not-decomposable", "nodes[4]"]);
    assert_eq!((warnings.len(), warnings[1][0]), (2, "side-names"));
    assert!(warnings[1][1].starts_with("nodes["), "{}", warnings[1][1]);
    assert_ne!(document["warnings"][1]["message"], Value::Null);
    let joint = model.findings()[0].joint.map(|joint| model.asset.skeleton.source_index(joint));
    assert_eq!(joint, Some(4));
}
