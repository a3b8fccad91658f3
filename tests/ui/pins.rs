//! Pinning joints: the section of the selected joint's card, and the handles in the viewport.

use egui::{PointerButton, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gaitway::app::mirror::entries;
use gaitway::ui::{Saved, Tab, UiAction, text};
use gaitway_character::anim::TimeRange;
use gaitway_retarget::{Pin, PinGoal, PinTimes};
use gaitway_scene::editor::Export;
use gaitway_scene::library::ClipId;
use gaitway_scene::state::{Command, Embed};
use glam::Vec3;

use crate::bench::{Bench, NARROW, WIDE, drag, painted, press, sample_bench};
use crate::mirror::tree_of;
use crate::motion::{choose, reach};

/// Joints of the walker, by index in the file.
const HEAD: usize = 5;
const LEFT_HAND: usize = 9;
const LEFT_SHOULDER: usize = 6;

fn selected(size: [f32; 2], joint: usize) -> Harness<'static, Bench> {
    let mut harness = sample_bench(size);
    harness.state_mut().editor.apply(Command::SelectJoint(Some(joint)));
    harness.run();
    harness
}

fn place(bench: &Bench, joint: usize) -> Vec3 {
    let skeleton = &bench.library().active().expect("a model").asset.skeleton;
    let joint = skeleton.joint_of_source(joint).expect("a joint");
    bench.frame.characters[0].world_from_joint[joint.get()].translation.into()
}

fn on_screen(bench: &Bench, at: Vec3) -> Pos2 {
    let view = &bench.frame.view;
    let at = view.projection_from_view * view.view_from_world * at.extend(1.0);
    let (x, y) = (0.5 + 0.5 * at.x / at.w, 0.5 - 0.5 * at.y / at.w);
    bench.viewport.min + vec2(x * bench.viewport.width(), y * bench.viewport.height())
}

fn pin_of(harness: &Harness<'_, Bench>, joint: usize) -> Option<Pin> {
    harness.state().state().character.edits.pins.get(&joint).copied()
}

fn choice(harness: &mut Harness<'_, Bench>, about: &str, option: &str) -> Vec<Command> {
    reach(harness, &text::labelled(about, option))
}

#[test]
fn a_hand_is_pinned_where_it_is_dragged_and_let_go() {
    for size in [WIDE, NARROW] {
        let mut harness = selected(WIDE, LEFT_HAND);
        let before = place(harness.state(), LEFT_HAND);
        choice(&mut harness, text::PIN, text::PIN_TO_POINT);
        let pinned = pin_of(&harness, LEFT_HAND).expect("is pinned");
        assert!(matches!(pinned.goal, PinGoal::Point(at) if at.distance(before) < 1e-3), "it stays: {pinned:?}");
        harness.set_size(size.into());
        harness.run();
        let handle = on_screen(harness.state(), before);
        let to = handle + vec2(-20.0, -30.0);
        let commands = drag(&mut harness, handle, to, PointerButton::Primary);
        let are_pins = commands.iter().all(|command| matches!(command, Command::SetPin { joint: LEFT_HAND, .. }));
        assert!(!commands.is_empty() && are_pins, "{commands:?}");
        harness.run();
        let hand = place(harness.state(), LEFT_HAND);
        assert!(hand.distance(before) > 0.02, "{hand}");
        assert!(on_screen(harness.state(), hand).distance(to) < 3.0, "{} {to}", on_screen(harness.state(), hand));
        harness.set_size(WIDE.into());
        harness.run();
        press(&mut harness, text::UNDO_STEP);
        assert_eq!(pin_of(&harness, LEFT_HAND), Some(pinned), "the drag is one step");
        choice(&mut harness, text::PIN, text::NOT_PINNED);
        assert_eq!(pin_of(&harness, LEFT_HAND), None);
        assert!(place(harness.state(), LEFT_HAND).distance(before) < 1e-6);
    }
}

#[test]
fn time_stands_still_over_a_handle_and_the_camera_turns_beside_it() {
    let mut harness = selected(WIDE, LEFT_HAND);
    choice(&mut harness, text::PIN, text::PIN_TO_POINT);
    let handle = on_screen(harness.state(), place(harness.state(), LEFT_HAND));
    let corner = harness.state().viewport.left_bottom() + vec2(30.0, -30.0);
    for (at, holds) in [(handle, true), (corner, false)] {
        harness.event(egui::Event::PointerMoved(at));
        harness.run();
        assert_eq!(harness.state().panels.holds_time, holds, "{at}");
    }
    let commands = drag(&mut harness, corner, corner + vec2(50.0, 0.0), PointerButton::Primary);
    assert!(!commands.is_empty() && commands.iter().all(|command| matches!(command, Command::Orbit { .. })));
}

#[test]
fn a_pin_does_not_widen_the_card() {
    let mut harness = selected([1024.0, 768.0], LEFT_HAND);
    let width =
        |harness: &Harness<'_, Bench>| harness.get_by_label(&text::labelled(text::PIN, text::NOT_PINNED)).rect();
    let before = width(&harness);
    choice(&mut harness, text::PIN, text::PIN_TO_POINT);
    assert_eq!(width(&harness).x_range(), before.x_range());
}

#[test]
fn numbers_are_read_as_they_are_shown_and_by_what_they_belong_to() {
    let mut harness = selected(WIDE, LEFT_HAND);
    choice(&mut harness, text::PIN, text::PIN_TO_POINT);
    let entries = entries(&tree_of(&mut harness));
    let Some(Pin { goal: PinGoal::Point(goal), .. }) = pin_of(&harness, LEFT_HAND) else { panic!("a pin") };
    for (axis, coordinate) in [("X", goal.x), ("Y", goal.y), ("Z", goal.z)] {
        let name = text::labelled(text::PINNED_TO, axis);
        let field = entries.iter().find(|entry| entry["name"] == name).expect("a field");
        let now = field["now"].as_f64().expect("a number");
        assert!((now - f64::from(coordinate)).abs() <= 0.005 && (100.0 * now).fract() == 0.0, "{now} for {coordinate}");
        assert_eq!(field["value"], format!("{axis} {now} m"));
    }
}

#[test]
fn a_hand_is_pinned_to_another_joint() {
    let mut harness = selected(WIDE, LEFT_HAND);
    let before = place(harness.state(), LEFT_HAND);
    choice(&mut harness, text::PIN, text::PIN_TO_JOINT);
    choose(&mut harness, text::PINNED_TO, "Head");
    assert!(matches!(pin_of(&harness, LEFT_HAND), Some(Pin { goal: PinGoal::Joint(HEAD, _), .. })));
    harness.run();
    assert!(place(harness.state(), LEFT_HAND).distance(before) < 5e-3, "it stays");
    let handle = on_screen(harness.state(), before);
    drag(&mut harness, handle, handle + vec2(-25.0, 0.0), PointerButton::Primary);
    assert!(matches!(pin_of(&harness, LEFT_HAND), Some(Pin { goal: PinGoal::Joint(HEAD, _), .. })));
    harness.run();
    assert!(place(harness.state(), LEFT_HAND).distance(before) > 0.02);
}

#[test]
fn a_head_looks_at_the_camera_or_a_point() {
    let mut harness = selected(WIDE, HEAD);
    choice(&mut harness, text::LOOK, text::LOOK_CAMERA);
    assert_eq!(pin_of(&harness, HEAD), Some(Pin { goal: PinGoal::Camera, times: None }));
    choice(&mut harness, text::LOOK, text::LOOK_POINT);
    assert!(matches!(pin_of(&harness, HEAD), Some(Pin { goal: PinGoal::Look(_), .. })));
    assert!(harness.query_by_label(text::PINNED_TO).is_none());
}

#[test]
fn a_coordinate_that_rounds_to_zero_has_no_sign() {
    let mut harness = selected(WIDE, LEFT_HAND);
    let goal = PinGoal::Point(Vec3::new(-0.002, 1.0, -0.0));
    harness.state_mut().editor.apply(Command::SetPin { joint: LEFT_HAND, pin: Some(Pin { goal, times: None }) });
    harness.run();
    let texts: Vec<_> = painted(&harness).into_iter().map(|(text, ..)| text).collect();
    // A field is painted as three texts.
    let numbers: Vec<_> = texts.windows(2).filter(|texts| texts[1] == " m").map(|texts| &texts[0]).collect();
    assert_eq!(numbers, ["0.00", "1.00", "0.00"]);
}

/// A joint that isn't at the end of two bones has no such choice.
#[test]
fn only_ends_of_limbs_are_pinned() {
    let harness = selected(WIDE, 1);
    assert!(harness.query_by_label(&text::labelled(text::PIN, text::PIN_TO_POINT)).is_none());
    let harness = selected(WIDE, LEFT_SHOULDER);
    assert!(harness.query_by_label(&text::labelled(text::PIN, text::PIN_TO_POINT)).is_some(), "two bones of the spine");
}

#[test]
fn a_pin_holds_in_the_range_with_a_blend() {
    let mut harness = selected(WIDE, LEFT_HAND);
    choice(&mut harness, text::PIN, text::PIN_TO_POINT);
    let range = TimeRange { start_secs: 0.25, end_secs: 0.75 };
    harness.state_mut().editor.apply(Command::SetRange(Some(range)));
    harness.run();
    reach(&mut harness, text::PIN_IN_RANGE);
    let times = pin_of(&harness, LEFT_HAND).and_then(|pin| pin.times).expect("is limited");
    assert_eq!((times.start_secs, times.end_secs), (0.25, 0.75));
    harness.get_by_label(text::BLEND).set_value_accesskit(0.5);
    harness.run();
    let blended = pin_of(&harness, LEFT_HAND).and_then(|pin| pin.times).expect("is limited");
    assert_eq!(blended, PinTimes { blend_secs: 0.5, ..times });
    assert!(harness.query_by_label(&text::pin_times(blended)).is_some());
    assert!(harness.query_by_label(&track_of(&harness, blended)).is_some());
    assert!(harness.query_by_label(text::PIN_TO_RANGE).is_none(), "it has the range");
    harness.state_mut().editor.apply(Command::SetRange(Some(TimeRange { start_secs: 0.1, end_secs: 0.5 })));
    harness.run();
    assert_eq!(pin_of(&harness, LEFT_HAND).and_then(|pin| pin.times), Some(blended), "it keeps its times");
    reach(&mut harness, text::PIN_TO_RANGE);
    let moved = pin_of(&harness, LEFT_HAND).and_then(|pin| pin.times);
    assert_eq!(moved, Some(PinTimes { start_secs: 0.1, end_secs: 0.5, blend_secs: 0.5 }));
    reach(&mut harness, text::PIN_IN_RANGE);
    assert_eq!(pin_of(&harness, LEFT_HAND).and_then(|pin| pin.times), None);
}

fn track_of(harness: &Harness<'_, Bench>, times: PinTimes) -> String {
    let skeleton = &harness.state().library().active().expect("a model").asset.skeleton;
    let name = |joint| skeleton.name(skeleton.joint_of_source(joint).expect("a joint"));
    let pin = pin_of(harness, LEFT_HAND).expect("is pinned");
    let other = if let PinGoal::Joint(other, _) = pin.goal { Some(name(other)) } else { None };
    text::pin_track(&text::pin_to(name(LEFT_HAND), pin.goal, other), &text::pin_times(times))
}

#[test]
fn a_pin_with_times_has_a_track_under_the_timeline() {
    for size in [WIDE, NARROW] {
        let mut harness = sample_bench(size);
        let goal = PinGoal::Joint(HEAD, Vec3::ZERO);
        let times = PinTimes { start_secs: 0.25, end_secs: 0.75, blend_secs: 0.1 };
        let pin = |times| Command::SetPin { joint: LEFT_HAND, pin: Some(Pin { goal, times }) };
        harness.state_mut().editor.apply(pin(None));
        let track = track_of(&harness, times);
        assert!(track.contains(" pinned to Head. Holds from 0.25 s"), "{track}");
        harness.run();
        assert!(harness.query_by_label(&track).is_none(), "it always holds");
        harness.state_mut().editor.apply(pin(Some(times)));
        harness.run();
        let (row, timeline) = (harness.get_by_label(&track).rect(), harness.get_by_label(text::TIME).rect());
        assert!(row.top() >= timeline.bottom() && row.bottom() <= size[1], "{row:?} below {timeline:?}");
        let name = painted(&harness).into_iter().find(|(_, _, rect)| row.contains(rect.center()));
        let (name, is_cut, rect) = name.expect("the pin's name");
        assert!(name.ends_with(": Head"), "{name}");
        assert!(!is_cut && rect.right() <= timeline.left() + 8.0, "{rect:?} left of {timeline:?}");
        harness.state_mut().change(|state| state.page.embed = Embed::Page);
        harness.run();
        assert!(harness.query_by_label(&track).is_none(), "an embedded view has none");
    }
}

/// The model's own clip is exported with its pins, as one more clip.
#[test]
fn a_pinned_clip_can_be_saved() {
    let mut harness = selected(WIDE, LEFT_HAND);
    press(&mut harness, text::EXPORT);
    assert!(harness.query_by_label(text::SAVE_GLB).is_none());
    press(&mut harness, text::EXPORT);
    choice(&mut harness, text::PIN, text::PIN_TO_POINT);
    crate::header::choose(&mut harness, text::EXPORT, text::SAVE_GLB);
    assert_eq!(harness.state().actions, [UiAction::Save(Saved::File(Export::Model { clip: ClipId::Own(0) }))]);
}

/// So that nobody has to remember which joints are pinned.
#[test]
fn the_motion_tab_lists_pins_which_are_selected_and_removed_there() {
    let mut harness = sample_bench(WIDE);
    let goals = [(LEFT_HAND, PinGoal::Joint(HEAD, Vec3::ZERO)), (HEAD, PinGoal::Camera)];
    for (joint, goal) in goals {
        let pin = Some(Pin { goal, times: None });
        harness.state_mut().editor.apply(Command::SetPin { joint, pin });
    }
    press(&mut harness, Tab::Motion.label());
    let row = text::pin_to("LeftHand", goals[0].1, Some("Head"));
    assert_eq!(reach(&mut harness, &row), [Command::SelectJoint(Some(LEFT_HAND))]);
    assert_eq!(reach(&mut harness, &row), [Command::SelectJoint(None)]);
    assert!(harness.query_by_label(&text::pin_to("Head", PinGoal::Camera, None)).is_some());
    let removed = Command::SetPin { joint: LEFT_HAND, pin: None };
    assert_eq!(reach(&mut harness, &text::remove_pin("LeftHand")), [removed]);
    assert!(harness.query_by_label(&row).is_none() && pin_of(&harness, LEFT_HAND).is_none());
}
