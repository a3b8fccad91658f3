//! The left panel.

use egui_kittest::kittest::Queryable;
use gaitway::state::{ClipChoice, Command};
use gaitway::ui::UiAction;

use crate::bench::{WIDE, bench, model_with_clips, press, sample_bench};

#[test]
fn every_clip_and_the_rest_pose_can_be_chosen() {
    let mut harness = sample_bench(WIDE);
    for name in ["Wave", "Idle", "Walk"] {
        let expected = Command::SetClip(ClipChoice::Named(name.to_owned()));
        assert_eq!(press(&mut harness, name), [expected], "{name}");
    }
    assert_eq!(press(&mut harness, "Rest pose"), [Command::SetClip(ClipChoice::RestPose)]);
}

#[test]
fn few_clips_need_no_search() {
    assert!(sample_bench(WIDE).query_by_label("Search 3 clips").is_none());
}

#[test]
fn search_narrows_many_clips_and_can_be_cleared() {
    let mut harness = bench(WIDE, model_with_clips(12));
    harness.get_by_label("Search 12 clips").click();
    harness.run();
    harness.get_by_label("Search 12 clips").type_text("move 11");
    harness.run();
    assert!(harness.query_by_label("Move 11").is_some());
    assert!(harness.query_by_label("Move 3").is_none());
    let expected = Command::SetClip(ClipChoice::Named("Move 11".to_owned()));
    assert_eq!(press(&mut harness, "Move 11"), [expected]);
    press(&mut harness, "Clear the search");
    assert!(harness.query_by_label("Move 3").is_some());
}

#[test]
fn open_and_copy_link_are_asked_of_the_host() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, "Open…");
    press(&mut harness, "Copy a link to this view");
    assert_eq!(harness.state().actions, [UiAction::OpenFiles, UiAction::CopyLink]);
}
