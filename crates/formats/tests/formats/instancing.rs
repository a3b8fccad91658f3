//! EXT_mesh_gpu_instancing: the transforms of the copies, limits, and invalid data.

use std::f32::consts::FRAC_1_SQRT_2;

use gaitway_formats::limits::Limit;
use gaitway_formats::{convert, load};
use glam::Vec3;
use serde_json::json;

use crate::build_gltf::{Build, F32, I8, floats, one, warnings};

/// The triangle, copied to each of these points.
fn copied(points: &[f32]) -> Build {
    let mut build = Build::triangle();
    let translation = build.accessor(F32, "VEC3", points.len() / 3, &floats(points));
    with_attribute(&mut build, "TRANSLATION", translation);
    build
}

fn with_attribute(build: &mut Build, name: &str, accessor: usize) {
    build.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"][name] = json!(accessor);
}

#[test]
fn each_copy_has_its_own_transform() {
    let mut build = copied(&[0.0, 0.0, 0.0, 5.0, 0.0, 0.0]);
    build.json["nodes"][0]["translation"] = json!([0.0, 0.0, 100.0]);
    let turns = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2];
    let rotation = build.accessor(F32, "VEC4", 2, &floats(&turns));
    with_attribute(&mut build, "ROTATION", rotation);
    let scale = build.accessor(F32, "VEC3", 2, &floats(&[1.0, 1.0, 1.0, 1.0, 3.0, 1.0]));
    with_attribute(&mut build, "SCALE", scale);
    let asset = build.loaded();
    assert!(asset.warnings.is_empty());
    let [first, second] = &asset.instances[..] else { panic!("{:?}", asset.instances) };
    assert_eq!((first.joint, first.mesh), (second.joint, second.mesh));
    let corner = |point: Vec3| second.joint_from_mesh.transform_point3(point);
    assert!(corner(Vec3::X).distance(Vec3::new(5.0, 1.0, 0.0)) < 1e-5, "{}", corner(Vec3::X));
    assert!(corner(Vec3::Y).distance(Vec3::new(2.0, 0.0, 0.0)) < 1e-5, "{}", corner(Vec3::Y));
}

#[test]
fn rotations_may_be_normalized_integers() {
    let mut build = copied(&[0.0; 3]);
    let rotation = build.accessor(I8, "VEC4", 1, &[0, 0, 90, 90]);
    build.json["accessors"][rotation]["normalized"] = json!(true);
    with_attribute(&mut build, "ROTATION", rotation);
    let turned = build.loaded().instances[0].joint_from_mesh.transform_point3(Vec3::X);
    assert!(turned.distance(Vec3::Y) < 1e-3, "{turned}");
}

#[test]
fn a_mesh_with_no_copies_is_not_drawn() {
    let mut build = Build::triangle();
    build.accessor(F32, "VEC3", 0, &[]);
    with_attribute(&mut build, "TRANSLATION", 1);
    assert!(build.loaded().instances.is_empty());
}

#[test]
fn a_mesh_with_invalid_instancing_is_drawn_once() {
    let place = "nodes[0].extensions.EXT_mesh_gpu_instancing";
    let check = |build: Build, expected: &str| {
        let asset = build.loaded();
        let warnings = warnings(&asset);
        let is_expected = |warning: &String| warning.contains(place) && warning.contains(expected);
        assert!(matches!(&warnings[..], [warning] if is_expected(warning)), "{expected}: {warnings:?}");
        assert_eq!(asset.instances.len(), 1, "{expected}");
    };
    let mut none = Build::triangle();
    with_attribute(&mut none, "_ID", 0);
    check(none, "expected TRANSLATION, ROTATION or SCALE, found none of them");
    let mut missing = Build::triangle();
    with_attribute(&mut missing, "SCALE", 9);
    check(missing, "expected an index into the 1 accessors, found 9");
    let mut uneven = copied(&[0.0; 6]);
    with_attribute(&mut uneven, "SCALE", 0);
    check(uneven, "expected 2 elements, as the first attribute has, found 3");
    check(copied(&[0.0, f32::NAN, 0.0]), "expected finite numbers");
    let mut shape = copied(&[0.0; 3]);
    with_attribute(&mut shape, "TRANSLATION", 0);
    shape.json["accessors"][0]["type"] = json!("VEC2");
    shape.json["meshes"][0]["primitives"][0]["attributes"] = json!({ "POSITION": 1 });
    check(shape, "VEC3");
    let mut skinned = Build::skinned([0; 12], [1.0, 0.0, 0.0, 0.0].repeat(3).try_into().expect("12"));
    with_attribute(&mut skinned, "TRANSLATION", 0);
    check(skinned, "expected a mesh without a skin, found a skinned mesh");
}

#[test]
fn copies_count_towards_the_limits_of_nodes_and_drawn_vertices() {
    let zeros = |count: usize| json!({ "componentType": F32, "type": "VEC3", "count": count });
    let with = |vertices: usize, copies: usize| {
        let mut build = Build::triangle();
        build.json["accessors"] = json!([zeros(vertices), zeros(copies)]);
        with_attribute(&mut build, "TRANSLATION", 1);
        load(&one("m.glb", build.glb()))
    };
    for (vertices, copies, limit) in [(1 << 16, (1 << 10) + 1, Limit::DrawnVertices), (3, 1 << 18, Limit::Nodes)] {
        let problem = with(vertices, copies).expect_err("over the limit").to_string();
        let expected = format!("at most {} {} in all", limit.max_in_unit(), limit.name());
        assert!(problem.contains("nodes[0]") && problem.contains(&expected), "{problem}");
    }
    assert_eq!(with(1 << 16, 1 << 10).expect("just within the limit").instances.len(), 1 << 10);
}

#[test]
fn copies_share_a_draw_call_unless_their_neighbours_are_mirrored() {
    let with = |mirrored: fn(usize) -> bool| {
        let mut build = Build::triangle();
        let sizes: Vec<f32> =
            (0..(1 << 15) + 2).flat_map(|copy| [if mirrored(copy) { -1.0 } else { 1.0 }, 1.0, 1.0]).collect();
        let scale = build.accessor(F32, "VEC3", sizes.len() / 3, &floats(&sizes));
        with_attribute(&mut build, "SCALE", scale);
        load(&one("m.glb", build.glb()))
    };
    assert_eq!(with(|copy| copy < 100).expect("two draw calls").instances.len(), (1 << 15) + 2);
    let problem = with(|copy| copy % 2 == 0).expect_err("over the limit").to_string();
    assert!(problem.contains("draw calls in all"), "{problem}");
}

#[test]
fn copies_survive_conversion() {
    let build = copied(&[0.0, 0.0, 0.0, 5.0, 0.0, 0.0]);
    let (bytes, mut files) = (build.bytes.clone(), one("model.gltf", build.gltf("data.bin")));
    files.insert("data.bin", bytes);
    let written = convert(&files, &Default::default()).expect("a GLB");
    let asset = load(&one("model.glb", written)).expect("readable");
    assert_eq!(asset.instances.len(), 2);
}
