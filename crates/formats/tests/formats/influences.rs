//! Influences: sets are merged, weights normalized, and changes reported.

use gaitway_character::asset::{Asset, Warning};
use serde_json::json;

use crate::build_gltf::{Build, F32, U8, floats};

fn influences(asset: &Asset, vertex: usize) -> Vec<(u16, f32)> {
    asset.meshes[0].primitives[0].influences.of_vertex(vertex).filter(|&(_, weight)| weight > 0.0).collect()
}

fn warnings(asset: &Asset) -> Vec<Warning> {
    asset.warnings.iter().cloned().collect()
}

/// The triangle with `count` influences per vertex in sets of four, weights falling from joint to joint.
fn many(count: usize) -> Build {
    let mut build = Build::triangle();
    let total: f32 = (1..=count).map(|at| at as f32).sum();
    for set in 0..count.div_ceil(4) {
        let (mut joints, mut weights) = (Vec::new(), Vec::new());
        for _vertex in 0..3 {
            for at in 4 * set..4 * set + 4 {
                joints.push(if at < count { at as u8 } else { 0 });
                weights.push(if at < count { (count - at) as f32 / total } else { 0.0 });
            }
        }
        let joints = build.accessor(U8, "VEC4", 3, &joints);
        let weights = build.accessor(F32, "VEC4", 3, &floats(&weights));
        build.attribute(&format!("JOINTS_{set}"), joints);
        build.attribute(&format!("WEIGHTS_{set}"), weights);
    }
    let nodes: Vec<_> =
        (0..=count).map(|node| if node == 0 { json!({ "mesh": 0, "skin": 0 }) } else { json!({}) }).collect();
    build.json["nodes"] = json!(nodes);
    build.json["skins"] = json!([{ "joints": (1..=count).collect::<Vec<_>>() }]);
    build
}

#[test]
fn weights_are_sorted_and_normalized_with_one_warning() {
    let weights = [1.0, 3.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0];
    let asset = Build::skinned([0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0], weights).load().unwrap();
    assert_eq!(influences(&asset, 0), [(1, 0.75), (0, 0.25)]);
    assert_eq!(influences(&asset, 1), [(0, 0.5), (1, 0.5)]);
    assert_eq!(influences(&asset, 2), [(1, 1.0)]);
    assert!(matches!(&warnings(&asset)[..], [Warning::WeightsNormalized { vertices: 2, .. }]), "{:?}", asset.warnings);
}

#[test]
fn vertices_without_weights_follow_the_first_joint() {
    let weights = [0.0, 0.0, 0.0, 0.0, f32::NAN, -1.0, f32::INFINITY, 3e38, 0.0, 1.0, 0.0, 0.0];
    let asset = Build::skinned([1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1], weights).load().unwrap();
    assert_eq!(influences(&asset, 0), [(0, 1.0)]);
    assert_eq!(influences(&asset, 1), [(0, 1.0)]);
    assert_eq!(influences(&asset, 2), [(1, 1.0)]);
    assert!(matches!(&warnings(&asset)[..], [Warning::WeightsMissing { vertices: 2, .. }]), "{:?}", asset.warnings);
}

#[test]
fn thirteen_influences_are_kept() {
    let asset = many(13).load().unwrap();
    assert_eq!(asset.meshes[0].primitives[0].influences.stride, 16);
    let found = influences(&asset, 2);
    assert_eq!(found.iter().map(|&(joint, _)| joint).collect::<Vec<_>>(), (0..13).collect::<Vec<_>>());
    assert!((found[0].1 - 13.0 / 91.0).abs() < 1e-6);
    assert!(asset.warnings.is_empty(), "{:?}", asset.warnings);
}

#[test]
fn past_sixteen_the_weakest_are_dropped_with_a_warning() {
    let asset = many(20).load().unwrap();
    let found = influences(&asset, 0);
    assert_eq!(found.iter().map(|&(joint, _)| joint).collect::<Vec<_>>(), (0..16).collect::<Vec<_>>());
    assert!((found.iter().map(|&(_, weight)| weight).sum::<f32>() - 1.0).abs() < 1e-6);
    match &warnings(&asset)[..] {
        [Warning::InfluencesDropped { found: 20, kept: 16, largest_lost_weight, .. }] => {
            assert!((largest_lost_weight - 4.0 / 210.0).abs() < 1e-6, "{largest_lost_weight}");
        }
        other => panic!("{other:?}"),
    }
}

/// A joint index is checked only if its weight is not zero: exporters leave anything in unused slots.
#[test]
fn joints_with_zero_weight_may_be_anything() {
    let asset =
        Build::skinned([0, 200, 0, 0, 0, 9, 0, 0, 1, 0, 0, 255], [1.0, 0.0, 0.0, 0.0].repeat(3).try_into().unwrap());
    assert_eq!(influences(&asset.load().unwrap(), 2), [(1, 1.0)]);
}
