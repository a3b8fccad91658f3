//! The tree of nodes: rows, keys, eyes, and its place in the Scene tab.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use gaitway::ui::{Tab, text};
use gaitway_scene::state::{Command, Hidden};

use crate::bench::{Bench, WIDE, press, press_key, sample_bench};
use crate::motion::reach;

#[test]
fn the_tree_shows_all_joints_and_chooses_one() {
    // Tall enough for the whole tree.
    let mut harness = sample_bench([1280.0, 1600.0]);
    let commands = press(&mut harness, "LeftHand");
    let skeleton = &harness.state().library().active().unwrap().asset.skeleton;
    let hand = skeleton.source_index(skeleton.find("LeftHand").unwrap());
    assert_eq!(commands, [Command::SelectJoint(Some(hand))]);
    assert!(harness.query_by_label(&text::local_transform(Some("LeftLowerArm"))).is_some());
    assert!(harness.query_all_by_label_contains(text::POSITION).count() >= 2, "local and world");
    assert_eq!(press(&mut harness, text::DESELECT), [Command::SelectJoint(None)]);
}

#[test]
fn folding_a_joint_hides_what_hangs_on_it() {
    let mut harness = sample_bench(WIDE);
    assert!(harness.query_by_label("Head").is_some());
    press(&mut harness, &text::collapse("Neck"));
    assert!(harness.query_by_label("Head").is_none());
    press(&mut harness, &text::expand("Neck"));
    assert!(harness.query_by_label("Head").is_some());
}

#[test]
fn nodes_are_found_by_name() {
    let mut harness = sample_bench(WIDE);
    press(&mut harness, "Hips");
    let card = |harness: &Harness<'_, Bench>| harness.get_by_label(text::DESELECT).rect().top();
    let before = card(&harness);
    harness.get_by_label(text::SEARCH_NODES).click();
    harness.run();
    harness.get_by_label(text::SEARCH_NODES).type_text("toes");
    harness.run();
    assert!(card(&harness) < before - 50.0, "the card follows the few rows: {} after {before}", card(&harness));
    assert!(harness.query_by_label("LeftToes").is_some());
    assert!(harness.query_by_label("Spine").is_none());
}

/// Wherever in the tree it is, and whether or not another joint was selected before.
#[test]
fn selecting_a_joint_moves_no_row() {
    let mut harness = sample_bench(WIDE);
    for joint in ["Hips", "Chest", "Neck", "Hips"] {
        let before = harness.get_by_label(joint).rect();
        press(&mut harness, joint);
        let name = |label: &str| harness.query_all_by_label(label).map(|node| node.rect()).next();
        assert_eq!(name(joint), Some(before), "{joint}");
    }
}

/// It takes what the cards leave, and gives it back to them without losing sight of the joint that was pressed.
#[test]
fn the_tree_uses_the_room_of_its_tab() {
    let rows = |harness: &Harness<'_, Bench>| harness.get_all_by_role(Role::TreeItem).count();
    let mut low = sample_bench([1280.0, 600.0]);
    let mut high = sample_bench([1280.0, 700.0]);
    assert!(rows(&high) >= rows(&low) + 3, "{} and {}", rows(&high), rows(&low));
    let timeline = low.get_by_label(text::TIME).rect().top();
    let gap = timeline - low.get_by_label(text::VERTEX_PROBE).rect().bottom();
    assert!((38.0..50.0).contains(&gap), "it ends where the tab does: {gap}");
    for harness in [&mut low, &mut high] {
        let before = rows(harness);
        let low_row = harness.get_all_by_role(Role::TreeItem).nth(before - 3).expect("a row");
        let joint = low_row.accesskit_node().label().expect("a name");
        harness.get_by_role_and_label(Role::TreeItem, &joint).click();
        harness.run();
        assert!(rows(harness) < before, "its card takes the room");
        let row = harness.get_by_role_and_label(Role::TreeItem, &joint).rect();
        let card = harness.get_by_label(text::POSE_MANUALLY).rect();
        assert!(row.bottom() <= card.top(), "{joint} at {row:?} above its card at {card:?}");
    }
}

#[test]
fn eyes_hide_nodes_and_materials_and_alt_solos_them() {
    // Tall enough for the whole tree.
    let mut harness = sample_bench([1280.0, 1800.0]);
    let nodes = |nodes: &[usize]| Hidden { nodes: nodes.iter().copied().collect(), ..Hidden::default() };
    assert!(harness.query_by_label(&text::eye("Hips", true)).is_none(), "nothing to hide on a bone");
    assert_eq!(press(&mut harness, &text::eye("Body", true)), [Command::SetHidden(nodes(&[22]))]);
    assert_eq!(press(&mut harness, &text::eye("Body", false)), [Command::SetHidden(Hidden::default())]);
    harness.state_mut().commands.clear();
    harness.get_by_label(&text::eye("Eyes", true)).click_modifiers(egui::Modifiers::ALT);
    harness.run();
    assert_eq!(harness.state().commands, [Command::SetHidden(nodes(&[22]))], "all others");
    // egui takes a long press of a finger for this click.
    harness.get_by_label(&text::eye("Eyes", true)).click_secondary();
    harness.run();
    assert_eq!(harness.state().commands.last(), Some(&Command::SetHidden(Hidden::default())), "again");
    harness.get_by_label(&text::eye("Eyes", true)).click_secondary();
    harness.run();
    assert_eq!(harness.state().commands.last(), Some(&Command::SetHidden(nodes(&[22]))));
    assert_eq!(press(&mut harness, text::SHOW_ALL), [Command::SetHidden(Hidden::default())]);
    assert!(harness.query_by_label(text::SHOW_ALL).is_none());
    // The card has the same as buttons.
    press(&mut harness, "Eyes");
    assert_eq!(press(&mut harness, text::SOLO), [Command::SetHidden(nodes(&[22]))]);
    assert_eq!(press(&mut harness, text::SOLO), [Command::SetHidden(Hidden::default())]);
    press(&mut harness, Tab::Info.label());
    let materials = Hidden { materials: [Some(1)].into(), ..Hidden::default() };
    assert_eq!(reach(&mut harness, &text::eye("Visor", true)), [Command::SetHidden(materials)]);
}

#[test]
fn keys_lead_through_the_whole_tree() {
    let mut harness = sample_bench([1280.0, 480.0]);
    let asset = harness.state().library().active().expect("a model").asset.clone();
    let names: Vec<&str> = asset.skeleton.joints().map(|joint| asset.skeleton.name(joint)).collect();
    let last = names.len() - 1;
    harness.get_by_role_and_label(Role::TreeItem, names[0]).focus();
    harness.run();
    let mut at_after = |key| {
        assert_eq!(press_key(&mut harness, key), [], "{key:?} does nothing else");
        let rows: Vec<_> = harness.get_all_by_role(Role::TreeItem).collect();
        assert!(rows.len() < last, "the tree scrolls");
        let row = rows.iter().find(|row| row.accesskit_node().is_focused()).expect("a row has the focus");
        let name = row.accesskit_node().label().expect("a name");
        names.iter().position(|other| *other == name).expect("a joint")
    };
    assert_eq!(at_after(egui::Key::End), last);
    let page = last - at_after(egui::Key::PageUp);
    assert!(page > 1, "{page}");
    assert_eq!(at_after(egui::Key::PageDown), last);
    assert_eq!(at_after(egui::Key::Home), 0);
    assert_eq!(at_after(egui::Key::PageDown), page);
    assert_eq!(at_after(egui::Key::Home), 0);
    assert_eq!(at_after(egui::Key::ArrowRight), 1, "the first child");
    assert_eq!(at_after(egui::Key::ArrowLeft), 1, "closed");
    assert_eq!(at_after(egui::Key::ArrowLeft), 0, "the parent");
    assert_eq!(at_after(egui::Key::ArrowRight), 1);
    assert_eq!(at_after(egui::Key::ArrowRight), 1, "open again");
    // Before the focus has arrived.
    harness.key_press(egui::Key::End);
    harness.key_press(egui::Key::Home);
    harness.key_press(egui::Key::End);
    harness.run();
    let row = harness.get_by_role_and_label(Role::TreeItem, names[last]);
    assert!(row.accesskit_node().is_focused(), "none of them is lost");
}
