//! The list of a motion's joints, searchable by name or number, to choose a joint's source from.

use egui::{Context, Key, ScrollArea, Ui};
use gaitway_character::anim::JointIndex;
use gaitway_character::sort::sort_by;
use gaitway_scene::library::MotionId;
use gaitway_scene::state::{Command, title};

use super::{Pairing, joint_text};
use crate::ui::search::finds;
use crate::ui::{Output, Shown, UiState, controls, modal, text};

/// The joint whose source is being chosen.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Picking {
    motion: MotionId,
    /// The joint's number in the model's file.
    target: usize,
    search: String,
    /// The row reached with the arrow keys.
    stepped: Option<JointIndex>,
    /// On the first frame the list scrolls to the current source.
    fresh: bool,
}

impl Picking {
    pub fn new(motion: MotionId, target: usize) -> Self {
        Self { motion, target, search: String::new(), stepped: None, fresh: true }
    }
}

/// Shows the list as a modal while a source is being chosen.
pub fn show(context: &Context, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let Some(picking) = &mut local.motion.picking else { return };
    let Some(pairing) = Pairing::of(shown, &picking.motion) else {
        local.motion.picking = None;
        return;
    };
    let mut chosen: Option<Option<usize>> = None;
    let mut closed = false;
    let modal = modal::window("source", context).show(context, |ui| {
        let screen = ui.ctx().content_rect();
        ui.set_width((screen.width() - 64.0).min(380.0));
        let asset = &pairing.model.asset;
        let target = asset.skeleton.joint_of_source(picking.target);
        let name = target.map_or_else(String::new, |joint| pairing.target_title(joint).into_owned());
        let title = text::what_follows(&name);
        modal::set_name(ui, &title);
        ui.heading(title);
        ui.add_space(4.0);
        let steps = ui.input_mut(|input| {
            let mut presses = |key| input.count_and_consume_key(egui::Modifiers::NONE, key) as isize;
            presses(Key::ArrowDown) - presses(Key::ArrowUp)
        });
        let field = controls::text_field(&mut picking.search)
            .hint_text("Name or number")
            .margin(egui::Margin::symmetric(10, 6))
            .desired_width(f32::INFINITY);
        let field = ui.add(field).accessible_name(text::SEARCH_SOURCES);
        let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if ui.memory(|memory| memory.focused().is_none()) && !entered {
            field.request_focus();
        }
        let found = matching(&pairing, &picking.search);
        if field.changed() {
            picking.stepped = None;
        }
        ui.add_space(4.0);
        let now = pairing.source_in(pairing.map, picking.target).flatten();
        let fresh = std::mem::take(&mut picking.fresh);
        // Without a search or an arrow key, Enter chooses nothing.
        let searched = found.first().copied().filter(|_| !picking.search.trim().is_empty());
        if steps != 0 && !found.is_empty() {
            let from = picking.stepped.or(searched).or(now).and_then(|at| found.iter().position(|&joint| joint == at));
            let to = from.map_or(0, |from| from.saturating_add_signed(steps).min(found.len() - 1));
            picking.stepped = Some(found[to]);
        }
        let taken = picking.stepped.or(searched);
        if let Some(taken) = taken.filter(|_| entered) {
            chosen = Some(Some(pairing.motion.asset.skeleton.source_index(taken)));
        }
        // Marks what Enter would choose, otherwise the current source.
        let marked = taken.or(now);
        let scroll_to = if steps != 0 { picking.stepped } else { now.filter(|_| fresh) };
        list(ui, &pairing, &found, scroll_to, marked, marked.is_none(), &mut chosen);
        ui.add_space(4.0);
        closed |= ui.button(text::CANCEL).clicked();
    });
    if let Some(source) = chosen {
        out.commands.push(Command::SetSource { motion: picking.motion.clone(), target: picking.target, source });
        closed = true;
    }
    if closed || modal.should_close() {
        local.motion.picking = None;
    }
}

fn list(
    ui: &mut Ui,
    pairing: &Pairing<'_>,
    found: &[JointIndex],
    scroll_to: Option<JointIndex>,
    marked: Option<JointIndex>,
    marks_nothing: bool,
    chosen: &mut Option<Option<usize>>,
) {
    if controls::list_row(ui, text::FOLLOW_NOTHING, "", marks_nothing).clicked() {
        *chosen = Some(None);
    }
    let height = (ui.ctx().content_rect().height() - 292.0).clamp(90.0, 360.0);
    ScrollArea::vertical().id_salt("sources").max_height(height).min_scrolled_height(height).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        for &joint in found {
            let asset = &pairing.motion.asset;
            let row = controls::list_row(ui, &joint_text(asset, joint), "", marked == Some(joint));
            if scroll_to == Some(joint) {
                row.scroll_to_me(Some(egui::Align::Center));
            }
            if row.clicked() {
                *chosen = Some(Some(asset.skeleton.source_index(joint)));
            }
        }
        if found.is_empty() {
            controls::hint(ui, "No joint of the motion has this name or number.");
        }
        controls::follow_focus(ui);
    });
}

/// Returns matching joints in the file's order, exact matches of number or name first.
fn matching(pairing: &Pairing<'_>, search: &str) -> Vec<JointIndex> {
    let asset = &pairing.motion.asset;
    let skeleton = &asset.skeleton;
    let wanted = search.trim().to_lowercase();
    let number: Option<usize> = wanted.parse().ok();
    let mut found: Vec<(bool, usize, JointIndex)> = skeleton
        .joints()
        .filter_map(|joint| {
            let (at, name) = (skeleton.source_index(joint), title(None, asset, joint));
            let exact = number == Some(at) || name.to_lowercase() == wanted;
            (exact || finds(&wanted, &name)).then_some((!exact, at, joint))
        })
        .collect();
    sort_by(&mut found, Ord::cmp);
    found.into_iter().map(|(_, _, joint)| joint).collect()
}
