//! The joint table: order, filters, wording and cost.

use std::sync::Arc;

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use gaitway::ui::{Tab, text};
use gaitway_character::asset::{Asset, AssetParts};
use gaitway_scene::library::{Library, Model, Motion};
use gaitway_scene::samples;
use gaitway_scene::state::Command;

use super::{choose, map, motion_tab, number, press_row, reach};
use crate::allocations::allocations_after;
use crate::bench::{Bench, WIDE, bench_of, painted, press};
use crate::by_place::motion_called;
use crate::skeletons;

/// Types into the search field of the joints.
fn search(harness: &mut Harness<'_, Bench>, words: &str) {
    harness.get_by_label(text::SEARCH_JOINTS).click();
    harness.run();
    harness.get_by_label(text::SEARCH_JOINTS).type_text(words);
    harness.run();
}

#[test]
fn the_table_lists_and_finds_joints_with_their_sources() {
    let mut harness = motion_tab();
    let (hips, spine) = (number(&harness, "Hips"), number(&harness, "Spine"));
    assert!(harness.query_by_label_contains(&text::follows("Hips", &text::joint(hips, "Hips"))).is_some());
    assert!(harness.query_by_label_contains(&text::follows("Spine", &text::joint(spine, "Spine"))).is_some());
    let joints = harness.state().library().active().expect("a model").asset.skeleton.len();
    assert!(harness.query_by_label(&text::joints_mapped(joints, joints)).is_some());
    search(&mut harness, "lefttoes");
    assert!(harness.query_by_label_contains(&text::follows("LeftToes", "")).is_some());
    assert!(harness.query_by_label_contains(&text::follows("Hips", "")).is_none());
    // Body parts are found as well.
    press(&mut harness, text::CLEAR_SEARCH);
    search(&mut harness, "left lower");
    assert!(harness.query_by_label_contains(&text::follows("LeftLowerArm", "")).is_some());
    assert!(harness.query_by_label_contains(&text::follows("RightLowerArm", "")).is_none());
}

#[test]
fn the_details_of_a_pressed_row_come_into_sight() {
    let mut harness = motion_tab();
    // The lowest row in sight: its details open below the panel.
    let timeline = harness.get_by_label(text::TIME).rect().top();
    let rows = harness.get_all_by_role(egui::accesskit::Role::Button).filter(|row| {
        let label = row.accesskit_node().label().unwrap_or_default();
        label.starts_with(text::edit_joint("").trim()) && row.rect().bottom() < timeline - 30.0
    });
    let lowest = rows.max_by(|a, b| a.rect().top().total_cmp(&b.rect().top())).expect("rows");
    let label = lowest.accesskit_node().label().expect("a name");
    lowest.click();
    harness.run();
    for label in [label.as_str(), &text::rotation_offset_about("X"), &text::ignore_channels(text::CHANNELS[0])] {
        let rect = harness.get_by_label(label).rect();
        assert!(rect.top() > 100.0 && rect.bottom() < timeline, "{label}: {rect:?} above {timeline}");
    }
}

/// The one test of the table's own wording.
#[test]
fn rows_read_like_sentences() {
    let mut harness = motion_tab();
    let [left, head, right] = ["LeftHand", "Head", "RightHand"].map(|name| number(&harness, name));
    for (target, source) in [(left, Some(right)), (head, None)] {
        harness.state_mut().editor.apply(Command::SetSource { motion: motion_called("dance.bvh"), target, source });
    }
    harness.run();
    let shared = format!("{right}  RightHand (conflict): right hand · same name · 100 % · shared with LeftHand");
    for row in [&format!("RightHand follows {shared}"), "Head follows none (none): head · unmapped manually"] {
        assert!(harness.query_by_label(row).is_some(), "{row}");
    }
}

#[test]
fn the_table_is_ordered_by_body_part_or_as_a_tree() {
    let mut harness = motion_tab();
    let top = |harness: &Harness<'_, Bench>, label: &str| harness.get_by_label_contains(label).rect().top();
    let left_arm = harness.get_by_label_contains(text::LEFT_ARM).rect();
    assert!(top(&harness, &text::follows("LeftHand", "")) > left_arm.top());
    assert!(
        top(&harness, &text::follows("LeftUpperLeg", "")) > top(&harness, &text::follows("RightHand", "")),
        "arms before legs"
    );
    let before = top(&harness, text::RIGHT_ARM);
    harness.get_by_label_contains(text::LEFT_ARM).click();
    harness.run();
    assert!(harness.query_by_label_contains(&text::follows("LeftHand", "")).is_none());
    assert!(top(&harness, text::RIGHT_ARM) < before);
    press(&mut harness, &text::labelled(text::ORDER, text::BY_TREE));
    assert!(harness.query_by_label_contains(text::LEFT_ARM).is_none());
    let order = [&text::follows("Hips", ""), &text::follows("Spine", ""), &text::follows("LeftHand", "")]
        .map(|label| top(&harness, label));
    assert!(order.is_sorted(), "{order:?}");
}

#[test]
fn the_table_is_filtered_by_status() {
    let mut harness = motion_tab();
    choose(&mut harness, text::JOINT_FILTER, &text::counted(text::NEEDS_REVIEW, 0));
    assert!(harness.query_by_label(text::NOTHING_TO_REVIEW).is_some());
    choose(&mut harness, text::JOINT_FILTER, &text::counted(text::ALL_JOINTS, 24));
    // A left hand that follows a right one, and two hands with the same source.
    let (left, right) = (number(&harness, "LeftHand"), number(&harness, "RightHand"));
    press_row(&mut harness, &text::follows("LeftHand", ""));
    press(&mut harness, &text::joint(right, "RightHand"));
    choose(&mut harness, text::JOINT_FILTER, &text::counted(text::CONFLICTS, 2));
    assert!(harness.query_by_label_contains(&text::follows("LeftHand", "")).is_some());
    let twice = text::row("RightHand", &text::joint(right, "RightHand"), text::IS_CONFLICT);
    assert!(harness.query_by_label_contains(&twice).is_some());
    assert!(harness.query_by_label_contains(&text::follows("Neck", "")).is_none());
    choose(&mut harness, text::JOINT_FILTER, &text::counted(text::NEEDS_REVIEW, 2));
    assert!(harness.query_by_label_contains(&text::follows("LeftHand", "")).is_some());
    choose(&mut harness, text::JOINT_FILTER, &text::counted(text::MUTED, 0));
    assert!(harness.query_by_label(text::NO_SUCH_JOINTS).is_some());
    assert_ne!(left, right);
}

#[test]
fn a_joint_chosen_anywhere_opens_in_the_table() {
    let mut harness = motion_tab();
    let [neck, toes] = ["Neck", "RightToes"].map(|name| number(&harness, name));
    assert_eq!(press(&mut harness, &text::edit_joint("Neck")), [Command::SelectJoint(Some(neck))]);
    assert!(harness.query_by_label(&text::source_of("Neck")).is_some());
    assert_eq!(press(&mut harness, &text::edit_joint("Neck")), [Command::SelectJoint(None)]);
    assert!(harness.query_by_label(&text::source_of("Neck")).is_none());
    // The row that is pressed stays where it is, even while details close above it, or moves up just enough to show its
    // own.
    let top = |harness: &Harness<'_, Bench>| harness.get_by_label(&text::edit_joint("LeftHand")).rect().top();
    press(&mut harness, &text::edit_joint("Neck"));
    reach(&mut harness, &text::edit_joint("LeftUpperArm"));
    harness.get_by_label(&text::edit_joint("LeftHand")).scroll_to_me();
    harness.run();
    let before = top(&harness);
    press(&mut harness, &text::edit_joint("LeftHand"));
    assert!(harness.query_by_label(&text::source_of("LeftHand")).is_some());
    let moved = top(&harness) - before;
    let end = harness.get_by_label(&text::ignore_channels(text::CHANNELS[2])).rect().bottom();
    let below = harness.get_by_label(text::TIME).rect().top() - end;
    assert!(moved.abs() < 1.0 || (moved < 0.0 && (0.0..60.0).contains(&below)), "moved by {moved}, {below} below");
    // Selected as by a click in the viewport; the table scrolls to it.
    harness.state_mut().change(|state| {
        state.selection.joint = Some(toes);
    });
    harness.run();
    let field = harness.get_by_label(&text::source_of("RightToes")).rect();
    assert!(field.bottom() < WIDE[1] - 80.0, "{field:?}");
}

/// The Motion tab of a chain of joints whose motion has the same skeleton.
fn bench_of_chain(joints: usize) -> Harness<'static, Bench> {
    let names: Vec<String> = (0..joints).map(|index| format!("Tentacle{index}")).collect();
    let asset = skeletons::asset(skeletons::chain(names.iter().map(String::as_str), glam::Vec3::Y * 0.01));
    let mut library = Library::default();
    library.add(Model::new("squid.glb".to_owned(), asset, Vec::new()));
    let asset = library.active().expect("just set").asset.clone();
    library.set_motions(vec![Motion::new("swim.bvh".to_owned(), asset)]);
    let mut harness = bench_of(WIDE, library);
    press(&mut harness, Tab::Motion.label());
    harness
}

#[test]
fn three_hundred_joints_have_their_rows() {
    let mut harness = bench_of_chain(300);
    assert!(harness.query_by_label(&text::joints_mapped(300, 300)).is_some());
    assert!(harness.query_by_label(&text::labelled(text::ORDER, text::BY_BODY)).is_none(), "it has no body");
    assert!(harness.query_by_label_contains(&text::follows("Tentacle250", "")).is_none(), "far out of sight");
    harness.state_mut().change(|state| {
        state.selection.joint = Some(250);
    });
    harness.run();
    let found = harness.get_by_label_contains(&text::follows("Tentacle250", "")).rect();
    assert!(found.top() > 0.0 && found.bottom() < WIDE[1], "{found:?}");
    harness.state_mut().change(|state| {
        state.selection.joint = None;
    });
    harness.run();
    press_row(&mut harness, &text::follows("Tentacle250", ""));
    assert_eq!(
        press(&mut harness, text::FOLLOW_NOTHING),
        [Command::SetSource { motion: motion_called("swim.bvh"), target: 250, source: None }]
    );
    choose(&mut harness, text::JOINT_FILTER, &text::counted(text::UNMAPPED, 1));
    assert!(harness.query_by_label_contains(&text::row("Tentacle250", text::NO_SOURCE, text::NO_SOURCE)).is_some());
    assert!(harness.query_by_label_contains(&text::follows("Tentacle249", "")).is_none());
    press(&mut harness, text::CLEAR_MAP);
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    harness.run();
    assert_eq!(map(&harness, 0).joints.len(), 300);
}

/// A namespace that all joints share only takes room; a wide table shows the rest of each name in full.
#[test]
fn names_are_shown_without_their_common_namespace() {
    let walker = samples::load("walker").expect("the sample is there").asset;
    let parts = Arc::into_inner(walker).expect("of one model").into_parts();
    let name = |joint| (parts.skeleton.source_index(joint), format!("mixamorig:{}Joint", parts.skeleton.name(joint)));
    let names: Vec<(usize, String)> = parts.skeleton.joints().map(name).collect();
    let skeleton = parts.skeleton.with_names(names.iter().map(|(number, name)| (*number, name.as_str())));
    let asset = Arc::new(Asset::new(AssetParts { skeleton, ..parts }).expect("as before"));
    for size in [WIDE, [1920.0, 1080.0]] {
        let mut library = Library::default();
        library.add(Model::new("rig.glb".to_owned(), asset.clone(), Vec::new()));
        library.set_motions(vec![Motion::new("dance.fbx".to_owned(), asset.clone())]);
        let mut harness = bench_of(size, library);
        assert!(
            harness.query_by_label("mixamorig:ChestJoint").is_some(),
            "the tree has whole names for screen readers"
        );
        let tree: Vec<_> = painted(&harness).into_iter().filter(|(text, ..)| text.contains("ChestJoint")).collect();
        assert!(matches!(&tree[..], [(text, false, _)] if text == "ChestJoint"), "{tree:?}");
        press(&mut harness, Tab::Motion.label());
        reach(&mut harness, &text::edit_joint("mixamorig:LeftUpperLegJoint"));
        let panel = harness.state().viewport.right();
        let texts = painted(&harness);
        let of_table = texts.iter().filter(|(text, _, rect)| text.contains("LeftUpperLegJoint") && rect.left() > panel);
        let found: Vec<_> = of_table.collect();
        assert_eq!(found.len(), 2, "target and source: {found:?}");
        assert!(found.iter().all(|(text, ..)| !text.contains("mixamorig")), "{found:?}");
        assert!(size == WIDE || found.iter().all(|(_, is_cut, _)| !is_cut), "{found:?}");
    }
}

/// egui allocates for what it lays out, the same for both tables, and now and then grows its own lists. Rows out of
/// sight must cost nothing.
#[test]
fn a_frame_of_the_table_allocates_no_more_for_more_joints() {
    let frames = |joints: usize| {
        let mut harness = bench_of_chain(joints);
        let run = |harness: &mut Harness<'static, Bench>, frames: usize| (0..frames).for_each(|_| harness.step());
        let counted = allocations_after(&mut harness, |harness| run(harness, 20), |harness| run(harness, 50));
        assert!(harness.query_by_label_contains(&text::follows("Tentacle3", "")).is_some());
        counted
    };
    let (few, many) = (frames(200), frames(1000));
    assert!(few.abs_diff(many) <= 4 * 50, "50 frames: {few} allocations with 200 joints, {many} with 1,000");
}
