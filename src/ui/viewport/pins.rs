//! Handles of pins: each is dragged in the plane of the viewport.

use egui::Stroke;
use gaitway_retarget::{Pin, PinGoal};
use gaitway_scene::state::Command;
use glam::Vec3;

use super::canvas::Canvas;
use super::panes::{pane_at, to_screen};
use crate::ui::tabs::rounded;
use crate::ui::{Output, Shown, UiState, style};

const RADIUS_POINTS: f32 = 8.0;
/// How close to a handle a press grabs it.
const GRAB_POINTS: f32 = 12.0;

/// Shows the handles; returns whether one has captured the pointer.
pub fn show(canvas: Canvas<'_>, local: &mut UiState, out: &mut Output) -> bool {
    let Canvas { ui, painter, response, shown } = canvas;
    let pins = &shown.state.character.edits.pins;
    if pins.is_empty() || shown.state.page.embed.is_on() {
        return false;
    }
    let pane = pane_at(shown, response.rect, response.hover_pos());
    let handles = || pins.iter().filter_map(|(&joint, pin)| Some((joint, to_screen(shown, pane, place(shown, pin)?)?)));
    let at = |position: egui::Pos2| {
        let near = handles().map(|(joint, handle)| (joint, handle - position));
        near.filter(|(_, offset)| offset.length() < GRAB_POINTS).min_by(|a, b| a.1.length().total_cmp(&b.1.length()))
    };
    if response.drag_stopped() || !ui.input(|input| input.pointer.primary_down()) {
        local.viewport.pin = None;
    }
    if response.drag_started_by(egui::PointerButton::Primary) {
        local.viewport.pin = ui.input(|input| input.pointer.press_origin()).and_then(at);
    }
    if let Some((joint, offset)) = local.viewport.pin
        && let Some(pointer) = response.interact_pointer_pos()
        && let Some(pin) = pins.get(&joint).and_then(|pin| moved(shown, pane, pin, pointer + offset))
    {
        out.commands.push(Command::SetPin { joint, pin: Some(pin) });
    }
    let active = local.viewport.pin.or_else(|| response.hover_pos().and_then(at)).map(|(joint, _)| joint);
    // A moving handle is hard to grab.
    local.holds_time |= active.is_some();
    let painter = painter.with_clip_rect(pane);
    let color = style::palette(ui).accent;
    for (joint, handle) in handles() {
        let fill = color.gamma_multiply(if active == Some(joint) { 0.6 } else { 0.25 });
        painter.circle(handle, RADIUS_POINTS, fill, Stroke::new(2.0, color));
    }
    local.viewport.pin.is_some()
}

/// Where a pin has its handle, in world space.
fn place(shown: &Shown<'_>, pin: &Pin) -> Option<Vec3> {
    match pin.goal {
        PinGoal::Point(at) | PinGoal::Look(at) => Some(at),
        PinGoal::Joint(other, at) => Some(world_from_joint(shown, other)?.transform_point3(at)),
        PinGoal::Camera => None,
    }
}

/// The pin with its handle at another position on the screen, as far from the camera as before. `None` if it stays.
fn moved(shown: &Shown<'_>, pane: egui::Rect, pin: &Pin, to: egui::Pos2) -> Option<Pin> {
    let from = place(shown, pin)?;
    let by = to - to_screen(shown, pane, from)?;
    let view = &shown.frame.view;
    let depth = (view.projection_from_view * view.view_from_world * from.extend(1.0)).w;
    let metres = 2.0 * depth / (view.projection_from_view.y_axis.y * pane.height().max(1.0));
    let camera = view.view_from_world.inverse();
    let (right, up) = (camera.x_axis.truncate(), camera.y_axis.truncate());
    let at = from + metres * (by.x * right - by.y * up);
    let model = shown.library.active()?;
    let goal = match pin.goal {
        PinGoal::Point(_) => PinGoal::Point(rounded(model, at)),
        PinGoal::Look(_) => PinGoal::Look(rounded(model, at)),
        PinGoal::Joint(other, _) => {
            PinGoal::Joint(other, world_from_joint(shown, other)?.inverse().transform_point3(at))
        }
        PinGoal::Camera => return None,
    };
    // Rounding leaves the handle a little off the pointer, which isn't a move.
    (by.length() > 0.1 && goal != pin.goal).then_some(Pin { goal, ..*pin })
}

fn world_from_joint(shown: &Shown<'_>, number: usize) -> Option<glam::Affine3A> {
    let joint = shown.library.active()?.asset.skeleton.joint_of_source(number)?;
    shown.frame.characters.first()?.world_from_joint.get(joint.get()).copied()
}
