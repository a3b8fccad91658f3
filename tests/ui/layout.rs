//! What fits where: wide, narrow, folded, embedded; and what lies over the picture.

use egui_kittest::kittest::Queryable;
use gaitway::ui::{PathPrompt, PathPurpose, Progress, Sheet, UiAction};

use crate::bench::{NARROW, WIDE, bench, model_with_clips, press, sample_bench};

#[test]
fn panels_fold_away_and_come_back() {
    let mut harness = sample_bench(WIDE);
    let narrower = harness.state().picture.width();
    press(&mut harness, "Fold the inspector away");
    press(&mut harness, "Fold the clips away");
    assert!(harness.query_by_label("Rest pose").is_none());
    assert!(harness.query_by_label("Scene").is_none());
    assert_eq!(harness.state().picture.width(), WIDE[0]);
    press(&mut harness, "Show the clips");
    press(&mut harness, "Show the inspector");
    assert_eq!(harness.state().picture.width(), narrower);
}

#[test]
fn a_narrow_screen_has_sheets_one_at_a_time() {
    let mut harness = sample_bench(NARROW);
    assert_eq!(harness.state().picture.width(), NARROW[0]);
    assert!(harness.query_by_label("Rest pose").is_none());
    press(&mut harness, "Clips");
    assert!(harness.query_by_label("Rest pose").is_some());
    press(&mut harness, "Inspector");
    assert_eq!(harness.state().panels.sheet, Some(Sheet::Inspector));
    assert!(harness.query_by_label("Rest pose").is_none());
    press(&mut harness, "Close the sheet");
    assert_eq!(harness.state().panels.sheet, None);
}

/// The picture is what a sheet leaves free: the character stays in sight while a clip is chosen.
#[test]
fn a_sheet_does_not_hide_the_picture() {
    for size in [NARROW, [320.0, 240.0]] {
        let mut harness = sample_bench(size);
        let whole = harness.state().picture;
        press(&mut harness, "Clips");
        let above = harness.state().picture;
        assert!(above.height() >= 56.0 && above.height() < whole.height(), "{above:?} of {whole:?}");
        let row = harness.get_by_label("Rest pose").rect();
        assert!(above.bottom() <= row.top(), "{above:?} and {row:?}");
        press(&mut harness, "Close the sheet");
        assert_eq!(harness.state().picture, whole);
    }
}

#[test]
fn the_help_fits_small_screens() {
    for size in [[320.0, 240.0], NARROW, WIDE] {
        let mut harness = sample_bench(size);
        harness.state_mut().panels.help_open = true;
        harness.run();
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        for label in ["Keys and gestures", "Close the help"] {
            let rect = harness.get_by_label(label).rect();
            assert!(screen.contains_rect(rect), "{label} at {rect:?} on {size:?}");
        }
        for label in ["Comma, period", "One frame back, one frame on"] {
            let rect = harness.get_by_label(label).rect();
            assert!(
                screen.x_range().contains(rect.left()) && screen.x_range().contains(rect.right()),
                "{label}: {rect:?}"
            );
        }
    }
}

/// The transport is cut off nowhere, and no tab makes a side panel grow.
#[test]
fn everything_stays_on_the_screen() {
    for size in [NARROW, [360.0, 640.0], [700.0, 500.0], WIDE, [1920.0, 1080.0]] {
        let mut harness = bench(size, model_with_clips(30));
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        let narrow = size[0] < 700.0;
        for label in ["Play", "Next frame (.)", "Time", if narrow { "1×" } else { "Speed value" }] {
            let rect = harness.get_by_label(label).rect();
            assert!(screen.contains_rect(rect), "{label} at {rect:?} on {size:?}");
        }
        if narrow {
            press(&mut harness, "Inspector");
        }
        for tab in ["Display", "File", "View", "Scene"] {
            press(&mut harness, tab);
            for node in ["Scene", "View"] {
                let rect = harness.get_by_label(node).rect();
                assert!(screen.contains_rect(rect), "{node} at {rect:?} on {size:?} with {tab} open");
            }
        }
        assert!(harness.state().picture.width() >= 180.0, "{size:?}");
    }
}

#[test]
fn embedded_there_is_only_picture_and_transport() {
    let mut harness = sample_bench(WIDE);
    harness.state_mut().change(|state| {
        state.page.embed = true;
    });
    harness.run();
    assert_eq!(harness.state().picture.width(), WIDE[0]);
    assert!(harness.query_by_label("Play").is_some());
    for label in ["Rest pose", "Scene", "Keys (?)", "Open…"] {
        assert!(harness.query_by_label(label).is_none(), "{label}");
    }
}

#[test]
fn an_error_stays_until_dismissed() {
    let mut harness = sample_bench(WIDE);
    harness.state_mut().panels.error = Some("broken.glb: it is not a GLB file".to_owned());
    harness.run();
    assert!(harness.query_by_label("broken.glb: it is not a GLB file").is_some());
    press(&mut harness, "Dismiss the error");
    assert_eq!(harness.state().panels.error, None);
}

#[test]
fn a_load_shows_how_far_it_is() {
    let mut harness = sample_bench(WIDE);
    harness.state_mut().panels.progress = Some(Progress { name: "large.glb".to_owned(), fraction: Some(0.5) });
    harness.run();
    assert!(harness.query_by_label("Opening large.glb").is_some());
}

#[test]
fn nothing_repaints_by_itself() {
    let mut harness = sample_bench(WIDE);
    harness.run();
    assert_eq!(harness.run(), 1, "one step for the run itself and none after it");
}

#[test]
fn a_path_can_be_typed_where_there_is_no_dialog() {
    let mut harness = sample_bench(WIDE);
    harness.state_mut().panels.path_prompt = Some(PathPrompt { purpose: PathPurpose::Open, path: String::new() });
    harness.run();
    harness.get_by_label("Path").type_text("models/fox.glb");
    harness.run();
    assert!(press(&mut harness, "Open").is_empty());
    assert_eq!(harness.state().actions, [UiAction::UsePath(PathPurpose::Open, "models/fox.glb".to_owned())]);
    assert_eq!(harness.state().panels.path_prompt, None);
}
