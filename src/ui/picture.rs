//! The picture itself: what pointer and fingers do to the camera, which joint is under the pointer, and the few buttons
//! that lie on top. The pixels are filled in by whoever draws the scene.

use egui::layers::ShapeIdx;
use egui::{Align, Layout, PaintCallback, Painter, PointerButton, Pos2, Rect, Response, Sense, Shape, Ui, pos2, vec2};
use glam::Vec2;

use super::icons::{Icon, icon_button};
use super::{Output, Sheet, Shown, UiAction, UiState, is_narrow, keys, scene_tree, style};
use crate::frame::pick_joint;
use crate::state::Command;

/// Where the pixels go: under everything that was painted on the picture.
pub struct PictureSlot {
    painter: Painter,
    index: ShapeIdx,
    rect: Rect,
}

impl PictureSlot {
    pub fn fill(self, picture: impl FnOnce(Rect) -> PaintCallback) {
        self.painter.set(self.index, Shape::Callback(picture(self.rect)));
    }
}

const ORBIT_RADIANS_PER_POINT: f32 = 0.0075;
const ZOOM_PER_SCROLL_POINT: f32 = 0.0022;
/// How far beside a bone a click still means it.
const PICK_POINTS: f32 = 10.0;

/// Listens to everything that happens on the picture and paints what lies over it.
pub fn picture(ui: &mut Ui, rect: Rect, shown: Shown<'_>, local: &mut UiState, out: &mut Output) -> PictureSlot {
    let painter = ui.painter_at(rect);
    let palette = style::palette(ui);
    checkerboard(&painter, rect, &shown, palette);
    let index = painter.add(Shape::Noop);
    if rect.is_positive() {
        local.aspect = rect.width() / rect.height().max(1.0);
        let response = ui.interact(rect, ui.scope_id().with("picture"), Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Image, true, "Picture"));
        camera(ui, &response, out);
        joints(ui, &painter, &response, &shown, local, out);
        keys::listen(ui.ctx(), &shown, local, out);
        if !shown.state.embed {
            buttons(ui, rect, local, out);
        }
    }
    PictureSlot { painter, index, rect }
}

/// Shows that there is nothing behind a transparent picture.
fn checkerboard(painter: &Painter, rect: Rect, shown: &Shown<'_>, palette: style::Palette) {
    if shown.state.background != crate::state::Background::Transparent || shown.state.embed {
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

fn camera(ui: &Ui, response: &Response, out: &mut Output) {
    let height = response.rect.height().max(1.0);
    let pan = |by: egui::Vec2| Command::Pan { right: -by.x / height, up: by.y / height };
    let (touch, shift) = ui.input(|input| (input.multi_touch(), input.modifiers.shift));
    if let Some(touch) = touch.filter(|touch| response.rect.contains(touch.start_pos)) {
        if touch.zoom_delta > 0.0 && touch.zoom_delta != 1.0 {
            out.commands.push(Command::Zoom(1.0 / touch.zoom_delta));
        }
        if touch.translation_delta != egui::Vec2::ZERO {
            out.commands.push(pan(touch.translation_delta));
        }
        // The first finger also moves the pointer, which must not turn the camera meanwhile.
        return;
    }
    let moved = response.drag_delta();
    if moved != egui::Vec2::ZERO {
        if response.dragged_by(PointerButton::Primary) && !shift {
            out.commands.push(Command::Orbit {
                yaw_radians: -moved.x * ORBIT_RADIANS_PER_POINT,
                pitch_radians: moved.y * ORBIT_RADIANS_PER_POINT,
            });
        } else if response.dragged() {
            out.commands.push(pan(moved));
        }
    }
    if response.contains_pointer() {
        let (scrolled, pinched) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        if scrolled != 0.0 {
            out.commands.push(Command::Zoom((-scrolled * ZOOM_PER_SCROLL_POINT).exp()));
        }
        if pinched > 0.0 && pinched != 1.0 {
            out.commands.push(Command::Zoom(1.0 / pinched));
        }
    }
    if response.double_clicked() {
        out.commands.push(Command::FrameAll);
    }
}

/// Hover names a joint, a click chooses it, a click beside all of them chooses none.
fn joints(ui: &Ui, painter: &Painter, response: &Response, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    let Some(model) = shown.library.active() else { return };
    let at = |position: Pos2| joint_at(shown, response.rect, position);
    local.hovered_joint = response.hover_pos().filter(|_| !response.dragged()).and_then(at);
    if response.clicked() {
        if local.sheet.take().is_some() {
            return;
        }
        let clicked = response.interact_pointer_pos().and_then(at);
        // Without bones to click on, a joint chosen in the tree stays chosen.
        if clicked != shown.state.joint && !shown.frame.bones.is_empty() {
            out.commands.push(Command::SelectJoint(clicked));
        }
    }
    let label = |source: usize, strong: bool| {
        let joint = model.asset.skeleton.joint_of_source(source)?;
        let world = shown.frame.characters.first()?.world_from_joint.get(joint.get())?;
        let position = to_screen(shown, response.rect, world.translation.into())?;
        let palette = style::palette(ui);
        let font = egui::FontId::proportional(13.0);
        let text = scene_tree::title(&model.asset, joint);
        let color = if strong { palette.on_accent } else { palette.text };
        let galley = painter.layout_no_wrap(text, font, color);
        let half = galley.size().x / 2.0 + 8.0;
        let x = position
            .x
            .clamp(response.rect.left() + half, (response.rect.right() - half).max(response.rect.left() + half));
        let box_ = Rect::from_center_size(pos2(x, position.y - 24.0), galley.size() + vec2(16.0, 6.0));
        let fill = if strong { palette.accent } else { palette.panel.gamma_multiply(0.92) };
        painter.rect_filled(box_, 6.0, fill);
        painter.galley(box_.center() - galley.size() / 2.0, galley, color);
        painter.circle_stroke(position, 6.0, egui::Stroke::new(2.0, palette.accent));
        Some(())
    };
    if let Some(chosen) = shown.state.joint {
        label(chosen, true);
    }
    if let Some(hovered) = local.hovered_joint.filter(|&joint| Some(joint) != shown.state.joint) {
        label(hovered, false);
    }
}

/// A world-space point on the screen; none behind the camera.
fn to_screen(shown: &Shown<'_>, rect: Rect, world: glam::Vec3) -> Option<Pos2> {
    let view = &shown.frame.view;
    let projected = view.projection_from_view * view.view_from_world * world.extend(1.0);
    let ndc = Vec2::new(projected.x, projected.y) / projected.w;
    (projected.w > 0.0 && ndc.is_finite()).then(|| {
        pos2(
            egui::lerp(rect.left()..=rect.right(), 0.5 + 0.5 * ndc.x),
            egui::lerp(rect.top()..=rect.bottom(), 0.5 - 0.5 * ndc.y),
        )
    })
}

/// The joint of the drawn bone under a point of the screen, as the file numbers it.
fn joint_at(shown: &Shown<'_>, rect: Rect, position: Pos2) -> Option<usize> {
    let part = (position - rect.min) / rect.size();
    let point = Vec2::new(2.0 * part.x - 1.0, 1.0 - 2.0 * part.y);
    let tolerance = 2.0 * PICK_POINTS / rect.height().max(1.0);
    pick_joint(shown.frame, point, tolerance).map(|joint| joint as usize)
}

fn buttons(ui: &mut Ui, rect: Rect, local: &mut UiState, out: &mut Output) {
    let narrow = is_narrow(ui);
    let strip = Rect::from_min_size(rect.min + vec2(10.0, 10.0), vec2(rect.width() - 20.0, 36.0));
    let mut bar = ui.new_child(egui::UiBuilder::new().max_rect(strip).layout(Layout::left_to_right(Align::Center)));
    pill(&mut bar, |ui| {
        if narrow {
            let open = local.sheet == Some(Sheet::Clips);
            if icon_button(ui, Icon::Clips, "Clips", open).clicked() {
                local.sheet = if open { None } else { Some(Sheet::Clips) };
            }
            if icon_button(ui, Icon::Open, "Open files", false).clicked() {
                out.actions.push(UiAction::OpenFiles);
            }
        } else {
            let label = if local.clips_open { "Fold the clips away" } else { "Show the clips" };
            if icon_button(ui, Icon::PanelLeft, label, false).clicked() {
                local.clips_open = !local.clips_open;
            }
            if !local.clips_open && icon_button(ui, Icon::Open, "Open files", false).clicked() {
                out.actions.push(UiAction::OpenFiles);
            }
        }
    });
    let mut bar = ui.new_child(egui::UiBuilder::new().max_rect(strip).layout(Layout::right_to_left(Align::Center)));
    pill(&mut bar, |ui| {
        if narrow {
            let open = local.sheet == Some(Sheet::Inspector);
            if icon_button(ui, Icon::Sliders, "Inspector", open).clicked() {
                local.sheet = if open { None } else { Some(Sheet::Inspector) };
            }
        } else {
            let label = if local.inspector_open { "Fold the inspector away" } else { "Show the inspector" };
            if icon_button(ui, Icon::PanelRight, label, false).clicked() {
                local.inspector_open = !local.inspector_open;
            }
            if icon_button(ui, Icon::Help, "Keys (?)", local.help_open).clicked() {
                local.help_open = !local.help_open;
            }
        }
        if icon_button(ui, Icon::Frame, "Fit into the picture (F)", false).clicked() {
            out.commands.push(Command::FrameAll);
        }
    });
}

/// Buttons on a translucent ground, so that they can be read on any picture.
fn pill(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    let fill = style::palette(ui).panel.gamma_multiply(0.86);
    egui::Frame::new().fill(fill).corner_radius(9).inner_margin(egui::Margin::same(2)).show(ui, |ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        contents(ui);
    });
}
