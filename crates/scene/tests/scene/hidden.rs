//! Nodes and materials that the user hides.

use std::collections::BTreeSet;

use gaitway_character::mesh::DeformedVertices;
use gaitway_scene::editor::Editor;
use gaitway_scene::frame::{Frame, evaluate, pick_vertex, pose_document};
use gaitway_scene::library::Library;
use gaitway_scene::state::{Command, Hidden, ViewerState, frame_all, from_link};
use glam::{Vec2, Vec3};

use crate::data::walker;
use crate::texts::link_of;

/// Nodes of the walker with its two meshes, and its hips.
const BODY: usize = 22;
const EYES: usize = 23;
const HIPS: usize = 1;
/// A material of the walker's body.
const SHELL: usize = 0;

fn of_nodes(nodes: &[usize]) -> Hidden {
    Hidden { nodes: nodes.iter().copied().collect(), ..Hidden::default() }
}

fn of_materials(materials: &[Option<usize>]) -> Hidden {
    Hidden { materials: materials.iter().copied().collect(), ..Hidden::default() }
}

fn hiding(hidden: Hidden) -> ViewerState {
    let mut state = ViewerState::default();
    state.character.edits.hidden = hidden;
    state
}

fn visible(library: &Library, state: &ViewerState) -> Vec<bool> {
    let mut frame = Frame::default();
    evaluate(library, state, 1.0, &mut frame);
    frame.characters[0].draws.iter().map(|draw| draw.visible).collect()
}

#[test]
fn hidden_nodes_are_not_drawn_in_the_same_frame_as_they_are_hidden() {
    let library = walker();
    let mut frame = Frame::default();
    let mut shown = |hidden: Hidden| {
        evaluate(&library, &hiding(hidden), 1.0, &mut frame);
        let bones = frame.bones.iter().any(|bone| bone.visible);
        (frame.characters[0].draws.iter().map(|draw| draw.visible).collect::<Vec<_>>(), bones)
    };
    assert_eq!(shown(Hidden::default()), (vec![true, true], false));
    assert_eq!(shown(of_nodes(&[EYES])), (vec![true, false], false));
    assert_eq!(shown(of_nodes(&[BODY])), (vec![false, true], false));
    // The skeleton doesn't replace meshes that are hidden, and joints carry none of them.
    assert_eq!(shown(of_nodes(&[BODY, EYES])), (vec![false, false], false));
    assert_eq!(shown(of_nodes(&[HIPS, 99])), (vec![true, true], false));
    assert_eq!(shown(Hidden::default()), (vec![true, true], false));
}

#[test]
fn a_solo_hides_all_others_and_a_second_one_shows_them() {
    let library = walker();
    let asset = &library.active().expect("a model").asset;
    let joint = |node| asset.skeleton.joint_of_source(node).expect("there");
    let solo = Hidden::default().with_node_soloed(asset, joint(EYES));
    assert_eq!(solo, of_nodes(&[BODY]));
    assert_eq!(solo.clone().with_node_soloed(asset, joint(BODY)), of_nodes(&[EYES]));
    assert_eq!(solo.with_node_soloed(asset, joint(EYES)), Hidden::default());
    let solo = Hidden::default().with_material_soloed(asset, Some(SHELL));
    assert_eq!(solo, of_materials(&[Some(1), Some(2)]));
    assert_eq!(solo.with_material_soloed(asset, Some(SHELL)), Hidden::default());
    // Nodes and materials are independent.
    let both = of_nodes(&[BODY]).with_material_soloed(asset, Some(2));
    assert_eq!((both.nodes, both.materials), (BTreeSet::from([BODY]), BTreeSet::from([Some(0), Some(1)])));
}

#[test]
fn what_is_hidden_cannot_be_picked() {
    let library = walker();
    let model = library.active().expect("a model");
    let picked = |hidden: Hidden| {
        let mut frame = Frame::default();
        evaluate(&library, &hiding(hidden), 1.0, &mut frame);
        let projection_from_world = frame.view.projection_from_view * frame.view.view_from_world;
        let chest = projection_from_world.project_point3(Vec3::new(0.0, 1.2, 0.0));
        let point = Vec2::new(chest.x, chest.y);
        pick_vertex(model, &frame, &frame.characters[0], point, &mut DeformedVertices::default())
    };
    assert_eq!(picked(Hidden::default()).map(|choice| choice.instance), Some(0));
    assert_eq!(picked(of_nodes(&[BODY])), None);
    assert_ne!(picked(of_materials(&[Some(SHELL)])), picked(Hidden::default()));
    assert_eq!(picked(of_materials(&[Some(SHELL), Some(1), Some(2)])), None);
}

#[test]
fn hiding_can_be_undone_and_changes_neither_numbers_nor_the_automatic_camera() {
    let mut editor = Editor::new(walker(), ViewerState::default());
    let before = pose_document(editor.library(), editor.state());
    let camera = |editor: &Editor| {
        let mut frame = Frame::default();
        evaluate(editor.library(), editor.state(), 1.0, &mut frame);
        frame.view.view_from_world
    };
    let view = camera(&editor);
    editor.apply(Command::SetHidden(of_nodes(&[BODY, 500])));
    assert_eq!(editor.state().character.edits.hidden, of_nodes(&[BODY]), "nodes that the model lacks are ignored");
    assert_eq!(visible(editor.library(), editor.state()), [false, true]);
    assert_eq!(pose_document(editor.library(), editor.state()), before);
    assert_eq!(camera(&editor), view);
    assert!(editor.undo());
    assert_eq!(visible(editor.library(), editor.state()), [true, true]);
    assert!(editor.redo());
    assert_eq!(editor.state().character.edits.hidden, of_nodes(&[BODY]));
}

#[test]
fn framing_everything_frames_what_is_shown() {
    let library = walker();
    let distance = |hidden| frame_all(&library, &hiding(hidden), 1.0).distance;
    let whole = distance(Hidden::default());
    assert!(distance(of_nodes(&[BODY])) < 0.5 * whole, "only the eyes");
    assert!(distance(of_nodes(&[BODY, EYES])) > 0.7 * whole, "the joints are left");
    assert_eq!(distance(of_materials(&[Some(SHELL)])), whole);
}

#[test]
fn a_link_says_what_is_hidden() {
    let hidden = Hidden { nodes: BTreeSet::from([4, 17]), materials: BTreeSet::from([None, Some(2)]) };
    let state = hiding(hidden);
    assert_eq!(link_of(&state), "v=2&hidden=4,17,m,m2");
    assert_eq!(from_link("v=1&hidden=m2,17,4,m"), (state, Vec::new()));
    for bad in ["x", "4,m-1", "-1", "m2.5"] {
        let (state, errors) = from_link(&format!("hidden={bad}"));
        assert_eq!((state.character.edits.hidden, errors.len()), (Hidden::default(), 1), "{bad}");
    }
}
