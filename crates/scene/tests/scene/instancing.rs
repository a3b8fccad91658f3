//! Copies of a mesh (EXT_mesh_gpu_instancing) in a frame: where they are drawn, picked and listed.

use std::f32::consts::FRAC_1_SQRT_2;

use gaitway_character::mesh::DeformedVertices;
use gaitway_scene::frame::{Frame, VertexFormula, evaluate, pick_vertex, pose_document, vertex_formula};
use gaitway_scene::library::{Library, Model};
use gaitway_scene::state::{Command, VertexChoice, ViewerState, apply};
use glam::{Vec2, Vec3, Vec4Swizzles};
use serde_json::json;

use crate::allocations::allocations_after;
use crate::build_gltf::{Build, F32, floats};
use crate::data::library_of;

/// Three copies of the triangle along X; the last one is mirrored.
fn copies() -> Library {
    let mut build = Build::triangle();
    let places = build.accessor(F32, "VEC3", 3, &floats(&[0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 9.0, 0.0, 0.0]));
    let scales = build.accessor(F32, "VEC3", 3, &floats(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, -1.0, 1.0, 1.0]));
    let attributes = json!({ "TRANSLATION": places, "SCALE": scales });
    build.json["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
    build.json["nodes"][0]["translation"] = json!([0.0, 2.0, 0.0]);
    library_of(Model::new("copies.glb".to_owned(), build.load().expect("readable"), Vec::new()))
}

fn evaluated(library: &Library) -> Frame {
    let mut state = ViewerState::default();
    apply(&mut state, library, Command::FrameAll);
    let mut frame = Frame::default();
    evaluate(library, &state, 1.0, &mut frame);
    frame
}

#[test]
fn a_frame_draws_each_copy_at_its_place() {
    let library = copies();
    let frame = evaluated(&library);
    let draws = &frame.characters[0].draws;
    let found: Vec<_> = draws.iter().map(|draw| (draw.instance, draw.is_copy, draw.mirrored)).collect();
    assert_eq!(found, [(0, false, false), (1, true, false), (2, true, true)]);
    let palettes: Vec<_> = draws.iter().map(|draw| draw.palette.clone()).collect();
    assert_eq!(palettes, [0..1, 1..2, 2..3], "consecutive, as instanced drawing expects");
    assert!(draws[1].center.distance(Vec3::new(4.5, 2.5, 0.0)) < 1e-4, "{}", draws[1].center);
    assert!(frame.bounds.max.distance(Vec3::new(9.0, 3.0, 0.0)) < 1e-4, "{:?}", frame.bounds);
}

#[test]
fn a_copy_is_picked_where_it_is_drawn() {
    let library = copies();
    let (frame, model) = (evaluated(&library), library.active().expect("a model"));
    let character = &frame.characters[0];
    let mut formula = VertexFormula::default();
    for (copy, inside, corner) in [
        (0, Vec3::new(0.1, 2.1, 0.0), Vec3::new(0.0, 2.0, 0.0)),
        (1, Vec3::new(4.1, 2.1, 0.0), Vec3::new(4.0, 2.0, 0.0)),
        (2, Vec3::new(8.9, 2.1, 0.0), Vec3::new(9.0, 2.0, 0.0)),
    ] {
        let projected = frame.view.projection_from_view * frame.view.view_from_world * inside.extend(1.0);
        let point: Vec2 = projected.xy() / projected.w;
        let picked = pick_vertex(model, &frame, character, point, &mut DeformedVertices::default());
        let expected = VertexChoice { instance: copy, primitive: 0, vertex: 0 };
        assert_eq!(picked, Some(expected), "{copy}");
        assert!(vertex_formula(model, character, expected, &mut formula));
        assert!(formula.drawn.distance(corner) < 1e-5 && formula.sum.distance(corner) < 1e-5, "{copy}: {formula:?}");
    }
}

#[test]
fn the_pose_document_lists_all_copies_of_a_node() {
    let library = copies();
    let document = pose_document(&library, &ViewerState::default());
    let meshes = document["meshes"].as_array().expect("meshes");
    let first_x: Vec<_> = meshes.iter().map(|mesh| (mesh["node"].clone(), mesh["positions"][0].clone())).collect();
    assert_eq!(first_x, [0.0, 4.0, 9.0].map(|x| (json!(0), json!(x))));
}

#[test]
fn copies_and_variants_allocate_nothing_per_frame() {
    let library = copies();
    let mut state = ViewerState::default();
    state.character.edits.variant = Some("none of the file's".to_owned());
    let mut frame = Frame::default();
    let draw = |frame: &mut Frame| evaluate(&library, &state, 1.0, frame);
    assert_eq!(allocations_after(&mut frame, draw, draw), 0);
}

#[test]
fn bounds_enclose_all_copies() {
    let mut build = Build::triangle();
    build.json["nodes"][0]["translation"] = json!([0.0, 0.0, 100.0]);
    let mut attribute = |name: &str, kind: &str, values: &[f32]| {
        let accessor = build.accessor(F32, kind, 2, &floats(values));
        build.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"][name] = json!(accessor);
    };
    attribute("TRANSLATION", "VEC3", &[0.0, 0.0, 0.0, 5.0, 0.0, 0.0]);
    attribute("ROTATION", "VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2]);
    attribute("SCALE", "VEC3", &[1.0, 1.0, 1.0, 1.0, 3.0, 1.0]);
    let bounds = Model::new("m".to_owned(), build.loaded(), Vec::new()).rest_bounds();
    assert!(bounds.min.distance(Vec3::new(0.0, 0.0, 100.0)) < 1e-4, "{bounds:?}");
    assert!(bounds.max.distance(Vec3::new(5.0, 1.0, 100.0)) < 1e-4, "{bounds:?}");
}
