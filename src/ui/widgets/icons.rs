//! Icons painted as shapes, because the fonts have no consistent set.

use egui::{Color32, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2};

use self::Mark::{Arc, Arrow, Bar, Dot, Fill, Line, Outline};
use super::{controls, style};
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
    Share,
    Close,
    MarkIn,
    MarkOut,
    Frame,
    Eye,
    EyeClosed,
    Undo,
    Redo,
}

/// Width and height of most buttons with an icon.
pub const ICON_SIZE: f32 = 32.0;

/// A button with an icon, square for a pointer; `label` is its accessible name and its tooltip.
pub fn icon_button(ui: &mut Ui, icon: Icon, label: &str) -> Response {
    icon_button_sized(ui, icon, label, ICON_SIZE)
}

pub fn icon_button_sized(ui: &mut Ui, icon: Icon, label: &str, size: f32) -> Response {
    any_icon_button(ui, icon, label, None, size)
}

/// Such a button for something that is on or off.
pub fn icon_toggle(ui: &mut Ui, icon: Icon, label: &str, is_on: bool) -> Response {
    any_icon_button(ui, icon, label, Some(is_on), ICON_SIZE)
}

/// `is_on` is `None` for a button that only acts.
fn any_icon_button(ui: &mut Ui, icon: Icon, label: &str, is_on: Option<bool>, size: f32) -> Response {
    let (rect, response) = ui.allocate_exact_size(icon_size(ui, size), Sense::click());
    response.widget_info(|| {
        let info = WidgetInfo::labeled(egui::accesskit::Role::Button, ui.is_enabled(), label);
        WidgetInfo { selected: is_on, ..info }
    });
    let chosen = is_on == Some(true);
    if ui.is_rect_visible(rect) {
        let palette = style::palette(ui);
        let is_pressed = !chosen && response.is_pointer_button_down_on();
        let fill = if is_pressed { palette.pressed } else { style::fill(&palette, &response, chosen) };
        ui.painter().rect_filled(rect, style::CORNER, fill);
        style::focus_ring(ui, &response, rect, style::CORNER, 1.5);
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

/// Returns the size of such a button, for the layout of what is beside it.
pub fn icon_size(ui: &Ui, size: f32) -> Vec2 {
    style::press_size(ui, Vec2::splat(size))
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
    let about = if playing { text::PAUSE_KEY } else { text::PLAY_KEY };
    response.on_hover_text(controls::with_key(ui, about))
}

/// A shape of an icon, in a square with corners (0, 0) and (1, 1), Y down.
#[derive(Debug, Clone, Copy)]
enum Mark {
    Line(&'static [(f32, f32)]),
    /// A filled convex polygon.
    Fill(&'static [(f32, f32)]),
    /// A filled rectangle, by two corners.
    Bar((f32, f32), (f32, f32)),
    /// A rounded rectangle, by two corners.
    Outline((f32, f32), (f32, f32)),
    /// A filled circle: centre and radius.
    Dot((f32, f32), f32),
    /// Part of a circle: centre, radius, and two angles in degrees, clockwise from the right.
    Arc((f32, f32), f32, (f32, f32)),
    /// An arrow head: tip and direction.
    Arrow((f32, f32), (f32, f32)),
}

const PLAY: &[Mark] = &[Fill(&[(0.2, 0.05), (0.95, 0.5), (0.2, 0.95)])];
const PAUSE: &[Mark] = &[Bar((0.14, 0.08), (0.4, 0.92)), Bar((0.6, 0.08), (0.86, 0.92))];
const STEP_BACK: &[Mark] = &[Bar((0.1, 0.12), (0.24, 0.88)), Fill(&[(0.92, 0.12), (0.92, 0.88), (0.34, 0.5)])];
const STEP_FORWARD: &[Mark] = &[Bar((0.76, 0.12), (0.9, 0.88)), Fill(&[(0.08, 0.12), (0.66, 0.5), (0.08, 0.88)])];
const LOOP: &[Mark] = &[Arc((0.5, 0.5), 0.4, (-60.0, 210.0)), Arrow((0.7, 0.1536), (-0.87, -0.5))];
const ONCE: &[Mark] =
    &[Line(&[(0.02, 0.5), (0.62, 0.5)]), Arrow((0.78, 0.5), (1.0, 0.0)), Bar((0.86, 0.18), (0.98, 0.82))];
const PING_PONG: &[Mark] =
    &[Line(&[(0.2, 0.5), (0.8, 0.5)]), Arrow((1.0, 0.5), (1.0, 0.0)), Arrow((0.0, 0.5), (-1.0, 0.0))];
const PANEL_LEFT: &[Mark] = &[Outline((0.02, 0.1), (0.98, 0.9)), Line(&[(0.36, 0.1), (0.36, 0.9)])];
const PANEL_RIGHT: &[Mark] = &[Outline((0.02, 0.1), (0.98, 0.9)), Line(&[(0.64, 0.1), (0.64, 0.9)])];
const CLIPS: &[Mark] = &[
    Dot((0.1, 0.18), 0.08),
    Line(&[(0.32, 0.18), (0.98, 0.18)]),
    Dot((0.1, 0.5), 0.08),
    Line(&[(0.32, 0.5), (0.98, 0.5)]),
    Dot((0.1, 0.82), 0.08),
    Line(&[(0.32, 0.82), (0.98, 0.82)]),
];
const SLIDERS: &[Mark] = &[
    Line(&[(0.02, 0.2), (0.98, 0.2)]),
    Dot((0.7, 0.2), 0.13),
    Line(&[(0.02, 0.5), (0.98, 0.5)]),
    Dot((0.3, 0.5), 0.13),
    Line(&[(0.02, 0.8), (0.98, 0.8)]),
    Dot((0.6, 0.8), 0.13),
];
const FOLDER: &[(f32, f32)] =
    &[(0.06, 0.86), (0.06, 0.16), (0.38, 0.16), (0.5, 0.3), (0.94, 0.3), (0.94, 0.86), (0.06, 0.86), (0.06, 0.7)];
const OPEN: &[Mark] = &[Line(FOLDER)];
const SHARE: &[Mark] = &[
    Line(&[(0.3, 0.4), (0.12, 0.4), (0.12, 0.95), (0.88, 0.95), (0.88, 0.4), (0.7, 0.4)]),
    Line(&[(0.5, 0.65), (0.5, 0.2)]),
    Arrow((0.5, 0.02), (0.0, -1.0)),
];
const CLOSE: &[Mark] = &[Line(&[(0.15, 0.15), (0.85, 0.85)]), Line(&[(0.85, 0.15), (0.15, 0.85)])];
const MARK_IN: &[Mark] = &[Line(&[(0.7, 0.08), (0.35, 0.08), (0.35, 0.92), (0.7, 0.92)])];
const MARK_OUT: &[Mark] = &[Line(&[(0.3, 0.08), (0.65, 0.08), (0.65, 0.92), (0.3, 0.92)])];
const FRAME: &[Mark] = &[
    Line(&[(0.33, 0.05), (0.05, 0.05), (0.05, 0.33)]),
    Line(&[(0.67, 0.05), (0.95, 0.05), (0.95, 0.33)]),
    Line(&[(0.33, 0.95), (0.05, 0.95), (0.05, 0.67)]),
    Line(&[(0.67, 0.95), (0.95, 0.95), (0.95, 0.67)]),
    Dot((0.5, 0.5), 0.14),
];
const EYE: &[Mark] =
    &[Arc((0.5, 0.12), 0.58, (40.0, 140.0)), Arc((0.5, 0.88), 0.58, (220.0, 320.0)), Dot((0.5, 0.5), 0.14)];
const EYE_CLOSED: &[Mark] = &[
    Arc((0.5, 0.12), 0.58, (40.0, 140.0)),
    Line(&[(0.5, 0.7), (0.5, 0.9)]),
    Line(&[(0.22, 0.63), (0.12, 0.78)]),
    Line(&[(0.78, 0.63), (0.88, 0.78)]),
];
const TURN_BACK: &[(f32, f32)] =
    &[(0.1, 0.36), (0.62, 0.36), (0.8, 0.43), (0.88, 0.6), (0.8, 0.77), (0.62, 0.84), (0.36, 0.84)];
const UNDO: &[Mark] = &[Line(TURN_BACK), Line(&[(0.36, 0.1), (0.1, 0.36), (0.36, 0.62)])];

impl Icon {
    fn marks(self) -> &'static [Mark] {
        match self {
            Self::Play => PLAY,
            Self::Pause => PAUSE,
            Self::StepBack => STEP_BACK,
            Self::StepForward => STEP_FORWARD,
            Self::Loop => LOOP,
            Self::Once => ONCE,
            Self::PingPong => PING_PONG,
            Self::PanelLeft => PANEL_LEFT,
            Self::PanelRight => PANEL_RIGHT,
            Self::Clips => CLIPS,
            Self::Sliders => SLIDERS,
            Self::Open => OPEN,
            Self::Share => SHARE,
            Self::Close => CLOSE,
            Self::MarkIn => MARK_IN,
            Self::MarkOut => MARK_OUT,
            Self::Frame => FRAME,
            Self::Eye => EYE,
            Self::EyeClosed => EYE_CLOSED,
            // Redo is its mirror image.
            Self::Undo | Self::Redo => UNDO,
        }
    }
}

/// Paints an icon into a square.
pub fn paint(painter: &Painter, icon: Icon, square: Rect, color: Color32) {
    let unit = square.width();
    let is_mirrored = icon == Icon::Redo;
    let at = |(x, y): (f32, f32)| square.min + unit * vec2(if is_mirrored { 1.0 - x } else { x }, y);
    let points = |list: &[(f32, f32)]| list.iter().map(|&point| at(point)).collect::<Vec<_>>();
    let thin = Stroke::new((unit * 0.095).max(1.3), color);
    for &mark in icon.marks() {
        let shape = match mark {
            Line(list) => Shape::line(points(list), thin),
            Fill(list) => Shape::convex_polygon(points(list), color, Stroke::NONE),
            Bar(from, to) => Shape::rect_filled(Rect::from_two_pos(at(from), at(to)), unit * 0.06, color),
            Outline(from, to) => {
                let rect = Rect::from_two_pos(at(from), at(to));
                Shape::rect_stroke(rect, unit * 0.14, thin, egui::StrokeKind::Middle)
            }
            Dot(center, radius) => Shape::circle_filled(at(center), unit * radius, color),
            Arc(center, radius, degrees) => arc(at(center), unit * radius, degrees, thin),
            Arrow(tip, (x, y)) => arrow_head(at(tip), vec2(x, y), unit * 0.3, color),
        };
        painter.add(shape);
    }
}

/// Angles run clockwise from the right.
fn arc(center: Pos2, radius: f32, (from_degrees, to_degrees): (f32, f32), stroke: Stroke) -> Shape {
    let steps = 20;
    let points = (0..=steps)
        .map(|step| {
            let angle = (from_degrees + (to_degrees - from_degrees) * step as f32 / steps as f32).to_radians();
            pos2(center.x + radius * angle.cos(), center.y + radius * angle.sin())
        })
        .collect();
    Shape::line(points, stroke)
}

fn arrow_head(tip: Pos2, direction: Vec2, size: f32, color: Color32) -> Shape {
    let side = direction.rot90();
    let back = tip - direction * size;
    let points = vec![tip, back + side * size * 0.62, back - side * size * 0.62];
    Shape::convex_polygon(points, color, Stroke::NONE)
}
