//! The skinning exercise in the panels: sliders, matrices, the skinning equation at a vertex, names, saving.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gaitway::ui::text::FormulaRow;
use gaitway::ui::{Saved, Tab, UiAction, text};
use gaitway_character::mesh::SkinningMode;
use gaitway_formats::{FileSet, load};
use gaitway_scene::editor::{Contents, Export};
use gaitway_scene::library::Model;
use gaitway_scene::state::{Command, Show, VertexChoice};

use crate::bench::{Bench, NARROW, WIDE, bench, model_with_clips, press, sample_bench};
use crate::motion::reach;

/// A strip along X: its beginning follows joint 1, its end joint 2, the middle both.
fn strip(size: [f32; 2]) -> Harness<'static, Bench> {
    let mut files = FileSet::default();
    let obj = "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 2 0 0\nv 2 1 0\nf 1 3 4 2\nf 3 5 6 4\n";
    for (name, text) in [
        ("strip.obj", obj),
        ("strip.skel", "0 0 0 -1\n0 0 0 0\n1 0 0 1\n"),
        ("strip.attach", "1 0\n1 0\n0.75 0.25\n0.5 0.5\n0 1\n0 1\n"),
    ] {
        files.insert(name, text.as_bytes().to_vec());
    }
    let asset = load(&files).expect("a small exercise");
    bench(size, Model::new("strip.obj".to_owned(), asset, Vec::new()))
}

/// The accessible text of a row of the skinning equation.
fn numbers(row: FormulaRow, values: &str) -> String {
    format!("{} {values}", row.label())
}

fn has(harness: &Harness<'_, Bench>, label: &str) -> bool {
    harness.query_by_label(label).is_some()
}

#[test]
fn the_sliders_say_their_order_and_bend_the_model() {
    let mut harness = strip(WIDE);
    press(&mut harness, "joint 2");
    press(&mut harness, text::POSE_MANUALLY);
    assert!(harness.query_by_label(text::POSE_HINT).is_some());
    harness.get_by_label(text::POSE_ANGLES[2]).set_value_accesskit(90.0);
    harness.run();
    let world = harness.state().frame.characters[0].world_from_joint[2];
    assert!(world.transform_point3(glam::Vec3::X).distance(glam::Vec3::new(1.0, 1.0, 0.0)) < 1e-5);
}

#[test]
fn the_three_matrices_of_the_chosen_joint_are_shown() {
    let mut harness = strip(WIDE);
    press(&mut harness, "joint 2");
    harness.state_mut().change(|state| {
        state.character.edits.pose.insert(2, [0.0, 0.0, 90.0]);
    });
    harness.run();
    let unscaled = text::labelled(text::SCALE, "1.000 1.000 1.000");
    assert_eq!(harness.query_all_by_label(&unscaled).count(), 2, "local and in the world");
    reach(&mut harness, text::MATRICES);
    let zero = "0.0000";
    let row = |numbers: [&str; 4]| format!(" {}", numbers.join(" "));
    let last = row([zero, zero, zero, "1.0000"]);
    let third = row([zero, zero, "1.0000", zero]);
    let bind = [row(["1.0000", zero, zero, "-1.0000"]), row([zero, "1.0000", zero, zero])].concat();
    let now = [row([zero, "-1.0000", zero, "1.0000"]), row(["1.0000", zero, zero, zero])].concat();
    let product = [row([zero, "-1.0000", zero, "1.0000"]), row(["1.0000", zero, zero, "-1.0000"])].concat();
    for (name, rows) in [(text::INVERSE_BIND, bind), (text::WORLD_MATRIX, now), (text::SKINNING_MATRIX, product)] {
        let label = format!("{name}:{rows}{third}{last}");
        assert!(has(&harness, &label), "{label}");
    }
    assert!(!has(&harness, &unscaled), "the matrices say the same");
    reach(&mut harness, text::MATRICES);
    assert!(harness.query_by_label_contains(&format!("{}:", text::INVERSE_BIND)).is_none());
}

#[test]
fn a_model_without_meshes_has_no_vertices_to_look_at() {
    let mut harness = strip(WIDE);
    reach(&mut harness, text::VERTEX_PROBE);
    let contents = Contents { models: vec![model_with_clips(2).into()], ..Contents::default() };
    harness.state_mut().editor.open(contents, None, &mut |_| Ok(())).expect("fits");
    harness.run();
    assert!(harness.query_by_label(text::VERTEX_PROBE).is_none());
}

#[test]
fn a_vertex_shows_shares_that_add_up() {
    for size in [WIDE, NARROW] {
        let mut harness = strip(size);
        if size == NARROW {
            press(&mut harness, text::INSPECTOR);
        }
        reach(&mut harness, text::VERTEX_PROBE);
        assert!(harness.query_by_label(text::VERTEX_HINT).is_some());
        // Turned by a quarter about Z, joint 2 alone would put (1, 1) at (0, 0).
        harness.state_mut().change(|state| {
            state.character.edits.pose.insert(2, [0.0, 0.0, 90.0]);
        });
        harness.state_mut().change(|state| {
            state.selection.vertex = Some(VertexChoice { instance: 0, primitive: 0, vertex: 3 });
        });
        harness.run();
        for label in [
            &text::vertex(3),
            &numbers(FormulaRow::Bound, "1.0000 1.0000 0.0000"),
            &text::joint_weight("joint 1", 0.5),
            &text::joint_weight("joint 2", 0.5),
            &numbers(FormulaRow::Share, "0.5000 0.5000 0.0000"),
            &numbers(FormulaRow::Share, "0.0000 0.0000 0.0000"),
            &numbers(FormulaRow::Sum, "0.5000 0.5000 0.0000"),
        ] {
            assert!(has(&harness, label), "{label} at {size:?}");
        }
        assert!(harness.query_by_label_contains(&FormulaRow::Drawn.label()).is_none(), "linear skinning draws the sum");
        harness.state_mut().change(|state| {
            state.display.skinning = SkinningMode::Rigid;
        });
        harness.run();
        assert!(harness.query_by_label_contains(&FormulaRow::Drawn.label()).is_some());
        harness.state_mut().change(|state| state.inspect.split = true);
        harness.run();
        assert!(harness.query_by_label_contains(&FormulaRow::Drawn.label()).is_none(), "each method is named");
        for method in [SkinningMode::Rigid, SkinningMode::DualQuaternion] {
            let label = FormulaRow::DrawnBy(method).label();
            assert!(harness.query_by_label_contains(&label).is_some(), "{label} at {size:?}");
        }
        harness.state_mut().change(|state| state.inspect.split = false);
        harness.run();
        assert_eq!(reach(&mut harness, &text::joint_weight("joint 2", 0.5)), [Command::SelectJoint(Some(2))]);
        assert_eq!(reach(&mut harness, text::UNPIN_VERTEX), [Command::SelectVertex(None)]);
    }
}

/// A vertex on a texture seam is drawn several times, again in each part.
#[test]
fn a_copy_has_the_number_of_its_vertex() {
    for (between, piece, vertex) in [("", 0, 5), ("g other\n", 1, 1)] {
        let mut files = FileSet::default();
        let head = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\n";
        files.insert("m.obj", format!("{head}f 1/1 2/1 3/1\n{between}f 1/2 3/2 4/2\n").into_bytes());
        let asset = load(&files).expect("a small model");
        let mut harness = bench(WIDE, Model::new("m.obj".to_owned(), asset, Vec::new()));
        reach(&mut harness, text::VERTEX_PROBE);
        harness.state_mut().change(|state| {
            state.selection.vertex = Some(VertexChoice { instance: 0, primitive: piece, vertex });
        });
        harness.run();
        assert!(has(&harness, &text::vertex(2)), "{between:?}");
    }
}

#[test]
fn a_click_keeps_the_vertex_and_a_click_beside_lets_it_go() {
    let mut harness = strip(WIDE);
    reach(&mut harness, text::VERTEX_PROBE);
    let middle = harness.state().viewport.center();
    let click = |harness: &mut Harness<'static, Bench>, at: egui::Pos2| {
        harness.state_mut().commands.clear();
        crate::bench::drag(harness, at, at, egui::PointerButton::Primary)
    };
    let kept = click(&mut harness, middle);
    assert!(matches!(kept[..], [Command::SelectVertex(Some(_))]), "{kept:?}");
    let aside = harness.state().viewport.right_center() - egui::vec2(12.0, 0.0);
    assert!(click(&mut harness, aside).contains(&Command::SelectVertex(None)));
    // Switched off, a click is about joints again.
    reach(&mut harness, text::VERTEX_PROBE);
    assert!(!click(&mut harness, middle).iter().any(|command| matches!(command, Command::SelectVertex(_))));
}

#[test]
fn a_joint_is_renamed_in_its_card() {
    let mut harness = strip(WIDE);
    press(&mut harness, "joint 2");
    press(&mut harness, text::RENAME);
    let field = harness.get_by_label(text::JOINT_NAME);
    field.focus();
    field.type_text(" of the tip");
    harness.run();
    harness.state_mut().commands.clear();
    harness.key_press(egui::Key::Enter);
    harness.run();
    let name = "joint 2 of the tip".to_owned();
    assert_eq!(harness.state().commands, [Command::RenameJoint { joint: 2, name: name.clone() }]);
    assert!(harness.query_all_by_label(&name).count() >= 2, "in the card and in the tree");
    assert!(!has(&harness, "joint 2"));
    press(&mut harness, text::RENAME);
    harness.get_by_label(text::JOINT_NAME).type_text("!");
    harness.run();
    harness.key_press(egui::Key::Escape);
    harness.run();
    assert_eq!(harness.state().state().character.edits.names[&2], name);
}

#[test]
fn the_model_can_be_saved_at_rest_and_as_it_stands() {
    let mut harness = strip(WIDE);
    harness.state_mut().panels.layout.tab = Tab::Info;
    harness.run();
    press(&mut harness, text::SAVE_REST_POSE);
    press(&mut harness, text::SAVE_CURRENT_POSE);
    let whole = |posed| UiAction::Save(Saved::File(Export::FullModel { posed }));
    assert_eq!(harness.state().actions, [whole(false), whole(true)]);
    let mut harness = sample_bench(WIDE);
    harness.state_mut().panels.layout.tab = Tab::Info;
    harness.run();
    assert!(!has(&harness, text::SAVE_CURRENT_POSE), "a glTF is one already");
}

#[test]
fn boxes_and_smooth_surfaces_are_in_the_display_tab() {
    let mut harness = strip(WIDE);
    harness.state_mut().panels.layout.tab = Tab::Display;
    harness.run();
    let smooth = Show { smooth: true, ..Show::default() };
    assert_eq!(press(&mut harness, text::SMOOTH_SURFACE), [Command::SetShow(smooth)]);
    let boxes = Show { boxes: true, skeleton: true, ..smooth };
    assert_eq!(press(&mut harness, text::SKELETON_BOXES), [Command::SetShow(boxes)]);
    let mut harness = sample_bench(WIDE);
    harness.state_mut().panels.layout.tab = Tab::Display;
    harness.run();
    assert!(!has(&harness, text::SMOOTH_SURFACE), "the sample has normals");
}
