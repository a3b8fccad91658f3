//! The header: the name, opening and borrowing on the left; undo, saving, sharing and the menu on the right.

use egui::{Align, Layout, RichText, ThemePreference, Ui};
use gaitway_scene::editor::{ClipFormat, Export, derived_clip};
use gaitway_scene::library::{Model, ModelClip};
use gaitway_scene::state::active_clip;

use super::icons::{ICON_SIZE, Icon, icon_button, icon_size, icon_toggle};
use super::widgets::controls::{self, capitals};
use super::{Output, Saved, Sheet, Shown, Tab, UiAction, UiState, style, text};

const MENU_WIDTH: f32 = 220.0;
/// Margin to the sides on small screens.
const SIDE_IF_SMALL: f32 = 6.0;
/// Smaller screens have no room for the name.
const NAME_WIDTH: f32 = 350.0;
/// Buttons of a small screen besides the menu, those first that a tiny one leaves out last.
const BY_NEED: [&str; 6] = [text::OPEN, text::INSPECTOR, text::CLIPS, text::SHARE, text::UNDO_STEP, text::REDO_STEP];

pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let (side, gap) = if local.layout.is_small { (SIDE_IF_SMALL as i8, 0.0) } else { (10, 4.0) };
    let frame = egui::Frame::new().inner_margin(egui::Margin { left: side, right: side, top: 5, bottom: 3 });
    egui::Panel::top("header").frame(frame).resizable(false).show_separator_line(false).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.set_height(icon_size(ui, ICON_SIZE).y);
            ui.spacing_mut().item_spacing.x = gap;
            left(ui, shown, local, out);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| right(ui, shown, local, out));
        });
    });
}

/// Whether the screen has room for one of the buttons in [`BY_NEED`].
fn has_room(ui: &Ui, label: &str, local: &UiState) -> bool {
    let width = ui.ctx().content_rect().width() - 2.0 * SIDE_IF_SMALL - controls::button_width(ui, text::MENU);
    let number = (width / icon_size(ui, ICON_SIZE).x).floor() as usize;
    !local.layout.is_small || BY_NEED.iter().take(number).any(|shown| *shown == label)
}

/// Whether there is room for the button that shows the samples; otherwise the menu has it.
fn has_samples(ui: &Ui, local: &UiState) -> bool {
    !local.layout.is_small && ui.ctx().content_rect().width() >= 800.0
}

fn left(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    panel_button(ui, Sheet::Clips, local);
    if ui.ctx().content_rect().width() >= NAME_WIDTH {
        let name = RichText::new(text::NAME).strong();
        if local.layout.is_small {
            ui.add_space(2.0);
        }
        ui.label(if local.layout.is_small { name } else { name.heading() });
        ui.add_space(4.0);
    }
    if local.layout.is_small {
        if has_room(ui, text::OPEN, local) && icon_button(ui, Icon::Open, text::OPEN).clicked() {
            out.actions.push(UiAction::OpenFiles);
        }
        return;
    }
    if ui.button(text::OPEN).on_hover_text("Open a model. You can also drop files anywhere.").clicked() {
        out.actions.push(UiAction::OpenFiles);
    }
    borrow(ui, shown, out);
    if has_samples(ui, local) && local.host.has_gallery && ui.button(text::SAMPLES).clicked() {
        out.actions.push(UiAction::ShowGallery);
    }
}

fn right(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    panel_button(ui, Sheet::Inspector, local);
    let were_open = (local.help.is_open, local.about_open);
    let button = controls::menu_button(ui, text::MENU, |ui| {
        // All of it is higher than the screen of a phone.
        let max_height = ui.ctx().content_rect().height() - 80.0;
        let area = egui::ScrollArea::vertical().max_height(max_height).min_scrolled_height(max_height);
        area.show(ui, |ui| menu(ui, shown, local, out));
    });
    // The entry that was pressed is gone when what it opened is closed.
    if were_open != (local.help.is_open, local.about_open) && ui.memory(|memory| memory.focused().is_some()) {
        button.request_focus();
    }
    let share = |ui: &mut Ui| match local.layout.is_small {
        true => icon_button(ui, Icon::Share, text::SHARE),
        false => ui.button(text::SHARE).on_hover_text("Share a link to this view and all its settings"),
    };
    if has_room(ui, text::SHARE, local) && share(ui).clicked() {
        out.actions.push(UiAction::ShareLink);
    }
    if !local.layout.is_small {
        controls::menu_button(ui, text::EXPORT, |ui| export(ui, shown, local, out));
    }
    let steps = [
        (Icon::Redo, text::REDO_STEP, local.host.can_redo, UiAction::Redo),
        (Icon::Undo, text::UNDO_STEP, local.host.can_undo, UiAction::Undo),
    ];
    for (icon, label, enabled, action) in steps {
        if !has_room(ui, label, local) {
            continue;
        }
        let label = controls::with_key(ui, label);
        if ui.add_enabled_ui(enabled, |ui| icon_button(ui, icon, label)).inner.clicked() {
            out.actions.push(action);
        }
    }
}

/// Shows or hides a panel.
fn panel_button(ui: &mut Ui, panel: Sheet, local: &mut UiState) {
    let of_small = if panel == Sheet::Clips { text::CLIPS } else { text::INSPECTOR };
    if !has_room(ui, of_small, local) {
        return;
    }
    let layout = &mut local.layout;
    let is_open = layout.sheet == Some(panel);
    let (icon, label) = match (panel, layout.is_small) {
        (Sheet::Clips, true) => (Icon::Clips, text::CLIPS),
        (Sheet::Inspector, true) => (Icon::Sliders, text::INSPECTOR),
        (Sheet::Clips, false) => (Icon::PanelLeft, if layout.clips_open { text::HIDE_CLIPS } else { text::SHOW_CLIPS }),
        (Sheet::Inspector, false) => {
            (Icon::PanelRight, if layout.inspector_open { text::HIDE_INSPECTOR } else { text::SHOW_INSPECTOR })
        }
    };
    // On a large screen, the label says what it does.
    let button = if layout.is_small { icon_toggle(ui, icon, label, is_open) } else { icon_button(ui, icon, label) };
    if button.clicked() {
        layout.toggle(panel);
    }
}

fn borrow(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let active = shown.library.active().filter(|model| !model.is_placeholder());
    let can_borrow = active.is_some_and(Model::has_skeleton);
    let button = ui.add_enabled(can_borrow, egui::Button::new(text::BORROW_MOTION));
    let button = button.on_hover_text("Borrow motion from another file, or load a joint map");
    if button.on_disabled_hover_text(text::NOTHING_TO_MOVE).clicked() {
        out.actions.push(UiAction::ChooseMotion);
    }
}

fn menu(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    ui.set_width(MENU_WIDTH);
    if local.layout.is_small {
        borrow(ui, shown, out);
        // No menu of its own: it would cover this one, without a way back.
        controls::section(ui, capitals!(text::EXPORT));
        export(ui, shown, local, out);
        ui.separator();
    }
    let items = [
        (text::SAMPLES, local.host.has_gallery && !has_samples(ui, local), UiAction::ShowGallery),
        (text::FULL_SCREEN, local.host.has_fullscreen, UiAction::ToggleFullscreen),
    ];
    for (label, is_there, action) in items {
        if is_there && entry(ui, label) {
            out.actions.push(action);
        }
    }
    if entry(ui, if style::is_for_fingers(ui) { text::GESTURES } else { text::HELP }) {
        local.help.is_open = true;
    }
    if entry(ui, text::ABOUT) {
        local.about_open = true;
    }
    let themes =
        [(ThemePreference::System, "System"), (ThemePreference::Light, "Light"), (ThemePreference::Dark, "Dark")];
    controls::hint(ui, text::THEME);
    let now = ui.ctx().options(|options| options.theme_preference);
    if let Some(theme) = controls::segmented_about(ui, text::THEME, Some(now), &themes) {
        out.actions.push(UiAction::SetTheme(theme));
    }
}

/// An entry that closes its menu, also when a key presses it: egui only sees clicks.
fn entry(ui: &mut Ui, label: &str) -> bool {
    let is_pressed = ui.button(label).clicked();
    if is_pressed {
        ui.close();
    }
    is_pressed
}

/// Everything that can be saved of this view.
fn export(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    ui.set_width(MENU_WIDTH);
    let Some(model) = shown.library.active() else { return };
    let clip = active_clip(model, shown.state);
    let borrowed = clip.and_then(ModelClip::borrowed);
    let pictures = &local.picture_settings;
    let clips = clip.into_iter().flat_map(|clip| {
        let formats = ClipFormat::ALL.into_iter().filter(|format| format.fits(model));
        formats.map(move |format| (text::save_clip(format), Export::Clip { clip: clip.id().clone(), format }))
    });
    let model_with_clip =
        derived_clip(model, shown.state).map(|clip| (text::SAVE_GLB, Export::Model { clip: clip.id().clone() }));
    let has_others = model.clips().len() > 1 && model.clips().iter().any(ModelClip::is_derived);
    let others = [
        has_others.then_some((text::SAVE_ALL_CLIPS, Export::AllClips)),
        borrowed.map(|borrowed| (text::SAVE_MAP, Export::Map { motion: borrowed.motion.clone() })),
        (model.asset.format == "obj").then_some((text::SAVE_REST_POSE, Export::FullModel { posed: false })),
        (model.asset.format == "obj").then_some((text::SAVE_CURRENT_POSE, Export::FullModel { posed: true })),
    ];
    let files = model_with_clip.into_iter().chain(clips).chain(others.into_iter().flatten());
    let files = files.map(|(label, file)| (label, UiAction::Save(Saved::File(file))));
    let recordings = pictures.recordings().into_iter().filter(|_| shown.is_animated());
    let recordings = recordings.map(|(label, _, action)| (label, action));
    let image = (text::SAVE_IMAGE, UiAction::Save(pictures.image()));
    let page = local.host.can_save_page.then_some((text::SAVE_PAGE, UiAction::SavePage));
    for (label, action) in [image].into_iter().chain(recordings).chain(files).chain(page) {
        if entry(ui, label) {
            out.actions.push(action);
        }
    }
    if entry(ui, text::PICTURE_SETTINGS) {
        local.layout.show_tab(Tab::Camera);
        local.seeks_picture_settings = true;
    }
}
