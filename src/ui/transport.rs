//! The bottom panel: play, scrub, step, speed, loop mode, in and out points.

use egui::{Align, Layout, RichText, Ui};

use super::icons::{Icon, icon_button, play_button};
use super::scrub::{self, Scrub, Scrubbed};
use super::{Output, Shown, UiState, controls, feet, style};
use crate::anim::{LoopMode, TimeRange};
use crate::library::ModelId;
use crate::state::Command;

pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, narrow: bool, out: &mut Output) {
    let model = shown.library.active();
    let clip_index = shown.clip_index();
    let clip = shown.clip();
    let time_secs = shown.clip_time_secs();
    let of = (model.map_or(ModelId::default(), |model| model.id), clip_index.unwrap_or(usize::MAX));
    let bar = Scrub { clip, time_secs, range: shown.state.playhead.range };
    let (scrubbed, held) = scrub::show(ui, &bar, of, &mut local.key_marks);
    local.holds_time = held;
    match scrubbed {
        Some(Scrubbed::Seek(secs)) => out.commands.push(Command::Seek(secs)),
        Some(Scrubbed::Range(range)) => out.commands.push(Command::SetRange(Some(range))),
        None => {}
    }
    if shown.state.display.show.source && !shown.state.page.embed {
        feet::show(ui, shown);
    }
    ui.horizontal(|ui| {
        ui.set_height(44.0);
        ui.spacing_mut().item_spacing.x = 4.0;
        let moves = clip.is_some_and(|clip| clip.duration_secs() > 0.0);
        ui.add_enabled_ui(moves, |ui| {
            if icon_button(ui, Icon::StepBack, "Previous frame (,)", false).clicked() {
                out.commands.push(Command::StepFrames(-1));
            }
            if play_button(ui, shown.state.playback.playing && moves, 40.0).clicked() {
                out.commands.push(Command::TogglePlaying);
            }
            if icon_button(ui, Icon::StepForward, "Next frame (.)", false).clicked() {
                out.commands.push(Command::StepFrames(1));
            }
        });
        ui.add_space(8.0);
        times(ui, shown);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            if narrow {
                speed_menu(ui, shown, out);
                loop_cycle(ui, shown, out);
            } else {
                speed_slider(ui, shown, out);
                ui.add_space(8.0);
                loop_choice(ui, shown, out);
                ui.add_space(8.0);
                ui.add_enabled_ui(moves, |ui| range_buttons(ui, shown, out));
            }
        });
    });
}

fn times(ui: &mut Ui, shown: &Shown<'_>) {
    let palette = style::palette(ui);
    let Some(clip) = shown.clip() else {
        ui.label(RichText::new("Rest pose").color(palette.weak_text));
        return;
    };
    let (time_secs, duration_secs) = (shown.clip_time_secs(), f64::from(clip.duration_secs()));
    let per_sec = shown.frames_per_sec();
    let frame = (time_secs * per_sec + 1e-4).floor();
    let frames = (duration_secs * per_sec).round();
    ui.vertical(|ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        ui.add_space(5.0);
        let text = format!("{time_secs:.2} / {duration_secs:.2} s");
        ui.add(egui::Label::new(RichText::new(text).color(palette.text)).extend());
        let text = format!("Frame {frame:.0} / {frames:.0}");
        ui.add(egui::Label::new(RichText::new(text).small().color(palette.weak_text)).extend())
            .on_hover_text(format!("At {per_sec:.0} frames a second"));
    });
}

const LOOP_MODES: [(LoopMode, Icon, &str); 3] = [
    (LoopMode::Once, Icon::Once, "Play once"),
    (LoopMode::Loop, Icon::Loop, "Loop"),
    (LoopMode::PingPong, Icon::PingPong, "There and back"),
];

fn loop_choice(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    for (mode, icon, label) in LOOP_MODES.into_iter().rev() {
        if icon_button(ui, icon, label, shown.state.playback.loop_mode == mode).clicked() {
            out.commands.push(Command::SetLoopMode(mode));
        }
    }
}

/// One button that goes through the modes.
fn loop_cycle(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let at = LOOP_MODES.iter().position(|(mode, ..)| *mode == shown.state.playback.loop_mode).unwrap_or(0);
    let (_, icon, label) = LOOP_MODES[at];
    if icon_button(ui, icon, label, false).clicked() {
        out.commands.push(Command::SetLoopMode(LOOP_MODES[(at + 1) % LOOP_MODES.len()].0));
    }
}

fn range_buttons(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    // Its place is kept, so that the others stay under the pointer.
    ui.scope(|ui| {
        if shown.state.playhead.range.is_none() {
            ui.set_invisible();
        }
        if icon_button(ui, Icon::Close, "Play the whole clip", false).clicked() {
            out.commands.push(Command::SetRange(None));
        }
    });
    if icon_button(ui, Icon::MarkOut, "Set the out point here (O)", false).clicked() {
        out.commands.extend(range_here(shown, false));
    }
    if icon_button(ui, Icon::MarkIn, "Set the in point here (I)", false).clicked() {
        out.commands.extend(range_here(shown, true));
    }
}

/// The range with its in or out point at the playhead.
pub(super) fn range_here(shown: &Shown<'_>, start: bool) -> Option<Command> {
    let duration_secs = f64::from(shown.clip()?.duration_secs());
    let now = shown.clip_time_secs();
    let TimeRange { start_secs, end_secs } =
        shown.state.playhead.range.unwrap_or(TimeRange { start_secs: 0.0, end_secs: duration_secs });
    let range = if start {
        TimeRange { start_secs: now, end_secs: if now < end_secs { end_secs } else { duration_secs } }
    } else {
        TimeRange { start_secs: if now > start_secs { start_secs } else { 0.0 }, end_secs: now }
    };
    Some(Command::SetRange(Some(range)))
}

const SPEEDS: std::ops::RangeInclusive<f64> = 0.1..=4.0;

fn speed_slider(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let mut speed = shown.state.playback.speed;
    let palette = style::palette(ui);
    if ui
        .add(egui::DragValue::new(&mut speed).range(SPEEDS).speed(0.01).fixed_decimals(2).suffix("×"))
        .on_hover_text("Speed; drag, or click to type")
        .accessible_name("Speed value")
        .changed()
    {
        out.commands.push(Command::SetSpeed(speed));
    }
    ui.add_space(4.0);
    ui.spacing_mut().slider_width = 100.0;
    let slider = ui
        .scope(|ui| {
            controls::knob_style(ui);
            ui.add(egui::Slider::new(&mut speed, SPEEDS).logarithmic(true).show_value(false))
        })
        .inner;
    let slider = slider.accessible_name("Speed").on_hover_text("Speed; double click for 1×");
    if slider.double_clicked() {
        out.commands.push(Command::SetSpeed(1.0));
    } else if slider.changed() {
        // Near the middle it catches, so that the ordinary speed is easy to find again.
        let speed = if (speed - 1.0).abs() < 0.04 { 1.0 } else { speed };
        out.commands.push(Command::SetSpeed(speed));
    }
    ui.add_space(2.0);
    ui.label(RichText::new("Speed").small().color(palette.weak_text));
}

fn speed_menu(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let label = format!("{}×", (shown.state.playback.speed * 100.0).round() / 100.0);
    let button = ui.menu_button(label, |ui| {
        for speed in [0.1, 0.25, 0.5, 1.0, 1.5, 2.0, 4.0] {
            let chosen = (shown.state.playback.speed - speed).abs() < 1e-6;
            if ui.selectable_label(chosen, format!("{speed}×")).clicked() {
                out.commands.push(Command::SetSpeed(speed));
                ui.close();
            }
        }
    });
    button.response.on_hover_text("Speed");
}
