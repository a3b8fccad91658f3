//! The part of the Motion tab that edits the clip.

use egui::accesskit::Role;
use egui::{Event, Modifiers, PointerButton, Pos2, TouchDeviceId, TouchId, TouchPhase, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use gaitway::ui::{Saved, Sheet, Tab, UiAction, text};
use gaitway_character::anim::TimeRange;
use gaitway_retarget::ClipChanges;
use gaitway_scene::editor::Export;
use gaitway_scene::library::ClipId;
use gaitway_scene::state::{ClipChoice, ClipEdit, Command};

use crate::bench::{Bench, NARROW, WIDE, motion_bench, press, press_key, sample_bench};
use crate::by_place::{ByPlace, motion_called};
use crate::header::choose;

#[test]
fn the_current_clip_is_changed_and_undone() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, Tab::Motion.label());
    harness.get_by_label(text::MIRROR).scroll_to_me();
    harness.run();
    let pose = |harness: &Harness<'_, Bench>| harness.state().frame.pose().clone();
    let before = pose(&harness);
    let mirrored = ClipChanges { mirror: true, ..ClipChanges::default() };
    assert_eq!(
        press(&mut harness, text::MIRROR),
        [Command::EditClip { clip: ClipId::Own(0), edit: ClipEdit::Change(Box::new(mirrored.clone())) }]
    );
    assert_ne!(pose(&harness), before);
    let clips = &harness.state().state().character.edits.clips;
    assert_eq!(clips.changes.values().collect::<Vec<_>>(), [&mirrored]);
    let mark = |harness: &Harness<'_, Bench>| {
        let row = harness.get_by_label("Walk");
        row.accesskit_node().description()
    };
    let trimmed = ClipChanges { trim: Some(TimeRange { start_secs: 0.0, end_secs: 0.5 }), ..mirrored.clone() };
    assert_eq!(text::changes(&trimmed), "Changed: mirrored, trimmed");
    assert_eq!(mark(&harness), Some(text::changes(&mirrored)));
    choose(&mut harness, text::EXPORT, text::SAVE_GLB);
    assert_eq!(harness.state().actions, [UiAction::Save(Saved::File(Export::Model { clip: ClipId::Own(0) }))]);
    press(&mut harness, text::UNDO_STEP);
    assert!(harness.state().state().character.edits.clips.changes.is_empty());
    assert_eq!(pose(&harness), before);
    assert_eq!(mark(&harness), None);
}

/// A link may change a clip by more than the sliders span.
#[test]
fn changes_beyond_the_sliders_stay() {
    let mut harness = sample_bench(WIDE);
    let far = ClipChanges { turn_degrees: 270.0, offset: [20.0, -7.0], loop_secs: Some(3.0), ..ClipChanges::NONE };
    harness
        .state_mut()
        .editor
        .apply(Command::EditClip { clip: ClipId::Own(0), edit: ClipEdit::Change(Box::new(far.clone())) });
    press(&mut harness, Tab::Motion.label());
    harness.get_by_label(text::MIRROR).scroll_to_me();
    harness.run();
    // Nor does the keyboard change them on its way through the fields.
    harness.get_by_label(&text::value_of(text::TURN_PATH)).focus();
    for _ in 0..6 {
        harness.run();
        harness.key_press(egui::Key::Tab);
    }
    harness.run();
    assert_eq!(harness.state().state().character.edits.clips.changes.values().collect::<Vec<_>>(), [&far]);
}

#[test]
fn the_range_becomes_the_clip() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, Tab::Motion.label());
    harness.get_by_label(text::TRIM_TO_RANGE).scroll_to_me();
    harness.run();
    assert!(harness.get_by_label(text::TRIM_TO_RANGE).accesskit_node().is_disabled());
    let range = TimeRange { start_secs: 0.25, end_secs: 0.75 };
    harness.state_mut().editor.apply(Command::SetRange(Some(range)));
    harness.run();
    press(&mut harness, text::TRIM_TO_RANGE);
    let duration = |harness: &Harness<'_, Bench>| {
        let model = harness.state().editor.library().active().expect("a model");
        model.clip_at(0).duration_secs()
    };
    assert_eq!(duration(&harness), 0.5);
    assert_eq!(harness.state().state().character.playhead.range, None);
    // A part of the part, in its own time.
    let range = TimeRange { start_secs: 0.125, end_secs: 0.375 };
    harness.state_mut().editor.apply(Command::SetRange(Some(range)));
    harness.run();
    press(&mut harness, text::TRIM_TO_RANGE);
    let trim = TimeRange { start_secs: 0.375, end_secs: 0.625 };
    let trimmed = ClipChanges { trim: Some(trim), ..ClipChanges::NONE };
    assert_eq!(harness.state().state().character.edits.clips.changes.values().collect::<Vec<_>>(), [&trimmed]);
    assert_eq!(duration(&harness), 0.25);
    press(&mut harness, text::UNDO_TRIM);
    assert!(duration(&harness) > 0.75);
}

#[test]
fn a_borrowed_clip_is_changed_in_the_motion_tab_and_tells_its_seam() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    harness.state_mut().editor.apply(Command::SetClip(ClipChoice::called("3")));
    harness.run();
    press(&mut harness, Tab::Motion.label());
    press(&mut harness, text::CLIP);
    harness.get_by_label(text::MAKE_LOOP).scroll_to_me();
    harness.run();
    press(&mut harness, text::MAKE_LOOP);
    let model = harness.state().editor.library().active().expect("a model");
    let seam = model.clip_at(3).changed().and_then(|changed| changed.seam).expect("is measured");
    let told = text::seam(seam);
    assert!(harness.query_by_label(&told).is_some(), "{told}");
    harness.get_by_label(text::RESET_CHANGES).scroll_to_me();
    harness.run();
    press(&mut harness, text::RESET_CHANGES);
    assert!(harness.state().state().character.edits.clips.changes.is_empty());
}

#[test]
fn the_range_becomes_a_new_clip_which_can_be_removed() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, Tab::Motion.label());
    let range = TimeRange { start_secs: 0.25, end_secs: 0.75 };
    harness.state_mut().editor.apply(Command::SetRange(Some(range)));
    harness.run();
    harness.get_by_label(text::TRIM_TO_COPY).scroll_to_me();
    harness.run();
    press(&mut harness, text::TRIM_TO_COPY);
    let row = |harness: &Harness<'_, Bench>, name: &str| {
        harness.query_by_label(name).map(|row| (row.rect().top(), row.accesskit_node().description()))
    };
    let (part, described) = row(&harness, "Walk part 1").expect("is listed");
    assert_eq!(described.as_deref(), Some("Changed: trimmed"));
    let [walk, wave] = ["Walk", "Wave"].map(|name| row(&harness, name).expect("is listed").0);
    assert!(walk < part && part < wave, "it follows its original");
    harness.get_by_label(text::REMOVE_COPY).scroll_to_me();
    harness.run();
    press(&mut harness, text::REMOVE_COPY);
    assert_eq!(row(&harness, "Walk part 1"), None);
    assert!(harness.query_by_label(text::REMOVE_COPY).is_none(), "the original can't be removed");
}

fn touch(phase: TouchPhase, pos: Pos2) -> Event {
    Event::Touch { device_id: TouchDeviceId(1), id: TouchId(1), phase, pos, force: None }
}

/// Moves a finger over the screen, as the browser does: it presses and lifts a pointer, each in a frame of its own, before it tells
/// that there is a finger. Returns what that does.
fn swipe(harness: &mut Harness<'_, Bench>, from: Pos2, by: Vec2) -> Vec<Command> {
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    harness.state_mut().commands.clear();
    harness.event(button(from, true));
    harness.step();
    harness.event(button(from, true));
    harness.event(touch(TouchPhase::Start, from));
    harness.step();
    for step in 1..=4 {
        let at = from + by * (step as f32 / 4.0);
        harness.event(Event::PointerMoved(at));
        harness.event(touch(TouchPhase::Move, at));
        harness.step();
    }
    harness.event(button(from + by, false));
    harness.step();
    harness.event(button(from + by, false));
    harness.event(Event::PointerGone);
    harness.event(touch(TouchPhase::End, from + by));
    harness.run();
    std::mem::take(&mut harness.state_mut().commands)
}

/// The panel is nearly as wide as a phone, and most of it is sliders.
#[test]
fn a_finger_on_a_slider_scrolls_up_and_down_and_drags_sideways() {
    let slider = |harness: &Harness<'_, Bench>| harness.get_by_role_and_label(Role::Slider, text::BAKED_SPEED).rect();
    let number = |harness: &Harness<'_, Bench>| harness.get_by_label(&text::value_of(text::BAKED_SPEED)).rect();
    for size in [WIDE, NARROW] {
        let mut harness = sample_bench(size);
        harness.state_mut().panels.layout.sheet = Some(Sheet::Inspector);
        harness.state_mut().panels.layout.tab = Tab::Motion;
        // The finger that has opened the panel.
        for phase in [TouchPhase::Start, TouchPhase::End] {
            harness.event(touch(phase, Pos2::ZERO));
        }
        harness.run();
        for place in [slider, number] {
            let before = place(&harness);
            assert_eq!(swipe(&mut harness, before.center(), vec2(4.0, -40.0)), [], "on {size:?}");
            let moved = place(&harness).top() - before.top();
            assert!((moved + 40.0).abs() < 1.0, "scrolled by {moved} on {size:?}");
            let scrolled = place(&harness).center();
            assert_eq!(swipe(&mut harness, scrolled, vec2(-4.0, 40.0)), [], "on {size:?}");
            assert!((place(&harness).top() - before.top()).abs() < 1.0, "scrolled back");
            let commands = swipe(&mut harness, before.center(), vec2(40.0, 4.0));
            assert!(
                matches!(commands.last(), Some(Command::EditClip { edit: ClipEdit::Change(_), .. })),
                "{commands:?}"
            );
            assert_eq!(place(&harness).top(), before.top(), "stays");
        }
        let tapped = slider(&harness).left_center() + vec2(20.0, 0.0);
        let commands = swipe(&mut harness, tapped, Vec2::ZERO);
        assert!(matches!(commands.last(), Some(Command::EditClip { edit: ClipEdit::Change(_), .. })), "{commands:?}");
    }
}

/// Borrowed clips are renamed like the model's own; Esc leaves the name as it was.
#[test]
fn the_current_clip_is_renamed_and_undone() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    let clip = ClipId::Borrowed(motion_called("dance.bvh"), 0);
    harness.state_mut().editor.apply(Command::SetClip(ClipChoice::Clip(clip.clone())));
    press(&mut harness, Tab::Motion.label());
    press(&mut harness, text::CLIP);
    let enter = |harness: &mut Harness<'_, Bench>, name: &str, key| {
        harness.get_by_label(text::CLIP_NAME).focus();
        harness.run();
        harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
        harness.get_by_label(text::CLIP_NAME).type_text(name);
        harness.run();
        press_key(harness, key)
    };
    assert_eq!(enter(&mut harness, "Never", egui::Key::Escape), []);
    let rename = Command::EditClip { clip, edit: ClipEdit::Rename("Stroll".to_owned()) };
    assert_eq!(enter(&mut harness, "Stroll", egui::Key::Enter), [rename]);
    harness.run();
    assert!(harness.query_by_label("Stroll").is_some(), "in the list of clips");
    assert_eq!(harness.get_by_label(text::CLIP_NAME).value().as_deref(), Some("Stroll"));
    press(&mut harness, text::UNDO_STEP);
    assert!(harness.query_by_label("Walk (2)").is_some() && harness.query_by_label("Stroll").is_none());
}
