//! What the parts of the Info tab have in common: facts, findings about nodes, and numbers in columns.

use egui::Ui;
use gaitway_character::anim::JointIndex;
use gaitway_scene::library::Model;
use gaitway_scene::state::{Command, title};

use super::formula::fixed;
use super::tab::Tab;
use crate::ui::{Layout, Output, Shown, controls, style, text};

/// A name on the left and its value on the right, or below where both don't fit.
pub(super) fn fact(ui: &mut Ui, name: &str, value: &str) {
    let palette = style::palette(ui);
    let font = egui::TextStyle::Body.resolve(ui.style());
    let width = ui.available_width();
    let name_galley = ui.painter().layout(name.to_owned(), font.clone(), palette.weak_text, width);
    let value_galley = ui.painter().layout(value.to_owned(), font, palette.text, width);
    let (name_size, value_size) = (name_galley.size(), value_galley.size());
    let beside = name_size.x + value_size.x + 12.0 <= width;
    let height = if beside || value.is_empty() { name_size.y } else { name_size.y + value_size.y + 2.0 };
    let (rect, response) = ui.allocate_exact_size(egui::vec2(width, height), egui::Sense::hover());
    let whole = text::labelled(name, value);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Label, true, &whole));
    let value_at = if beside {
        egui::pos2(rect.right() - value_size.x, rect.top())
    } else {
        egui::pos2(rect.left(), rect.top() + name_size.y + 2.0)
    };
    ui.painter().galley(rect.min, name_galley, palette.weak_text);
    ui.painter().galley(value_at, value_galley, palette.text);
}

/// Shows the text of a finding, and a button that leads to the node it is about.
pub(super) fn about_node(
    ui: &mut Ui,
    shown: &Shown<'_>,
    model: &Model,
    finding: &str,
    joint: Option<JointIndex>,
    layout: &mut Layout,
    out: &mut Output,
) {
    controls::hint(ui, finding);
    let Some(joint) = joint else { return };
    let name = title(Some(shown.state), &model.asset, joint);
    if ui.add(egui::Button::new(text::go_to(&name)).truncate()).clicked() {
        out.commands.push(Command::SelectJoint(Some(model.asset.skeleton.source_index(joint))));
        layout.show_tab(Tab::Scene);
    }
}

/// Formats numbers with the same decimals, as many as suit the largest, so that they stand below each other in columns.
pub fn aligned(numbers: &[f32]) -> Vec<String> {
    let decimals = match numbers.iter().map(|number| number.abs()).fold(0.0, f32::max) {
        100.0.. => 1,
        0.00005..0.01 => 4,
        _ => 3,
    };
    numbers.iter().map(|&number| fixed(number, decimals)).collect()
}

#[cfg(test)]
mod tests {
    use super::aligned;

    #[test]
    fn numbers_have_the_same_decimals_and_no_exponents() {
        assert_eq!(aligned(&[1.0, -2.2e-6, 0.25]), ["1.000", "0.000", "0.250"]);
        assert_eq!(aligned(&[-2.2e-6, 0.0, 1e-7]), ["0.000", "0.000", "0.000"]);
        assert_eq!(aligned(&[0.0012, -0.0001, 0.0]), ["0.0012", "-0.0001", "0.0000"]);
        assert_eq!(aligned(&[154.72, -0.04, 3.0]), ["154.7", "0.0", "3.0"]);
        assert_eq!(aligned(&[f32::NAN, 1.0]), ["NaN", "1.000"]);
    }
}
