//! The Fit part: how well the active clip does what its source does, in numbers with a verdict on each.

use std::rc::Rc;

use egui::{Align2, Color32, RichText, Sense, Ui, WidgetInfo, pos2, vec2};
use gaitway_character::anim::Clip;
use gaitway_retarget::{Contacts, Figures, FitWarning, Planting, Verdict, Verdicts};
use gaitway_scene::state::active_clip;

use super::{Contents, MotionTab, Pairing};
use crate::ui::widgets::controls::{self, capitals};
use crate::ui::{Shown, style, text};

/// The figures of a clip in words, kept while neither the clip nor its map changes.
#[derive(Debug)]
pub(super) struct Fit {
    contents: Rc<Contents>,
    clip: Clip,
    /// The worst of all verdicts, also in words.
    overall: Option<(Verdict, String)>,
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
        verdict: Option<Verdict>,
        /// All, for screen readers.
        text: String,
    },
    Note(String),
    /// What is wrong, and where.
    Warning(String),
}

pub(super) fn show(
    ui: &mut Ui,
    shown: &Shown<'_>,
    pairing: &Pairing<'_>,
    contents: &Rc<Contents>,
    tab: &mut MotionTab,
) {
    let clip = active_clip(pairing.model, shown.state);
    let Some((clip, figures)) = clip.and_then(|clip| Some((clip, shown.library.figures(clip.id())?))) else {
        controls::hint(ui, text::NOTHING_TO_MEASURE);
        return;
    };
    tab.fit.take_if(|fit| !fit.clip.is_same(clip.unchanged()) || !Rc::ptr_eq(&fit.contents, contents));
    let fit = tab.fit.get_or_insert_with(|| {
        let planting = clip.borrowed().and_then(|borrowed| borrowed.planting);
        let verdicts = Verdicts::new(figures, pairing.model.size_metres(), pairing.map.contacts);
        let overall = verdicts.worst().map(|worst| (worst, text::overall(worst)));
        Fit {
            contents: contents.clone(),
            clip: clip.unchanged().clone(),
            overall,
            lines: lines(figures, &verdicts, planting, pairing.map.contacts),
        }
    });
    if let Some((verdict, overall)) = &fit.overall {
        ui.label(RichText::new(overall).color(color(ui, *verdict)));
    }
    controls::hint(ui, "Over the whole clip as it plays, with unmapped joints at rest.");
    for line in &fit.lines {
        match line {
            Line::Group { title, hint } => {
                controls::section(ui, title);
                controls::hint(ui, *hint);
            }
            Line::Figure { name, value, verdict, text } => row(ui, name, value, *verdict, text),
            Line::Note(note) => controls::hint(ui, note),
            Line::Warning(warning) => {
                ui.label(RichText::new(warning).color(style::palette(ui).warning));
            }
        }
    }
}

fn lines(figures: &Figures, verdicts: &Verdicts, planting: Option<Planting>, contacts: Contacts) -> Vec<Line> {
    let degrees = |value: Option<f64>| value.map(|value| format!("{value:.2}°"));
    let speed = |value: Option<f64>| value.map(|value| format!("{:.1} cm/s", 100.0 * value));
    let group = |title, hint| Line::Group { title, hint };
    let angles = |mean: Option<f64>, mean_verdict, max: Option<f64>, max_verdict| {
        [figure(text::MEAN, degrees(mean), mean_verdict), figure("Largest", degrees(max), max_verdict)]
    };
    let hint = match contacts {
        Contacts::Off => "Angle between a limb and its source: the visible error.",
        Contacts::Keep => "Angle between a limb and its source. Arms and legs turn away from theirs to keep contacts.",
    };
    let sentence = |warning: FitWarning| Line::Warning(text::sentence(&warning.to_string()));
    let mut lines: Vec<Line> = FitWarning::of(figures).into_iter().map(sentence).collect();
    lines.push(group("LIMB DIRECTION ERROR", hint));
    lines.extend(angles(
        figures.limb_direction_error_degrees_mean,
        verdicts.limb_direction_error_mean,
        figures.limb_direction_error_degrees_max,
        verdicts.limb_direction_error_max,
    ));
    lines.push(group(
        "FACING ERROR",
        "Angle between hips, shoulders, feet or hands and the source's, as far as their build allows.",
    ));
    lines.extend(angles(
        figures.facing_error_degrees_mean,
        verdicts.facing_error_mean,
        figures.facing_error_degrees_max,
        verdicts.facing_error_max,
    ));
    lines.push(figure("Along the path", degrees(figures.facing_path_error_degrees_mean), verdicts.facing_path_error));
    let hint =
        "Difference from the source's rotations, each from its own rest pose, before feet and contacts are kept.";
    lines.push(group(capitals!(text::ROTATION_ERROR), hint));
    lines.extend(angles(
        figures.orientation_error_degrees_mean,
        verdicts.orientation_error_mean,
        figures.orientation_error_degrees_max,
        verdicts.orientation_error_max,
    ));
    lines.push(figure("Largest turn in 1/60 s", degrees(figures.largest_turn_degrees_per_frame), None));
    let jerk = figures.jerk_metres_per_sec3_mean.map(|jerk| format!("{jerk:.0} m/s³"));
    lines.push(figure("Mean jerk", jerk, None));
    let hint = "Measured while the source's foot is on the ground, next to the source's own slide.";
    lines.extend([
        group("FEET", hint),
        figure("Slide", speed(figures.foot_slide_metres_per_sec), verdicts.foot_slide),
        figure("Slide of the source", speed(figures.foot_slide_source_metres_per_sec), None),
        figure("Height of the soles", length(figures.foot_hover_metres_mean), verdicts.foot_hover),
        figure("Max. sole penetration", length(figures.sole_penetration_metres_max), verdicts.sole_penetration),
        figure("Max. joint penetration", length(figures.ground_penetration_metres_max), verdicts.ground_penetration),
    ]);
    lines.extend(contact_lines(figures, verdicts));
    lines.extend(planting.map(|planting| Line::Note(text::labelled(text::PLANTING, &format!("{planting}.")))));
    lines.extend(skin_lines(figures, verdicts));
    lines.extend(coverage_lines(figures, verdicts));
    lines
}

fn skin_lines(figures: &Figures, verdicts: &Verdicts) -> [Line; 3] {
    let times = |value: Option<f64>| value.map(|value| format!("× {value:.2}"));
    let hint = "Lengths of the mesh's edges against those as it was bound, where joints meet.";
    [
        Line::Group { title: "SKIN STRETCH", hint },
        figure(text::MEAN, times(figures.skin_stretch_mean), verdicts.skin_stretch_mean),
        figure("Largest", times(figures.skin_stretch_max), verdicts.skin_stretch_max),
    ]
}

fn coverage_lines(figures: &Figures, verdicts: &Verdicts) -> [Line; 3] {
    let idle = match figures.idle_chains.as_slice() {
        [] => "none".to_owned(),
        chains => chains.join(", "),
    };
    let hint = "Mapped joints of limbs, trunk and head, as far as both files have them.";
    [
        Line::Group { title: "COVERAGE", hint },
        figure(text::COVERAGE, figures.coverage.map(text::percent), verdicts.coverage),
        figure("Idle limbs", figures.coverage.map(|_| idle), verdicts.idle_chains),
    ]
}

fn contact_lines(figures: &Figures, verdicts: &Verdicts) -> [Line; 3] {
    let inside = figures.self_penetration_share.map(text::percent);
    // With a body to measure, only contacts can be missing.
    let error = length(figures.contact_error_metres_mean).or(inside.is_some().then(|| "no contacts".to_owned()));
    let hint = "Where the source's hands touch its body, or hands and knees the ground, and limbs inside other parts of the body.";
    [
        Line::Group { title: "CONTACTS", hint },
        figure("Contact error", error, verdicts.contact_error),
        figure("Limbs inside the body", inside, verdicts.self_penetration),
    ]
}

fn length(metres: Option<f64>) -> Option<String> {
    // Adding zero takes the sign from −0.
    metres.map(|metres| format!("{:.1} cm", egui::emath::round_to_decimals(100.0 * metres, 1) + 0.0))
}

fn figure(name: &'static str, value: Option<String>, verdict: Option<Verdict>) -> Line {
    let value = value.unwrap_or_else(|| "cannot be measured".to_owned());
    let mut text = text::labelled(name, &value);
    if let Some(verdict) = verdict {
        text = format!("{text}, {}", text::verdict(verdict));
    }
    Line::Figure { name, value, verdict, text }
}

fn color(ui: &Ui, verdict: Verdict) -> Color32 {
    let palette = style::palette(ui);
    match verdict {
        Verdict::Good => palette.accent,
        Verdict::Acceptable => palette.text,
        Verdict::NeedsReview => palette.warning,
    }
}

/// A name, its value, and the verdict in a column on the right.
fn row(ui: &mut Ui, name: &str, value: &str, verdict: Option<Verdict>, text: &str) {
    const VERDICT_WIDTH: f32 = 78.0;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 22.0), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Label, true, text));
    let palette = style::palette(ui);
    let right = |x: f32, text: &str, color| {
        ui.painter().text(pos2(x, rect.center().y), Align2::RIGHT_CENTER, text, style::SMALL, color)
    };
    if let Some(verdict) = verdict {
        right(rect.right(), text::verdict(verdict), color(ui, verdict));
    }
    let drawn = right(rect.right() - VERDICT_WIDTH, value, palette.text);
    controls::elided(ui, rect.with_max_x(drawn.left() - 6.0), name, palette.weak_text);
}
