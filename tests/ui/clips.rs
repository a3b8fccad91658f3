//! The left panel.

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use gaitway::ui::text;
use gaitway_character::anim::{ClipBuilder, Joint, JointIndex, Skeleton};
use gaitway_character::asset::{Asset, AssetParts, MeshInstance};
use gaitway_character::mesh::{Geometry, Mesh};
use gaitway_scene::editor::Contents;
use gaitway_scene::library::{ClipId, Model, Motion};
use gaitway_scene::state::{ClipChoice, Command};

use crate::bench::{Bench, WIDE, bench, model_with_clips, press, sample_bench};
use crate::by_place::motion_called;

#[test]
fn every_clip_and_the_rest_pose_can_be_chosen() {
    let mut harness = sample_bench(WIDE);
    for (name, index) in [("Wave", 2), ("Idle", 1), ("Walk", 0)] {
        let expected = Command::SetClip(ClipChoice::Clip(ClipId::Own(index)));
        assert_eq!(press(&mut harness, name), [expected], "{name}");
    }
    assert_eq!(press(&mut harness, text::REST_POSE), [Command::SetClip(ClipChoice::RestPose)]);
}

#[test]
fn the_chosen_clip_is_in_sight() {
    let mut harness = bench(WIDE, model_with_clips(60));
    let is_in_sight = |harness: &Harness<'_, Bench>| {
        let row = harness.get_by_label("Move 50").rect();
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, harness.ctx.content_rect().size());
        screen.contains_rect(row)
    };
    assert!(!is_in_sight(&harness));
    harness.state_mut().change(|state| {
        state.character.playhead.clip = ClipChoice::called("Move 50");
    });
    harness.run_steps(30);
    assert!(is_in_sight(&harness));
    harness.set_size(egui::vec2(WIDE[0], 0.6 * WIDE[1]));
    harness.run_steps(30);
    assert!(is_in_sight(&harness), "the list got shorter");
}

/// Even if a search would hide it, or another motion's clip has the same index.
#[test]
fn a_borrowed_clip_is_selected_and_in_sight() {
    let mut harness = bench(WIDE, model_with_clips(60));
    harness.get_by_label(&text::search_clips(60)).click();
    harness.run();
    harness.get_by_label(&text::search_clips(60)).type_text("move 59");
    harness.run();
    let borrow = |harness: &mut Harness<'_, Bench>, name: &str| {
        let asset = model_with_clips(3).asset;
        let motions = Some(vec![Motion::new(name.to_owned(), asset)]);
        let contents = Contents { motions, ..Contents::default() };
        harness.state_mut().editor.open(contents, None, &mut |_| Ok(())).expect("has the same joint");
        harness.run_steps(40);
        let row = harness.get_by_label("Move 0 (2)");
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, WIDE.into());
        assert!(screen.contains_rect(row.rect()), "{name}: {:?}", row.rect());
        assert_eq!(row.accesskit_node().toggled(), Some(egui::accesskit::Toggled::True));
    };
    borrow(&mut harness, "first.glb");
    let scrolled = harness.get_by_label("Move 0 (2)").rect().center();
    harness.event(egui::Event::PointerMoved(scrolled));
    harness.run();
    for _ in 0..40 {
        harness.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Line,
            delta: egui::vec2(0.0, 10.0),
            source: egui::MouseWheelSource::Wheel,
            phase: egui::TouchPhase::Move,
            modifiers: egui::Modifiers::NONE,
        });
        harness.step();
    }
    harness.run_steps(120);
    assert!(harness.get_by_label("Move 0 (2)").rect().top() > WIDE[1], "scrolled away");
    harness.state_mut().editor.remove_motion(&motion_called("first.glb"));
    borrow(&mut harness, "second.glb");
}

#[test]
fn a_model_without_clips_is_told_what_it_lacks() {
    let skeleton = Skeleton::new(vec![Joint { name: "Chair".to_owned(), ..Joint::default() }]).expect("one joint");
    let positions = vec![glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Y];
    let geometry = Geometry { file_vertices: 3, positions, indices: vec![0, 1, 2], ..Geometry::default() };
    let parts = AssetParts {
        skeleton,
        meshes: vec![Mesh { primitives: vec![geometry], ..Mesh::default() }],
        instances: vec![MeshInstance::new(JointIndex(0), 0, None)],
        ..AssetParts::default()
    };
    let chair = Model::new("chair.glb".to_owned(), Asset::new(parts).expect("indices in range"), Vec::new());
    for (model, told, not_told) in
        [(model_with_clips(0), text::NO_CLIPS, text::NO_SKELETON), (chair, text::NO_SKELETON, text::NO_CLIPS)]
    {
        let harness = bench(WIDE, model);
        assert!(harness.query_by_label(told).is_some() && harness.query_by_label(not_told).is_none(), "{told}");
    }
}

#[test]
fn few_clips_need_no_search() {
    assert!(sample_bench(WIDE).query_by_label(&text::search_clips(3)).is_none());
}

#[test]
fn search_narrows_many_clips_and_can_be_cleared() {
    let mut harness = bench(WIDE, model_with_clips(12));
    harness.get_by_label(&text::search_clips(12)).click();
    harness.run();
    harness.get_by_label(&text::search_clips(12)).type_text("move 11");
    harness.run();
    assert!(harness.query_by_label("Move 11").is_some());
    assert!(harness.query_by_label("Move 3").is_none());
    let expected = Command::SetClip(ClipChoice::Clip(ClipId::Own(11)));
    assert_eq!(press(&mut harness, "Move 11"), [expected]);
    press(&mut harness, text::CLEAR_SEARCH);
    assert!(harness.query_by_label("Move 3").is_some());
}

/// A row that is wider than its panel widens the panel, again in every pass.
#[test]
fn a_search_leaves_the_panels_as_wide_as_they_are() {
    let mut harness = bench(WIDE, model_with_clips(12));
    let width = harness.state().viewport.width();
    for field in [&text::search_clips(12), text::SEARCH_NODES] {
        harness.get_by_label(field).click();
        harness.run();
        harness.get_by_label(field).type_text("o");
        harness.run_steps(20);
        assert_eq!(harness.state().viewport.width(), width, "{field}");
    }
}

#[test]
fn a_name_that_is_cut_is_told_in_full_under_the_pointer() {
    let mut model = model_with_clips(2);
    let long = "One_Handed_Melee_Attack_Slice_Horizontal";
    let asset = std::sync::Arc::get_mut(&mut model.asset).expect("nobody else has it");
    let mut parts = std::mem::take(asset).into_parts();
    parts.clips[1] = ClipBuilder::new(long.to_owned(), &parts.skeleton).build();
    *asset = Asset::new(parts).expect("indices in range");
    let mut harness = bench(WIDE, model);
    for (name, told) in [("Move 0", 1), (long, 2)] {
        harness.get_by_label(name).hover();
        harness.run_steps(60);
        assert_eq!(harness.query_all_by_label(name).count(), told, "{name}");
    }
}
