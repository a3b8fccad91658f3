//! Pointer, wheel and fingers in the viewport.

use egui::{Event, Modifiers, PointerButton, TouchDeviceId, TouchId, TouchPhase, pos2, vec2};
use egui_kittest::Harness;
use gaitway_scene::state::{Command, Show};

use crate::bench::{Bench, NARROW, WIDE, drag, sample_bench};

#[test]
fn dragging_turns_or_moves_the_camera() {
    let mut harness = sample_bench(WIDE);
    let center = harness.state().viewport.center();
    let commands = drag(&mut harness, center, center + vec2(100.0, 40.0), PointerButton::Primary);
    let turned: (f32, f32) = commands.iter().fold((0.0, 0.0), |(yaw, pitch), command| match command {
        Command::Orbit { yaw_radians, pitch_radians } => (yaw + yaw_radians, pitch + pitch_radians),
        other => panic!("{other:?}"),
    });
    assert!(turned.0 < -0.5 && turned.1 > 0.2, "{turned:?}");
    for button in [PointerButton::Secondary, PointerButton::Middle] {
        let commands = drag(&mut harness, center, center + vec2(100.0, 40.0), button);
        assert!(!commands.is_empty());
        for command in commands {
            let Command::Pan { right, up } = command else { panic!("{command:?}") };
            assert!(right < 0.0 && up > 0.0);
        }
    }
}

/// One step of the wheel with the pointer here.
fn wheel(harness: &mut Harness<'_, Bench>, at: egui::Pos2) -> Vec<Command> {
    harness.event(Event::PointerMoved(at));
    harness.run();
    harness.state_mut().commands.clear();
    harness.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: vec2(0.0, 1.0),
        source: egui::MouseWheelSource::Wheel,
        phase: TouchPhase::Move,
        modifiers: Modifiers::NONE,
    });
    harness.run();
    std::mem::take(&mut harness.state_mut().commands)
}

#[test]
fn the_wheel_goes_nearer_towards_the_pointer() {
    let mut harness = sample_bench(WIDE);
    let picture = harness.state().viewport;
    for beside in [vec2(0.0, 0.0), vec2(0.25, -0.1)] {
        let mut together = 1.0;
        for command in wheel(&mut harness, picture.center() + beside * picture.height()) {
            let Command::Zoom { factor, right, up } = command else { panic!("{command:?}") };
            assert!((right - beside.x).abs() < 1e-3 && (up + beside.y).abs() < 1e-3, "{right} {up}");
            together *= factor;
        }
        assert!((0.5..0.99).contains(&together), "{together}");
    }
}

#[test]
fn two_fingers_pinch_and_move_but_do_not_turn() {
    let mut harness = sample_bench(NARROW);
    let center = harness.state().viewport.center();
    let touch =
        |id: u64, phase, pos| Event::Touch { device_id: TouchDeviceId(1), id: TouchId(id), phase, pos, force: None };
    // As the browser does, the first finger moves the pointer too.
    let finger = |apart: f32| center - vec2(apart, 0.0);
    harness.event(Event::PointerMoved(finger(50.0)));
    harness.event(Event::PointerButton {
        pos: finger(50.0),
        button: PointerButton::Primary,
        pressed: true,
        modifiers: Modifiers::NONE,
    });
    for (phase, apart) in [(TouchPhase::Start, 50.0), (TouchPhase::Move, 60.0), (TouchPhase::Move, 100.0)] {
        harness.event(touch(1, phase, finger(apart)));
        harness.event(Event::PointerMoved(finger(apart)));
        harness.event(touch(2, phase, center + vec2(apart, 20.0)));
        harness.run();
    }
    let commands = &harness.state().commands;
    assert!(
        commands.iter().any(|command| matches!(command, Command::Zoom { factor, .. } if *factor < 1.0)),
        "{commands:?}"
    );
    assert!(!commands.iter().any(|command| matches!(command, Command::Orbit { .. })), "{commands:?}");
}

#[test]
fn a_click_on_a_bone_chooses_its_joint_and_one_beside_it_none() {
    let mut harness = sample_bench(WIDE);
    harness.state_mut().change(|state| {
        state.display.show = Show { skeleton: true, ..Show::default() };
    });
    harness.run();
    let rect = harness.state().viewport;
    let (bone, point) = {
        let frame = &harness.state().frame;
        // A shin: nothing else is near its middle.
        let bone = *frame.bones.iter().find(|bone| bone.joint == 15).expect("bones are drawn");
        let middle = (0.5 * (bone.head + bone.tail)).extend(1.0);
        let at = frame.view.projection_from_view * frame.view.view_from_world * middle;
        (bone, glam::Vec2::new(at.x / at.w, at.y / at.w))
    };
    let on_screen =
        pos2(rect.left() + rect.width() * (0.5 + 0.5 * point.x), rect.top() + rect.height() * (0.5 - 0.5 * point.y));
    drag(&mut harness, on_screen, on_screen, PointerButton::Primary);
    assert_eq!(harness.state().state().selection.joint, Some(bone.joint as usize));
    assert_eq!(harness.state().panels.viewport.hovered_joint, Some(bone.joint as usize));
    let beside = rect.left_bottom() + vec2(12.0, -12.0);
    drag(&mut harness, beside, beside, PointerButton::Primary);
    assert_eq!(harness.state().state().selection.joint, None);
}

#[test]
fn a_double_click_frames() {
    let mut harness = sample_bench(WIDE);
    let center = harness.state().viewport.center();
    let event = |pressed| Event::PointerButton {
        pos: center,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    harness.event(Event::PointerMoved(center));
    for pressed in [true, false, true, false] {
        harness.event(event(pressed));
        harness.step();
    }
    assert!(harness.state().commands.contains(&Command::FrameAll), "{:?}", harness.state().commands);
}
