//! The box about Gaitway: what it is, its version and licence, and where to find more.

use egui::{Context, RichText, Ui};

use crate::ui::{Output, UiAction, modal, style, text};

const REPOSITORY: &str = env!("CARGO_PKG_REPOSITORY");

/// Shows the box while it is open.
pub fn show(context: &Context, is_open: &mut bool, out: &mut Output) {
    if *is_open {
        let modal = modal::window("about", context).show(context, |ui| contents(ui, out));
        *is_open = !(modal.inner || modal.should_close());
    }
}

/// Returns whether the close button was clicked.
fn contents(ui: &mut Ui, out: &mut Output) -> bool {
    ui.set_width((ui.ctx().content_rect().width() - 64.0).min(360.0));
    let weak = style::palette(ui).weak_text;
    modal::set_name(ui, text::ABOUT);
    ui.heading(text::NAME);
    ui.add(egui::Label::new(text::TAGLINE).wrap());
    ui.label(RichText::new(text::VERSION).color(weak));
    if option_env!("GAITWAY_QUICK_BUILD").is_some() {
        ui.add(egui::Label::new(text::QUICK_BUILD).wrap());
    }
    ui.add(egui::Label::new(RichText::new(text::LICENCE).color(weak)).wrap());
    ui.add(egui::Label::new(RichText::new(text::PRIVACY).color(weak)).wrap());
    ui.add_space(6.0);
    ui.horizontal_wrapped(|ui| {
        for (label, url) in [
            (text::DOCUMENTATION, concat!(env!("CARGO_PKG_REPOSITORY"), "#readme")),
            (text::SOURCE_CODE, REPOSITORY),
            (text::LICENCES, concat!(env!("CARGO_PKG_REPOSITORY"), "#licence")),
        ] {
            // Cargo.toml may not name a repository.
            if !REPOSITORY.is_empty() && ui.link(label).clicked() {
                out.actions.push(UiAction::OpenUrl(url));
            }
        }
        ui.button(text::CLOSE_ABOUT).clicked()
    })
    .inner
}
