//! The cost of drawing, in the Info tab: counts of the last image, GPU memory, and the times of the last frames.

use egui::{Rect, Sense, Ui, WidgetInfo, pos2, vec2};

use super::facts::fact;
use super::lists::Lists;
use crate::ui::text::grouped;
use crate::ui::{Drawn, FrameTimes, HostState, controls, style, text};

/// Frame time at the graph's full height.
const FULL_SECS: f32 = 0.05;
/// Frame rate at the line across the graph.
const LINE_FPS: f32 = 60.0;
/// Longer frames stand out.
const SLOW_SECS: f32 = 1.5 / LINE_FPS;
const HEIGHT: f32 = 40.0;

pub fn show(ui: &mut Ui, lists: &Lists, host: &HostState) {
    controls::section(ui, text::DRAWING);
    controls::card(ui, |ui| {
        let [geometry, images] = host.drawn_bytes.map(text::megabytes);
        fact(ui, text::INFLUENCES, &lists.influences);
        fact(ui, text::DRAW_CALLS, &grouped(host.drawn.draw_calls as usize));
        fact(ui, text::DRAWN_TRIANGLES, &grouped(host.drawn.triangles as usize));
        fact(ui, text::GEOMETRY_MEMORY, &geometry);
        fact(ui, text::IMAGE_MEMORY, &images);
        graph(ui, &host.drawn);
    });
}

/// One bar per frame, the newest on the right.
fn graph(ui: &mut Ui, drawn: &Drawn) {
    let mean = drawn.frames.mean_secs();
    fact(ui, text::FRAME_TIME, &mean.map_or_else(|| text::NO_FRAMES.to_owned(), text::frame_time));
    if mean.is_none() {
        return;
    }
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let about = || text::frame_graph(FrameTimes::CAPACITY, LINE_FPS, FULL_SECS);
    response.widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Image, true, about()));
    let palette = style::palette(ui);
    let painter = ui.painter_at(rect);
    let width = rect.width() / FrameTimes::CAPACITY as f32;
    let missing = FrameTimes::CAPACITY - drawn.frames.iter().count();
    let y = |secs: f32| rect.bottom() - rect.height() * (secs / FULL_SECS).min(1.0);
    for (at, secs) in drawn.frames.iter().enumerate() {
        let left = rect.left() + (missing + at) as f32 * width;
        let color = if secs > SLOW_SECS { palette.warning } else { palette.accent };
        let bar = Rect::from_min_max(pos2(left, y(secs)), pos2(left + 0.8 * width, rect.bottom()));
        painter.rect_filled(bar, 0.0, color);
    }
    painter.hline(rect.x_range(), y(1.0 / LINE_FPS), egui::Stroke::new(1.0, palette.line));
    response.on_hover_ui(|ui| drop(ui.label(about())));
}
