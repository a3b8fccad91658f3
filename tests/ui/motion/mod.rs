//! The Motion tab: borrowed clips, the joint table, choosing sources, options and files.

mod edits;
mod files;
mod layout;
mod options;
mod source;
mod table;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gaitway::ui::{Tab, text};
use gaitway_retarget::JointMap;
use gaitway_scene::state::{Command, MapEdit, active_map};

use crate::bench::{Bench, WIDE, motion_bench, press};
use crate::by_place::{motion_at, motion_called};

/// The walker with its own clips as the motion `dance.bvh`, and the Motion tab open.
pub fn motion_tab() -> Harness<'static, Bench> {
    let mut harness = motion_bench(WIDE, &["dance.bvh"]);
    press(&mut harness, Tab::Motion.label());
    harness
}

/// The Motion tab with the details of the joint `Neck`, and the joint's index in the file.
pub fn neck_details() -> (Harness<'static, Bench>, usize) {
    let mut harness = motion_tab();
    let neck = number(&harness, "Neck");
    press(&mut harness, &text::edit_joint("Neck"));
    (harness, neck)
}

pub fn map(harness: &Harness<'_, Bench>, motion: usize) -> JointMap {
    let bench = harness.state();
    active_map(bench.library(), bench.state(), &motion_at(bench.library(), motion)).expect("a map for the motion")
}

pub fn number(harness: &Harness<'_, Bench>, name: &str) -> usize {
    let skeleton = &harness.state().library().active().expect("a model").asset.skeleton;
    skeleton.source_index(skeleton.find(name).expect("a joint of the walker"))
}

/// Scrolls to a control and presses it.
pub fn reach(harness: &mut Harness<'_, Bench>, label: &str) -> Vec<Command> {
    harness.get_by_label(label).scroll_to_me();
    harness.run();
    press(harness, label)
}

/// Scrolls to the row of the joint table that begins with `start`, and presses it.
pub fn press_row(harness: &mut Harness<'_, Bench>, start: &str) {
    harness.get_by_label_contains(start).scroll_to_me();
    harness.run();
    harness.get_by_label_contains(start).click();
    harness.run();
}

pub fn edit(edit: MapEdit) -> Command {
    Command::EditMap { motion: motion_called("dance.bvh"), edit }
}

/// Chooses an entry of a drop-down list; other controls may have the same label.
pub fn choose(harness: &mut Harness<'_, Bench>, list: &str, entry: &str) -> Vec<Command> {
    reach(harness, list);
    harness.get_all_by_label(entry).last().expect("in the list").scroll_to_me();
    harness.run();
    harness.state_mut().commands.clear();
    harness.get_all_by_label(entry).last().expect("in the list").click();
    harness.run();
    std::mem::take(&mut harness.state_mut().commands)
}

/// Whether any label contains these words: a row of the table, the details below it, or both.
pub fn says(harness: &Harness<'_, Bench>, words: &str) -> bool {
    harness.query_all_by_label_contains(words).next().is_some()
}
