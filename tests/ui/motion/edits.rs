//! Editing the map: sides, rotation offsets, channels, joints without a source, and undo.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gaitway::ui::{Tab, UiAction, text};
use gaitway_character::asset::Asset;
use gaitway_retarget::{ClipRef, MutedProperty, Unmapped};
use gaitway_scene::library::{Library, Model, Motion};
use gaitway_scene::samples;
use gaitway_scene::state::{Command, MapEdit, muted_properties};

use super::{choose, edit, map, motion_tab, neck_details, number, reach, says};
use crate::bench::{Bench, WIDE, bench_of, drag, press, press_key};
use crate::by_place::motion_called;

#[test]
fn whole_maps_are_swapped_cleared_and_restored() {
    let mut harness = motion_tab();
    let before = harness.state().state().clone();
    let [left, right] = ["LeftHand", "RightHand"].map(|name| number(&harness, name));
    assert_eq!(press(&mut harness, text::SWAP_SIDES), [edit(MapEdit::SwapSides)]);
    let swapped = text::row("LeftHand", &text::joint(right, "RightHand"), text::IS_SURE);
    assert!(
        harness.query_by_label_contains(&swapped).is_some(),
        "swapping sides is deliberate, so there is no conflict"
    );
    press(&mut harness, text::UNDO_KEY);
    assert!(harness.query_by_label_contains(&text::follows("LeftHand", &text::joint(left, "LeftHand"))).is_some());
    press(&mut harness, text::REDO_KEY);
    assert!(harness.query_by_label_contains(&swapped).is_some());
    assert_eq!(press(&mut harness, text::CLEAR_MAP), [edit(MapEdit::Clear)]);
    assert!(harness.query_by_label(&text::joints_mapped(0, 0)).is_some());
    assert!(harness.query_by_label_contains(&text::row("Hips", text::NO_SOURCE, text::NO_SOURCE)).is_some());
    assert_eq!(press(&mut harness, text::REMATCH), [Command::SetMap { motion: motion_called("dance.bvh"), map: None }]);
    for _ in 0..3 {
        harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
        harness.run();
    }
    assert_eq!(harness.state().state(), &before);
}

/// The walker with other joint names, left and right exchanged, as by a converter that mirrors a model.
#[test]
fn sides_matched_by_position_are_matched_by_name_with_one_click() {
    let walker = samples::load("walker").expect("the sample is there");
    let skeleton = &walker.asset.skeleton;
    const WORDS: [(&str, &str); 12] = [
        ("UpperArm", "Humerus"),
        ("LowerArm", "Forearm"),
        ("Shoulder", "Clavicle"),
        ("Hand", "Wrist"),
        ("UpperLeg", "Thigh"),
        ("LowerLeg", "Shin"),
        ("Foot", "Ankle"),
        ("Toes", "Ball"),
        ("Hips", "Pelvis"),
        ("Spine", "Belly"),
        ("Chest", "Thorax"),
        ("Head", "Skull"),
    ];
    let reworded =
        |rest: &str| WORDS.iter().find(|(word, _)| *word == rest).map_or(rest, |(_, other)| other).to_owned();
    let exchanged = |name: &str| match (name.strip_prefix("Left"), name.strip_prefix("Right")) {
        (Some(rest), _) => format!("Right{}", reworded(rest)),
        (_, Some(rest)) => format!("Left{}", reworded(rest)),
        _ => reworded(name),
    };
    let names: Vec<(usize, String)> =
        skeleton.joints().map(|joint| (skeleton.source_index(joint), exchanged(skeleton.name(joint)))).collect();
    let renamed = skeleton.with_names(names.iter().map(|(number, name)| (*number, name.as_str())));
    let mut library = Library::default();
    library.add(Model::new("mirrored.glb".to_owned(), Asset::from(renamed), Vec::new()));
    library.set_motions(vec![Motion::new("dance.bvh".to_owned(), walker.asset.clone())]);
    let mut harness = bench_of(WIDE, library);
    press(&mut harness, Tab::Motion.label());
    let at = |name: &str| skeleton.source_index(skeleton.find(name).expect(name));
    let by_position = text::row("LeftWrist", &text::joint(at("RightHand"), "RightHand"), text::IS_GUESS);
    let by_name = text::row("LeftWrist", &text::joint(at("LeftHand"), "LeftHand"), text::IS_SURE);
    assert!(harness.query_by_label_contains(&by_position).is_some());
    assert!(harness.query_by_label_contains(text::sides_matched(true)).is_some());
    assert!(harness.query_by_label(text::SWAP_SIDES).is_none(), "one control per effect");
    assert_eq!(press(&mut harness, text::MATCH_SIDES_BY_NAME), [edit(MapEdit::SwapSides)]);
    assert!(harness.query_by_label_contains(&by_name).is_some());
    assert!(harness.query_by_label_contains(text::sides_matched(false)).is_some());
    press(&mut harness, text::MATCH_SIDES_BY_POSITION);
    assert!(harness.query_by_label_contains(&by_position).is_some());
}

/// A button that was reached with the tab key keeps the focus; its edits can still be undone.
#[test]
fn undo_works_while_a_button_has_the_focus() {
    let mut harness = motion_tab();
    harness.get_by_label(text::SWAP_SIDES).focus();
    harness.run();
    assert_eq!(press_key(&mut harness, egui::Key::Enter), [edit(MapEdit::SwapSides)]);
    let undo = |harness: &mut Harness<'_, Bench>| {
        harness.state_mut().actions.clear();
        harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
        harness.run();
        harness.state().actions.clone()
    };
    assert_eq!(undo(&mut harness), [UiAction::Undo]);
    // In a text field, the shortcut undoes typing.
    harness.get_by_label(text::SEARCH_JOINTS).focus();
    harness.run();
    assert_eq!(undo(&mut harness), []);
}

#[test]
fn a_rotation_offset_is_dragged_and_reset() {
    let (mut harness, neck) = neck_details();
    harness.get_by_label(&text::rotation_offset_about("Y")).scroll_to_me();
    harness.run();
    let from = harness.get_by_label(&text::rotation_offset_about("Y")).rect().center();
    let commands = drag(&mut harness, from, from + egui::vec2(40.0, 0.0), egui::PointerButton::Primary);
    assert!(!commands.is_empty());
    let turned = map(&harness, 0).joints[&neck].correction;
    let (axis, angle) = turned.to_axis_angle();
    assert!(axis.abs_diff_eq(glam::Vec3::Y, 1e-4) && angle > 0.05, "{axis} {angle}");
    assert!(says(&harness, &format!("· {}", text::HAS_OFFSET)));
    let reset = reach(&mut harness, text::RESET_OFFSET);
    assert_eq!(reset, [edit(MapEdit::Correction { target: neck, correction: glam::Quat::IDENTITY })]);
    // The drag was one step, the reset another.
    press(&mut harness, text::UNDO_KEY);
    assert_eq!(map(&harness, 0).joints[&neck].correction, turned);
    press(&mut harness, text::UNDO_KEY);
    assert_eq!(map(&harness, 0).joints[&neck].correction, glam::Quat::IDENTITY);
    assert!(!harness.state().editor.can_undo());
}

#[test]
fn channels_of_a_source_can_be_ignored() {
    let (mut harness, neck) = neck_details();
    let [_, rotation, scale] = text::CHANNELS;
    let mute = |property, muted| [edit(MapEdit::Mute { source: neck, property, muted })];
    assert_eq!(reach(&mut harness, &text::ignore_channels(rotation)), mute(MutedProperty::Rotation, true));
    assert!(harness.query_by_label_contains(&text::follows("Neck", "")).is_some());
    assert!(says(&harness, &text::ignored(rotation)));
    assert_eq!(muted_properties(&map(&harness, 0), neck), [false, true, false]);
    assert_eq!(reach(&mut harness, &text::ignore_channels(rotation)), mute(MutedProperty::Rotation, false));
    reach(&mut harness, &text::ignore_channels(scale));
    press(&mut harness, text::OPTIONS);
    assert_eq!(reach(&mut harness, text::USE_ALL_CHANNELS), [edit(MapEdit::UnmuteAll)]);
}

/// Whoever works with keys goes on where they were.
#[test]
fn the_row_has_the_focus_after_its_details_were_closed_by_a_key() {
    let (mut harness, neck) = neck_details();
    harness.get_by_label(text::CLEAR_SOURCE).focus();
    harness.run();
    let clear = Command::SetSource { motion: motion_called("dance.bvh"), target: neck, source: None };
    assert_eq!(press_key(&mut harness, egui::Key::Enter), [clear]);
    assert!(harness.get_by_label(text::LIST_SOURCES).is_focused(), "there is nothing more to clear");
    assert_eq!(press_key(&mut harness, egui::Key::Escape), [Command::SelectJoint(None)]);
    assert!(harness.get_by_label(&text::edit_joint("Neck")).is_focused());
}

#[test]
fn a_joint_without_a_source_can_have_its_own_policy() {
    let (mut harness, neck) = neck_details();
    let clear = Command::SetSource { motion: motion_called("dance.bvh"), target: neck, source: None };
    assert_eq!(reach(&mut harness, text::CLEAR_SOURCE), [clear]);
    let frozen = Unmapped::Clip { clip: ClipRef::Index(2), frozen: true };
    let commands = choose(&mut harness, text::OWN_POLICY, &text::first_key_of("Wave"));
    assert_eq!(commands, [edit(MapEdit::Unmapped { target: neck, unmapped: Some(frozen) })]);
    assert!(says(&harness, &text::holds_first_key("Wave")));
    let commands = choose(&mut harness, text::OWN_POLICY, &text::default_policy(text::REST));
    assert_eq!(commands, [edit(MapEdit::Unmapped { target: neck, unmapped: None })]);
}
