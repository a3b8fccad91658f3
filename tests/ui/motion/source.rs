//! Choosing the source of a joint: from the list, by typing, or by picking in the viewport.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gaitway::ui::{Tab, text};
use gaitway_scene::state::Command;

use super::{map, motion_tab, neck_details, number, press_row, reach};
use crate::bench::{Bench, NARROW, WIDE, drag, motion_bench, press, press_key};
use crate::by_place::motion_called;

/// Whether the list of sources is open. Its title is also the name of the dialog.
fn asks(harness: &Harness<'_, Bench>, target: &str) -> bool {
    harness.query_by_role_and_label(Role::Dialog, &text::what_follows(target)).is_some()
}

#[test]
fn another_source_is_chosen_from_a_list() {
    let mut harness = motion_tab();
    let (neck, head) = (number(&harness, "Neck"), number(&harness, "Head"));
    press_row(&mut harness, &text::follows("Neck", ""));
    assert!(asks(&harness, "Neck"));
    let commands = press(&mut harness, &text::joint(head, "Head"));
    assert_eq!(commands, [Command::SetSource { motion: motion_called("dance.bvh"), target: neck, source: Some(head) }]);
    assert!(!asks(&harness, "Neck"));
    assert!(harness.query_by_label_contains(&text::follows("Neck", &text::joint(head, "Head"))).is_some());
    assert_eq!(map(&harness, 0).joints[&neck].source, Some(head));
    press_row(&mut harness, &text::follows("Neck", ""));
    press(&mut harness, text::FOLLOW_NOTHING);
    assert!(harness.query_by_label_contains(&text::follows("Neck", text::NO_SOURCE)).is_some());
    // Matching again restores the proposal.
    press(&mut harness, text::REMATCH);
    assert!(harness.query_by_label_contains(&text::follows("Neck", &text::joint(neck, "Neck"))).is_some());
}

#[test]
fn a_source_is_typed_by_number_or_name() {
    let mut harness = motion_tab();
    let (neck, head, chest) = (number(&harness, "Neck"), number(&harness, "Head"), number(&harness, "Chest"));
    for (typed, source) in [(head.to_string(), head), ("chest".to_owned(), chest)] {
        press_row(&mut harness, &text::follows("Neck", ""));
        harness.get_by_label(text::SEARCH_SOURCES).type_text(&typed);
        harness.run();
        let commands = press_key(&mut harness, egui::Key::Enter);
        assert_eq!(
            commands,
            [Command::SetSource { motion: motion_called("dance.bvh"), target: neck, source: Some(source) }],
            "{typed}"
        );
    }
}

#[test]
fn a_source_is_chosen_by_arrow_keys() {
    let mut harness = motion_tab();
    let neck = number(&harness, "Neck");
    for (keys, source) in
        [(&[egui::Key::ArrowDown][..], neck + 1), (&[egui::Key::ArrowUp, egui::Key::ArrowUp], neck - 1)]
    {
        press_row(&mut harness, &text::follows("Neck", ""));
        keys.iter().for_each(|&key| assert_eq!(press_key(&mut harness, key), []));
        let commands = press_key(&mut harness, egui::Key::Enter);
        assert_eq!(
            commands,
            [Command::SetSource { motion: motion_called("dance.bvh"), target: neck, source: Some(source) }]
        );
    }
}

#[test]
fn keys_do_nothing_else_while_a_source_is_chosen() {
    let mut harness = motion_tab();
    press_row(&mut harness, &text::follows("Neck", ""));
    assert_eq!(press_key(&mut harness, egui::Key::Space), []);
    assert_eq!(press_key(&mut harness, egui::Key::Escape), []);
    assert!(!asks(&harness, "Neck"));
}

#[test]
fn a_source_is_typed_in_the_table() {
    let (mut harness, neck) = neck_details();
    let [head, chest] = ["Head", "Chest"].map(|name| number(&harness, name));
    let mut enter = |text: &str| {
        harness.get_by_label(&text::source_of("Neck")).focus();
        harness.run();
        harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
        harness.key_press(egui::Key::Delete);
        harness.run();
        harness.get_by_label(&text::source_of("Neck")).type_text(text);
        harness.run();
        press_key(&mut harness, egui::Key::Enter)
    };
    let set = |source| vec![Command::SetSource { motion: motion_called("dance.bvh"), target: neck, source }];
    assert_eq!(enter(&head.to_string()), set(Some(head)));
    assert_eq!(enter("chest"), set(Some(chest)));
    assert_eq!(enter("Head"), set(Some(head)));
    assert_eq!(enter(""), set(None));
    assert_eq!(enter("9999"), []);
    assert_eq!(enter("tail"), []);
    assert!(harness.query_by_label(&text::no_source_called("tail")).is_some());
    assert_eq!(map(&harness, 0).joints[&neck].source, None);
    // Escape discards the typed text; the joint stays selected.
    harness.get_by_label(&text::source_of("Neck")).focus();
    harness.run();
    harness.get_by_label(&text::source_of("Neck")).type_text("5");
    harness.run();
    assert_eq!(press_key(&mut harness, egui::Key::Escape), []);
    assert_eq!(harness.get_by_label(&text::source_of("Neck")).value().unwrap_or_default(), "");
    assert_eq!(harness.state().state().selection.joint, Some(neck));
}

/// Where a joint of the walker is on the screen: of the model, or of the motion beside it.
fn screen_position(harness: &Harness<'_, Bench>, character: usize, name: &str) -> egui::Pos2 {
    let bench = harness.state();
    let joint = bench.library().active().expect("a model").asset.skeleton.find(name).expect("a joint");
    let view = &bench.frame.view;
    let world = bench.frame.characters[character].world_from_joint[joint.get()].translation;
    let at = (view.projection_from_view * view.view_from_world).project_point3(world.into());
    let rect = bench.viewport;
    rect.min + egui::vec2(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y) * rect.size()
}

fn click(harness: &mut Harness<'_, Bench>, at: egui::Pos2) -> Vec<Command> {
    drag(harness, at, at, egui::PointerButton::Primary)
}

/// This works without the skeleton overlay: dots show what can be clicked.
#[test]
fn a_joint_is_picked_in_the_viewport() {
    for size in [WIDE, NARROW] {
        let mut harness = motion_bench(size, &["dance.bvh"]);
        let [hand, head] = ["LeftHand", "Head"].map(|name| number(&harness, name));
        if size == NARROW {
            press(&mut harness, text::INSPECTOR);
        }
        press(&mut harness, Tab::Motion.label());
        press(&mut harness, text::PICK_IN_VIEWPORT);
        assert!(harness.query_by_label(text::PICK_TARGET).is_some());
        let at = screen_position(&harness, 0, "LeftHand");
        assert_eq!(click(&mut harness, at), [Command::SelectJoint(Some(hand))]);
        assert!(asks(&harness, "LeftHand"));
        let commands = reach(&mut harness, &text::joint(head, "Head"));
        assert_eq!(
            commands,
            [Command::SetSource { motion: motion_called("dance.bvh"), target: hand, source: Some(head) }]
        );
        assert!(harness.query_by_label(&text::source_of("LeftHand")).is_some(), "the table is back on {size:?}");
        // The button and Escape both end picking without a change.
        for stop in [true, false] {
            harness.get_by_label(text::PICK_IN_VIEWPORT).scroll_to_me();
            harness.run();
            press(&mut harness, text::PICK_IN_VIEWPORT);
            if stop {
                press(&mut harness, text::DONE_PICKING);
            } else {
                press_key(&mut harness, egui::Key::Escape);
                if size == NARROW {
                    press(&mut harness, text::INSPECTOR);
                }
            }
            assert!(harness.query_by_label(text::PICK_TARGET).is_none());
        }
        assert_eq!(harness.state().state().selection.joint, Some(hand));
    }
}

/// With the motion's skeleton on the stage, the source is picked in the viewport as well.
#[test]
fn both_joints_are_picked_if_both_are_shown() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, "Walk (2)");
    press(&mut harness, Tab::Motion.label());
    harness.state_mut().change(|state| {
        state.display.show.source = true;
    });
    harness.run();
    let [hand, head, foot] = ["LeftHand", "Head", "RightFoot"].map(|name| number(&harness, name));
    press(&mut harness, text::PICK_IN_VIEWPORT);
    let at = screen_position(&harness, 0, "LeftHand");
    assert_eq!(click(&mut harness, at), [Command::SelectJoint(Some(hand))]);
    assert!(harness.query_by_label(&text::pick_source_of("LeftHand")).is_some());
    let at = screen_position(&harness, 1, "Head");
    let source =
        |source| [Command::SetSource { motion: motion_called("dance.bvh"), target: hand, source: Some(source) }];
    assert_eq!(click(&mut harness, at), source(head));
    assert_eq!(map(&harness, 0).joints[&hand].source, Some(head));
    // Starting from the table, only the source is picked.
    reach(&mut harness, text::CLICK_SOURCE);
    let at = screen_position(&harness, 1, "RightFoot");
    assert_eq!(click(&mut harness, at), source(foot));
    reach(&mut harness, text::CLICK_SOURCE);
    press(&mut harness, text::CHOOSE_FROM_LIST);
    assert_eq!(reach(&mut harness, &text::joint(head, "Head")), source(head));
}
