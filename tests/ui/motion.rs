//! Borrowed motion: its clips at the left, the channel table and its options at the right, offers when it does not fit.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gaitway::retarget::{ClipRef, Feet, JointMap, RestChoice, RootOptions, RootPart, SourceRef, Unmapped};
use gaitway::state::{ClipChoice, Command, map_in_force};
use gaitway::ui::{PathPrompt, PathPurpose, Saved, UiAction};

use crate::bench::{Bench, NARROW, WIDE, motion_bench, press, press_key, sample_bench};

fn map(harness: &Harness<'_, Bench>, motion: usize) -> JointMap {
    let bench = harness.state();
    map_in_force(&bench.library, &bench.state, motion).expect("a map for the motion")
}

fn number(harness: &Harness<'_, Bench>, name: &str) -> usize {
    let skeleton = &harness.state().library.active().expect("a model").asset.skeleton;
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
    harness.get_by_label_contains(start).click();
    harness.run();
}

#[test]
fn borrowed_clips_stand_under_the_name_of_their_file() {
    let mut harness = motion_bench(WIDE, &["folder/dance.bvh"]);
    assert!(harness.query_by_label("From dance.bvh").is_some());
    let [walk, idle, wave] = ["Walk (2)", "Idle (2)", "Wave (2)"];
    for (title, index) in [(walk, 3), (idle, 4), (wave, 5)] {
        let expected = Command::SetClip(ClipChoice::Named(index.to_string()));
        assert_eq!(press(&mut harness, title), [expected], "{title}");
    }
}

#[test]
fn without_a_motion_there_is_no_tab_for_it() {
    let mut harness = sample_bench(WIDE);
    assert!(harness.query_by_label("Motion").is_none());
    press(&mut harness, "Motion…");
    assert_eq!(harness.state().actions, [UiAction::ChooseMotion]);
}

#[test]
fn the_table_says_who_follows_whom_and_why() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, "Motion");
    let (hips, spine) = (number(&harness, "Hips"), number(&harness, "Spine"));
    assert!(harness.query_by_label_contains(&format!("Hips follows {hips}  Hips (")).is_some());
    assert!(harness.query_by_label_contains(&format!("Spine follows {spine}  Spine (")).is_some());
    assert!(harness.query_by_label_contains("joints follow the motion").is_some());
    harness.get_by_label("Search joints of the model").click();
    harness.run();
    harness.get_by_label("Search joints of the model").type_text("lefttoes");
    harness.run();
    assert!(harness.query_by_label_contains("LeftToes follows").is_some());
    assert!(harness.query_by_label_contains("Hips follows").is_none());
}

#[test]
fn another_source_is_chosen_from_a_list() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, "Motion");
    let (neck, head) = (number(&harness, "Neck"), number(&harness, "Head"));
    press_row(&mut harness, "Neck follows");
    assert!(harness.query_by_label("What does Neck follow?").is_some());
    let commands = press(&mut harness, &format!("{head}  Head"));
    assert_eq!(commands, [Command::SetSource { motion: 0, target: neck, source: Some(head) }]);
    assert!(harness.query_by_label("What does Neck follow?").is_none());
    assert!(harness.query_by_label_contains(&format!("Neck follows {head}  Head (")).is_some());
    assert_eq!(map(&harness, 0).joints[&format!("#{neck}")].source, Some(SourceRef::Number(head)));
    press_row(&mut harness, "Neck follows");
    press(&mut harness, "Nothing");
    assert!(harness.query_by_label_contains("Neck follows none (").is_some());
    // And all the way back.
    press(&mut harness, "Match anew");
    assert!(harness.query_by_label_contains(&format!("Neck follows {neck}  Neck (")).is_some());
}

#[test]
fn a_source_is_typed_by_number_or_name() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, "Motion");
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
fn keys_do_nothing_else_while_a_source_is_chosen() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, "Motion");
    press_row(&mut harness, "Neck follows");
    assert_eq!(press_key(&mut harness, egui::Key::Space), []);
    assert_eq!(press_key(&mut harness, egui::Key::Escape), []);
    assert!(harness.query_by_label("What does Neck follow?").is_none());
}

#[test]
fn the_options_say_how_the_motion_is_carried_over() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, "Motion");
    press(&mut harness, "Options");
    let mut root = RootOptions { horizontal: RootPart::InPlace, ..RootOptions::default() };
    assert_eq!(press(&mut harness, "Over the ground: In place"), [Command::SetRoot(Some(root))]);
    root.yaw = RootPart::Freeze;
    assert_eq!(press(&mut harness, "Turning: Freeze"), [Command::SetRoot(Some(root))]);
    root.extract = true;
    assert_eq!(reach(&mut harness, "Travel on the root joint"), [Command::SetRoot(Some(root))]);
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
    press(&mut harness, "Motion");
    press(&mut harness, "Options");
    reach(&mut harness, "Joints that follow nothing");
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
    let row = "Head follows none (head · deliberately none · first key of Wave)";
    assert!(harness.query_by_label(row).is_some());
}

#[test]
fn files_are_asked_of_the_host() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, "Motion");
    press(&mut harness, "Save map");
    press(&mut harness, "Load map");
    press(&mut harness, "Options");
    press(&mut harness, "Walk (2)");
    press(&mut harness, "Save GLB");
    reach(&mut harness, "Show its own skeleton");
    reach(&mut harness, "Remove motion");
    let expected = [
        UiAction::Save(Saved::Map { motion: 0 }),
        UiAction::ChooseMotion,
        UiAction::Save(Saved::Model { clip: 3 }),
        UiAction::ShowMotionAlone(0),
        UiAction::RemoveMotions,
    ];
    assert_eq!(harness.state().actions, expected);
}

#[test]
fn a_path_to_save_at_can_be_typed() {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    let purpose = PathPurpose::Save(Saved::Map { motion: 0 });
    harness.state_mut().panels.path_prompt = Some(PathPrompt { purpose, path: "map.json".to_owned() });
    harness.run();
    press(&mut harness, "Save");
    assert_eq!(harness.state().actions, [UiAction::UsePath(purpose, "map.json".to_owned())]);
}

/// The tab shows the motion whose clip plays.
#[test]
fn one_of_several_motions_is_chosen() {
    let mut harness = motion_bench(WIDE, &["first.bvh", "second.bvh"]);
    press(&mut harness, "Motion");
    press(&mut harness, "Motion file");
    let commands = press(&mut harness, "second.bvh");
    assert_eq!(commands, [Command::SetClip(ClipChoice::Named("6".to_owned()))]);
    press(&mut harness, "Save map");
    assert_eq!(harness.state().actions, [UiAction::Save(Saved::Map { motion: 1 })]);
}

#[test]
fn what_does_not_fit_can_be_looked_at_or_mapped_by_hand() {
    let offers =
        [("Show its own skeleton", UiAction::ShowRefusedAlone), ("Choose joints by hand", UiAction::MapRefusedByHand)];
    for (label, action) in offers {
        let mut harness = sample_bench(WIDE);
        harness.state_mut().panels.error = Some("snake.bvh: no joint in common".to_owned());
        harness.run();
        assert!(harness.query_by_label(label).is_none(), "only for motions");
        harness.state_mut().panels.motion_refused = true;
        harness.run();
        press(&mut harness, label);
        assert_eq!(harness.state().actions, [action]);
        assert_eq!(harness.state().panels.error, None);
    }
}

#[test]
fn everything_fits_on_a_narrow_screen() {
    for size in [NARROW, [360.0, 640.0]] {
        let mut harness = motion_bench(size, &["a-motion-with-a-rather-long-name.bvh", "b.bvh"]);
        press(&mut harness, "Inspector");
        press(&mut harness, "Motion");
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        for label in ["Match anew", "Save map", "Load map", "Joints", "Options", "Motion file"] {
            let rect = harness.get_by_label(label).rect();
            assert!(screen.contains_rect(rect), "{label} at {rect:?} on {size:?}");
        }
        harness.get_by_label_contains("RightHand follows").scroll_to_me();
        harness.run();
        harness.get_by_label_contains("RightHand follows").click();
        harness.run();
        for label in ["Nothing", "Cancel", "Name or number of a joint of the motion"] {
            let rect = harness.get_by_label(label).rect();
            assert!(screen.contains_rect(rect), "{label} at {rect:?} on {size:?}");
        }
    }
}
