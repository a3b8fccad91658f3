//! The legend in the lower right corner of the viewport: the shown channel, or the scale of weights or of influence counts.

use egui::{Align2, Color32, Mesh, Painter, Pos2, Rect, Rgba, Ui, pos2, vec2};
use gaitway_render::shaders::{HEAT_COLORS, INFLUENCE_COLORS};
use gaitway_scene::state::Channel;

use crate::ui::{Shown, style, text};

pub fn show(ui: &Ui, painter: &Painter, rect: Rect, shown: &Shown<'_>) {
    let state = shown.state;
    match state.channel() {
        Channel::Shaded if state.shows_weights() => {
            let colors = HEAT_COLORS.map(|[red, green, blue]| Rgba::from_rgb(red, green, blue).into());
            scale(ui, painter, rect, &colors, ["0", "1"], text::WEIGHT_LEGEND);
        }
        Channel::Shaded => {}
        Channel::Influences => {
            let colors = INFLUENCE_COLORS.map(|color| {
                let [red, green, blue] = color.map(|channel| (255.0 * channel).round() as u8);
                Color32::from_rgb(red, green, blue)
            });
            scale(ui, painter, rect, &colors, ["1", "16"], text::INFLUENCES_LEGEND);
        }
        channel => {
            let absent = shown.library.active().and_then(|model| text::absent(channel, model));
            caption(ui, painter, rect, absent.unwrap_or(text::channel(channel)));
        }
    }
}

fn panel(ui: &Ui, painter: &Painter, rect: Rect, size: egui::Vec2) -> Rect {
    let corner = rect.right_bottom() - vec2(12.0, 12.0);
    let frame = Rect::from_min_max(corner - size, corner);
    painter.rect_filled(frame, style::CORNER, style::palette(ui).panel.gamma_multiply(0.86));
    frame
}

fn caption(ui: &Ui, painter: &Painter, rect: Rect, text: &str) {
    let galley = painter.layout_no_wrap(text.to_owned(), style::SMALL, style::palette(ui).text);
    let frame = panel(ui, painter, rect, galley.size() + vec2(20.0, 10.0));
    let color = style::palette(ui).text;
    painter.galley(frame.center() - galley.size() / 2.0, galley, color);
}

/// A bar of colours at equal distances, its ends, and a line of text below.
fn scale(ui: &Ui, painter: &Painter, rect: Rect, colors: &[Color32], ends: [&str; 2], below: &str) {
    let palette = style::palette(ui);
    let frame = panel(ui, painter, rect, vec2(194.0, 32.0));
    let bar = Rect::from_min_size(frame.min + vec2(26.0, 6.0), vec2(142.0, 8.0));
    let mut mesh = Mesh::default();
    for (at, &color) in colors.iter().enumerate() {
        let x = egui::lerp(bar.x_range(), at as f32 / (colors.len() - 1) as f32);
        mesh.colored_vertex(pos2(x, bar.top()), color);
        mesh.colored_vertex(pos2(x, bar.bottom()), color);
        if let Some(left) = (2 * at as u32).checked_sub(2) {
            mesh.add_triangle(left, left + 1, left + 2);
            mesh.add_triangle(left + 1, left + 2, left + 3);
        }
    }
    painter.add(mesh);
    let text = |at: Pos2, align, text: &str, color| painter.text(at, align, text, style::SMALL, color);
    text(bar.left_center() - vec2(6.0, 0.0), Align2::RIGHT_CENTER, ends[0], palette.text);
    text(bar.right_center() + vec2(6.0, 0.0), Align2::LEFT_CENTER, ends[1], palette.text);
    text(pos2(bar.center().x, frame.bottom() - 9.0), Align2::CENTER_CENTER, below, palette.weak_text);
}
