//! Keyboard shortcuts and their table.

use egui::{Event, Key};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use gaitway::ui::{KEY_TABLE, RecordingProgress, Tab, UiAction, text};
use gaitway_scene::library::ClipId;
use gaitway_scene::state::{CameraChoice, Channel, ClipChoice, Command};

use crate::bench::{Bench, WIDE, motion_bench, press, press_key, sample_bench};
use crate::header::choose;
use crate::motion::press_row;

#[test]
fn keys_do_what_the_help_says() {
    let clip = |index| Command::SetClip(ClipChoice::Clip(ClipId::Own(index)));
    let turn = |yaw_radians| Command::Orbit { yaw_radians, pitch_radians: 0.0 };
    let cases = [
        (Key::Space, Command::TogglePlaying),
        (Key::Comma, Command::StepFrames(-1)),
        (Key::Period, Command::StepFrames(1)),
        (Key::ArrowUp, Command::Zoom { factor: 0.9, right: 0.0, up: 0.0 }),
        (Key::ArrowDown, Command::Zoom { factor: 1.0 / 0.9, right: 0.0, up: 0.0 }),
        (Key::ArrowLeft, turn(-0.12)),
        (Key::ArrowRight, turn(0.12)),
        (Key::Num1, clip(0)),
        (Key::Num3, clip(2)),
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
fn one_key_cycles_through_channels_and_shift_goes_back() {
    let mut harness = sample_bench(WIDE);
    let shown = |harness: &Harness<'_, Bench>| harness.state().state().display.channel;
    for channel in Channel::ALL.into_iter().skip(1).chain([Channel::Shaded]) {
        press_key(&mut harness, Key::V);
        assert_eq!(shown(&harness), channel);
    }
    for channel in [Channel::Wireframe, Channel::Influences] {
        harness.key_press_modifiers(egui::Modifiers::SHIFT, Key::V);
        harness.run();
        assert_eq!(shown(&harness), channel);
    }
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
fn presses_within_a_frame_keep_their_order() {
    let mut harness = sample_bench(WIDE);
    for key in [Key::Z, Key::Y, Key::Z, Key::Z, Key::Y] {
        let modifiers = egui::Modifiers::COMMAND;
        let event = egui::Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers };
        harness.input_mut().events.push(event);
    }
    harness.step();
    let (undo, redo) = (UiAction::Undo, UiAction::Redo);
    assert_eq!(harness.state().actions, [undo.clone(), redo.clone(), undo.clone(), undo, redo]);
}

/// As after the Tab key.
#[test]
fn a_control_with_the_keyboard_takes_its_own_keys_only() {
    let mut harness = sample_bench(WIDE);
    harness.get_by_label(text::SHARE).focus();
    harness.run();
    assert_eq!(press_key(&mut harness, Key::F), [Command::FrameAll]);
    assert_eq!(press_key(&mut harness, Key::Period), [Command::StepFrames(1)]);
    for key in [Key::Space, Key::ArrowDown, Key::Home] {
        harness.get_by_label(text::SHARE).focus();
        harness.run();
        assert!(press_key(&mut harness, key).is_empty(), "{key:?}");
    }
}

#[test]
fn keys_scroll_the_help() {
    let mut harness = sample_bench(WIDE);
    press_key(&mut harness, Key::Questionmark);
    let top = |harness: &Harness<'_, Bench>| harness.get_by_label("Play or pause").rect().top();
    let first = top(&harness);
    press_key(&mut harness, Key::ArrowDown);
    let after_arrow = top(&harness);
    assert!(after_arrow < first - 20.0, "{after_arrow} after {first}");
    press_key(&mut harness, Key::End);
    assert!(top(&harness) < after_arrow - 20.0);
    assert!(press_key(&mut harness, Key::Home).is_empty(), "the camera stays");
    assert_eq!(top(&harness), first);
}

#[test]
fn typing_is_not_taken_for_keys() {
    let mut harness = sample_bench(WIDE);
    harness.get_by_label(text::SEARCH_NODES).click();
    harness.run();
    assert!(press_key(&mut harness, Key::F).is_empty());
    assert!(press_key(&mut harness, Key::Space).is_empty());
}

/// The events of pressing and releasing a key.
fn typed(key: Key, text: &str) -> Vec<Event> {
    let event = |pressed| {
        let modifiers = egui::Modifiers::NONE;
        Event::Key { key, physical_key: None, pressed, repeat: false, modifiers }
    };
    let text = (!text.is_empty()).then(|| Event::Text(text.to_owned()));
    [event(true)].into_iter().chain(text).chain([event(false)]).collect()
}

/// Sends all events in one frame, as a slow machine does; returns the commands.
fn in_one_frame(harness: &mut Harness<'_, Bench>, events: impl IntoIterator<Item = Event>) -> Vec<Command> {
    harness.state_mut().commands.clear();
    harness.input_mut().events.extend(events);
    harness.step();
    harness.run();
    std::mem::take(&mut harness.state_mut().commands)
}

fn click(at: egui::Pos2) -> Vec<Event> {
    let button = egui::PointerButton::Primary;
    let event = |pressed| Event::PointerButton { pos: at, button, pressed, modifiers: egui::Modifiers::NONE };
    vec![Event::PointerMoved(at), event(true), event(false)]
}

#[test]
fn a_number_typed_in_the_frame_of_its_click_is_no_shortcut() {
    let mut harness = sample_bench(WIDE);
    let at = harness.get_by_label(text::SPEED_VALUE).rect().center();
    let events = [click(at), typed(Key::Num2, "2"), typed(Key::Enter, "")].concat();
    assert_eq!(in_one_frame(&mut harness, events), [Command::SetSpeed(2.0)]);
    // What follows Enter no longer goes to the field.
    let events = [click(at), typed(Key::Num3, "3"), typed(Key::Enter, ""), typed(Key::Space, " ")].concat();
    assert_eq!(in_one_frame(&mut harness, events), [Command::SetSpeed(3.0), Command::TogglePlaying]);
}

#[test]
fn a_name_typed_in_the_frame_of_its_click_is_no_shortcut() {
    let mut harness = sample_bench(WIDE);
    harness.state_mut().editor.apply(Command::SelectJoint(Some(1)));
    harness.run();
    let at = harness.get_by_label(text::RENAME).rect().center();
    let name = [typed(Key::C, "c"), typed(Key::S, "s"), typed(Key::Space, " "), typed(Key::W, "w")].concat();
    let select = Event::Key {
        key: Key::A,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: egui::Modifiers::COMMAND,
    };
    let events = [click(at), vec![select], name.clone(), typed(Key::Enter, "")].concat();
    let renamed = Command::RenameJoint { joint: 1, name: "cs w".to_owned() };
    assert_eq!(in_one_frame(&mut harness, events), [renamed]);
    // Esc only leaves the field.
    let events = [click(at), name, typed(Key::Escape, "")].concat();
    assert!(in_one_frame(&mut harness, events).is_empty());
    assert_eq!(harness.state().state().selection.joint, Some(1));
}

#[test]
fn the_help_takes_the_focus_and_gives_it_back() {
    let is_focused = |harness: &Harness<'_, Bench>, label: &str| {
        harness.query_all_by_label(label).any(|node| node.accesskit_node().is_focused())
    };
    let mut harness = sample_bench(WIDE);
    harness.get_by_label(text::VIEWPORT).focus();
    harness.run();
    for closing in [&[Key::Escape][..], &[Key::Questionmark], &[Key::Tab, Key::Enter]] {
        press_key(&mut harness, Key::Questionmark);
        assert!(is_focused(&harness, text::HELP_TITLE));
        closing.iter().for_each(|&key| drop(press_key(&mut harness, key)));
        assert!(!harness.state().panels.help.is_open && is_focused(&harness, text::VIEWPORT), "{closing:?}");
    }
    harness.get_by_label(text::MENU).focus();
    press_key(&mut harness, Key::Enter);
    harness.get_by_label(text::HELP).focus();
    press_key(&mut harness, Key::Enter);
    assert!(is_focused(&harness, text::HELP_TITLE));
    press_key(&mut harness, Key::Escape);
    assert!(is_focused(&harness, text::MENU));
}

/// The page dims what is around the canvas.
#[test]
fn every_modal_dialog_is_reported() {
    type Act = fn(&mut Harness<'_, Bench>);
    let dialogs: [(&str, Act, Act); 4] = [
        (
            "help",
            |harness| drop(press_key(harness, Key::Questionmark)),
            |harness| {
                drop(press_key(harness, Key::Escape));
            },
        ),
        (
            "about",
            |harness| choose(harness, text::MENU, text::ABOUT),
            |harness| {
                drop(press(harness, text::CLOSE_ABOUT));
            },
        ),
        (
            "picker",
            |harness| {
                press(harness, Tab::Motion.label());
                press_row(harness, &text::follows("Neck", ""));
            },
            |harness| drop(press(harness, text::CANCEL)),
        ),
        (
            "recording",
            |harness| {
                harness.state_mut().panels.host.recording = Some(RecordingProgress { frames_done: 1, frame_count: 2 });
            },
            |harness| harness.state_mut().panels.host.recording = None,
        ),
    ];
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    for (name, open, close) in dialogs {
        assert!(!harness.state().panels.has_modal(), "before {name}");
        open(&mut harness);
        assert!(harness.state().panels.has_modal(), "{name}");
        close(&mut harness);
        harness.run();
        assert!(!harness.state().panels.has_modal(), "after {name}");
    }
}

#[test]
fn the_help_opens_while_a_control_has_the_focus() {
    let mut harness = sample_bench(WIDE);
    harness.get_by_label(text::MENU).focus();
    harness.run();
    for closing in [Key::Questionmark, Key::Escape] {
        press_key(&mut harness, Key::Questionmark);
        assert!(harness.state().panels.help.is_open);
        press_key(&mut harness, closing);
        assert!(!harness.state().panels.help.is_open, "{closing:?}");
    }
}

#[test]
fn escape_closes_a_list_and_nothing_else() {
    let mut harness = sample_bench(WIDE);
    harness.state_mut().editor.apply(Command::SelectJoint(Some(5)));
    press(&mut harness, Tab::Display.label());
    press(&mut harness, text::CHANNEL);
    assert!(egui::Popup::is_any_open(&harness.ctx));
    assert_eq!(press_key(&mut harness, Key::Escape), []);
    assert!(!egui::Popup::is_any_open(&harness.ctx));
    assert_eq!(press_key(&mut harness, Key::Escape), [Command::SelectJoint(None)]);
}

#[test]
fn a_menu_closes_when_the_focus_leaves_it_and_gives_it_back_on_escape() {
    let mut harness = sample_bench(WIDE);
    let focused = |harness: &Harness<'_, Bench>| harness.ctx.memory(egui::Memory::focused);
    for menu in [text::EXPORT, text::MENU] {
        let open = |harness: &mut Harness<'_, Bench>| {
            harness.get_by_label(menu).focus();
            harness.run();
            let button = focused(harness);
            press_key(harness, Key::Enter);
            press_key(harness, Key::Tab);
            assert!(egui::Popup::is_any_open(&harness.ctx) && focused(harness) != button, "{menu}: Tab leads into it");
            button
        };
        let button = open(&mut harness);
        press_key(&mut harness, Key::Escape);
        assert!(!egui::Popup::is_any_open(&harness.ctx));
        assert_eq!(focused(&harness), button, "{menu}");
        open(&mut harness);
        for _ in 0..20 {
            press_key(&mut harness, Key::Tab);
        }
        assert!(!egui::Popup::is_any_open(&harness.ctx), "{menu}: Tab leads out of it");
        assert!(focused(&harness).is_some_and(|id| Some(id) != button));
    }
}

#[test]
fn choosing_with_a_key_closes_the_list() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, Tab::Display.label());
    press(&mut harness, text::CHANNEL);
    harness.get_by_label(text::channel(Channel::Metallic)).focus();
    harness.run();
    assert_eq!(press_key(&mut harness, Key::Enter), [Command::SetChannel(Channel::Metallic)]);
    assert!(!egui::Popup::is_any_open(&harness.ctx));
}

#[test]
fn the_help_lists_every_key_and_closes() {
    let mut harness = sample_bench(WIDE);
    press_key(&mut harness, Key::Questionmark);
    for line in KEY_TABLE {
        assert!(harness.query_all_by_label(line.does).next().is_some(), "{}", line.does);
        assert!(!line.keys.contains("  "), "keys are separated by commas: {}", line.keys);
    }
    assert!(press_key(&mut harness, Key::Space).is_empty(), "nothing plays behind the help");
    press(&mut harness, text::CLOSE_HELP);
    assert!(!harness.state().panels.help.is_open);
    press(&mut harness, text::MENU);
    press(&mut harness, text::HELP);
    assert!(harness.state().panels.help.is_open, "the press that opens it does not close it");
    press_key(&mut harness, Key::Escape);
    assert!(!harness.state().panels.help.is_open);
}
