//! Icons painted as shapes, because the fonts have no consistent set.

use egui::{Color32, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2};

use super::style;
use crate::ui::text;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Icon {
    Play,
    Pause,
    StepBack,
    StepForward,
    Loop,
    Once,
    PingPong,
    PanelLeft,
    PanelRight,
    Clips,
    Sliders,
    Open,
    Samples,
    Help,
    Close,
    MarkIn,
    MarkOut,
    Frame,
    Undo,
    Redo,
}

/// A square button with an icon; `label` is its accessible name and its tooltip.
pub fn icon_button(ui: &mut Ui, icon: Icon, label: &str, chosen: bool) -> Response {
    icon_button_sized(ui, icon, label, chosen, 32.0)
}

pub fn icon_button_sized(ui: &mut Ui, icon: Icon, label: &str, chosen: bool, size: f32) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(size), Sense::click());
    response.widget_info(|| WidgetInfo::selected(egui::accesskit::Role::Button, ui.is_enabled(), chosen, label));
    if ui.is_rect_visible(rect) {
        let palette = style::palette(ui);
        let fill = if chosen {
            palette.chosen
        } else if response.is_pointer_button_down_on() {
            palette.pressed
        } else if response.hovered() {
            palette.hover
        } else {
            Color32::TRANSPARENT
        };
        ui.painter().rect_filled(rect, style::CORNER, fill);
        if response.has_focus() {
            let stroke = Stroke::new(1.5, palette.accent);
            ui.painter().rect_stroke(rect, style::CORNER, stroke, egui::StrokeKind::Inside);
        }
        let color = if !ui.is_enabled() {
            palette.weak_text.gamma_multiply(0.5)
        } else if chosen {
            palette.accent
        } else {
            palette.text
        };
        paint(ui.painter(), icon, Rect::from_center_size(rect.center(), Vec2::splat(size * 0.5)), color);
    }
    response.on_hover_text(label)
}

/// The large round play button.
pub fn play_button(ui: &mut Ui, playing: bool, size: f32) -> Response {
    let label = if playing { text::PAUSE } else { text::PLAY };
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(size), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(egui::accesskit::Role::Button, ui.is_enabled(), label));
    let palette = style::palette(ui);
    let fill = if !ui.is_enabled() {
        palette.pressed
    } else if response.hovered() {
        palette.accent.lerp_to_gamma(palette.text, 0.15)
    } else {
        palette.accent
    };
    ui.painter().circle_filled(rect.center(), size / 2.0, fill);
    if response.has_focus() {
        ui.painter().circle_stroke(rect.center(), size / 2.0 + 1.5, Stroke::new(1.5, palette.text));
    }
    let icon = if playing { Icon::Pause } else { Icon::Play };
    paint(ui.painter(), icon, Rect::from_center_size(rect.center(), Vec2::splat(size * 0.42)), palette.on_accent);
    response.on_hover_text(format!("{label} (Space)"))
}

/// Paints an icon into a square.
pub fn paint(painter: &Painter, icon: Icon, square: Rect, color: Color32) {
    let at = |x: f32, y: f32| square.min + vec2(x, y) * square.width();
    let unit = square.width();
    let thin = Stroke::new((unit * 0.095).max(1.3), color);
    let line = |points: &[(f32, f32)]| {
        painter.line(points.iter().map(|&(x, y)| at(x, y)).collect(), thin);
    };
    let fill = |points: &[(f32, f32)]| {
        painter.add(Shape::convex_polygon(points.iter().map(|&(x, y)| at(x, y)).collect(), color, Stroke::NONE));
    };
    let bar = |x0: f32, y0: f32, x1: f32, y1: f32| {
        painter.rect_filled(Rect::from_two_pos(at(x0, y0), at(x1, y1)), unit * 0.06, color);
    };
    let outline = |x0: f32, y0: f32, x1: f32, y1: f32| {
        let rect = Rect::from_two_pos(at(x0, y0), at(x1, y1));
        painter.rect_stroke(rect, unit * 0.14, thin, egui::StrokeKind::Middle);
    };
    match icon {
        Icon::Play => fill(&[(0.2, 0.05), (0.95, 0.5), (0.2, 0.95)]),
        Icon::Pause => {
            bar(0.14, 0.08, 0.4, 0.92);
            bar(0.6, 0.08, 0.86, 0.92);
        }
        Icon::StepBack => {
            bar(0.1, 0.12, 0.24, 0.88);
            fill(&[(0.92, 0.12), (0.92, 0.88), (0.34, 0.5)]);
        }
        Icon::StepForward => {
            bar(0.76, 0.12, 0.9, 0.88);
            fill(&[(0.08, 0.12), (0.66, 0.5), (0.08, 0.88)]);
        }
        Icon::Loop => {
            arc(painter, at(0.5, 0.5), unit * 0.4, -60.0, 210.0, thin);
            let tip = at(0.5, 0.5) + unit * 0.4 * vec2((-60.0_f32).to_radians().cos(), (-60.0_f32).to_radians().sin());
            arrow_head(painter, tip, vec2(-0.87, -0.5), unit * 0.3, color);
        }
        Icon::Once => {
            line(&[(0.02, 0.5), (0.62, 0.5)]);
            arrow_head(painter, at(0.78, 0.5), vec2(1.0, 0.0), unit * 0.3, color);
            bar(0.86, 0.18, 0.98, 0.82);
        }
        Icon::PingPong => {
            line(&[(0.2, 0.5), (0.8, 0.5)]);
            arrow_head(painter, at(1.0, 0.5), vec2(1.0, 0.0), unit * 0.3, color);
            arrow_head(painter, at(0.0, 0.5), vec2(-1.0, 0.0), unit * 0.3, color);
        }
        Icon::PanelLeft => {
            outline(0.02, 0.1, 0.98, 0.9);
            line(&[(0.36, 0.1), (0.36, 0.9)]);
        }
        Icon::PanelRight => {
            outline(0.02, 0.1, 0.98, 0.9);
            line(&[(0.64, 0.1), (0.64, 0.9)]);
        }
        Icon::Clips => {
            for y in [0.18, 0.5, 0.82] {
                painter.circle_filled(at(0.1, y), unit * 0.08, color);
                line(&[(0.32, y), (0.98, y)]);
            }
        }
        Icon::Sliders => {
            for (y, x) in [(0.2, 0.7), (0.5, 0.3), (0.8, 0.6)] {
                line(&[(0.02, y), (0.98, y)]);
                painter.circle_filled(at(x, y), unit * 0.13, color);
            }
        }
        Icon::Open => {
            line(&[
                (0.06, 0.86),
                (0.06, 0.16),
                (0.38, 0.16),
                (0.5, 0.3),
                (0.94, 0.3),
                (0.94, 0.86),
                (0.06, 0.86),
                (0.06, 0.7),
            ]);
        }
        Icon::Samples => {
            for (x, y) in [(0.06, 0.06), (0.58, 0.06), (0.06, 0.58), (0.58, 0.58)] {
                outline(x, y, x + 0.36, y + 0.36);
            }
        }
        Icon::Help => {
            painter.circle_stroke(at(0.5, 0.5), unit * 0.47, thin);
            arc(painter, at(0.5, 0.4), unit * 0.16, -180.0, 90.0, thin);
            line(&[(0.5, 0.56), (0.5, 0.64)]);
            painter.circle_filled(at(0.5, 0.77), unit * 0.065, color);
        }
        Icon::Close => {
            line(&[(0.15, 0.15), (0.85, 0.85)]);
            line(&[(0.85, 0.15), (0.15, 0.85)]);
        }
        Icon::Undo | Icon::Redo => {
            let x = |x: f32| if icon == Icon::Undo { x } else { 1.0 - x };
            let curve = [(0.1, 0.36), (0.62, 0.36), (0.8, 0.43), (0.88, 0.6), (0.8, 0.77), (0.62, 0.84), (0.36, 0.84)];
            line(&curve.map(|(along, y)| (x(along), y)));
            line(&[(x(0.36), 0.1), (x(0.1), 0.36), (x(0.36), 0.62)]);
        }
        Icon::MarkIn => line(&[(0.7, 0.08), (0.35, 0.08), (0.35, 0.92), (0.7, 0.92)]),
        Icon::MarkOut => line(&[(0.3, 0.08), (0.65, 0.08), (0.65, 0.92), (0.3, 0.92)]),
        Icon::Frame => {
            for (x, y, dx, dy) in [
                (0.05, 0.05, 0.28, 0.28),
                (0.95, 0.05, -0.28, 0.28),
                (0.05, 0.95, 0.28, -0.28),
                (0.95, 0.95, -0.28, -0.28),
            ] {
                line(&[(x + dx, y), (x, y), (x, y + dy)]);
            }
            painter.circle_filled(at(0.5, 0.5), unit * 0.14, color);
        }
    }
}

/// Angles run clockwise from the right.
fn arc(painter: &Painter, center: Pos2, radius: f32, from_degrees: f32, to_degrees: f32, stroke: Stroke) {
    let steps = 20;
    let points = (0..=steps)
        .map(|step| {
            let angle = (from_degrees + (to_degrees - from_degrees) * step as f32 / steps as f32).to_radians();
            pos2(center.x + radius * angle.cos(), center.y + radius * angle.sin())
        })
        .collect();
    painter.line(points, stroke);
}

fn arrow_head(painter: &Painter, tip: Pos2, direction: Vec2, size: f32, color: Color32) {
    let side = direction.rot90();
    let back = tip - direction * size;
    let points = vec![tip, back + side * size * 0.62, back - side * size * 0.62];
    painter.add(Shape::convex_polygon(points, color, Stroke::NONE));
}
