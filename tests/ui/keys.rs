//! Keyboard shortcuts and their table.

use egui::Key;
use egui_kittest::kittest::Queryable;
use gaitway::state::{CameraChoice, ClipChoice, Command};
use gaitway::ui::{KEY_TABLE, UiAction, text};

use crate::bench::{WIDE, press, press_key, sample_bench};

#[test]
fn keys_do_what_the_help_says() {
    let clip = |name: &str| Command::SetClip(ClipChoice::Named(name.to_owned()));
    let turn = |yaw_radians| Command::Orbit { yaw_radians, pitch_radians: 0.0 };
    let cases = [
        (Key::Space, Command::TogglePlaying),
        (Key::Comma, Command::StepFrames(-1)),
        (Key::Period, Command::StepFrames(1)),
        (Key::ArrowUp, Command::Zoom { factor: 0.9, right: 0.0, up: 0.0 }),
        (Key::ArrowDown, Command::Zoom { factor: 1.0 / 0.9, right: 0.0, up: 0.0 }),
        (Key::ArrowLeft, turn(-0.12)),
        (Key::ArrowRight, turn(0.12)),
        (Key::Num1, clip("Walk")),
        (Key::Num3, clip("Wave")),
        (Key::F, Command::FrameAll),
        (Key::C, Command::SetFollow(true)),
        (Key::Home, Command::SetCamera(CameraChoice::Auto)),
    ];
    let mut harness = sample_bench(WIDE);
    for (key, expected) in cases {
        assert_eq!(press_key(&mut harness, key), [expected], "{key:?}");
    }
    assert!(press_key(&mut harness, Key::Num9).is_empty(), "there are three clips");
}

#[test]
fn undo_and_redo_are_asked_for() {
    let mut harness = sample_bench(WIDE);
    let command = egui::Modifiers::COMMAND;
    for (modifiers, key) in [(command, Key::Z), (command, Key::Y), (command | egui::Modifiers::SHIFT, Key::Z)] {
        harness.key_press_modifiers(modifiers, key);
        harness.run();
    }
    assert_eq!(harness.state().actions, [UiAction::Undo, UiAction::Redo, UiAction::Redo]);
}

#[test]
fn every_press_within_a_frame_counts() {
    let mut harness = sample_bench(WIDE);
    for pressed in [true, false].into_iter().cycle().take(6) {
        let (key, modifiers) = (Key::Z, egui::Modifiers::COMMAND);
        let event = egui::Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
        harness.input_mut().events.push(event);
    }
    harness.step();
    assert_eq!(harness.state().actions, [UiAction::Undo, UiAction::Undo, UiAction::Undo]);
}

#[test]
fn typing_is_not_taken_for_keys() {
    let mut harness = sample_bench(WIDE);
    harness.get_by_label(text::SEARCH_NODES).click();
    harness.run();
    assert!(press_key(&mut harness, Key::F).is_empty());
    assert!(press_key(&mut harness, Key::Space).is_empty());
}

#[test]
fn the_help_lists_every_key_and_closes() {
    let mut harness = sample_bench(WIDE);
    press_key(&mut harness, Key::Questionmark);
    for line in KEY_TABLE {
        assert!(harness.query_all_by_label(line.does).next().is_some(), "{}", line.does);
    }
    assert!(press_key(&mut harness, Key::Space).is_empty(), "nothing plays behind the help");
    press(&mut harness, text::CLOSE_HELP);
    assert!(!harness.state().panels.help.is_open);
    press(&mut harness, text::HELP);
    assert!(harness.state().panels.help.is_open, "the press that opens it does not close it");
    press_key(&mut harness, Key::Escape);
    assert!(!harness.state().panels.help.is_open);
}
