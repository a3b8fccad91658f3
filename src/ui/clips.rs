//! The left panel: which model, and which of its clips.

use egui::{RichText, ScrollArea, Ui};

use super::icons::{Icon, icon_button_sized};
use super::{Output, Shown, UiAction, UiState, controls, style};
use crate::library::Model;
use crate::samples;
use crate::state::{ClipChoice, Command, choice_of_clip};

/// As high as a search field, so that nothing moves when the first letter is typed.
const CLEAR_SIZE: f32 = 28.0;
/// With the space below it.
const ROW_HEIGHT: f32 = 32.0;
/// Of the heading of the clips.
const CLIPS_HEADING: f32 = 40.0;
/// With more clips than this there is a search field.
const MANY_CLIPS: usize = 8;

pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let Some(model) = shown.library.active() else { return };
    header(ui, model, out);
    if shown.library.models().len() > 1 {
        models(ui, shown, model, local, out);
    }
    controls::section(ui, "CLIPS");
    let titles = model.clip_titles();
    if titles.len() > MANY_CLIPS {
        search_field(ui, &mut local.clip_search, &format!("Search {} clips", titles.len()));
        ui.add_space(4.0);
    } else {
        local.clip_search.clear();
    }
    let wanted = local.clip_search.to_lowercase();
    let chosen = shown.clip_index();
    let motions = names_of(shown.library.motions().iter().map(|motion| &*motion.source));
    // What is chosen stays in sight when the list gets shorter, and comes into sight when another is chosen elsewhere.
    let seen = (model.id, chosen, ui.available_height() as u32);
    let scrolls = local.clips_seen.replace(seen) != Some(seen);
    ScrollArea::vertical().id_salt("clips").auto_shrink([false, true]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        let mut found = false;
        if wanted.is_empty() {
            found = true;
            if controls::list_row(ui, "Rest pose", "", chosen.is_none()).clicked() {
                out.commands.push(Command::SetClip(ClipChoice::RestPose));
            }
        }
        let mut heading = None;
        for (index, title) in titles.iter().enumerate() {
            if !title.to_lowercase().contains(&wanted) {
                continue;
            }
            found = true;
            let motion = model.borrowed(index).map(|borrowed| borrowed.motion);
            if motion != heading
                && let Some(name) = motion.and_then(|motion| motions.get(motion))
            {
                motion_heading(ui, name);
            }
            heading = motion;
            let duration = model.clip(index).map_or(0.0, |clip| clip.duration_secs());
            let row = controls::list_row(ui, title, &format!("{duration:.2} s"), chosen == Some(index));
            if scrolls && chosen == Some(index) {
                row.scroll_to_me(None);
            }
            if row.clicked() {
                out.commands.push(Command::SetClip(choice_of_clip(model, index)));
            }
        }
        if !found {
            controls::hint(ui, format!("No clip's name contains “{}”.", local.clip_search));
        } else if titles.is_empty() {
            ui.add_space(4.0);
            controls::hint(
                ui,
                "This file has no animation. Drop a motion to borrow one (.bvh, .vrma, a .glb without meshes), or take \
                 another model's clips with “Motion…”.",
            );
        }
    });
}

/// The models to turn to, in no more than a part of the panel.
fn models(ui: &mut Ui, shown: &Shown<'_>, active: &Model, local: &mut UiState, out: &mut Output) {
    controls::section(ui, "MODELS");
    let room = ui.available_height();
    // What the clips do not need, or their fair share.
    let clips_need = CLIPS_HEADING + (active.clip_count() + 1) as f32 * ROW_HEIGHT;
    let most_high = (room - clips_need).max(0.4 * room).max(2.0 * ROW_HEIGHT);
    let seen = (active.id, room as u32);
    let scrolls = local.models_seen.replace(seen) != Some(seen);
    ScrollArea::vertical().id_salt("models").max_height(most_high).auto_shrink([false, true]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        let models = shown.library.models();
        let names = names_of(models.iter().map(|model| &*model.source));
        for (model, name) in models.iter().zip(&names) {
            let chosen = active.id == model.id;
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 2.0;
                let size = egui::vec2(ui.available_width() - CLEAR_SIZE - 2.0, ROW_HEIGHT);
                let row = ui.allocate_ui(size, |ui| controls::list_row(ui, name, "", chosen)).inner;
                if scrolls && chosen {
                    row.scroll_to_me(None);
                }
                if row.clicked() && !chosen {
                    out.actions.push(UiAction::ShowModel(model.id));
                }
                let close = format!("Close {name}");
                if icon_button_sized(ui, Icon::Close, &close, false, CLEAR_SIZE).clicked() {
                    out.actions.push(UiAction::CloseModel(model.id));
                }
            });
        }
    });
}

/// Whose clips follow.
fn motion_heading(ui: &mut Ui, name: &str) {
    ui.add_space(8.0);
    let weak = style::palette(ui).weak_text;
    let text = RichText::new(format!("From {name}")).small().color(weak);
    ui.add(egui::Label::new(text).truncate());
    ui.add_space(1.0);
}

fn header(ui: &mut Ui, model: &Model, out: &mut Output) {
    let palette = style::palette(ui);
    let (name, place) = name_and_place(&model.source);
    ui.add(egui::Label::new(RichText::new(name).heading().color(palette.text)).truncate());
    ui.add(egui::Label::new(RichText::new(place).small().color(palette.weak_text)).truncate());
    ui.add_space(8.0);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::Vec2::splat(6.0);
        // All three in a row of the narrowest panel that a screen of 800 pixels gives.
        ui.spacing_mut().button_padding.x = 7.0;
        let size = egui::vec2(0.0, 32.0);
        let open = egui::Button::new("Open…").min_size(size);
        if ui.add(open).on_hover_text("Open a model; files can also be dropped anywhere").clicked() {
            out.actions.push(UiAction::OpenFiles);
        }
        let motion = egui::Button::new("Motion…").min_size(size);
        if ui.add(motion).on_hover_text("Borrow motion from another file, or load a joint map").clicked() {
            out.actions.push(UiAction::ChooseMotion);
        }
        let share = egui::Button::new("Share…").min_size(size);
        if ui.add(share).on_hover_text("A link to this view, with all that is set").clicked() {
            out.actions.push(UiAction::ShareLink);
        }
    });
}

/// The last part of a path or URL, and where it is.
fn name_and_place(source: &str) -> (String, String) {
    if let Some(sample) = source.strip_prefix("sample:") {
        return (samples::title(sample).to_owned(), "Sample".to_owned());
    }
    let source = source.split(['?', '#']).next().unwrap_or(source);
    match source.trim_end_matches('/').rsplit_once(['/', '\\']) {
        Some((place, name)) => (name.to_owned(), place.to_owned()),
        None if source.is_empty() => ("Untitled".to_owned(), String::new()),
        None => (source.to_owned(), "Opened from this computer".to_owned()),
    }
}

/// What a file is called without the place where it lies.
pub fn short_name(source: &str) -> String {
    name_and_place(source).0
}

/// What files are called in a list of them: those of the same name are numbered.
pub(super) fn names_of<'a>(sources: impl Iterator<Item = &'a str>) -> Vec<String> {
    let names: Vec<String> = sources.map(short_name).collect();
    let numbered = |(index, name): (usize, &String)| {
        let same = |names: &[String]| names.iter().filter(|other| *other == name).count();
        if same(&names) > 1 { format!("{name} ({})", same(&names[..=index])) } else { name.clone() }
    };
    names.iter().enumerate().map(numbered).collect()
}

/// A search field that can be emptied.
pub(super) fn search_field(ui: &mut Ui, text: &mut String, hint: &str) {
    // As the pass began: typing does not make room for the button before the next.
    let filled = !text.is_empty();
    ui.horizontal(|ui| {
        // All of the button and its distance: a row that is too wide makes the panel grow, in every pass again.
        let clear_width = if filled { CLEAR_SIZE + ui.spacing().item_spacing.x } else { 0.0 };
        let field = ui.add(
            egui::TextEdit::singleline(text)
                .hint_text(hint)
                .margin(egui::Margin::symmetric(10, 6))
                .desired_width(ui.available_width() - clear_width),
        );
        if field.changed() {
            ui.ctx().request_repaint();
        }
        field.accessible_name(hint);
        if filled && icon_button_sized(ui, Icon::Close, "Clear the search", false, CLEAR_SIZE).clicked() {
            text.clear();
        }
    });
}
