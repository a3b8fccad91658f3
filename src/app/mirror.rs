//! The panels' accessibility tree as a list, for platforms that AccessKit doesn't support: the page turns it into
//! transparent HTML over the canvas (web/shell/mirror.js), for keyboards and screen readers. What the user does there comes
//! back as the events that a desktop's assistive technology sends.

use std::collections::HashMap;

use egui::accesskit::{
    Action, ActionData, ActionRequest, Node, NodeId, Point, Rect, Role, Toggled, TreeId, TreeUpdate,
};
use egui::emath::round_to_decimals;
use egui::{Context, Event, FullOutput, Plugin, RawInput};
use serde_json::{Map, Value, json};

/// Seconds between two trees while the panels change without input, such as during playback.
const PERIOD_SECS: f64 = 0.25;
/// Minimum seconds from a frame without input to its tree, which would delay the picture of a newly opened model.
const SOON_SECS: f64 = 0.05;
/// Seconds until the first tree, which would otherwise delay the first picture.
const FIRST_SECS: f64 = 1.0;

/// A plugin of egui that builds trees for some frames only: for each with input, otherwise once in a while.
pub struct Mirror {
    /// Receives the list as JSON whenever it changes: `focus`, the id of the focused entry, and `entries` (see [`entries`]).
    show: fn(&str),
    shown: String,
    /// The user's actions in the mirror since the last frame.
    events: Vec<Event>,
    /// The mirror has the focus.
    pub has_focus: bool,
    /// When the last tree was built, in egui's time.
    last_secs: Option<f64>,
    /// When the next one is due; `None` until a frame may have changed something.
    due_secs: Option<f64>,
}

impl Mirror {
    /// Returns a mirror that passes its lists to `show`.
    pub fn new(show: fn(&str)) -> Self {
        Self { show, shown: String::new(), events: Vec::new(), has_focus: false, last_secs: None, due_secs: None }
    }

    /// Queues a user's action on an entry: `focus`, `blur`, `click`, `more` or `less` (by one step), or `set` with the new value as
    /// data. Ignores anything else.
    pub fn act(&mut self, id: &str, action: &str, data: Option<ActionData>) {
        let Ok(id) = id.parse() else { return };
        let action = match action {
            "focus" => Action::Focus,
            "blur" => Action::Blur,
            "click" => Action::Click,
            "more" => Action::Increment,
            "less" => Action::Decrement,
            "set" => Action::SetValue,
            _ => return,
        };
        let (target_tree, target_node) = (TreeId::ROOT, NodeId(id));
        let request =
            |action, data| Event::AccessKitActionRequest(ActionRequest { action, target_tree, target_node, data });
        if matches!(data, Some(ActionData::Value(_))) {
            // The key that accepts or cancels a text takes the panel's focus away, but not that of the field in which the user goes
            // on typing.
            self.events.push(request(Action::Focus, None));
        }
        self.events.push(request(action, data));
    }

    /// Queues a key that the mirror doesn't handle itself; `name` and `code` are the `key` and `code` of the DOM's event. The code, which
    /// is the key's place on the keyboard, stands in for letters of other scripts. Drops a key that moves the focus while several wait,
    /// as when it is held on a slow machine.
    pub fn key(&mut self, name: &str, code: &str, pressed: bool, modifiers: egui::Modifiers) {
        const MAX_WAITING: usize = 4;
        let name = if name == " " { "Space" } else { name };
        let upper = name.to_uppercase();
        if let Some(key) = [name, &upper, code].into_iter().find_map(egui::Key::from_name) {
            let event = Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
            let waiting = self.events.iter().filter(|event| moves_focus(event)).count();
            if !moves_focus(&event) || waiting < MAX_WAITING {
                self.events.push(event);
            }
        }
    }

    /// Takes the events of the next frame. In each, egui moves the focus only once, however many keys ask for it, and a key that
    /// accepts or cancels a text only works in a field that had the focus in the frame before.
    fn take_events(&mut self) -> Vec<Event> {
        let places = |is: fn(&Event) -> bool| self.events.iter().enumerate().filter(move |(_, event)| is(event));
        let move_at = places(moves_focus).map(|(at, _)| at).nth(1);
        // Alone in its frame.
        let leave_at = places(leaves_field).map(|(at, _)| at.max(1)).next();
        let end = move_at.into_iter().chain(leave_at).min().unwrap_or(self.events.len());
        let rest = self.events.split_off(end);
        std::mem::replace(&mut self.events, rest)
    }
}

fn is_blur(event: &Event) -> bool {
    matches!(event, Event::AccessKitActionRequest(ActionRequest { action: Action::Blur, .. }))
}

fn leaves_field(event: &Event) -> bool {
    matches!(event, Event::Key { key: egui::Key::Enter | egui::Key::Escape, pressed: true, .. })
}

fn moves_focus(event: &Event) -> bool {
    use egui::Key::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp, End, Home, PageDown, PageUp};
    let keys = [ArrowDown, ArrowLeft, ArrowRight, ArrowUp, End, Home, PageDown, PageUp];
    matches!(event, Event::Key { key, pressed: true, .. } if keys.contains(key))
}

impl Plugin for Mirror {
    fn debug_name(&self) -> &'static str {
        "mirror"
    }

    fn input_hook(&mut self, context: &Context, input: &mut RawInput) {
        let is_input = |event: &Event| !matches!(event, Event::PointerMoved(_) | Event::MouseMoved(_));
        let has_input = !self.events.is_empty() || input.events.iter().any(is_input);
        // What was typed into the canvas belongs to the field that still has the focus.
        let is_typed =
            input.events.iter().any(|event| matches!(event, Event::Text(_) | Event::Key { pressed: true, .. }));
        let mut events = if is_typed { Vec::new() } else { self.take_events() };
        if events.iter().any(is_blur) {
            // egui doesn't do it.
            context
                .memory_mut(|memory| memory.focused().into_iter().for_each(|focused| memory.surrender_focus(focused)));
        }
        input.events.append(&mut events);
        if !self.events.is_empty() {
            context.request_repaint();
        }
        if self.has_focus {
            // The canvas has lost the focus only to its mirror.
            input.focused = true;
            input.events.retain(|event| !matches!(event, Event::WindowFocused(false)));
        }
        let now_secs = input.time.unwrap_or_default();
        let next_secs = self.last_secs.map_or(now_secs + FIRST_SECS, |last_secs| last_secs + PERIOD_SECS);
        let due_secs = *self.due_secs.get_or_insert(next_secs.max(now_secs + SOON_SECS));
        if has_input || now_secs >= due_secs {
            (self.last_secs, self.due_secs) = (Some(now_secs), None);
            context.enable_accesskit();
        } else {
            context.disable_accesskit();
        }
    }

    fn output_hook(&mut self, context: &Context, output: &mut FullOutput) {
        let Some(update) = output.platform_output.accesskit_update.take() else {
            // This frame may have changed something: come back for a tree.
            let wait_secs = self.due_secs.unwrap_or_default() - context.input(|input| input.time);
            context.request_repaint_after_secs(wait_secs.max(0.01) as f32);
            return;
        };
        let text = json!({ "focus": update.focus.0.to_string(), "entries": entries(&update) }).to_string();
        if text != self.shown {
            (self.show)(&text);
            self.shown = text;
        }
    }
}

/// Lists the contents of a tree in reading order. Each entry is an object with `id`, `role` (an ARIA role; `text` for plain text,
/// `group` for a menu or list, `section` for controls with a common name, `dialog` for what lies over everything), `name` and `rect`
/// (left, top, width and height in points), and where they apply: `in` (the `id` of the innermost group, section or dialog around
/// it), `value`, `description`, `now`, `min` and `max`, `checked` (`true`, `false` or `mixed`), `expanded`, `disabled`, `focusable`,
/// `level`, `at` and `of` (its place in a list and the list's length, from 1), `row` (equal in the cells of a table's row), `list`
/// (the name of the list that it is in: tabs, a tree, a table or a group of radio buttons).
pub fn entries(update: &TreeUpdate) -> Vec<Value> {
    let nodes = update.nodes.iter().map(|(id, node)| (*id, node)).collect();
    let mut list = List { nodes, entries: Vec::new(), row: None, list: None };
    if let Some(tree) = &update.tree {
        list.add(tree.root, None, false);
    }
    for end in 1..list.entries.len() {
        let mut at = end;
        while at > 0 && is_left_of(&list.entries[at], &list.entries[at - 1]) {
            list.entries.swap(at, at - 1);
            at -= 1;
        }
    }
    list.entries
}

/// Whether two entries are side by side with the first on the left. egui lists right-to-left layouts from the right.
fn is_left_of(first: &Value, second: &Value) -> bool {
    let rect = |entry: &Value| -> Option<[f64; 4]> {
        let side = |index: usize| entry["rect"].get(index)?.as_f64();
        Some([side(0)?, side(1)?, side(2)?, side(3)?])
    };
    let (Some([x, y, _, height]), Some([other_x, other_y, _, other_height])) = (rect(first), rect(second)) else {
        return false;
    };
    let distance = ((y + 0.5 * height) - (other_y + 0.5 * other_height)).abs();
    first["in"] == second["in"] && x < other_x && distance < 0.25 * height.min(other_height)
}

struct List<'a> {
    nodes: HashMap<NodeId, &'a Node>,
    entries: Vec<Value>,
    /// Bounds of the last tree row in the same layout. ARIA allows no controls in a row, so its buttons are left out; keys replace
    /// them: arrows expand the row, others act on the selection.
    row: Option<Rect>,
    /// The innermost list around: the ARIA role of what is in it, and its name.
    list: Option<(&'static str, &'a str)>,
}

impl<'a> List<'a> {
    /// Adds a node and its descendants. Text inside a control is the control's name; a menu is a child of the control that opened it.
    fn add(&mut self, id: NodeId, group: Option<NodeId>, is_in_control: bool) {
        let Some(node) = self.nodes.get(&id).copied() else { return };
        let role = aria_role(node);
        if let Some(role) = role {
            let entry = self.entry(id, node, role, group);
            let center = |rect: Rect| Point::new(0.5 * (rect.x0 + rect.x1), 0.5 * (rect.y0 + rect.y1));
            let is_in_row = |row: Rect| node.bounds().is_some_and(|rect| row.contains(center(rect)));
            if role == "treeitem" {
                self.row = node.bounds();
            } else if role != "button" || !self.row.is_some_and(is_in_row) {
                self.row = None;
            }
            let is_part = (role == "button" && self.row.is_some()) || (role == "text" && is_in_control);
            // Even without a name, a group marks the start of a menu; anything else without a name says nothing.
            if !is_part && (role == "group" || entry.contains_key("name") || entry.contains_key("now")) {
                self.entries.push(Value::Object(entry));
            }
        }
        let (group, is_in_control) = match role {
            Some("group" | "section" | "dialog") => (Some(id), false),
            Some(_) => (group, true),
            None => (group, is_in_control),
        };
        let (row, list) = (self.row, self.list);
        if let Some(role) = role_in(node.role()) {
            self.list = node.label().map(|name| (role, name));
        }
        node.children().iter().for_each(|child| self.add(*child, group, is_in_control));
        self.list = list;
        if role.is_none() {
            // The last row of a scrolled tree reaches under what comes below the tree.
            self.row = row;
        }
    }

    fn entry(&self, id: NodeId, node: &Node, role: &str, group: Option<NodeId>) -> Map<String, Value> {
        let mut entry = Map::new();
        let mut set = |key: &str, value: Option<Value>| {
            if let Some(value) = value {
                entry.insert(key.to_owned(), value);
            }
        };
        let is_text = role == "text";
        let labels = || node.labelled_by().iter().filter_map(|label| self.nodes.get(label));
        let name = node.label().filter(|_| !is_text).or(node.value().filter(|_| is_text)).map(str::to_owned);
        let name = name.or_else(|| labels().find_map(|label| label.value().or(label.label()).map(str::to_owned)));
        set("id", Some(id.0.to_string().into()));
        set("role", Some(role.into()));
        set("in", group.map(|group| group.0.to_string().into()));
        set("name", name.filter(|name| !name.trim().is_empty()).map(Value::from));
        set("value", node.value().filter(|_| !is_text).map(Value::from));
        let finite = |number: Option<f64>| number.filter(|number| number.is_finite()).map(Value::from);
        // A tooltip may only repeat the name.
        set("description", node.description().filter(|&text| Some(text) != node.label()).map(Value::from));
        let decimals = match node.role() {
            // A share of the room.
            Role::Splitter => Some(3),
            _ => node.value().filter(|_| role == "spinbutton").map(decimals_in),
        };
        let now = node.numeric_value().map(|now| decimals.map_or(now, |decimals| round_to_decimals(now, decimals)));
        set("now", finite(now));
        set("min", finite(node.min_numeric_value()));
        set("max", finite(node.max_numeric_value()));
        set(
            "checked",
            node.toggled().map(|toggled| match toggled {
                Toggled::True => "true".into(),
                Toggled::False => "false".into(),
                Toggled::Mixed => "mixed".into(),
            }),
        );
        set("expanded", node.is_expanded().map(Value::from));
        set("disabled", node.is_disabled().then_some(true.into()));
        set("focusable", node.supports_action(Action::Focus).then_some(true.into()));
        set("level", node.level().map(|level| (level + 1).into()));
        set("at", node.position_in_set().map(|at| (at + 1).into()));
        set("of", node.size_of_set().map(Value::from));
        set("row", node.row_index().map(Value::from));
        set("list", self.list.filter(|(of, _)| *of == role).map(|(_, name)| name.into()));
        set("rect", node.bounds().map(|rect| json!([rect.x0, rect.y0, rect.x1 - rect.x0, rect.y1 - rect.y0])));
        entry
    }
}

/// Returns how many decimals the first number in a text has.
fn decimals_in(text: &str) -> usize {
    let (_, fraction) = text.split_once('.').unwrap_or_default();
    fraction.bytes().take_while(u8::is_ascii_digit).count()
}

/// Returns the ARIA role of what a list consists of; `None` for anything else.
fn role_in(list: Role) -> Option<&'static str> {
    Some(match list {
        Role::RadioGroup => "radio",
        Role::TabList => "tab",
        Role::Tree => "treeitem",
        Role::Grid => "gridcell",
        _ => return None,
    })
}

/// Returns the ARIA role of a node that users read or operate; `None` for layout and decoration, of which only the children count.
fn aria_role(node: &Node) -> Option<&'static str> {
    Some(match node.role() {
        // AccessKit's own Cell role would also need nodes for the row and the table.
        Role::Button if node.row_index().is_some() => "gridcell",
        Role::Button | Role::DefaultButton => "button",
        Role::CheckBox => "checkbox",
        Role::Switch => "switch",
        Role::RadioButton => "radio",
        // Of ARIA's separators, screen readers don't tell that they can be moved.
        Role::Slider | Role::Splitter => "slider",
        Role::SpinButton => "spinbutton",
        Role::TextInput | Role::SearchInput | Role::MultilineTextInput => "textbox",
        Role::ComboBox => "combobox",
        Role::Link => "link",
        Role::Label | Role::Heading | Role::Paragraph => "text",
        Role::Tab => "tab",
        Role::TreeItem => "treeitem",
        Role::ProgressIndicator => "progressbar",
        Role::Image => "img",
        Role::Dialog if node.label().is_some() => "dialog",
        Role::Menu | Role::Dialog | Role::ListBox => "group",
        Role::Group if node.label().is_some() => "section",
        Role::MenuItem | Role::ListBoxOption => "button",
        _ if node.supports_action(Action::Click) && node.label().is_some() => "button",
        _ => return None,
    })
}
