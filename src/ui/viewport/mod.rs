//! The viewport: what pointer and fingers do there, what is painted over the scene, and what floats above everything for a
//! while. Whoever draws the scene fills in its pixels.

mod about;
pub mod awaited;
mod buttons;
mod camera;
mod canvas;
mod gizmo;
pub mod help;
mod hover;
pub mod labels;
mod legend;
pub mod notices;
pub mod overlays;
pub mod panes;
mod pins;
mod recording;
pub mod sheet;

use egui::layers::ShapeIdx;
use egui::{PaintCallback, Painter, Rect, Sense, Shape, Ui, vec2};
use gaitway_scene::frame::PickedJoint;
use gaitway_scene::state::{Background, DEFAULT_ASPECT};

use super::tabs::formula;
use super::{Output, Shown, UiState, keys, style, text};

pub(super) use canvas::Canvas;

/// What the viewport remembers.
#[derive(Debug)]
pub struct ViewportState {
    /// Width over height, as last shown.
    pub aspect: f32,
    /// Number in the file of the model's joint under the pointer, or of the one that follows the source's joint there.
    pub hovered_joint: Option<usize>,
    /// The viewport has the keyboard focus: keys do the same as without any focus.
    pub(in crate::ui) has_focus: bool,
    hovered: Option<PickedJoint>,
    grab: Option<gizmo::Grab>,
    /// The pinned joint whose handle is dragged, and where the handle is from the pointer.
    pin: Option<(usize, egui::Vec2)>,
}

impl Default for ViewportState {
    fn default() -> Self {
        Self { aspect: DEFAULT_ASPECT, hovered_joint: None, has_focus: false, hovered: None, grab: None, pin: None }
    }
}

impl ViewportState {
    /// Forgets the joint under the pointer.
    pub(in crate::ui) fn clear_hover(&mut self) {
        (self.hovered, self.hovered_joint) = (None, None);
    }
}

/// Where the rendered scene goes: under everything painted over the viewport.
pub struct ViewportSlot {
    painter: Painter,
    index: ShapeIdx,
    rect: Rect,
}

impl ViewportSlot {
    /// Paints the scene into the slot; `picture` receives the viewport's rectangle, in points.
    pub fn fill(self, picture: impl FnOnce(Rect) -> PaintCallback) {
        self.painter.set(self.index, Shape::Callback(picture(self.rect)));
    }
}

/// Handles input on the viewport and paints what lies over the scene.
pub fn viewport(ui: &mut Ui, rect: Rect, shown: Shown<'_>, local: &mut UiState, out: &mut Output) -> ViewportSlot {
    let painter = ui.painter_at(rect);
    checkerboard(&painter, rect, &shown, style::palette(ui));
    let index = painter.add(Shape::Noop);
    local.viewport.has_focus = false;
    let is_covered = local.layout.sheet_rect.is_some_and(|sheet| sheet.contains_rect(rect));
    if rect.is_positive() && !is_covered {
        input(ui, &painter, rect, &shown, local, out);
    }
    keys::listen(ui.ctx(), &shown, local, out);
    ViewportSlot { painter, index, rect }
}

fn input(ui: &mut Ui, painter: &Painter, rect: Rect, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    local.viewport.aspect = rect.width() / rect.height().max(1.0);
    let response = ui.interact(rect, ui.scope_id().with("viewport"), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Image, true, text::VIEWPORT));
    local.viewport.has_focus = response.has_focus();
    if response.has_focus() {
        let filter =
            egui::EventFilter { horizontal_arrows: true, vertical_arrows: true, ..egui::EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    }
    let canvas = Canvas { ui, painter, response: &response, shown };
    let is_grabbed = pins::show(canvas, local, out);
    if !is_grabbed && !gizmo::show(canvas, local, out) {
        camera::show(ui, &response, shown, out);
    }
    if !formula::point_at_vertex(&response, shown, local, out) {
        hover::show(canvas, local, out);
    }
    buttons::show(ui, rect, shown, local, out);
}

/// Marks a transparent background.
fn checkerboard(painter: &Painter, rect: Rect, shown: &Shown<'_>, palette: style::Palette) {
    if shown.state.display.background != Background::Transparent || shown.state.page.embed.is_on() {
        return;
    }
    let size = 12.0;
    let (columns, rows) = ((rect.width() / size).ceil() as usize, (rect.height() / size).ceil() as usize);
    let mut mesh = egui::Mesh::default();
    for row in 0..rows {
        for column in (row % 2..columns).step_by(2) {
            let min = rect.min + vec2(column as f32, row as f32) * size;
            mesh.add_colored_rect(Rect::from_min_size(min, vec2(size, size)), palette.surface);
        }
    }
    painter.add(mesh);
}
