//! Borrowed motion: its clips at the left, the channel table and its options at the right, offers when it does not fit.

use std::sync::Arc;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gaitway::anim::{ClipBuilder, Interpolation, Keys, Transform};
use gaitway::asset::{Asset, AssetParts};
use gaitway::editor::Export;
use gaitway::library::{Library, Model, Motion};
use gaitway::retarget::{ClipRef, Feet, JointMap, Keep, MutedProperty, RestChoice, RootOptions, RootPart, Unmapped};
use gaitway::samples;
use gaitway::state::{ClipChoice, Command, MapEdit, active_map, muted_properties};
use gaitway::ui::{PathPrompt, PathPurpose, Saved, Tab, UiAction, text};
use glam::{Quat, Vec3};

use crate::allocations::allocations_after;
use crate::bench::{Bench, NARROW, WIDE, bench_of, drag, motion_bench, painted, press, press_key, sample_bench};
use crate::call_sites::own_allocations;
use crate::skeletons;

fn map(harness: &Harness<'_, Bench>, motion: usize) -> JointMap {
    let bench = harness.state();
    active_map(bench.library(), bench.state(), motion).expect("a map for the motion")
}

fn number(harness: &Harness<'_, Bench>, name: &str) -> usize {
    let skeleton = &harness.state().library().active().expect("a model").asset.skeleton;
    skeleton.source_index(skeleton.find(name).expect("a joint of the walker"))
}

/// Presses what may have to be scrolled to first.
fn reach(harness: &mut Harness<'_, Bench>, label: &str) -> Vec<Command> {
    harness.get_by_label(label).scroll_to_me();
    harness.run();
    press(harness, label)
}

/// Presses the line of the table that begins so.
fn press_row(harness: &mut Harness<'_, Bench>, start: &str) {
    harness.get_by_label_contains(start).scroll_to_me();
    harness.run();
    harness.get_by_label_contains(start).click();
    harness.run();
}

#[test]
fn borrowed_clips_stand_under_the_name_of_their_file() {
    let mut harness = motion_bench(WIDE, &["folder/dance.bvh"]);
    assert!(harness.query_by_label(&text::from_motion("dance.bvh")).is_some());
    let [walk, idle, wave] = ["Walk (2)", "Idle (2)", "Wave (2)"];
    for (title, index) in [(walk, 3), (idle, 4), (wave, 5)] {
        let expected = Command::SetClip(ClipChoice::Named(index.to_string()));
        assert_eq!(press(&mut harness, title), [expected], "{title}");
    }
}

#[test]
fn without_a_motion_there_is_no_tab_for_it() {
    let mut harness = sample_bench(WIDE);
    assert!(harness.query_by_label(Tab::Motion.label()).is_none());
    press(&mut harness, text::BORROW_MOTION);
    assert_eq!(harness.state().actions, [UiAction::ChooseMotion]);
}

#[test]
fn the_table_says_who_follows_whom_and_why() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    let (hips, spine) = (number(&harness, "Hips"), number(&harness, "Spine"));
    assert!(harness.query_by_label_contains(&format!("Hips follows {hips}  Hips (")).is_some());
    assert!(harness.query_by_label_contains(&format!("Spine follows {spine}  Spine (")).is_some());
    let joints = harness.state().library().active().expect("a model").asset.skeleton.len();
    assert!(harness.query_by_label(&text::joints_mapped(joints, joints)).is_some());
    harness.get_by_label("Search joints of the model").click();
    harness.run();
    harness.get_by_label("Search joints of the model").type_text("lefttoes");
    harness.run();
    assert!(harness.query_by_label_contains("LeftToes follows").is_some());
    assert!(harness.query_by_label_contains("Hips follows").is_none());
    // By what it is, too.
    press(&mut harness, text::CLEAR_SEARCH);
    harness.get_by_label("Search joints of the model").click();
    harness.run();
    harness.get_by_label("Search joints of the model").type_text("left lower");
    harness.run();
    assert!(harness.query_by_label_contains("LeftLowerArm follows").is_some());
    assert!(harness.query_by_label_contains("RightLowerArm follows").is_none());
}

#[test]
fn another_source_is_chosen_from_a_list() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    let (neck, head) = (number(&harness, "Neck"), number(&harness, "Head"));
    press_row(&mut harness, "Neck follows");
    assert!(harness.query_by_label("What does Neck follow?").is_some());
    let commands = press(&mut harness, &format!("{head}  Head"));
    assert_eq!(commands, [Command::SetSource { motion: 0, target: neck, source: Some(head) }]);
    assert!(harness.query_by_label("What does Neck follow?").is_none());
    assert!(harness.query_by_label_contains(&format!("Neck follows {head}  Head (")).is_some());
    assert_eq!(map(&harness, 0).joints[&neck].source, Some(head));
    press_row(&mut harness, "Neck follows");
    press(&mut harness, "Nothing");
    assert!(harness.query_by_label_contains("Neck follows none (").is_some());
    // And all the way back.
    press(&mut harness, text::REMATCH);
    assert!(harness.query_by_label_contains(&format!("Neck follows {neck}  Neck (")).is_some());
}

#[test]
fn a_source_is_typed_by_number_or_name() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    let (neck, head, chest) = (number(&harness, "Neck"), number(&harness, "Head"), number(&harness, "Chest"));
    for (typed, source) in [(head.to_string(), head), ("chest".to_owned(), chest)] {
        press_row(&mut harness, "Neck follows");
        harness.get_by_label("Name or number of a joint of the motion").type_text(&typed);
        harness.run();
        let commands = press_key(&mut harness, egui::Key::Enter);
        assert_eq!(commands, [Command::SetSource { motion: 0, target: neck, source: Some(source) }], "{typed}");
    }
}

#[test]
fn a_source_is_chosen_by_arrow_keys() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    let neck = number(&harness, "Neck");
    for (keys, source) in
        [(&[egui::Key::ArrowDown][..], neck + 1), (&[egui::Key::ArrowUp, egui::Key::ArrowUp], neck - 1)]
    {
        press_row(&mut harness, "Neck follows");
        keys.iter().for_each(|&key| assert_eq!(press_key(&mut harness, key), []));
        let commands = press_key(&mut harness, egui::Key::Enter);
        assert_eq!(commands, [Command::SetSource { motion: 0, target: neck, source: Some(source) }]);
    }
}

#[test]
fn keys_do_nothing_else_while_a_source_is_chosen() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    press_row(&mut harness, "Neck follows");
    assert_eq!(press_key(&mut harness, egui::Key::Space), []);
    assert_eq!(press_key(&mut harness, egui::Key::Escape), []);
    assert!(harness.query_by_label("What does Neck follow?").is_none());
}

#[test]
fn the_options_say_how_the_motion_is_carried_over() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    press(&mut harness, "Options");
    let mut root = RootOptions { horizontal: RootPart::InPlace, ..RootOptions::default() };
    assert_eq!(press(&mut harness, &format!("{}: In place", text::ROOT_HORIZONTAL)), [Command::SetRoot(Some(root))]);
    root.yaw = RootPart::Freeze;
    assert_eq!(press(&mut harness, &format!("{}: Freeze", text::ROOT_TURN)), [Command::SetRoot(Some(root))]);
    root.extract = true;
    assert_eq!(reach(&mut harness, text::EXTRACT_ROOT_MOTION), [Command::SetRoot(Some(root))]);
    let plant = Command::SetFeet(Some(Feet::Plant));
    assert_eq!(reach(&mut harness, "Hold feet on the ground"), [plant]);
    reach(&mut harness, "Rest pose of the model");
    press(&mut harness, "As the mesh was bound");
    let now = map(&harness, 0);
    assert_eq!((now.rest.model, now.root, now.feet), (RestChoice::Bind, root, Feet::Plant));
}

#[test]
fn joints_without_a_source_can_play_a_clip() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    press(&mut harness, "Options");
    reach(&mut harness, text::UNMAPPED_JOINTS);
    // One in the list at the left, one in the list that has opened.
    harness.state_mut().commands.clear();
    harness.get_all_by_label("Wave").last().expect("in the list").click();
    harness.run();
    let wave = |frozen| Command::SetUnmapped(Some(Unmapped::Clip { clip: ClipRef::Index(2), frozen }));
    assert_eq!(harness.state().commands, [wave(false)]);
    assert_eq!(press(&mut harness, "Stand still at the clip's first key"), [wave(true)]);
    press(&mut harness, "Joints");
    press_row(&mut harness, "Head follows");
    press(&mut harness, "Nothing");
    let row = "Head follows none (none: head · deliberately none · first key of Wave)";
    assert!(harness.query_by_label(row).is_some());
}

#[test]
fn files_are_asked_of_the_host() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    press(&mut harness, "Files");
    press(&mut harness, "Save map");
    press(&mut harness, "Load map");
    press(&mut harness, "Walk (2)");
    press(&mut harness, text::SAVE_GLB);
    reach(&mut harness, text::OPEN_INSTEAD);
    reach(&mut harness, "Remove motion");
    let expected = [
        UiAction::Save(Saved::File(Export::Map { motion: 0 })),
        UiAction::ChooseMotion,
        UiAction::Save(Saved::File(Export::Model { clip: 3 })),
        UiAction::ShowMotionAlone(0),
        UiAction::RemoveMotion(0),
    ];
    assert_eq!(harness.state().actions, expected);
}

#[test]
fn a_path_to_save_at_can_be_typed() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    let purpose = PathPurpose::Save(Saved::File(Export::Map { motion: 0 }));
    harness.state_mut().panels.messages.path_prompt = Some(PathPrompt { purpose, path: "map.json".to_owned() });
    harness.run();
    press(&mut harness, text::PROMPT_SAVE);
    assert_eq!(harness.state().actions, [UiAction::UsePath(purpose, "map.json".to_owned())]);
}

/// The tab shows the motion whose clip plays.
#[test]
fn one_of_several_motions_is_chosen() {
    let mut harness = motion_bench(WIDE, &["first.bvh", "second.bvh"]);
    press(&mut harness, Tab::Motion.label());
    press(&mut harness, "Motion file");
    let commands = press(&mut harness, "second.bvh");
    assert_eq!(commands, [Command::SetClip(ClipChoice::Named("6".to_owned()))]);
    press(&mut harness, "Files");
    press(&mut harness, "Save map");
    assert_eq!(harness.state().actions, [UiAction::Save(Saved::File(Export::Map { motion: 1 }))]);
}

#[test]
fn what_does_not_fit_can_be_looked_at_or_mapped_by_hand() {
    let offers = [
        (text::SHOW_REFUSED_ALONE, UiAction::ShowRefusedAlone),
        (text::MAP_REFUSED_MANUALLY, UiAction::MapRefusedManually),
    ];
    for (label, action) in offers {
        let mut harness = sample_bench(WIDE);
        harness.state_mut().panels.messages.error = Some("snake.bvh: no joint in common".to_owned());
        harness.run();
        assert!(harness.query_by_label(label).is_none(), "only for motions");
        harness.state_mut().panels.messages.motion_refused = true;
        harness.run();
        press(&mut harness, label);
        assert_eq!(harness.state().actions, [action]);
        assert_eq!(harness.state().panels.messages.error, None);
    }
}

/// A model without a skeleton has no joints to map.
#[test]
fn a_motion_for_a_model_without_a_skeleton_can_only_be_looked_at() {
    let mut harness = sample_bench(WIDE);
    let messages = &mut harness.state_mut().panels.messages;
    messages.error = Some("dance.bvh: Chair has no skeleton".to_owned());
    (messages.motion_refused, messages.model_lacks_skeleton) = (true, true);
    harness.run();
    assert!(harness.query_by_label(text::MAP_REFUSED_MANUALLY).is_none());
    press(&mut harness, text::SHOW_REFUSED_ALONE);
    assert_eq!(harness.state().actions, [UiAction::ShowRefusedAlone]);
}

fn edit(edit: MapEdit) -> Command {
    Command::EditMap { motion: 0, edit }
}

/// Chooses from a list that opens under a button; the entry may stand elsewhere too.
fn choose(harness: &mut Harness<'_, Bench>, list: &str, entry: &str) -> Vec<Command> {
    reach(harness, list);
    harness.get_all_by_label(entry).last().expect("in the list").scroll_to_me();
    harness.run();
    harness.state_mut().commands.clear();
    harness.get_all_by_label(entry).last().expect("in the list").click();
    harness.run();
    std::mem::take(&mut harness.state_mut().commands)
}

#[test]
fn the_table_stands_by_parts_of_the_body_or_as_a_tree() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    let top = |harness: &Harness<'_, Bench>, label: &str| harness.get_by_label_contains(label).rect().top();
    let left_arm = harness.get_by_label_contains("Left arm, ").rect();
    assert!(top(&harness, "LeftHand follows") > left_arm.top());
    assert!(top(&harness, "LeftUpperLeg follows") > top(&harness, "RightHand follows"), "arms before legs");
    let before = top(&harness, "Right arm, ");
    harness.get_by_label_contains("Left arm, ").click();
    harness.run();
    assert!(harness.query_by_label_contains("LeftHand follows").is_none());
    assert!(top(&harness, "Right arm, ") < before);
    press(&mut harness, "Order: Tree");
    assert!(harness.query_by_label_contains("Left arm, ").is_none());
    let order = ["Hips follows", "Spine follows", "LeftHand follows"].map(|label| top(&harness, label));
    assert!(order.is_sorted(), "{order:?}");
}

#[test]
fn the_table_is_filtered_by_how_it_stands() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    choose(&mut harness, "Which joints are shown", "Needs review (0)");
    assert!(harness.query_by_label("No joints need review.").is_some());
    choose(&mut harness, "Which joints are shown", "All joints (24)");
    // A left arm that follows a right one, and two that follow the same.
    let (left, right) = (number(&harness, "LeftHand"), number(&harness, "RightHand"));
    press_row(&mut harness, "LeftHand follows");
    press(&mut harness, &format!("{right}  RightHand"));
    choose(&mut harness, "Which joints are shown", "Conflicts (2)");
    assert!(harness.query_by_label_contains("LeftHand follows").is_some());
    let twice = format!(
        "RightHand follows {right}  RightHand (conflict: right hand · same name · 100 % · shared with LeftHand)"
    );
    assert!(harness.query_by_label(&twice).is_some());
    assert!(harness.query_by_label_contains("Neck follows").is_none());
    choose(&mut harness, "Which joints are shown", "Needs review (2)");
    assert!(harness.query_by_label_contains("LeftHand follows").is_some());
    choose(&mut harness, "Which joints are shown", "Muted (0)");
    assert!(harness.query_by_label("There are no such joints.").is_some());
    assert_ne!(left, right);
}

#[test]
fn whole_maps_are_swapped_cleared_and_taken_back() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    let before = harness.state().state().clone();
    let [left, right] = ["LeftHand", "RightHand"].map(|name| number(&harness, name));
    assert_eq!(press(&mut harness, "Swap sides"), [edit(MapEdit::SwapSides)]);
    let swapped = format!("LeftHand follows {right}  RightHand (sure");
    assert!(harness.query_by_label_contains(&swapped).is_some(), "on purpose: no conflict");
    press(&mut harness, "Undo (Ctrl+Z)");
    assert!(harness.query_by_label_contains(&format!("LeftHand follows {left}  LeftHand (")).is_some());
    press(&mut harness, "Redo (Ctrl+Y)");
    assert!(harness.query_by_label_contains(&swapped).is_some());
    assert_eq!(press(&mut harness, text::CLEAR_MAP), [edit(MapEdit::Clear)]);
    assert!(harness.query_by_label(&text::joints_mapped(0, 0)).is_some());
    assert!(harness.query_by_label_contains("Hips follows none (none: hips · follows nothing").is_some());
    assert_eq!(press(&mut harness, text::REMATCH), [Command::SetMap { motion: 0, map: None }]);
    for _ in 0..3 {
        harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
        harness.run();
    }
    assert_eq!(harness.state().state(), &before);
}

/// The walker in other words, with left and right exchanged, as converters that mirror a model leave it.
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
    let by_position =
        format!("LeftWrist follows {}  RightHand (guess: right hand · position in space · 55 %", at("RightHand"));
    let by_name = format!("LeftWrist follows {}  LeftHand (sure", at("LeftHand"));
    assert!(harness.query_by_label_contains(&by_position).is_some());
    assert!(harness.query_by_label_contains("on the opposite side; matched by position.").is_some());
    assert!(harness.query_by_label(text::SWAP_SIDES).is_none(), "one control for one effect");
    assert_eq!(press(&mut harness, text::MATCH_SIDES_BY_NAME), [edit(MapEdit::SwapSides)]);
    assert!(harness.query_by_label_contains(&by_name).is_some());
    assert!(harness.query_by_label_contains("on the opposite side; matched by name.").is_some());
    press(&mut harness, text::MATCH_SIDES_BY_POSITION);
    assert!(harness.query_by_label_contains(&by_position).is_some());
}

/// A button that was reached with the tab key keeps the keyboard; edits made with it can be undone all the same.
#[test]
fn undo_works_while_a_button_has_the_keyboard() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    harness.get_by_label("Swap sides").focus();
    harness.run();
    assert_eq!(press_key(&mut harness, egui::Key::Enter), [edit(MapEdit::SwapSides)]);
    let undo = |harness: &mut Harness<'_, Bench>| {
        harness.state_mut().actions.clear();
        harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
        harness.run();
        harness.state().actions.clone()
    };
    assert_eq!(undo(&mut harness), [UiAction::Undo]);
    // Where text is typed it is the text that is undone.
    harness.get_by_label("Search joints of the model").focus();
    harness.run();
    assert_eq!(undo(&mut harness), []);
}

#[test]
fn a_joint_chosen_anywhere_opens_in_the_table() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    let [neck, toes] = ["Neck", "RightToes"].map(|name| number(&harness, name));
    assert_eq!(press(&mut harness, "Edit Neck"), [Command::SelectJoint(Some(neck))]);
    assert!(harness.query_by_label("Source of Neck").is_some());
    assert_eq!(press(&mut harness, "Edit Neck"), [Command::SelectJoint(None)]);
    assert!(harness.query_by_label("Source of Neck").is_none());
    // Far down, what opens is not left below the edge.
    reach(&mut harness, "Edit LeftHand");
    let inside = harness.get_by_label(&text::ignore_channels("scale")).rect();
    assert!(inside.bottom() < WIDE[1] - 100.0, "{inside:?}");
    // As a click in the picture does; the table scrolls to it.
    harness.state_mut().change(|state| {
        state.selection.joint = Some(toes);
    });
    harness.run();
    let field = harness.get_by_label("Source of RightToes").rect();
    assert!(field.bottom() < WIDE[1] - 80.0, "{field:?}");
}

#[test]
fn a_source_is_typed_in_the_table() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    let [neck, head, chest] = ["Neck", "Head", "Chest"].map(|name| number(&harness, name));
    press(&mut harness, "Edit Neck");
    let mut enter = |text: &str| {
        harness.get_by_label("Source of Neck").focus();
        harness.run();
        harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
        harness.key_press(egui::Key::Delete);
        harness.run();
        harness.get_by_label("Source of Neck").type_text(text);
        harness.run();
        press_key(&mut harness, egui::Key::Enter)
    };
    let set = |source| vec![Command::SetSource { motion: 0, target: neck, source }];
    assert_eq!(enter(&head.to_string()), set(Some(head)));
    assert_eq!(enter("chest"), set(Some(chest)));
    assert_eq!(enter("Head"), set(Some(head)));
    assert_eq!(enter(""), set(None));
    assert_eq!(enter("9999"), []);
    assert_eq!(enter("tail"), []);
    assert!(harness.query_by_label("No joint of the motion is called “tail”.").is_some());
    assert_eq!(map(&harness, 0).joints[&neck].source, None);
    // Escape takes back what was typed and leaves the joint chosen.
    harness.get_by_label("Source of Neck").focus();
    harness.run();
    harness.get_by_label("Source of Neck").type_text("5");
    harness.run();
    assert_eq!(press_key(&mut harness, egui::Key::Escape), []);
    assert_eq!(harness.get_by_label("Source of Neck").value().unwrap_or_default(), "");
    assert_eq!(harness.state().state().selection.joint, Some(neck));
}

#[test]
fn a_joint_is_turned_further_and_back() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    let neck = number(&harness, "Neck");
    press(&mut harness, "Edit Neck");
    let from = harness.get_by_label(&text::rotation_offset_about("Y")).rect().center();
    let commands = drag(&mut harness, from, from + egui::vec2(40.0, 0.0), egui::PointerButton::Primary);
    assert!(!commands.is_empty());
    let turned = map(&harness, 0).joints[&neck].correction;
    let (axis, angle) = turned.to_axis_angle();
    assert!(axis.abs_diff_eq(glam::Vec3::Y, 1e-4) && angle > 0.05, "{axis} {angle}");
    assert!(harness.query_by_label_contains("rotation offset)").is_some());
    let reset = press(&mut harness, "Reset");
    assert_eq!(reset, [edit(MapEdit::Correction { target: neck, correction: glam::Quat::IDENTITY })]);
    // The drag was one step, the reset another.
    press(&mut harness, "Undo (Ctrl+Z)");
    assert_eq!(map(&harness, 0).joints[&neck].correction, turned);
    press(&mut harness, "Undo (Ctrl+Z)");
    assert_eq!(map(&harness, 0).joints[&neck].correction, glam::Quat::IDENTITY);
    assert!(!harness.state().editor.can_undo());
}

#[test]
fn channels_of_a_source_are_left_out() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    let neck = number(&harness, "Neck");
    press(&mut harness, "Edit Neck");
    let mute = |property, muted| [edit(MapEdit::Mute { source: neck, property, muted })];
    assert_eq!(reach(&mut harness, &text::ignore_channels("rotation")), mute(MutedProperty::Rotation, true));
    assert!(harness.query_by_label_contains("Neck follows").is_some());
    assert!(harness.query_by_label_contains("rotation left out)").is_some());
    assert_eq!(muted_properties(&map(&harness, 0), neck), [false, true, false]);
    assert_eq!(reach(&mut harness, &text::ignore_channels("rotation")), mute(MutedProperty::Rotation, false));
    reach(&mut harness, &text::ignore_channels("scale"));
    press(&mut harness, "Options");
    assert_eq!(reach(&mut harness, text::USE_ALL_CHANNELS), [edit(MapEdit::UnmuteAll)]);
}

#[test]
fn one_joint_without_a_source_has_a_policy_of_its_own() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    let neck = number(&harness, "Neck");
    press(&mut harness, "Edit Neck");
    let clear = Command::SetSource { motion: 0, target: neck, source: None };
    assert_eq!(reach(&mut harness, "Clear"), [clear]);
    let frozen = Unmapped::Clip { clip: ClipRef::Index(2), frozen: true };
    let commands = choose(&mut harness, "What it does instead", "First key of Wave");
    assert_eq!(commands, [edit(MapEdit::Unmapped { target: neck, unmapped: Some(frozen) })]);
    assert!(harness.query_by_label_contains("deliberately none · first key of Wave)").is_some());
    let commands = choose(&mut harness, "What it does instead", "As all (rest)");
    assert_eq!(commands, [edit(MapEdit::Unmapped { target: neck, unmapped: None })]);
}

#[test]
fn translations_scales_and_the_crossfade_are_options() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    press(&mut harness, "Options");
    assert_eq!(reach(&mut harness, "Translations of joints: Drop"), [edit(MapEdit::Translations(Keep::Drop))]);
    assert_eq!(reach(&mut harness, "Scales of joints: Keep"), [edit(MapEdit::Scales(Keep::Keep))]);
    let field = harness.get_by_label("Crossfade value");
    field.scroll_to_me();
    harness.run();
    let from = harness.get_by_label("Crossfade value").rect().center();
    drag(&mut harness, from, from + egui::vec2(50.0, 0.0), egui::PointerButton::Primary);
    let now = map(&harness, 0);
    assert_eq!((now.translations, now.scales), (Keep::Drop, Keep::Keep));
    assert!(now.crossfade_secs > 0.1, "{}", now.crossfade_secs);
}

/// Where a joint of the walker is in the picture: of the model, or of the motion beside it.
fn place(harness: &Harness<'_, Bench>, character: usize, name: &str) -> egui::Pos2 {
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

/// The skeleton is not drawn, and need not be: dots show what can be clicked.
#[test]
fn the_joint_is_chosen_by_clicking_it() {
    for size in [WIDE, NARROW] {
        let mut harness = motion_bench(size, &["dance.bvh"]);
        let [hand, head] = ["LeftHand", "Head"].map(|name| number(&harness, name));
        if size == NARROW {
            press(&mut harness, text::INSPECTOR);
        }
        press(&mut harness, Tab::Motion.label());
        press(&mut harness, text::PICK_IN_VIEWPORT);
        assert!(harness.query_by_label("Click a joint of the model").is_some());
        let at = place(&harness, 0, "LeftHand");
        assert_eq!(click(&mut harness, at), [Command::SelectJoint(Some(hand))]);
        assert!(harness.query_by_label("What does LeftHand follow?").is_some());
        let commands = press(&mut harness, &format!("{head}  Head"));
        assert_eq!(commands, [Command::SetSource { motion: 0, target: hand, source: Some(head) }]);
        assert!(harness.query_by_label("Source of LeftHand").is_some(), "the table is back on {size:?}");
        // And by escape, or the button, to nothing.
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
            assert!(harness.query_by_label("Click a joint of the model").is_none());
        }
        assert_eq!(harness.state().state().selection.joint, Some(hand));
    }
}

/// Where the motion's skeleton stands on the stage, its joint is clicked too.
#[test]
fn both_joints_are_clicked_where_both_are_shown() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, "Walk (2)");
    press(&mut harness, Tab::Motion.label());
    harness.state_mut().change(|state| {
        state.display.show.source = true;
    });
    harness.run();
    let [hand, head, foot] = ["LeftHand", "Head", "RightFoot"].map(|name| number(&harness, name));
    press(&mut harness, text::PICK_IN_VIEWPORT);
    let at = place(&harness, 0, "LeftHand");
    assert_eq!(click(&mut harness, at), [Command::SelectJoint(Some(hand))]);
    assert!(harness.query_by_label("Click the joint of the motion that LeftHand is to follow").is_some());
    let at = place(&harness, 1, "Head");
    let source = |source| [Command::SetSource { motion: 0, target: hand, source: Some(source) }];
    assert_eq!(click(&mut harness, at), source(head));
    assert_eq!(map(&harness, 0).joints[&hand].source, Some(head));
    // From the table the model's joint is known already.
    reach(&mut harness, "Click its source");
    let at = place(&harness, 1, "RightFoot");
    assert_eq!(click(&mut harness, at), source(foot));
    reach(&mut harness, "Click its source");
    press(&mut harness, "Choose from the list");
    assert_eq!(reach(&mut harness, &format!("{head}  Head")), source(head));
}

/// The Motion tab of a chain of joints that borrows from itself.
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

/// egui allocates for what it lays out, which is the same for both, and grows some lists of its own. Rows out of sight must
/// cost nothing.
#[test]
fn a_frame_of_the_table_allocates_no_more_for_more_joints() {
    let frames = |joints: usize| {
        let mut harness = bench_of_chain(joints);
        let run = |harness: &mut Harness<'static, Bench>, frames: usize| (0..frames).for_each(|_| harness.step());
        let counted = allocations_after(&mut harness, |harness| run(harness, 20), |harness| run(harness, 50));
        assert!(harness.query_by_label_contains("Tentacle3 follows").is_some());
        counted
    };
    let (few, many) = (frames(200), frames(1000));
    assert!(few.abs_diff(many) <= 4 * 50, "50 frames: {few} allocations with 200 joints, {many} with 1,000");
}

/// Every part of the tab, with a joint's details open once with a source and once without one, and all of the fit's groups.
#[test]
fn an_open_motion_tab_allocates_nothing_of_its_own() {
    let mut harness = motion_bench([1280.0, 2400.0], &["dance.bvh", "other.bvh"]);
    press(&mut harness, "Walk (2)");
    press(&mut harness, Tab::Motion.label());
    let neck = number(&harness, "Neck");
    let mute = MapEdit::Mute { source: neck, property: MutedProperty::Scale, muted: true };
    harness.state_mut().editor.apply(edit(mute));
    harness.state_mut().editor.apply(Command::SetFeet(Some(Feet::Plant)));
    let check = |part: &str, harness: &mut Harness<'_, Bench>| {
        press(harness, part);
        (0..20).for_each(|_| harness.step());
        let sites = own_allocations("gaitway::ui::motion::show", || (0..2).for_each(|_| harness.step()));
        assert!(sites.is_empty(), "{part}: {sites:#?}");
    };
    for (label, source) in [("Source of Neck", Some(neck)), ("What it does instead", None)] {
        harness.state_mut().editor.apply(Command::SetSource { motion: 0, target: neck, source });
        harness.state_mut().editor.apply(Command::SelectJoint(Some(neck)));
        check("Joints", &mut harness);
        assert!(harness.query_by_label(label).is_some());
    }
    check("Options", &mut harness);
    assert!(harness.query_by_label(text::USE_ALL_CHANNELS).is_some());
    check("Fit", &mut harness);
    assert!(harness.query_by_label_contains("Planting: ").is_some());
    check("Files", &mut harness);
}

#[test]
fn three_hundred_joints_have_their_lines() {
    let mut harness = bench_of_chain(300);
    assert!(harness.query_by_label(&text::joints_mapped(300, 300)).is_some());
    assert!(harness.query_by_label("Order: Body").is_none(), "it has no body");
    assert!(harness.query_by_label_contains("Tentacle250 follows").is_none(), "far out of sight");
    harness.state_mut().change(|state| {
        state.selection.joint = Some(250);
    });
    harness.run();
    let found = harness.get_by_label_contains("Tentacle250 follows");
    assert!(found.rect().top() > 0.0 && found.rect().bottom() < WIDE[1], "{:?}", found.rect());
    harness.state_mut().change(|state| {
        state.selection.joint = None;
    });
    harness.run();
    press_row(&mut harness, "Tentacle250 follows");
    assert_eq!(press(&mut harness, "Nothing"), [Command::SetSource { motion: 0, target: 250, source: None }]);
    choose(&mut harness, "Which joints are shown", "Follow nothing (1)");
    assert!(harness.query_by_label_contains("Tentacle250 follows none (none: deliberately none)").is_some());
    assert!(harness.query_by_label_contains("Tentacle249 follows").is_none());
    press(&mut harness, text::CLEAR_MAP);
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    harness.run();
    assert_eq!(map(&harness, 0).joints.len(), 300);
}

/// Names are told apart by what follows their namespace, and a wide table has room for them.
#[test]
fn names_are_shown_without_the_namespace_that_all_have() {
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
        press(&mut harness, Tab::Motion.label());
        reach(&mut harness, "Edit mixamorig:LeftUpperLegJoint");
        let panel = harness.state().viewport.right();
        let texts = painted(&harness);
        let of_table = texts.iter().filter(|(text, _, rect)| text.contains("LeftUpperLegJoint") && rect.left() > panel);
        let found: Vec<_> = of_table.collect();
        assert_eq!(found.len(), 2, "target and source: {found:?}");
        assert!(found.iter().all(|(text, ..)| !text.contains("mixamorig")), "{found:?}");
        assert!(size == WIDE || found.iter().all(|(_, is_cut, _)| !is_cut), "{found:?}");
    }
}

/// All of them are inside, and none lies over another.
fn fits(harness: &Harness<'_, Bench>, screen: egui::Rect, labels: &[&str]) {
    let rects: Vec<egui::Rect> = labels.iter().map(|label| harness.get_by_label(label).rect()).collect();
    for (at, (rect, label)) in rects.iter().zip(labels).enumerate() {
        assert!(screen.expand(0.5).contains_rect(*rect), "{label} at {rect:?} on {screen:?}");
        for (other, name) in rects[..at].iter().zip(labels) {
            assert!(!rect.shrink(0.5).intersects(*other), "{label} at {rect:?} over {name} at {other:?}");
        }
    }
}

#[test]
fn the_chosen_joint_fits_everywhere() {
    for size in [NARROW, [360.0, 640.0], WIDE, [1920.0, 1080.0]] {
        let mut harness = motion_bench(size, &["dance.bvh"]);
        if size[0] < 700.0 {
            press(&mut harness, text::INSPECTOR);
        }
        press(&mut harness, Tab::Motion.label());
        let arm = number(&harness, "LeftUpperArm");
        harness.state_mut().change(|state| {
            state.selection.joint = Some(arm);
        });
        harness.run();
        let labels = [
            "Source of LeftUpperArm",
            "List…",
            "Clear",
            &text::rotation_offset_about("X"),
            &text::rotation_offset_about("Y"),
            &text::rotation_offset_about("Z"),
            &text::ignore_channels("rotation"),
            &text::ignore_channels("translation"),
            &text::ignore_channels("scale"),
        ];
        for label in labels {
            harness.get_by_label(label).scroll_to_me();
            harness.run();
            let rect = harness.get_by_label(label).rect();
            let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
            assert!(screen.contains_rect(rect), "{label} at {rect:?} on {size:?}");
        }
        fits(&harness, egui::Rect::EVERYTHING, &labels);
    }
}

#[test]
fn everything_fits_on_a_narrow_screen() {
    for size in [NARROW, [360.0, 640.0]] {
        let mut harness = motion_bench(size, &["a-motion-with-a-rather-long-name.bvh", "b.bvh"]);
        press(&mut harness, text::INSPECTOR);
        press(&mut harness, Tab::Motion.label());
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        let head = [
            "Motion file",
            "Joints",
            "Options",
            "Files",
            text::PICK_IN_VIEWPORT,
            "Undo (Ctrl+Z)",
            "Redo (Ctrl+Y)",
            text::REMATCH,
            "Swap sides",
            "Clear all",
            "Order: Body",
            "Which joints are shown",
        ];
        fits(&harness, screen, &head);
        press(&mut harness, "Files");
        fits(&harness, screen, &["Save map", "Load map"]);
        press(&mut harness, "Joints");
        harness.get_by_label_contains("RightHand follows").scroll_to_me();
        harness.run();
        harness.get_by_label_contains("RightHand follows").click();
        harness.run();
        fits(&harness, screen, &["Nothing", "Cancel", "Name or number of a joint of the motion"]);
    }
}

/// A body in mid-stride that only nods.
fn striding() -> Asset {
    let at = |x, y, z| Transform::from_translation(Vec3::new(x, y, z));
    let joints = [
        ("Hips", None, at(0.0, 1.0, 0.0)),
        ("Spine", Some(0), at(0.0, 0.2, 0.0)),
        ("Neck", Some(1), at(0.0, 0.3, 0.0)),
        ("Head", Some(2), at(0.0, 0.1, 0.0)),
        ("LeftUpLeg", Some(0), at(0.1, 0.0, 0.0)),
        ("LeftLeg", Some(4), at(0.0, -0.3, 0.3)),
        ("LeftFoot", Some(5), at(0.0, -0.3, 0.3)),
        ("RightUpLeg", Some(0), at(-0.1, 0.0, 0.0)),
        ("RightLeg", Some(7), at(0.0, -0.3, -0.3)),
        ("RightFoot", Some(8), at(0.0, -0.3, -0.3)),
    ];
    let joints = joints.map(|(name, parent, rest)| skeletons::joint(name, parent, rest));
    let parts = skeletons::asset(joints.to_vec()).into_parts();
    let mut clip = ClipBuilder::new("nod", &parts.skeleton);
    let keys = Keys::Rotation(vec![Quat::IDENTITY, Quat::from_rotation_x(0.3)]);
    let head = parts.skeleton.find("Head").expect("it is there");
    clip.channel(head, Interpolation::Linear, &[0.0, 1.0], keys).expect("a valid channel");
    let clips = vec![clip.build()];
    Asset::new(AssetParts { clips, ..parts }).expect("a valid asset")
}

#[test]
fn a_rest_in_motion_is_remarked_until_one_is_chosen() {
    let mut library = Library::default();
    library.add(samples::load("walker").expect("the sample is there"));
    library.set_motions(vec![Motion::new("stride.glb".to_owned(), striding().into())]);
    let mut harness = bench_of(WIDE, library);
    press(&mut harness, Tab::Motion.label());
    assert!(harness.query_by_label(text::DOUBTFUL_REST).is_some());
    press(&mut harness, "Options");
    reach(&mut harness, "Rest pose of the motion");
    press(&mut harness, "As the file's nodes stand");
    assert!(harness.query_by_label(text::DOUBTFUL_REST).is_none());
}
