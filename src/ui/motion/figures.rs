//! The Fit part: how well the clip that plays does what its source does, in numbers.

use egui::{RichText, Sense, Ui, WidgetInfo, vec2};

use super::Pairing;
use crate::retarget::Figures;
use crate::state::active_clip;
use crate::ui::{Shown, controls, style, text};

pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, pairing: &Pairing<'_>) {
    let clip = active_clip(pairing.model, shown.state);
    let Some((clip, figures)) = clip.and_then(|clip| Some((clip, shown.library.figures(clip)?))) else {
        controls::hint(ui, "Choose a borrowed clip to see how well it fits.");
        return;
    };
    let Figures {
        limb_direction_error_degrees_mean,
        limb_direction_error_degrees_max,
        facing_error_degrees_mean,
        facing_error_degrees_max,
        orientation_error_degrees_mean,
        orientation_error_degrees_max,
        foot_slide_metres_per_sec,
        foot_slide_source_metres_per_sec,
        ground_penetration_metres_max,
        foot_hover_metres_mean,
        coverage,
    } = *figures;
    let degrees = |value: Option<f64>| value.map(|value| format!("{value:.2}°"));
    let speed = |value: Option<f64>| value.map(|value| format!("{:.1} cm/s", 100.0 * value));
    controls::hint(ui, "Over the whole clip as it plays, with unmapped joints at rest.");
    group(ui, "LIMB DIRECTION ERROR", "Angle between a limb and its source: the visible error.");
    row(ui, "Mean", degrees(limb_direction_error_degrees_mean));
    row(ui, "Largest", degrees(limb_direction_error_degrees_max));
    group(
        ui,
        "FACING ERROR",
        "Angle between hips, shoulders, feet or hands and the source's, as far as their build allows.",
    );
    row(ui, "Mean", degrees(facing_error_degrees_mean));
    row(ui, "Largest", degrees(facing_error_degrees_max));
    group(
        ui,
        &text::ROTATION_ERROR.to_uppercase(),
        "Difference from the source's rotations, each from its own rest pose.",
    );
    row(ui, "Mean", degrees(orientation_error_degrees_mean));
    row(ui, "Largest", degrees(orientation_error_degrees_max));
    group(ui, "FEET", "Measured while the source's foot is on the ground, next to the source's own slide.");
    row(ui, "Slide", speed(foot_slide_metres_per_sec));
    row(ui, "Slide of the source", speed(foot_slide_source_metres_per_sec));
    let centimetres = |value: Option<f64>| value.map(|metres| format!("{:.1} cm", 100.0 * metres));
    row(ui, "Mean height of the soles", centimetres(foot_hover_metres_mean));
    row(ui, "Max. ground penetration", centimetres(ground_penetration_metres_max));
    if let Some(planting) = pairing.model.borrowed(clip).and_then(|borrowed| borrowed.planting) {
        controls::hint(ui, format!("Planting: {planting}."));
    }
    group(ui, "COVERAGE", "Mapped body parts, of those that both files have.");
    row(ui, "Mapped", coverage.map(|share| format!("{:.0} %", 100.0 * share)));
}

fn group(ui: &mut Ui, title: &str, hint: &str) {
    controls::section(ui, title);
    controls::hint(ui, hint);
}

fn row(ui: &mut Ui, name: &str, value: Option<String>) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 22.0), Sense::hover());
    let palette = style::palette(ui);
    let value = value.unwrap_or_else(|| "cannot be measured".to_owned());
    let text = format!("{name}: {value}");
    response.widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Label, true, &text));
    ui.put(rect, |ui: &mut Ui| {
        ui.horizontal(|ui| {
            ui.label(RichText::new(name).color(palette.weak_text));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(RichText::new(value).monospace());
            });
        })
        .response
    });
}
