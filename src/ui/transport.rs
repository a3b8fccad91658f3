//! The bottom panel: playback, scrubbing, frame steps, speed, loop mode, in and out points.

use egui::{Align, Layout, RichText, Ui};
use gaitway_character::anim::{LoopMode, TimeRange};
use gaitway_scene::library::ModelClip;
use gaitway_scene::state::{Command, Playback};

use super::icons::{ICON_SIZE, Icon, icon_button, icon_size, icon_toggle, play_button};
use super::scrub::{self, Scrub, Scrubbed};
use super::{LOW_HEIGHT, Output, Shown, UiState, controls, feet, layers, pins, style, text};
use crate::ui::widgets::accessible;

/// At most this share of the window's height is for tracks: a link may bring hundreds of layers. The others are scrolled to.
const MAX_SHARE_OF_TRACKS: f32 = 0.25;

pub(super) fn show(ui: &mut Ui, shown: &Shown<'_>, local: &mut UiState, small: bool, out: &mut Output) {
    // A low screen has no room for them.
    let has_tracks = !shown.state.page.embed.is_on() && ui.ctx().content_rect().height() >= LOW_HEIGHT;
    let has_feet = shown.state.display.show.source && has_tracks;
    let feet_gutter = if has_feet { feet::gutter(ui, shown) } else { 0.0 };
    let gutters = if has_tracks { [layers::gutter(ui, shown), pins::gutter(ui, shown)] } else { [0.0; 2] };
    let gutter = gutters.into_iter().fold(feet_gutter, f32::max);
    let range = shown.state.character.playhead.range;
    let bar = Scrub {
        clip: shown.clip().map(ModelClip::clip),
        time_secs: shown.clip_time_secs(),
        frames_per_sec: shown.frames_per_sec(),
        range,
        gutter,
    };
    let (scrubbed, is_held) = scrub::show(ui, &bar, &mut local.key_marks);
    local.holds_time = is_held;
    match scrubbed {
        Some(Scrubbed::Seek(secs)) => out.commands.push(Command::Seek(secs)),
        Some(Scrubbed::Range(range)) => out.commands.push(Command::SetRange(Some(range))),
        None => {}
    }
    // Without tracks, there are no names.
    if gutter > 0.0 {
        let max_height = MAX_SHARE_OF_TRACKS * ui.ctx().content_rect().height();
        egui::ScrollArea::vertical().id_salt("tracks").max_height(max_height).show(ui, |ui| {
            layers::show(ui, shown, gutter);
            pins::show(ui, shown, gutter);
            if has_feet {
                feet::show(ui, shown, gutter);
            }
        });
    }
    ui.horizontal(|ui| {
        ui.set_height(44.0);
        ui.spacing_mut().item_spacing.x = if small { 0.0 } else { 4.0 };
        // A tiny screen has no room for all of it.
        let room_for_steps = ui.available_width() - play_width(ui) - GAP - rest_width(ui, shown);
        let has_rest = !small || room_for_steps >= 0.0;
        let has_steps = !small || room_for_steps >= 2.0 * icon_size(ui, ICON_SIZE).x;
        ui.add_enabled_ui(shown.is_animated(), |ui| play_buttons(ui, shown, has_steps, out));
        ui.add_space(GAP);
        let room = small.then(|| ui.available_width() - if has_rest { rest_width(ui, shown) } else { 0.0 });
        if room.is_none_or(|room| room >= MIN_TIMES_WIDTH) {
            times(ui, shown, room);
        }
        if !has_rest {
            return;
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if small {
                speed_menu(ui, shown, out);
                loop_cycle(ui, shown, out);
            } else {
                speed_slider(ui, shown, out);
                ui.add_space(8.0);
                loop_buttons(ui, shown, out);
                ui.add_space(8.0);
                ui.add_enabled_ui(shown.is_animated(), |ui| range_buttons(ui, shown, out));
            }
        });
    });
}

/// Between the play buttons and the times.
const GAP: f32 = 8.0;
/// Less would only show a few digits.
const MIN_TIMES_WIDTH: f32 = 40.0;

fn play_width(ui: &Ui) -> f32 {
    controls::row_height(ui, 40.0)
}

fn play_buttons(ui: &mut Ui, shown: &Shown<'_>, has_steps: bool, out: &mut Output) {
    let (previous, next) = (controls::with_key(ui, text::PREVIOUS_FRAME), controls::with_key(ui, text::NEXT_FRAME));
    if has_steps && icon_button(ui, Icon::StepBack, previous).clicked() {
        out.commands.push(Command::StepFrames(-1));
    }
    let is_playing = shown.state.playback.playing && shown.is_animated();
    if play_button(ui, is_playing, play_width(ui)).clicked() {
        out.commands.push(Command::TogglePlaying);
    }
    if has_steps && icon_button(ui, Icon::StepForward, next).clicked() {
        out.commands.push(Command::StepFrames(1));
    }
}

/// Returns the width of what is to the right of the times on a small screen, with a gap between.
fn rest_width(ui: &Ui, shown: &Shown<'_>) -> f32 {
    icon_size(ui, ICON_SIZE).x + controls::button_width(ui, &speed_text(shown)) + 4.0
}

/// Shows time and frame, within the width `room` if there is a limit.
fn times(ui: &mut Ui, shown: &Shown<'_>, room: Option<f32>) {
    let palette = style::palette(ui);
    let Some(clip) = shown.clip() else {
        ui.label(RichText::new(text::REST_POSE).color(palette.weak_text));
        return;
    };
    let (time_secs, duration_secs) = (shown.clip_time_secs(), clip.duration_secs());
    let per_sec = shown.frames_per_sec();
    let frame = (time_secs * per_sec + 1e-4).floor();
    let last = (duration_secs * per_sec).round();
    ui.vertical(|ui| {
        if let Some(room) = room {
            ui.set_max_width(room);
        }
        ui.spacing_mut().item_spacing.y = 1.0;
        ui.add_space(5.0);
        let label = |ui: &mut Ui, text: RichText| {
            let label = egui::Label::new(text);
            ui.add(if room.is_some() { label.truncate() } else { label.extend() });
        };
        label(ui, RichText::new(text::seconds(time_secs, duration_secs)).color(palette.text));
        let mut frames = text::frames(frame, last, per_sec);
        if room.is_some_and(|room| room < controls::text_width(ui, &frames, style::SMALL)) {
            frames = text::frame(frame, last);
        }
        label(ui, RichText::new(frames).small().color(palette.weak_text));
    });
}

const LOOP_MODES: [(LoopMode, Icon, &str); 3] = [
    (LoopMode::Once, Icon::Once, text::PLAY_ONCE),
    (LoopMode::Loop, Icon::Loop, text::LOOP),
    (LoopMode::PingPong, Icon::PingPong, text::PING_PONG),
];

fn loop_buttons(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    for (mode, icon, label) in LOOP_MODES.into_iter().rev() {
        if icon_toggle(ui, icon, label, shown.state.playback.loop_mode == mode).clicked() {
            out.commands.push(Command::SetLoopMode(mode));
        }
    }
}

/// A single button that cycles through the modes.
fn loop_cycle(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let at = LOOP_MODES.iter().position(|(mode, ..)| *mode == shown.state.playback.loop_mode).unwrap_or(0);
    let (_, icon, label) = LOOP_MODES[at];
    if icon_button(ui, icon, label).clicked() {
        out.commands.push(Command::SetLoopMode(LOOP_MODES[(at + 1) % LOOP_MODES.len()].0));
    }
}

fn range_buttons(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    // Invisible rather than absent, so that the other buttons don't move.
    ui.scope(|ui| {
        if shown.state.character.playhead.range.is_none() {
            ui.set_invisible();
        }
        if icon_button(ui, Icon::Close, text::CLEAR_RANGE).clicked() {
            out.commands.push(Command::SetRange(None));
        }
    });
    if icon_button(ui, Icon::MarkOut, text::SET_OUT_POINT).clicked() {
        out.commands.extend(range_here(shown, false));
    }
    if icon_button(ui, Icon::MarkIn, text::SET_IN_POINT).clicked() {
        out.commands.extend(range_here(shown, true));
    }
}

/// The range with its in or out point moved to the playhead.
pub(super) fn range_here(shown: &Shown<'_>, start: bool) -> Option<Command> {
    let duration_secs = shown.clip()?.duration_secs();
    let now = shown.clip_time_secs();
    let TimeRange { start_secs, end_secs } =
        shown.state.character.playhead.range.unwrap_or(TimeRange { start_secs: 0.0, end_secs: duration_secs });
    let range = if start {
        TimeRange { start_secs: now, end_secs: if now < end_secs { end_secs } else { duration_secs } }
    } else {
        TimeRange { start_secs: if now > start_secs { start_secs } else { 0.0 }, end_secs: now }
    };
    Some(Command::SetRange(Some(range)))
}

fn speed_slider(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let mut speed = shown.state.playback.speed;
    let palette = style::palette(ui);
    let field = controls::number(ui, [50.0, 0.0], &mut speed, |field| {
        field.range(Playback::SPEED).speed(0.01).fixed_decimals(2).suffix("×")
    });
    field.on_hover_text("Speed. Drag, or click to type.").accessible_name(text::SPEED_VALUE);
    if speed != shown.state.playback.speed {
        out.commands.push(Command::SetSpeed(speed));
    }
    ui.add_space(4.0);
    ui.spacing_mut().slider_width = 100.0;
    let slider = ui
        .scope(|ui| {
            controls::knob_style(ui);
            ui.add(egui::Slider::new(&mut speed, Playback::SPEED).logarithmic(true).show_value(false))
        })
        .inner;
    accessible::describe_value(&slider, || speed_text(shown));
    let slider = slider.accessible_name(text::SPEED).on_hover_text("Speed. Double-click to reset to 1×.");
    if controls::is_double_clicked(&slider) {
        out.commands.push(Command::SetSpeed(1.0));
    } else if slider.changed() {
        // Snaps to the normal speed.
        let speed = if (speed - 1.0).abs() < 0.04 { 1.0 } else { speed };
        out.commands.push(Command::SetSpeed(speed));
    }
    ui.add_space(2.0);
    ui.label(RichText::new(text::SPEED).small().color(palette.weak_text));
}

fn speed_text(shown: &Shown<'_>) -> String {
    text::speed((shown.state.playback.speed * 100.0).round() / 100.0)
}

fn speed_menu(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let button = controls::menu_button(ui, &speed_text(shown), |ui| {
        for speed in [0.1, 0.25, 0.5, 1.0, 1.5, 2.0, 4.0] {
            let chosen = (shown.state.playback.speed - speed).abs() < 1e-6;
            if controls::option(ui, chosen, &text::speed(speed)) {
                out.commands.push(Command::SetSpeed(speed));
            }
        }
    });
    button.on_hover_text(text::SPEED);
}
