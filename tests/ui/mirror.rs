//! The panels' mirror: what it lists, when it is built, and what the user does with it.

use gaitway_scene::library::{ClipId, LayeredClip};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::{Arc, Mutex};

use egui::accesskit::{Action, ActionData, Node, NodeId, Role, TreeUpdate};
use egui::{Context, FullOutput, Plugin, RawInput};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gaitway::app::mirror::{Mirror, entries};
use gaitway::ui::{Sheet, Tab, Toast, text};
use gaitway_retarget::ClipLayer;
use gaitway_scene::state::{Command, Hidden};
use serde_json::Value;

use crate::bench::{Bench, NARROW, WIDE, motion_bench, press};

/// Keeps the last tree that a harness builds.
struct Spy(Arc<Mutex<Option<TreeUpdate>>>);

impl Plugin for Spy {
    fn debug_name(&self) -> &'static str {
        "spy"
    }

    fn output_hook(&mut self, _context: &Context, output: &mut FullOutput) {
        *self.0.lock().expect("one thread") = output.platform_output.accesskit_update.clone();
    }
}

/// Returns the accessibility tree of the next frame.
pub fn tree_of(harness: &mut Harness<'_, Bench>) -> TreeUpdate {
    let tree = Arc::new(Mutex::new(None));
    harness.ctx.add_plugin(Spy(tree.clone()));
    harness.run();
    tree.lock().expect("one thread").take().expect("a tree")
}

#[test]
fn everything_that_takes_the_focus_has_a_name() {
    for size in [WIDE, NARROW] {
        let mut harness = motion_bench(size, &["borrowed.bvh"]);
        let tree = Arc::new(Mutex::new(None));
        harness.ctx.add_plugin(Spy(tree.clone()));
        for tab in [Tab::Scene, Tab::Display, Tab::Info, Tab::Camera, Tab::Motion] {
            harness.state_mut().panels.layout.tab = tab;
            harness.run();
            let update: TreeUpdate = tree.lock().expect("one thread").take().expect("a tree");
            let entries = entries(&update);
            let listed: BTreeSet<&str> = entries.iter().map(|entry| entry["id"].as_str().expect("an id")).collect();
            // Keys do what the buttons in a row of the tree do.
            let rows: Vec<[Range<f64>; 2]> =
                entries.iter().filter(|entry| entry["role"] == "treeitem").map(extent_of).collect();
            for (id, node) in &update.nodes {
                let [left, top] = node.bounds().map_or([f64::NAN; 2], |rect| [rect.x0, rect.y0]);
                let is_around = |[across, down]: &[Range<f64>; 2]| across.contains(&left) && down.contains(&top);
                let is_in_row = node.role() == Role::Button && rows.iter().any(is_around);
                if node.supports_action(Action::Focus) && !is_in_row {
                    assert!(listed.contains(id.0.to_string().as_str()), "{tab:?} at {size:?}: {node:#?}");
                }
            }
        }
    }
}

#[test]
fn the_button_below_a_scrolled_tree_is_listed() {
    let mut harness = motion_bench(WIDE, &[]);
    let tree = Arc::new(Mutex::new(None));
    harness.ctx.add_plugin(Spy(tree.clone()));
    harness.state_mut().panels.layout.tab = Tab::Scene;
    let hidden = Hidden { nodes: [0].into(), ..Hidden::default() };
    harness.state_mut().editor.apply(Command::SetHidden(hidden));
    // At some of these heights, the button covers the center of a row that is scrolled out of sight.
    for height in 0..40 {
        harness.set_size(egui::vec2(WIDE[0], WIDE[1] - 4.0 * height as f32));
        harness.run();
        let update: TreeUpdate = tree.lock().expect("one thread").take().expect("a tree");
        let entries = entries(&update);
        assert!(entries.iter().any(|entry| entry["name"] == text::SHOW_ALL), "{height}");
    }
}

#[test]
fn a_dialog_has_its_title_as_its_name() {
    let mut harness = motion_bench(WIDE, &[]);
    harness.state_mut().panels.about_open = true;
    let entries = entries(&tree_of(&mut harness));
    let dialog = entries.iter().find(|entry| entry["role"] == "dialog").expect("a dialog");
    assert_eq!(dialog["name"], text::ABOUT);
    let button = entries.iter().find(|entry| entry["name"] == text::CLOSE_ABOUT).expect("a button");
    assert_eq!(button["in"], dialog["id"]);
}

#[test]
fn a_button_says_whether_its_menu_is_open() {
    let mut harness = motion_bench(WIDE, &[]);
    let tree = Arc::new(Mutex::new(None));
    harness.ctx.add_plugin(Spy(tree.clone()));
    for is_open in [false, true, false] {
        harness.run();
        let update: TreeUpdate = tree.lock().expect("one thread").take().expect("a tree");
        let entries = entries(&update);
        for (name, is_expanded) in [(text::EXPORT, is_open), (text::MENU, false)] {
            let button = entries.iter().find(|entry| entry["name"] == name).expect("a button");
            assert_eq!((&button["role"], &button["expanded"]), (&"button".into(), &is_expanded.into()), "{name}");
        }
        press(&mut harness, text::EXPORT);
    }
}

#[test]
fn the_edges_that_resize_panels_have_names_of_their_own() {
    let mut harness = motion_bench(WIDE, &[]);
    let update = tree_of(&mut harness);
    let edges = update.nodes.iter().filter(|(_, node)| node.role() == Role::Splitter);
    let names: BTreeSet<&str> = edges.filter_map(|(_, node)| node.label()).collect();
    assert_eq!(names, BTreeSet::from([text::RESIZE_CLIPS, text::RESIZE_INSPECTOR]));
}

#[test]
fn the_width_of_a_panel_is_read_in_percent() {
    let mut harness = motion_bench([1366.0, 768.0], &[]);
    let entries = entries(&tree_of(&mut harness));
    for name in [text::RESIZE_CLIPS, text::RESIZE_INSPECTOR] {
        let edge = entries.iter().find(|entry| entry["name"] == name).expect("an edge");
        let share = edge["now"].as_f64().expect("a share");
        assert!((0.1..0.4).contains(&share) && edge["now"].to_string().len() <= 5, "{name}: {share}");
        assert_eq!(edge["value"], format!("{:.0} %", 100.0 * share));
    }
}

/// On a slow machine, one frame may have several.
#[test]
fn every_key_moves_the_focus() {
    let context = Context::default();
    context.add_plugin(Mirror::new(|_| ()));
    let mut ids = Vec::new();
    let mut frame = || {
        let mut output = context.run_ui(RawInput::default(), |ui| {
            ids = (0..6).map(|index| ui.button(index.to_string()).id).collect();
        });
        output.textures_delta.clear();
        ids.clone()
    };
    let ids = frame();
    context.memory_mut(|memory| memory.request_focus(ids[0]));
    let mut check = |keys: &[&str], expected: usize| {
        for pressed in keys.iter().flat_map(|key| [(key, true), (key, false)]) {
            let press = |mirror: &mut Mirror| mirror.key(pressed.0, "", pressed.1, egui::Modifiers::NONE);
            context.with_plugin(press).expect("a mirror");
        }
        (0..10).for_each(|_| drop(frame()));
        assert_eq!(context.memory(egui::Memory::focused), Some(ids[expected]), "{keys:?}");
    };
    check(&["ArrowDown", "ArrowDown", "ArrowDown", "ArrowUp"], 2);
    // Held for long: it stops soon after it is released.
    check(&["ArrowUp"; 40], 0);
}

#[test]
fn shortcuts_work_with_every_keyboard_layout() {
    let context = Context::default();
    context.add_plugin(Mirror::new(|_| ()));
    // German layout: Z and Y have changed places; Russian: both have other letters.
    for (name, code, expected) in
        [("z", "KeyY", egui::Key::Z), ("я", "KeyZ", egui::Key::Z), ("н", "KeyY", egui::Key::Y)]
    {
        let press = |mirror: &mut Mirror| mirror.key(name, code, true, egui::Modifiers::COMMAND);
        context.with_plugin(press).expect("a mirror");
        let mut is_pressed = false;
        let mut output =
            context.run_ui(RawInput::default(), |ui| is_pressed |= ui.input(|input| input.key_pressed(expected)));
        output.textures_delta.clear();
        assert!(is_pressed, "{name} at {code}");
    }
}

/// On a slow machine, one frame may have what is typed and the step to the next control.
#[test]
fn what_is_typed_reaches_the_field_that_is_left() {
    let context = Context::default();
    context.add_plugin(Mirror::new(|_| ()));
    let (mut number, mut ids) = (1.0, Vec::new());
    let mut frame = |events: Vec<egui::Event>| {
        let mut output = context.run_ui(RawInput { events, ..RawInput::default() }, |ui| {
            let field = egui::DragValue::new(&mut number).update_while_editing(false);
            ids = vec![ui.add(field).id, ui.button("next").id];
        });
        output.textures_delta.clear();
        (number, ids.clone())
    };
    let (_, ids) = frame(Vec::new());
    context.memory_mut(|memory| memory.request_focus(ids[0]));
    (0..2).for_each(|_| drop(frame(Vec::new())));
    let step = |mirror: &mut Mirror| mirror.act(&ids[1].accesskit_id().0.to_string(), "focus", None);
    context.with_plugin(step).expect("a mirror");
    frame(["2", ".", "5"].map(|letter| egui::Event::Text(letter.to_owned())).to_vec());
    let entered = (0..4).map(|_| frame(Vec::new()).0).last();
    // Behind the 1 that is there.
    assert_eq!((entered, context.memory(egui::Memory::focused)), (Some(12.5), Some(ids[1])));
}

/// A name counts once Enter accepts it. The browser's field keeps the focus, and the user goes on typing, perhaps before the next frame.
#[test]
fn what_is_typed_after_enter_reaches_the_field() {
    for frames_between in [0, 3] {
        let context = Context::default();
        context.add_plugin(Mirror::new(|_| ()));
        let (mut names, mut draft) = (vec!["Walk".to_owned()], None::<String>);
        let mut frame = || {
            let mut id = None;
            let mut output = context.run_ui(RawInput::default(), |ui| {
                let mut typed = draft.take().or_else(|| names.last().cloned()).unwrap_or_default();
                let field = ui.text_edit_singleline(&mut typed);
                id = Some(field.id);
                if field.has_focus() {
                    draft = Some(typed);
                } else if field.lost_focus() && names.last() != Some(&typed) {
                    names.push(typed);
                }
            });
            output.textures_delta.clear();
            (id.expect("a field"), names.clone())
        };
        let id = frame().0.accesskit_id().0.to_string();
        context.with_plugin(|mirror: &mut Mirror| mirror.act(&id, "focus", None)).expect("a mirror");
        (0..3).for_each(|_| drop(frame()));
        for typed in ["Stroll", "Strolls"] {
            let enter = |mirror: &mut Mirror| {
                mirror.act(&id, "set", Some(ActionData::Value(typed.into())));
                mirror.key("Enter", "Enter", true, egui::Modifiers::NONE);
                mirror.key("Enter", "Enter", false, egui::Modifiers::NONE);
            };
            context.with_plugin(enter).expect("a mirror");
            (0..frames_between).for_each(|_| drop(frame()));
        }
        let named = (0..4).map(|_| frame().1).last();
        assert_eq!(named, Some(["Walk", "Stroll", "Strolls"].map(str::to_owned).to_vec()), "{frames_between}");
    }
}

#[test]
fn tabs_trees_and_tables_are_in_lists_with_names() {
    let mut harness = motion_bench(WIDE, &["borrowed.bvh"]);
    let tree = Arc::new(Mutex::new(None));
    harness.ctx.add_plugin(Spy(tree.clone()));
    for (tab, role, name) in [
        (Tab::Info, "tab", text::INSPECTOR),
        (Tab::Scene, "treeitem", text::NODES),
        (Tab::Motion, "gridcell", text::JOINTS_AND_SOURCES),
    ] {
        harness.state_mut().panels.layout.tab = tab;
        harness.run();
        let update: TreeUpdate = tree.lock().expect("one thread").take().expect("a tree");
        let entries = entries(&update);
        let names: BTreeSet<_> =
            entries.iter().filter(|entry| entry["role"] == role).map(|entry| entry["list"].as_str()).collect();
        assert_eq!(names, BTreeSet::from([Some(name)]), "{role}");
    }
}

#[test]
fn radio_buttons_are_in_a_group_named_by_its_topic() {
    let mut harness = motion_bench(WIDE, &["borrowed.bvh"]);
    let tree = Arc::new(Mutex::new(None));
    harness.ctx.add_plugin(Spy(tree.clone()));
    for (tab, topics) in [
        (Tab::Display, vec![text::SKINNING, text::MOTION_SOURCE]),
        (Tab::Camera, vec![text::BACKGROUND, text::LIGHT, text::TONE_MAP, text::UP_AXIS]),
        (Tab::Motion, vec![text::MOTION_PART]),
    ] {
        harness.state_mut().panels.layout.tab = tab;
        harness.run();
        let update: TreeUpdate = tree.lock().expect("one thread").take().expect("a tree");
        let entries = entries(&update);
        let radios = entries.iter().filter(|entry| entry["role"] == "radio");
        let named: BTreeSet<&str> = radios.map(|radio| radio["list"].as_str().expect("a group")).collect();
        assert!(topics.iter().all(|topic| named.contains(topic)), "{topics:?} in {named:?}");
    }
}

/// Minimum height of a control for fingers, as in web/theme.css.
const TOUCH: f64 = 44.0;

fn check_touch_sizes(update: &TreeUpdate, place: &str) {
    let mut count = 0;
    let entries = entries(update);
    let listed: BTreeSet<&str> = entries.iter().map(|entry| entry["id"].as_str().expect("an id")).collect();
    let is_control =
        |id: &NodeId, node: &Node| node.supports_action(Action::Focus) && listed.contains(id.0.to_string().as_str());
    for (_, node) in update.nodes.iter().filter(|(id, node)| is_control(id, node)) {
        let rect = node.bounds().expect("bounds");
        let name = node.label().unwrap_or_default();
        // The handles of the range share their height with the timeline, and are as wide as other controls are high.
        let is_handle = [text::IN_POINT, text::OUT_POINT].contains(&name);
        let (width, height) = if is_handle { (TOUCH, 30.0) } else { (0.0, TOUCH) };
        assert!(rect.height() >= height && rect.width() >= width, "{name} in {place}: {rect:?} {:?}", node.role());
        count += 1;
    }
    assert!(count > 10, "{place}: {count}");
}

#[test]
fn every_control_of_a_phone_is_large_enough_for_fingers() {
    for size in [NARROW, [360.0, 640.0], [320.0, 480.0]] {
        let mut harness = motion_bench(size, &["borrowed.bvh", "second.bvh"]);
        let tree = Arc::new(Mutex::new(None));
        harness.ctx.add_plugin(Spy(tree.clone()));
        harness.state_mut().editor.apply(Command::SelectJoint(Some(3)));
        harness
            .state_mut()
            .editor
            .apply(Command::SetLayers(vec![LayeredClip { clip: ClipId::Own(0), layer: ClipLayer::default() }]));
        let check = |harness: &mut Harness<'_, Bench>, place: &str| {
            harness.run();
            let update: TreeUpdate = tree.lock().expect("one thread").take().expect("a tree");
            check_touch_sizes(&update, &format!("{place} at {size:?}"));
        };
        check(&mut harness, "transport");
        press(&mut harness, text::MENU);
        check(&mut harness, text::MENU);
        harness.key_press(egui::Key::Escape);
        harness.run();
        harness.state_mut().panels.layout.sheet = Some(Sheet::Clips);
        check(&mut harness, "clips");
        harness.state_mut().panels.layout.sheet = Some(Sheet::Inspector);
        for tab in [Tab::Scene, Tab::Display, Tab::Info, Tab::Camera, Tab::Motion] {
            harness.state_mut().panels.layout.tab = tab;
            check(&mut harness, tab.label());
        }
        for part in [text::OPTIONS, text::FIT, text::FILES] {
            harness.get_by_label(part).scroll_to_me();
            harness.run();
            press(&mut harness, part);
            check(&mut harness, part);
        }
        harness.state_mut().panels.layout.sheet = None;
        harness.state_mut().panels.joint_card.is_posing = true;
        harness.state_mut().panels.messages.error = Some("broken.glb: it is not a GLB file".to_owned());
        let text = "Opened.".to_owned();
        harness.state_mut().panels.messages.toast = Some(Toast { text, until_secs: 1e9, undoable: true, other: None });
        check(&mut harness, "messages");
    }
}

#[test]
fn the_joint_table_is_one_grid_with_rows_of_two_cells_and_headings() {
    let mut harness = motion_bench(WIDE, &["borrowed.bvh"]);
    let tree = Arc::new(Mutex::new(None));
    harness.ctx.add_plugin(Spy(tree.clone()));
    harness.state_mut().panels.layout.tab = Tab::Motion;
    harness.run();
    let update: TreeUpdate = tree.lock().expect("one thread").take().expect("a tree");
    let entries = entries(&update);
    let is_cell = |entry: &Value| entry["role"] == "gridcell";
    let first = entries.iter().position(is_cell).expect("cells");
    let cells = entries[first..].iter().take_while(|entry| is_cell(entry));
    assert_eq!(cells.clone().count(), entries.iter().filter(|entry| is_cell(entry)).count(), "one grid");
    let mut rows: BTreeMap<u64, Vec<&Value>> = BTreeMap::new();
    for cell in cells {
        rows.entry(cell["row"].as_u64().expect("a row")).or_default().push(cell);
    }
    let (headings, joints): (Vec<_>, Vec<_>) = rows.values().partition(|cells| !cells[0]["expanded"].is_null());
    assert!(headings.len() > 3 && headings.iter().all(|cells| cells.len() == 1), "{headings:?}");
    assert!(joints.len() > 10 && joints.iter().all(|cells| cells.len() == 2), "{joints:?}");
}

/// From left to right and from the top to the bottom.
fn extent_of(entry: &Value) -> [Range<f64>; 2] {
    let side = |index: usize| entry["rect"][index].as_f64().expect("a rectangle");
    [side(0)..side(0) + side(2), side(1)..side(1) + side(3)]
}

thread_local! {
    /// What was shown, oldest first.
    static SHOWN: RefCell<Vec<Value>> = const { RefCell::new(Vec::new()) };
}

fn show(text: &str) {
    SHOWN.with_borrow_mut(|shown| shown.push(serde_json::from_str(text).expect("JSON")));
}

fn entry(list: &Value, role: &str) -> Value {
    let entries = list["entries"].as_array().expect("entries");
    entries.iter().find(|entry| entry["role"] == role).unwrap_or_else(|| panic!("no {role} in {list:#}")).clone()
}

#[test]
fn lists_come_when_something_changed_and_what_is_done_reaches_the_panels() {
    let context = Context::default();
    context.add_plugin(Mirror::new(show));
    let (mut clicks, mut number, mut text) = (0, 3.0_f32, String::new());
    let mut frame = |time: f64| {
        let input = RawInput { time: Some(time), ..RawInput::default() };
        let mut output = context.run_ui(input, |ui| {
            clicks += usize::from(ui.button(format!("Clicked {clicks} times")).clicked());
            ui.menu_button("More", |ui| ui.button("Less"));
            ui.add(egui::Slider::new(&mut number, 0.0..=10.0).text("Size"));
            ui.add(egui::TextEdit::singleline(&mut text)).accessible_name("Name");
        });
        output.textures_delta.clear();
    };
    let lists = || SHOWN.with_borrow(Vec::len);
    let last = || SHOWN.with_borrow(|shown| shown.last().expect("a list").clone());
    // The first picture comes first; then once, while nothing changes.
    (0..12).for_each(|step| frame(0.05 * f64::from(step)));
    assert_eq!(lists(), 0);
    (20..60).for_each(|step| frame(0.05 * f64::from(step)));
    assert_eq!(lists(), 1);
    let button = entry(&last(), "button");
    assert_eq!(button["name"], "Clicked 0 times");
    let slider = entry(&last(), "slider");
    assert_eq!((&slider["now"], &slider["min"], &slider["max"]), (&3.0.into(), &0.0.into(), &10.0.into()));
    assert_eq!(slider["name"], "Size");

    let id = |role: &str| entry(&last(), role)["id"].as_str().expect("an id").to_owned();
    let act = |role: &str, action: &str, data: Option<ActionData>| {
        let id = id(role);
        context.with_plugin(|mirror: &mut Mirror| mirror.act(&id, action, data)).expect("a mirror");
    };
    act("button", "click", None);
    act("slider", "set", Some(ActionData::NumericValue(7.0)));
    act("textbox", "set", Some(ActionData::Value("42".into())));
    act("textbox", "focus", None);
    act("textbox", "vanish", None);
    assert!(!SHOWN.with_borrow(|shown| shown.last().is_some_and(|list| list.to_string().contains("Less"))));
    frame(3.01);
    let before = lists();
    frame(3.5);
    assert_eq!(lists(), before);
    frame(3.56);
    assert_eq!(entry(&last(), "button")["name"], "Clicked 1 times");
    assert_eq!(entry(&last(), "slider")["now"], 7.0);
    assert_eq!(entry(&last(), "textbox")["value"], "42");
    assert_eq!(last()["focus"], entry(&last(), "textbox")["id"]);
    act("textbox", "blur", None);
    frame(3.7);
    assert_ne!(last()["focus"], entry(&last(), "textbox")["id"]);
    // A menu hangs on the button that opens it.
    let entries = last()["entries"].as_array().expect("entries").clone();
    let more =
        entries.iter().find(|entry| entry["name"] == "More").expect("a menu")["id"].as_str().expect("an id").to_owned();
    context.with_plugin(|mirror: &mut Mirror| mirror.act(&more, "click", None)).expect("a mirror");
    (0..20).for_each(|step| frame(4.0 + 0.1 * f64::from(step)));
    let group = entry(&last(), "group")["id"].clone();
    let less = last()["entries"].as_array().expect("entries").iter().find(|entry| entry["name"] == "Less").cloned();
    assert_eq!(less.expect("the menu is open")["in"], group);
}
