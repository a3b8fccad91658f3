//! Hidden nodes: what they hide, and what stays.

use gaitway_character::mesh::DeformedVertices;
use gaitway_scene::frame::{Frame, evaluate, pick_vertex, pose_document};
use gaitway_scene::library::Library;
use gaitway_scene::state::{CharacterView, ClipChoice, Playhead, ViewerState, resolved_bounds};
use glam::{Vec2, Vec3};
use serde_json::json;

use super::{at, complete, library};
use crate::build_gltf::{Build, warnings};
use crate::data::open;

/// [`complete`] with node 4 hidden, and with it its child, node 5.
fn with_hidden_node() -> Build {
    complete().with("/nodes/4/extensions", json!({ "KHR_node_visibility": { "visible": false } }))
}

#[test]
fn a_hidden_node_hides_its_descendants() {
    let [shown, hidden] = [complete(), with_hidden_node()].map(library);
    let state = ViewerState::default();
    let visible = |library: &Library| {
        let mut frame = Frame::default();
        evaluate(library, &state, 1.0, &mut frame);
        frame.characters[0].draws.iter().map(|draw| draw.visible).collect::<Vec<_>>()
    };
    assert_eq!(visible(&shown), [true; 4]);
    assert_eq!(visible(&hidden), [true, false, true, true]);
    // A child of a hidden node stays hidden even if it is marked visible.
    let visible_child = json!({ "KHR_node_visibility": { "visible": true } });
    let with_visible_child = library(with_hidden_node().with("/nodes/5/extensions", visible_child));
    assert_eq!(visible(&with_visible_child), [true, false, true, true]);
    // Neither the bounds nor the framing include it.
    let rest = |library: &Library| library.active().expect("a model").rest_bounds().max.x;
    assert_eq!((rest(&shown), rest(&hidden)), (6.0, 2.0));
    let framed = |library: &Library| resolved_bounds(library, &state).max.x;
    assert_eq!((framed(&shown), framed(&hidden)), (6.0, 2.0));
    // The pose document still has it: nodes move and meshes deform whether or not they are shown.
    let [shown, hidden] = [&shown, &hidden].map(|library| pose_document(library, &state));
    assert_eq!((&shown["nodes"], &shown["meshes"]), (&hidden["nodes"], &hidden["meshes"]));
}

#[test]
fn hidden_meshes_cannot_be_picked() {
    for (build, found) in [(complete(), Some(1)), (with_hidden_node(), None)] {
        let library = library(build);
        let model = library.active().expect("a model");
        let mut frame = Frame::default();
        evaluate(&library, &ViewerState::default(), 1.0, &mut frame);
        let projection_from_world = frame.view.projection_from_view * frame.view.view_from_world;
        let on_screen = projection_from_world.project_point3(Vec3::new(5.2, 0.2, 0.0));
        let point = Vec2::new(on_screen.x, on_screen.y);
        let picked = pick_vertex(model, &frame, &frame.characters[0], point, &mut DeformedVertices::default());
        assert_eq!(picked.map(|choice| choice.instance), found);
    }
}

/// The FBX reader hides the coarser levels of detail of an object, and the objects that the file hides.
#[test]
fn hidden_objects_of_fbx_files_are_not_shown() {
    let frame_of = |path| {
        let library = open(path)?;
        let mut frame = Frame::default();
        evaluate(&library, &ViewerState::default(), 1.0, &mut frame);
        let asset = &library.active().expect("a model").asset;
        let visible = frame.characters[0].draws.iter().filter(|draw| draw.visible);
        let joints = visible.map(|draw| asset.instances[draw.instance].joint);
        let names: Vec<String> = joints.map(|joint| asset.skeleton.name(joint).to_owned()).collect();
        Some((names, frame))
    };
    let Some((names, frame)) = frame_of("fbx/ufbx/maya_lod_group_7500_binary.fbx") else { return };
    assert_eq!(names, ["pPlatonic1", "pSphere1"]);
    assert_eq!((frame.characters[0].draws.len(), frame.bones.iter().any(|bone| bone.visible)), (6, false));
    // Its only mesh is hidden, so only the skeleton is visible, and framed.
    let Some((names, frame)) = frame_of("fbx/ufbx/max7_skin_5000_binary.fbx") else { return };
    assert_eq!((names, frame.bones.iter().any(|bone| bone.visible)), (vec![], true));
    assert!(frame.bounds.diagonal() > 0.0 && frame.bones.len() > 2);
}

#[test]
fn a_value_that_is_not_a_boolean_leaves_the_node_visible() {
    let build = complete().with("/nodes/4/extensions", json!({ "KHR_node_visibility": { "visible": 0 } }));
    let asset = build.load().expect("readable");
    assert_eq!(asset.hidden, []);
    let warnings = warnings(&asset);
    assert!(warnings.len() == 1 && warnings[0].contains("nodes[4].extensions.KHR_node_visibility"), "{warnings:?}");
}

#[test]
fn visibility_is_animated_in_steps() {
    let mut build = with_hidden_node();
    let keys = [0.0, 1.0, 1.5, 2.0];
    build.point("/nodes/4/extensions/KHR_node_visibility/visible", "STEP", "SCALAR", &keys, &[0.0, 1.0, 0.0, 1.0]);
    let library = library(build);
    let mut frame = Frame::default();
    for (time_secs, is_shown) in [(0.0, false), (0.99, false), (1.0, true), (1.49, true), (1.5, false), (1.9, false)] {
        evaluate(&library, &at(time_secs), 1.0, &mut frame);
        assert_eq!(frame.characters[0].draws[1].visible, is_shown, "{time_secs}");
    }
    assert_eq!(
        resolved_bounds(&library, &at(0.0)).max.x,
        6.0,
        "the framing leaves room for hidden meshes that the clip shows"
    );
    // The rest pose has the visibility of the file.
    let playhead = Playhead { clip: ClipChoice::RestPose, ..Playhead::default() };
    evaluate(
        &library,
        &ViewerState { character: CharacterView { playhead, ..CharacterView::default() }, ..ViewerState::default() },
        1.0,
        &mut frame,
    );
    assert!(!frame.characters[0].draws[1].visible);
}

/// The studio's key light takes the place of lights that are left out, not of dark ones.
#[test]
fn a_light_hidden_by_the_clip_is_dark_and_one_hidden_by_the_file_is_left_out() {
    let visibility = "/nodes/1/extensions/KHR_node_visibility";
    let mut build = complete();
    build.point(&format!("{visibility}/visible"), "STEP", "SCALAR", &[0.0, 1.0], &[1.0, 0.0]);
    let library_of_clip = library(build);
    let colors = |library: &Library, time_secs| {
        let mut frame = Frame::default();
        evaluate(library, &at(time_secs), 1.0, &mut frame);
        frame.lights.iter().map(|light| light.color).collect::<Vec<_>>()
    };
    assert_eq!(colors(&library_of_clip, 0.5), [Vec3::ONE]);
    assert_eq!(colors(&library_of_clip, 1.0), [Vec3::ZERO]);
    let hidden = complete().with(visibility, json!({ "visible": false }));
    assert_eq!(colors(&library(hidden), 0.0), []);
}
