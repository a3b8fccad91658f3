//! Orbits, pans and zooms the camera with pointer, wheel and fingers.

use egui::{PointerButton, Pos2, Response, Ui};
use gaitway_scene::state::Command;

use super::panes::pane_at;
use crate::ui::{Output, Shown};

const ORBIT_RADIANS_PER_POINT: f32 = 0.0075;
const ZOOM_PER_SCROLL_POINT: f32 = 0.0022;

pub fn show(ui: &Ui, response: &Response, shown: &Shown<'_>, out: &mut Output) {
    let height = pane_at(shown, response.rect, None).height().max(1.0);
    let pan = |by: egui::Vec2| Command::Pan { right: -by.x / height, up: by.y / height };
    let zoom = |factor: f32, at: Option<Pos2>| {
        let from_center = at.map_or(egui::Vec2::ZERO, |at| at - pane_at(shown, response.rect, Some(at)).center());
        Command::Zoom { factor, right: from_center.x / height, up: -from_center.y / height }
    };
    let (touch, shift) = ui.input(|input| (input.multi_touch(), input.modifiers.shift));
    if let Some(touch) = touch.filter(|touch| response.rect.contains(touch.start_pos)) {
        if touch.zoom_delta > 0.0 && touch.zoom_delta != 1.0 {
            out.commands.push(zoom(1.0 / touch.zoom_delta, Some(touch.center_pos)));
        }
        if touch.translation_delta != egui::Vec2::ZERO {
            out.commands.push(pan(touch.translation_delta));
        }
        // The first finger also moves the pointer, which must not orbit the camera.
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
            out.commands.push(zoom((-scrolled * ZOOM_PER_SCROLL_POINT).exp(), response.hover_pos()));
        }
        if pinched > 0.0 && pinched != 1.0 {
            out.commands.push(zoom(1.0 / pinched, response.hover_pos()));
        }
    }
    if response.double_clicked() {
        out.commands.push(Command::FrameAll);
    }
}
