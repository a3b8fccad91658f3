//! The skinning exercise as a scene: manual poses, the skinning formula and renaming.

use std::slice::from_ref;

use gaitway_character::mesh::{DeformedVertices, Geometry, SkinningMode, Topology, smooth_normals};
use gaitway_formats::{FileSet, load};
use gaitway_scene::frame::{
    Frame, VertexFormula, evaluate, joint_matrices, pick_vertex, pose_document, vertex_formula,
};
use gaitway_scene::library::{Library, Model};
use gaitway_scene::state::{
    CharacterView, ClipChoice, Command, Display, Edits, History, Playhead, Show, UpAxis, VertexChoice, ViewerState,
    apply, from_link, title, written_skeleton,
};
use glam::{DVec3, Vec2, Vec3};
use serde_json::Value;

use crate::bent_exercise::{bent, exercise, furthest, positions, rotations};
use crate::data::{library_of, open, walker};
use crate::history::undo;
use crate::texts::link_of;

#[test]
fn manual_poses_match_the_formula() {
    for name in ["Model1", "Model2", "Model3", "Model4"] {
        let (Some(exercise), Some(library)) = (exercise(name), open(&format!("mit6837/{name}.obj"))) else { return };
        let state = bent();
        let found = positions(&pose_document(&library, &state));
        assert!(furthest(&found, &exercise.skinned(&rotations(&state))) < 1e-6, "{name}");
        assert!(furthest(&found, &exercise.vertices) > 0.05, "{name} is bent");
        let rest = ViewerState {
            character: CharacterView {
                playhead: Playhead { clip: ClipChoice::RestPose, ..Playhead::default() },
                ..CharacterView::default()
            },
            ..ViewerState::default()
        };
        assert!(furthest(&positions(&pose_document(&library, &rest)), &exercise.vertices) < 1e-6, "{name}");
    }
}

fn evaluated(library: &Library, state: &ViewerState) -> Frame {
    let mut frame = Frame::default();
    evaluate(library, state, 1.0, &mut frame);
    frame
}

#[test]
fn the_terms_of_the_formula_add_up_to_the_drawn_position() {
    let (Some(library), Some(exercise)) = (open("mit6837/Model1.obj"), exercise("Model1")) else { return };
    let model = library.active().expect("a model");
    for up in [UpAxis::Y, UpAxis::Z] {
        let state = ViewerState {
            character: CharacterView { edits: Edits { up, ..bent().character.edits }, ..bent().character },
            ..bent()
        };
        let frame = evaluated(&library, &state);
        let expected = exercise.skinned(&rotations(&state));
        let mut formula = VertexFormula::default();
        let mut max_influences = 0;
        for vertex in (0..13336).step_by(37) {
            let choice = VertexChoice { instance: 0, primitive: 0, vertex };
            assert!(vertex_formula(model, &frame.characters[0], choice, &mut formula));
            max_influences = max_influences.max(formula.terms.len());
            assert!(formula.sum.distance(formula.drawn) < 1e-6);
            if up == UpAxis::Y {
                assert!(formula.sum.as_dvec3().distance(expected[vertex]) < 1e-6);
            }
            assert!((formula.terms.iter().map(|part| part.weight).sum::<f32>() - 1.0).abs() < 1e-6);
            for part in &formula.terms {
                let matrices = joint_matrices(model, &frame.characters[0], part.joint).expect("of the skin");
                let alone = matrices.world_from_bind().transform_point3(formula.bound);
                assert!(alone.distance(part.alone) < 1e-6 && part.share == part.weight * part.alone);
            }
        }
        assert!(max_influences > 8, "vertices with many influences were checked: {max_influences}");
    }
    let nowhere = VertexChoice { instance: 0, primitive: 0, vertex: 13336 };
    let frame = evaluated(&library, &bent());
    assert!(!vertex_formula(model, &frame.characters[0], nowhere, &mut VertexFormula::default()));
}

#[test]
fn any_skinned_model_has_a_formula() {
    let library = walker();
    let model = library.active().expect("a model");
    for skinning in [SkinningMode::Linear, SkinningMode::Rigid, SkinningMode::DualQuaternion] {
        let state = ViewerState {
            character: CharacterView {
                playhead: Playhead { time_secs: 0.4, ..Playhead::default() },
                ..CharacterView::default()
            },
            display: Display { skinning, ..Display::default() },
            ..ViewerState::default()
        };
        let frame = evaluated(&library, &state);
        let document = pose_document(&library, &state);
        let mut formula = VertexFormula::default();
        for (at, draw) in frame.characters[0].draws.iter().enumerate() {
            let choice = VertexChoice { instance: draw.instance, primitive: 0, vertex: 3 };
            assert!(vertex_formula(model, &frame.characters[0], choice, &mut formula));
            let first = document["meshes"].as_array().expect("meshes").iter().find(|mesh| mesh["mesh"] == draw.mesh);
            let number =
                |axis: usize| first.expect("it is drawn")["positions"][9 + axis].as_f64().expect("a number") as f32;
            let drawn = Vec3::new(number(0), number(1), number(2));
            assert!(formula.drawn.distance(drawn) < 1e-5, "{skinning:?}, draw {at}");
            if skinning == SkinningMode::Linear {
                assert!(formula.sum.distance(drawn) < 1e-5, "draw {at}");
            }
        }
    }
}

#[test]
fn picking_a_visible_vertex_finds_it() {
    let Some(library) = open("mit6837/Model1.obj") else { return };
    let model = library.active().expect("a model");
    let state = bent();
    let frame = evaluated(&library, &state);
    let character = &frame.characters[0];
    let projection = frame.view.projection_from_view * frame.view.view_from_world;
    let mut scratch = DeformedVertices::default();
    let mut formula = VertexFormula::default();
    let (mut found, mut hidden) = (0, 0);
    for vertex in (0..13336).step_by(101) {
        let choice = VertexChoice { instance: 0, primitive: 0, vertex };
        vertex_formula(model, character, choice, &mut formula);
        let at = projection.project_point3(formula.drawn);
        match pick_vertex(model, &frame, character, at.truncate(), &mut scratch) {
            Some(picked) if picked == choice => found += 1,
            Some(picked) => {
                // A vertex in front of it, or a neighbour at a silhouette.
                vertex_formula(model, character, picked, &mut formula);
                let other = projection.project_point3(formula.drawn);
                assert!(other.z <= at.z + 2e-3, "vertex {vertex}: {picked:?}");
                assert!(other.truncate().distance(at.truncate()) < 0.05);
                hidden += 1;
            }
            None => hidden += 1,
        }
    }
    assert!(found > 30 && hidden > 30, "{found} visible, {hidden} hidden");
    assert_eq!(pick_vertex(model, &frame, character, Vec2::new(-0.99, 0.99), &mut scratch), None);
}

#[test]
fn joints_can_be_renamed() {
    let mut library = walker();
    let asset = &library.active().expect("a model").asset.clone();
    let joint = asset.skeleton.joint_of_source(5).expect("a joint");
    let (mut state, mut history) = (ViewerState::default(), History::default());
    let before = title(Some(&state), asset, joint).into_owned();
    let mut rename = |state: &mut ViewerState, name: &str| {
        history.apply(state, &walker(), Command::RenameJoint { joint: 5, name: name.to_owned() });
        history.end_gesture();
        title(Some(state), asset, joint).into_owned()
    };
    assert_eq!(rename(&mut state, "  Crown,\tof: the head \n"), "Crown,of: the head");
    assert_eq!(from_link(&link_of(&state)).0.character.edits.names, state.character.edits.names);
    assert_eq!(rename(&mut state, &"x".repeat(500)).len(), 80);
    assert_eq!(rename(&mut state, ""), before);
    assert_eq!(rename(&mut state, &before.clone()), before, "the file's own name is not a custom name");
    assert!(state.character.edits.names.is_empty());
    assert!(undo(&mut history, &mut state, &mut library));
    assert_eq!(state.character.edits.names[&5].len(), 80);
    assert!(undo(&mut history, &mut state, &mut library));
    assert_eq!(state.character.edits.names[&5], "Crown,of: the head");
    assert_eq!(title(None, asset, joint), before, "other files keep their names");
    apply(&mut state, &library, Command::RenameJoint { joint: 9999, name: "Nobody".to_owned() });
    assert_eq!(state.character.edits.names.len(), 1);
    let written = written_skeleton(library.active().expect("a model"), &state, None);
    assert_eq!(written.name(joint), "Crown,of: the head");
    assert_eq!(written.rest(), asset.skeleton.rest());
}

#[test]
fn smooth_normals_are_weighted_by_angle() {
    // However the faces of a cube are triangulated, a corner's normal points along its diagonal.
    let side = |corner: usize, bit: usize| if corner & bit == 0 { -1.0 } else { 1.0 };
    let positions: Vec<Vec3> = (0..8).map(|at| Vec3::new(side(at, 4), side(at, 2), side(at, 1))).collect();
    let quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    let indices: Vec<u32> = quads.iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d].map(|&index| index)).collect();
    let cube = Geometry { positions: positions.clone(), indices: indices.clone(), ..Geometry::default() };
    for (normal, at) in smooth_normals(from_ref(&cube))[0].iter().zip(&positions) {
        assert!(normal.distance(at.normalize()) < 1e-6, "{at}: {normal}");
    }
    // The same with unshared vertices.
    let split: Vec<Vec3> = indices.iter().map(|&index| positions[index as usize]).collect();
    let split = Geometry { indices: (0..36).collect(), positions: split, ..Geometry::default() };
    for (normal, at) in smooth_normals(from_ref(&split))[0].iter().zip(&split.positions) {
        assert!(normal.distance(at.normalize()) < 1e-6, "{at}: {normal}");
    }
    assert!(smooth_normals(&[Geometry { topology: Topology::Lines, ..cube }])[0].is_empty());
}

fn loaded(files: &FileSet, name: &str) -> Model {
    Model::new(name.to_owned(), load(files).expect("readable"), Vec::new())
}

#[test]
fn a_surface_is_smooth_across_parts() {
    let normals = |between: &str| -> Vec<f64> {
        let mut files = FileSet::default();
        // Two triangles at a right angle along the second axis.
        let obj = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n{between}f 1 3 4\n");
        files.insert("m.obj", obj.into_bytes());
        let library = library_of(loaded(&files, "m.obj"));
        let state = ViewerState {
            display: Display { show: Show { smooth: true, ..Show::default() }, ..Display::default() },
            ..ViewerState::default()
        };
        let document = pose_document(&library, &state);
        let normals = document["meshes"][0]["normals"].as_array().expect("normals");
        normals.iter().filter_map(Value::as_f64).collect()
    };
    let half = f64::from(0.5_f32.sqrt());
    let expected = [half, 0.0, half, 0.0, 0.0, 1.0, half, 0.0, half, 1.0, 0.0, 0.0];
    for between in ["", "g b\n", "usemtl other\n"] {
        let off = normals(between).iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-6, "{between:?}: {:?}", normals(between));
    }
}

#[test]
fn the_pose_document_has_normals_of_smooth_surfaces() {
    let Some(library) = open("mit6837/Model4.obj") else { return };
    let normals = |smooth: bool| {
        let state =
            ViewerState { display: Display { show: Show { smooth, ..Show::default() }, ..bent().display }, ..bent() };
        pose_document(&library, &state)["meshes"][0]["normals"].as_array().map(Vec::len)
    };
    assert_eq!((normals(false), normals(true)), (Some(0), Some(3 * 13336)));
}

#[test]
fn several_parts_are_one_mesh_in_file_order() {
    let mut files = FileSet::default();
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\ng a\nf 3 4 1\ng b\nf 1 2 3\n";
    files.insert("parts.obj", obj.as_bytes().to_vec());
    let library = library_of(loaded(&files, "parts.obj"));
    let expected = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y, DVec3::splat(5.0)];
    let document = pose_document(&library, &ViewerState::default());
    assert_eq!(positions(&document), expected);
    assert_eq!(document["meshes"][0]["normals"].as_array().map(Vec::len), Some(0));
    let model = library.active().expect("a model");
    assert_eq!(gaitway_scene::library::inspect(model, &[])["vertices"], 5);
    assert_eq!(gaitway_scene::library::inspect(model, &[])["primitives"], 2);
    assert_eq!(gaitway_scene::library::inspect(model, &[])["parts"], serde_json::json!(["a", "b"]));
}
