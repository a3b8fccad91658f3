//! Tracks under the timeline: rows with a name at the left, over the time of the clip.

use egui::{Rect, Response, Sense, Stroke, Ui, WidgetInfo, vec2};
use gaitway_scene::library::ModelClip;

use super::{Shown, controls, scrub, style};

const TRACK_HEIGHT: f32 = 18.0;
/// At most this share of the width is for names.
const MAX_GUTTER: f32 = 0.25;

/// A name without its namespace, such as `mixamorig:`.
pub(super) fn short(name: &str) -> &str {
    name.rsplit_once(':').map_or(name, |(_, name)| name)
}

/// Returns the duration of the clip; `None` if no time passes.
pub(super) fn duration_secs(shown: &Shown<'_>) -> Option<f64> {
    shown.clip().map(ModelClip::duration_secs).filter(|&secs| secs > 0.0)
}

/// Returns the width of a gutter for the names of tracks.
pub(super) fn widest(ui: &Ui, names: &mut dyn Iterator<Item = String>) -> f32 {
    // Laid out, since a name may have letters that our font lacks.
    let widths = names.map(|name| ui.painter().layout_no_wrap(name, style::SMALL, egui::Color32::PLACEHOLDER).size().x);
    widths.fold(0.0, f32::max).ceil().min(MAX_GUTTER * ui.available_width())
}

/// Shows a track with its name in the gutter and the playhead over what `paint` draws. Returns its rectangle and response.
pub(super) fn row(
    ui: &mut Ui,
    shown: &Shown<'_>,
    gutter: f32,
    name: &str,
    accessible_name: &str,
    paint: impl FnOnce(&Ui, Rect),
) -> (Rect, Response) {
    let palette = style::palette(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), TRACK_HEIGHT), Sense::hover());
    let lane = rect.with_min_x(rect.left() + gutter).shrink2(vec2(scrub::MARGIN, 1.0));
    response.widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Image, true, accessible_name));
    controls::elided_small(ui, rect.with_max_x(rect.left() + gutter), name, palette.weak_text);
    paint(ui, lane);
    let duration_secs = duration_secs(shown).unwrap_or_default();
    let x = lane.left() + (shown.clip_time_secs() / duration_secs).clamp(0.0, 1.0) as f32 * lane.width();
    ui.painter().vline(x, lane.y_range(), Stroke::new(1.5, palette.accent));
    (lane, response)
}

/// Paints a bar in a track, between two places in it.
pub(super) fn bar(ui: &Ui, lane: Rect, [start, end]: [f32; 2], opacity: f32) {
    let bar = Rect::from_x_y_ranges(start..=end, lane.y_range()).shrink2(vec2(0.0, 3.0));
    ui.painter_at(lane).rect_filled(bar, 3.0, style::palette(ui).accent.gamma_multiply(opacity));
}
