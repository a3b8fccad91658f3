//! The left panel: the open models, and the clips of the active one.

use egui::{RichText, ScrollArea, Ui, vec2};
use gaitway_scene::editor::{name_and_place, short_name};
use gaitway_scene::library::{ClipId, Model, ModelClip, ModelId};
use gaitway_scene::state::{ClipChoice, Command, is_to_bring};

use super::icons::{Icon, icon_button_sized, icon_size};
use super::search::finds;
use super::{Output, Shown, UiAction, UiState, controls, style, text, title_and_hint};

/// The height of a search field, so that nothing moves when the clear button appears.
const CLEAR_SIZE: f32 = 28.0;
const BORROW_WIDTH: f32 = 56.0;
/// Below a row.
const ROW_SPACING: f32 = 2.0;
/// Height of the clip list's heading.
const CLIPS_HEADING_HEIGHT: f32 = 40.0;
/// Longer lists have a search field.
const MANY_CLIPS: usize = 8;

/// What the panel remembers.
#[derive(Debug, Default)]
pub struct ClipList {
    search: String,
    /// The active model and the panel's height when the list of models last scrolled to it.
    seen_model: Option<(ModelId, u32)>,
    /// The current clip when the list last scrolled to it.
    seen_clip: Option<SeenClip>,
}

/// What the list scrolls to the current clip for, when it changes.
#[derive(Debug, Clone, PartialEq, Eq)]
struct SeenClip {
    model: ModelId,
    clip: Option<ClipId>,
    count: usize,
    /// Height of the list.
    height: u32,
}

pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let Some(model) = shown.library.active() else { return };
    let list = &mut local.clip_list;
    header(ui, model);
    if shown.library.models().len() > 1 {
        models(ui, shown, model, list, out);
    }
    controls::section(ui, text::CLIPS_SECTION);
    let count = model.clips().len();
    if count > MANY_CLIPS {
        search_field(ui, &mut list.search, &text::search_clips(count));
        ui.add_space(4.0);
    } else {
        list.search.clear();
    }
    // The current clip stays visible when the list gets shorter, and becomes visible when it is set elsewhere.
    let clip = shown.clip();
    let height = ui.available_height() as u32;
    let seen = SeenClip { model: model.id, clip: clip.map(|clip| clip.id().clone()), count, height };
    let before = list.seen_clip.replace(seen.clone());
    let scrolls = before.as_ref() != Some(&seen);
    // A clip that was set elsewhere, such as the first one of a motion that was just borrowed, is not hidden by a search.
    if before.is_some_and(|before| SeenClip { height: seen.height, ..before } != seen)
        && clip.is_some_and(|clip| !finds(&list.search, clip.title()))
    {
        list.search.clear();
    }
    ScrollArea::vertical().id_salt("clips").auto_shrink([false, true]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        clips(ui, shown, model, &list.search, scrolls, out);
        controls::follow_focus(ui);
    });
}

/// The rest pose and the clips that match the search, borrowed ones under the name of their motion.
fn clips(ui: &mut Ui, shown: &Shown<'_>, model: &Model, search: &str, scrolls: bool, out: &mut Output) {
    let current = shown.clip().map(ModelClip::id);
    let motions = shown.library.motions();
    let names = names_of(motions.iter().map(|motion| &*motion.source));
    if search.is_empty() && controls::list_row(ui, text::REST_POSE, "", current.is_none()).clicked() {
        out.commands.push(Command::SetClip(ClipChoice::RestPose));
    }
    let mut found = search.is_empty();
    let mut heading = None;
    for clip in model.clips().listed() {
        if !finds(search, clip.title()) {
            continue;
        }
        found = true;
        let motion = clip.borrowed().map(|borrowed| &borrowed.motion);
        if motion != heading
            && let Some((_, name)) = motions.iter().zip(&names).find(|(known, _)| Some(known.id()) == motion)
        {
            motion_heading(ui, name);
        }
        heading = motion;
        let is_current = current == Some(clip.id());
        let row = controls::list_row(ui, clip.title(), &format!("{:.2} s", clip.duration_secs()), is_current);
        if scrolls && is_current {
            row.scroll_to_me(None);
        }
        if row.clicked() {
            out.commands.push(Command::SetClip(ClipChoice::Clip(clip.id().clone())));
        }
        let changes = shown.state.character.edits.clips.changes_of(clip.id());
        if !changes.is_none() {
            ui.painter().circle_filled(row.rect.left_center() + vec2(5.0, 0.0), 2.5, style::palette(ui).accent);
            let changes = text::changes(&changes);
            ui.ctx().accesskit_node_builder(row.id, |node| node.set_description(changes.clone()));
            row.on_hover_text(changes);
        }
    }
    if !found {
        controls::hint(ui, text::no_clip_found(search));
    } else if model.clips().is_empty() {
        ui.add_space(4.0);
        controls::hint(
            ui,
            if model.is_placeholder() {
                title_and_hint(model).1
            } else if model.has_skeleton() {
                text::NO_CLIPS
            } else if model.asset.format == "obj" {
                text::NO_SKELETON_OF_OBJ
            } else {
                text::NO_SKELETON
            },
        );
    }
}

/// The open models, in at most a part of the panel.
fn models(ui: &mut Ui, shown: &Shown<'_>, active: &Model, list: &mut ClipList, out: &mut Output) {
    controls::section(ui, "MODELS");
    let room = ui.available_height();
    // What the clips leave free, but at least a fair share.
    let row_height = controls::row_height(ui, controls::ROW_HEIGHT) + ROW_SPACING;
    let clips_need = CLIPS_HEADING_HEIGHT + (active.clips().len() + 1) as f32 * row_height;
    let max_height = (room - clips_need).max(0.4 * room).max(2.0 * row_height);
    let seen = (active.id, room as u32);
    let scrolls = list.seen_model.replace(seen) != Some(seen);
    ScrollArea::vertical().id_salt("models").max_height(max_height).auto_shrink([false, true]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = ROW_SPACING;
        let models = shown.library.models();
        let names = names_of(models.iter().map(|model| &*model.source));
        for (model, name) in models.iter().zip(&names) {
            let is_active = active.id == model.id;
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                let has_motion =
                    !is_active && !model.asset.clips.is_empty() && [model, active].iter().all(|one| one.has_skeleton());
                let borrow_width = if has_motion { BORROW_WIDTH + 2.0 } else { 0.0 };
                let close_width = icon_size(ui, CLEAR_SIZE).x + 2.0;
                let size = egui::vec2(ui.available_width() - borrow_width - close_width, row_height);
                let row = ui.allocate_ui(size, |ui| controls::list_row(ui, name, "", is_active)).inner;
                if scrolls && is_active {
                    row.scroll_to_me(None);
                }
                if row.clicked() && !is_active {
                    out.actions.push(UiAction::ShowModel(model.id));
                }
                if has_motion && borrow_button(ui, name) {
                    out.actions.push(UiAction::BorrowFrom(model.id));
                }
                let close = text::close_model(name);
                if icon_button_sized(ui, Icon::Close, &close, CLEAR_SIZE).clicked() {
                    out.actions.push(UiAction::CloseModel(model.id));
                }
            });
        }
        controls::follow_focus(ui);
    });
}

/// Returns whether the button that borrows the motion of an open model was clicked.
fn borrow_button(ui: &mut Ui, name: &str) -> bool {
    ui.spacing_mut().button_padding.x = 4.0;
    let button = controls::sized(ui, [BORROW_WIDTH, CLEAR_SIZE], egui::Button::new(text::BORROW).small());
    controls::named(&button, || text::borrow_from(name));
    button.on_hover_ui(|ui| drop(ui.label(text::borrow_from(name)))).clicked()
}

/// The name of a motion, above its clips.
fn motion_heading(ui: &mut Ui, name: &str) {
    ui.add_space(8.0);
    let weak = style::palette(ui).weak_text;
    let text = RichText::new(text::from_motion(name)).small().color(weak);
    ui.add(egui::Label::new(text).truncate());
    ui.add_space(1.0);
}

fn header(ui: &mut Ui, model: &Model) {
    let palette = style::palette(ui);
    let (name, place) = name_and_place(&model.source);
    let place = match place.filter(|_| !is_to_bring(&model.origin)) {
        Some(place) => place,
        None if model.is_placeholder() => text::NOT_OPENED.to_owned(),
        None => text::LOCAL.to_owned(),
    };
    ui.add(egui::Label::new(RichText::new(name).heading().color(palette.text)).truncate());
    ui.add(egui::Label::new(RichText::new(place).small().color(palette.weak_text)).truncate());
}

/// The names of files in a list; equal names are numbered.
pub(super) fn names_of<'a>(sources: impl Iterator<Item = &'a str>) -> Vec<String> {
    let names: Vec<String> = sources.map(short_name).collect();
    let numbered = |(index, name): (usize, &String)| {
        let same = |names: &[String]| names.iter().filter(|other| *other == name).count();
        if same(&names) > 1 { format!("{name} ({})", same(&names[..=index])) } else { name.clone() }
    };
    names.iter().enumerate().map(numbered).collect()
}

/// A search field with a button that clears it.
pub(super) fn search_field(ui: &mut Ui, text: &mut String, hint: &str) {
    // As of the start of the pass: the button appears in the pass after the first letter.
    let filled = !text.is_empty();
    ui.horizontal(|ui| {
        // The button and its spacing: a row that is too wide would widen the panel in every pass.
        let clear_width = if filled { icon_size(ui, CLEAR_SIZE).x + ui.spacing().item_spacing.x } else { 0.0 };
        let field = ui.add(
            controls::text_field(text)
                .hint_text(hint)
                .margin(egui::Margin::symmetric(10, 6))
                .desired_width(ui.available_width() - clear_width),
        );
        if field.changed() {
            ui.ctx().request_repaint();
        }
        field.accessible_name(hint);
        if filled && icon_button_sized(ui, Icon::Close, text::CLEAR_SEARCH, CLEAR_SIZE).clicked() {
            text.clear();
        }
    });
}
