//! Controls that hide nodes and materials: the eye of a row and the button that shows everything again.

use egui::{Id, Rect, Sense, Ui, Vec2, WidgetInfo};
use gaitway_scene::state::{Command, Hidden};

use crate::ui::icons::{Icon, paint};
use crate::ui::{Output, Shown, style, text};

/// What pressing an eye asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pressed {
    Toggle,
    /// With Alt.
    Solo,
}

/// Width of an eye at the right end of a row.
pub const EYE_WIDTH: f32 = 26.0;

/// Shows the eye at the right end of a row; returns how it was pressed. It comes after the row, so that it gets the click.
pub fn eye(ui: &Ui, row: Rect, id: Id, name: &str, is_shown: bool) -> Option<Pressed> {
    let grab = Rect::from_min_max(row.right_top() - Vec2::new(EYE_WIDTH, 0.0), row.max);
    let response = ui.interact(grab, id, Sense::click());
    let label = || text::eye(name, is_shown);
    response.widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Button, true, label()));
    let palette = style::palette(ui);
    let color = if response.hovered() || !is_shown { palette.text } else { palette.weak_text.gamma_multiply(0.7) };
    let icon = if is_shown { Icon::Eye } else { Icon::EyeClosed };
    paint(ui.painter(), icon, Rect::from_center_size(grab.center(), Vec2::splat(15.0)), color);
    style::focus_ring(ui, &response, grab.shrink(1.0), style::CORNER, 1.0);
    let is_solo = response.secondary_clicked() || (response.clicked() && ui.input(|input| input.modifiers.alt));
    let pressed = if is_solo { Some(Pressed::Solo) } else { response.clicked().then_some(Pressed::Toggle) };
    response.on_hover_text(text::SOLO_ALTERNATIVES);
    pressed
}

/// Shows the button that unhides everything, if anything is hidden.
pub fn show_all(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    if !shown.state.character.edits.hidden.is_empty() && ui.button(text::SHOW_ALL).clicked() {
        out.commands.push(Command::SetHidden(Hidden::default()));
    }
}
