//! The left panel.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gaitway::anim::ClipBuilder;
use gaitway::asset::Asset;
use gaitway::state::{ClipChoice, Command};
use gaitway::ui::{UiAction, text};

use crate::bench::{Bench, WIDE, bench, model_with_clips, press, sample_bench};

#[test]
fn every_clip_and_the_rest_pose_can_be_chosen() {
    let mut harness = sample_bench(WIDE);
    for name in ["Wave", "Idle", "Walk"] {
        let expected = Command::SetClip(ClipChoice::Named(name.to_owned()));
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
        state.playhead.clip = ClipChoice::Named("Move 50".to_owned());
    });
    harness.run_steps(30);
    assert!(is_in_sight(&harness));
    harness.set_size(egui::vec2(WIDE[0], 0.6 * WIDE[1]));
    harness.run_steps(30);
    assert!(is_in_sight(&harness), "the list got shorter");
}

#[test]
fn the_buttons_of_the_header_stand_in_one_row() {
    for size in [WIDE, [1920.0, 1080.0], [800.0, 600.0]] {
        let harness = sample_bench(size);
        let [open, motion, share] =
            [text::OPEN, text::BORROW_MOTION, text::SHARE].map(|label| harness.get_by_label(label).rect());
        assert!(open.top() == motion.top() && motion.top() == share.top(), "{open:?} {motion:?} {share:?} on {size:?}");
        assert!(open.right() < motion.left() && motion.right() < share.left());
        assert!(share.right() < harness.state().viewport.left(), "{share:?} on {size:?}");
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
    let expected = Command::SetClip(ClipChoice::Named("Move 11".to_owned()));
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

#[test]
fn open_and_share_are_asked_of_the_host() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, text::OPEN);
    press(&mut harness, text::SHARE);
    assert_eq!(harness.state().actions, [UiAction::OpenFiles, UiAction::ShareLink]);
}
