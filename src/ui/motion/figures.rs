//! The Fit part: how well the clip that plays does what its source does, in numbers.

use std::rc::Rc;

use egui::{RichText, Sense, Ui, WidgetInfo, vec2};

use super::{Contents, MotionTab, Pairing};
use crate::retarget::{Figures, Planting};
use crate::state::active_clip;
use crate::ui::widgets::controls::{self, capitals};
use crate::ui::{Shown, style, text};

/// The figures of a clip in words, kept while neither the clip nor its map changes.
#[derive(Debug)]
pub(super) struct Fit {
    contents: Rc<Contents>,
    clip: usize,
    lines: Vec<Line>,
}

#[derive(Debug)]
enum Line {
    Group {
        title: &'static str,
        hint: &'static str,
    },
    Figure {
        name: &'static str,
        value: String,
        /// Both, for screen readers.
        text: String,
    },
    Note(String),
}

pub(super) fn show(
    ui: &mut Ui,
    shown: &Shown<'_>,
    pairing: &Pairing<'_>,
    contents: &Rc<Contents>,
    tab: &mut MotionTab,
) {
    let clip = active_clip(pairing.model, shown.state);
    let Some((clip, figures)) = clip.and_then(|clip| Some((clip, shown.library.figures(clip)?))) else {
        controls::hint(ui, text::NOTHING_TO_MEASURE);
        return;
    };
    tab.fit.take_if(|fit| fit.clip != clip || !Rc::ptr_eq(&fit.contents, contents));
    let fit = tab.fit.get_or_insert_with(|| {
        let planting = pairing.model.borrowed(clip).and_then(|borrowed| borrowed.planting);
        Fit { contents: contents.clone(), clip, lines: lines(figures, planting) }
    });
    controls::hint(ui, "Over the whole clip as it plays, with unmapped joints at rest.");
    for line in &fit.lines {
        match line {
            Line::Group { title, hint } => {
                controls::section(ui, title);
                controls::hint(ui, *hint);
            }
            Line::Figure { name, value, text } => row(ui, name, value, text),
            Line::Note(note) => controls::hint(ui, note),
        }
    }
}

fn lines(figures: &Figures, planting: Option<Planting>) -> Vec<Line> {
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
        sole_penetration_metres_max,
        largest_turn_degrees_per_frame,
        coverage,
    } = *figures;
    let degrees = |name, value: Option<f64>| figure(name, value.map(|value| format!("{value:.2}°")));
    let speed = |name, value: Option<f64>| figure(name, value.map(|value| format!("{:.1} cm/s", 100.0 * value)));
    let length = |name, value: Option<f64>| figure(name, value.map(|metres| format!("{:.1} cm", 100.0 * metres)));
    let group = |title, hint| Line::Group { title, hint };
    let mut lines = vec![
        group("LIMB DIRECTION ERROR", "Angle between a limb and its source: the visible error."),
        degrees(text::MEAN, limb_direction_error_degrees_mean),
        degrees("Largest", limb_direction_error_degrees_max),
        group(
            "FACING ERROR",
            "Angle between hips, shoulders, feet or hands and the source's, as far as their build allows.",
        ),
        degrees(text::MEAN, facing_error_degrees_mean),
        degrees("Largest", facing_error_degrees_max),
        group(capitals!(text::ROTATION_ERROR), "Difference from the source's rotations, each from its own rest pose."),
        degrees(text::MEAN, orientation_error_degrees_mean),
        degrees("Largest", orientation_error_degrees_max),
        degrees("Largest turn in 1/60 s", largest_turn_degrees_per_frame),
        group("FEET", "Measured while the source's foot is on the ground, next to the source's own slide."),
        speed("Slide", foot_slide_metres_per_sec),
        speed("Slide of the source", foot_slide_source_metres_per_sec),
        length("Mean height of the soles", foot_hover_metres_mean),
        length("Max. sole penetration", sole_penetration_metres_max),
        length("Max. joint penetration", ground_penetration_metres_max),
    ];
    lines.extend(planting.map(|planting| Line::Note(text::labelled(text::PLANTING, &format!("{planting}.")))));
    lines.push(group("COVERAGE", "Mapped body parts, of those that both files have."));
    lines.push(figure(text::COVERAGE, coverage.map(|share| format!("{:.0} %", 100.0 * share))));
    lines
}

fn figure(name: &'static str, value: Option<String>) -> Line {
    let value = value.unwrap_or_else(|| "cannot be measured".to_owned());
    Line::Figure { name, text: text::labelled(name, &value), value }
}

fn row(ui: &mut Ui, name: &str, value: &str, text: &str) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 22.0), Sense::hover());
    let palette = style::palette(ui);
    response.widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Label, true, text));
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
