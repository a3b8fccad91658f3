//! The bottom panel.

use egui::{PointerButton, pos2};
use egui_kittest::kittest::Queryable;
use gaitway::ui::text;
use gaitway_character::anim::{LoopMode, TimeRange};
use gaitway_scene::state::{ClipChoice, Command};

use crate::bench::{NARROW, WIDE, drag, press, press_key, sample_bench};

#[test]
fn play_becomes_pause() {
    let mut harness = sample_bench(WIDE);
    assert_eq!(press(&mut harness, text::PLAY), [Command::TogglePlaying]);
    assert_eq!(press(&mut harness, text::PAUSE), [Command::TogglePlaying]);
    assert!(!harness.state().state().playback.playing);
}

#[test]
fn frames_are_stepped() {
    let mut harness = sample_bench(WIDE);
    assert_eq!(press(&mut harness, text::NEXT_FRAME), [Command::StepFrames(1)]);
    assert_eq!(press(&mut harness, text::PREVIOUS_FRAME), [Command::StepFrames(-1)]);
}

#[test]
fn loop_modes_are_chosen_side_by_side_or_in_turn() {
    let modes =
        [(text::PLAY_ONCE, LoopMode::Once), (text::PING_PONG, LoopMode::PingPong), (text::LOOP, LoopMode::Loop)];
    let mut harness = sample_bench(WIDE);
    for (label, mode) in modes {
        assert_eq!(press(&mut harness, label), [Command::SetLoopMode(mode)]);
    }
    let mut harness = sample_bench(NARROW);
    let in_turn =
        [(text::LOOP, LoopMode::PingPong), (text::PING_PONG, LoopMode::Once), (text::PLAY_ONCE, LoopMode::Loop)];
    for (label, next) in in_turn {
        assert_eq!(press(&mut harness, label), [Command::SetLoopMode(next)]);
    }
}

#[test]
fn esc_leaves_a_number_as_it_was_before_typing() {
    let mut harness = sample_bench(WIDE);
    let mut typed = |number: &str, key| {
        harness.get_by_label(text::SPEED_VALUE).focus();
        harness.run();
        harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
        harness.get_by_label(text::SPEED_VALUE).type_text(number);
        harness.run();
        let meanwhile = std::mem::take(&mut harness.state_mut().commands);
        assert_eq!(meanwhile, [], "nothing is set while typing");
        press_key(&mut harness, key)
    };
    assert_eq!(typed("3", egui::Key::Escape), []);
    assert_eq!(typed("2,5", egui::Key::Enter), [Command::SetSpeed(2.5)]);
    assert_eq!(typed("0.5", egui::Key::Escape), []);
    assert_eq!(harness.state().state().playback.speed, 2.5);
}

#[test]
fn scrubbing_seeks_and_holds_the_time() {
    let mut harness = sample_bench(WIDE);
    let bar = harness.get_by_label(text::TIME).rect();
    let y = bar.top() + 8.0;
    let commands = drag(&mut harness, pos2(bar.left() + 20.0, y), pos2(bar.center().x, y), PointerButton::Primary);
    let Some(Command::Seek(secs)) = commands.last() else { panic!("{commands:?}") };
    let half = f64::from(harness.state().library().active().unwrap().asset.clips[0].duration_secs()) / 2.0;
    assert!((secs - half).abs() < 0.01, "{secs} is not about {half}");
    assert!(!harness.state().panels.holds_time, "let go");
}

#[test]
fn in_and_out_points_are_set_dragged_and_cleared() {
    let mut harness = sample_bench(WIDE);
    harness.state_mut().change(|state| {
        state.character.playhead.time_secs = 0.5;
    });
    harness.run();
    let duration = f64::from(harness.state().library().active().unwrap().asset.clips[0].duration_secs());
    let range = TimeRange { start_secs: 0.5, end_secs: duration };
    assert_eq!(press(&mut harness, text::SET_IN_POINT), [Command::SetRange(Some(range))]);
    let (handle, bar) =
        (harness.get_by_label(text::OUT_POINT).rect().center(), harness.get_by_label(text::TIME).rect());
    let three_quarters = bar.left() + 0.75 * bar.width();
    let commands = drag(&mut harness, handle, pos2(three_quarters, handle.y), PointerButton::Primary);
    let Some(Command::SetRange(Some(range))) = commands.last() else { panic!("{commands:?}") };
    assert_eq!(range.start_secs, 0.5);
    assert!((range.end_secs - 0.75 * duration).abs() < 0.01, "{range:?}");
    assert_eq!(press(&mut harness, text::CLEAR_RANGE), [Command::SetRange(None)]);
}

#[test]
fn a_dragged_in_or_out_point_stops_at_the_other() {
    let duration = f64::from(sample_bench(WIDE).state().library().active().unwrap().asset.clips[0].duration_secs());
    let set = TimeRange { start_secs: 0.25 * duration, end_secs: 0.75 * duration };
    for (dragged, share) in [(text::IN_POINT, 0.9), (text::OUT_POINT, 0.1)] {
        let mut harness = sample_bench(WIDE);
        harness.state_mut().change(|state| state.character.playhead.range = Some(set));
        harness.run();
        let (handle, bar) = (harness.get_by_label(dragged).rect().center(), harness.get_by_label(text::TIME).rect());
        let beyond = pos2(bar.left() + share * bar.width(), handle.y);
        drag(&mut harness, handle, beyond, PointerButton::Primary);
        let range = harness.state().state().character.playhead.range.expect("is set");
        let (kept, was) =
            if dragged == text::IN_POINT { (range.end_secs, set.end_secs) } else { (range.start_secs, set.start_secs) };
        assert_eq!(kept, was, "{dragged}: the other stays");
        assert!((range.end_secs - range.start_secs - 1.0 / 30.0).abs() < 1e-6, "{dragged}: {range:?}");
    }
}

#[test]
fn handles_that_meet_can_both_be_grabbed() {
    let duration = f64::from(sample_bench(NARROW).state().library().active().unwrap().asset.clips[0].duration_secs());
    let middle = 0.5 * duration;
    for side in [-1.0, 1.0] {
        let mut harness = sample_bench(NARROW);
        let set = TimeRange { start_secs: middle, end_secs: middle + 1.0 / 30.0 };
        harness.state_mut().change(|state| state.character.playhead.range = Some(set));
        harness.run();
        let [start, end] = [text::IN_POINT, text::OUT_POINT].map(|label| harness.get_by_label(label).rect());
        assert!(start.right() <= end.left() + 0.01, "{start:?} {end:?}");
        let inner = if side < 0.0 { start.right() } else { end.left() };
        let from = pos2(inner + side * 4.0, start.center().y);
        drag(&mut harness, from, pos2(from.x + side * 100.0, from.y), PointerButton::Primary);
        let range = harness.state().state().character.playhead.range.expect("is set");
        let (moved, kept) = if side < 0.0 {
            (set.start_secs - range.start_secs, range.end_secs - set.end_secs)
        } else {
            (range.end_secs - set.end_secs, range.start_secs - set.start_secs)
        };
        assert!(moved > 1.0 / 30.0 && kept == 0.0, "{side}: {range:?}");
    }
}

/// With an out point at the beginning, or an in point at the end, nothing would play.
#[test]
fn a_range_has_at_least_one_frame() {
    let mut harness = sample_bench(WIDE);
    let duration = f64::from(harness.state().library().active().unwrap().asset.clips[0].duration_secs());
    for (at, button) in [(0.0, text::SET_OUT_POINT), (duration, text::SET_IN_POINT)] {
        harness
            .state_mut()
            .change(|state| (state.character.playhead.time_secs, state.character.playhead.range) = (at, None));
        harness.run();
        press(&mut harness, button);
        let range = harness.state().state().character.playhead.range.expect("is set");
        assert!((range.end_secs - range.start_secs - 1.0 / 30.0).abs() < 1e-6, "{range:?} from {at}");
        assert!(range.start_secs >= 0.0 && range.end_secs <= duration, "{range:?}");
    }
}

#[test]
fn speed_goes_from_a_tenth_to_four_times() {
    let mut harness = sample_bench(WIDE);
    let bar = harness.get_by_role_and_label(egui::accesskit::Role::Slider, text::SPEED).rect();
    let across = |x: f32| pos2(x, bar.center().y);
    drag(&mut harness, bar.center(), across(bar.right() + 50.0), PointerButton::Primary);
    assert_eq!(harness.state().state().playback.speed, 4.0);
    drag(&mut harness, across(bar.right() - 6.0), across(bar.left() - 50.0), PointerButton::Primary);
    assert_eq!(harness.state().state().playback.speed, 0.1);
}

#[test]
fn speed_is_a_menu_on_a_phone() {
    let mut harness = sample_bench(NARROW);
    press(&mut harness, &text::speed(1.0));
    assert_eq!(press(&mut harness, &text::speed(0.25)), [Command::SetSpeed(0.25)]);
}

#[test]
fn the_rest_pose_has_nothing_to_play() {
    let mut harness = sample_bench(WIDE);
    harness.state_mut().change(|state| {
        state.character.playhead.clip = ClipChoice::RestPose;
    });
    harness.run();
    assert!(press(&mut harness, text::PLAY).is_empty());
    assert!(harness.query_by_label(text::TIME).is_none());
}

#[test]
fn time_is_told_in_seconds_and_frames() {
    let mut harness = sample_bench(WIDE);
    harness.state_mut().change(|state| {
        state.character.playhead.time_secs = 0.5;
    });
    harness.run();
    assert!(harness.query_by_label(&text::seconds(0.5, 1.07)).is_some());
    assert!(harness.query_by_label(&text::frames(15.0, 32.0, 30.0)).is_some());
}
