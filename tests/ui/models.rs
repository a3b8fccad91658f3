//! Several models at once, and undoing an open.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gaitway::ui::{Tab, Toast, UiAction, text};
use gaitway_scene::library::{Library, Model};
use gaitway_scene::samples;

use crate::bench::{Bench, NARROW, WIDE, bench, bench_of, painted, press, sample_bench};

fn two_models() -> Library {
    let mut library = Library::default();
    let first = library.add(samples::load("walker").expect("the sample is there"));
    let asset = library.get(first).expect("just set").asset.clone();
    library.add(Model::new("folder/other.glb".to_owned(), asset, Vec::new()));
    library
}

#[test]
fn models_are_listed_when_there_are_several() {
    assert!(sample_bench(WIDE).query_by_label(&text::close_model("Walker")).is_none(), "one needs no list");
    for size in [WIDE, NARROW] {
        let mut harness = bench_of(size, two_models());
        if size == NARROW {
            press(&mut harness, text::CLIPS);
        }
        let first = harness.state().library().models()[0].id;
        press(&mut harness, "Walker");
        assert_eq!(harness.state().actions, [UiAction::ShowModel(first)], "{size:?}");
        assert!(harness.query_by_label(&text::close_model("other.glb")).is_some(), "what is shown can be closed too");
        harness.state_mut().actions.clear();
        press(&mut harness, &text::close_model("Walker"));
        assert_eq!(harness.state().actions, [UiAction::CloseModel(first)]);
    }
}

#[test]
fn the_shown_model_is_in_sight_among_many() {
    let mut library = two_models();
    let asset = library.active().expect("there are two").asset.clone();
    for index in library.models().len()..Library::MAX_MODELS {
        library.add(Model::new(format!("{index}.glb"), asset.clone(), Vec::new()));
    }
    let mut harness = bench_of([1280.0, 400.0], library);
    harness.run_steps(30);
    let last = text::close_model(&format!("{}.glb", Library::MAX_MODELS - 1));
    // Its section leaves room for the clips.
    let section = harness.get_by_label(text::CLIPS_SECTION).rect();
    assert!(harness.get_by_label(&last).rect().bottom() <= section.top());
    assert!(harness.get_by_label(text::REST_POSE).rect().bottom() < 400.0);
}

#[test]
fn models_of_one_name_are_told_apart() {
    let mut library = two_models();
    let asset = library.active().expect("there are two").asset.clone();
    library.add(Model::new("elsewhere/other.glb".to_owned(), asset, Vec::new()));
    let harness = bench_of(WIDE, library);
    for name in ["Walker", "other.glb (1)", &text::close_model("other.glb (1)"), "other.glb (2)"] {
        assert_eq!(harness.query_all_by_label(name).count(), 1, "{name}");
    }
}

#[test]
fn an_error_takes_the_place_of_a_toast_that_goes() {
    let mut harness = sample_bench(WIDE);
    harness.state_mut().panels.messages.error = Some("broken.glb: it is not a GLB file".to_owned());
    harness.run();
    let place = |harness: &Harness<'_, Bench>| harness.get_by_label(text::DISMISS_ERROR).rect();
    let before = place(&harness);
    harness.state_mut().panels.messages.toast =
        Some(Toast { text: "Opened Fox.".to_owned(), until_secs: 1e9, undoable: false, other: None });
    // A toast waits for its end.
    harness.step();
    harness.step();
    harness.step();
    assert!(place(&harness).bottom() < before.bottom() - 20.0);
    harness.state_mut().panels.messages.toast = None;
    harness.run();
    assert_eq!(place(&harness), before);
}

#[test]
fn what_was_opened_has_a_button_to_undo_it() {
    for size in [WIDE, NARROW, [320.0, 480.0]] {
        let mut harness = sample_bench(size);
        let text = "Opened a-rather-long-name-of-a-character.glb. 3 others are in the list of models.".to_owned();
        harness.state_mut().panels.messages.toast = Some(Toast { text, until_secs: 1e9, undoable: true, other: None });
        harness.step();
        harness.step();
        harness.step();
        let button = harness.get_by_label(text::UNDO).rect();
        let words = harness.get_by_label_contains("Opened a-rather").rect();
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        assert!(screen.contains_rect(button) && screen.contains_rect(words), "{button:?} {words:?} on {size:?}");
        assert!(!button.intersects(words), "{button:?} over {words:?}");
        harness.get_by_label(text::UNDO).click();
        harness.step();
        harness.step();
        assert_eq!(harness.state().actions, [UiAction::Undo]);
        assert!(harness.state().panels.messages.toast.is_none());
    }
}

/// A link whose model is unavailable: the stage says so, and how to supply it.
#[test]
fn an_empty_stage_says_what_it_waits_for_and_keeps_the_offer() {
    for size in [WIDE, NARROW] {
        let mut harness = bench(size, Model::placeholder("file:in/Soldier.glb"));
        assert!(harness.query_by_label(&text::waiting_for("Soldier.glb")).is_some());
        let opened = painted(&harness).into_iter().find(|(text, ..)| text.contains("Opened from"));
        assert_eq!(opened, None, "it isn't yet");
        press(&mut harness, text::BRING);
        assert_eq!(harness.state().actions, [UiAction::OpenFiles]);
        assert!(harness.query_by_label(text::NO_SKELETON).is_none());
        assert!(harness.query_all_by_label(text::BRING_HERE).next().is_some());
        let failed = bench(size, Model::placeholder("https://example.org/a/Soldier.glb"));
        assert!(failed.query_by_label(&text::couldnt_load("Soldier.glb")).is_some());
        assert!(failed.query_by_label(text::BRING).is_some());
        // Nothing in the panels depends on a model being there.
        if size == NARROW {
            press(&mut harness, text::INSPECTOR);
        }
        for tab in [Tab::Scene, Tab::Display, Tab::Info, Tab::Camera] {
            press(&mut harness, tab.label());
        }
    }
}
