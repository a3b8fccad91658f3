//! The rotation gizmo of the selected joint: each ring rotates it about one of its own axes, the disc between them freely.

use egui::{Color32, Painter, Pos2, Rect, Response, Shape, Stroke, Ui, Vec2};
use gaitway_character::anim::Transform;
use gaitway_scene::library::manual_degrees;
use gaitway_scene::state::Command;
use glam::{Quat, Vec3};

use super::canvas::Canvas;
use super::panes::{pane_at, to_screen};
use crate::ui::{Output, Shown, UiState, style};

const RADIUS_POINTS: f32 = 72.0;
/// Radius of the disc for free rotation, relative to the rings.
const DISC: f32 = 0.55;
/// How close to a ring a press grabs it.
const GRAB_POINTS: f32 = 9.0;
const RADIANS_PER_POINT: f32 = 0.01;
const STEPS: usize = 48;
const COLORS: [Color32; 3] =
    [Color32::from_rgb(240, 70, 76), Color32::from_rgb(92, 190, 66), Color32::from_rgb(70, 126, 250)];

/// The part that is being dragged.
#[derive(Debug, Clone, Copy)]
pub enum Grab {
    /// Axis of a ring, and the grabbed point of it as a unit vector from the joint.
    Ring(usize, Vec3),
    Disc,
}

/// The gizmo of one joint.
struct Gizmo {
    joint: usize,
    position: Vec3,
    rest: Quat,
    local: Quat,
    world: Quat,
    /// Radius of the rings in metres.
    radius: f32,
    pane: Rect,
}

/// Shows the gizmo while posing manually; returns whether it has captured the pointer.
pub fn show(canvas: Canvas<'_>, local: &mut UiState, out: &mut Output) -> bool {
    let Canvas { ui, painter, response, shown } = canvas;
    let wanted = local.joint_card.is_posing && !shown.state.page.embed.is_on();
    let Some(gizmo) = wanted.then(|| gizmo(response, shown)).flatten() else {
        local.viewport.grab = None;
        return false;
    };
    if response.drag_stopped() || !ui.input(|input| input.pointer.primary_down()) {
        local.viewport.grab = None;
    }
    let hover = response.hover_pos().and_then(|at| gizmo.at(shown, at));
    let pressed = ui.input(|input| input.pointer.press_origin()).filter(|at| response.rect.contains(*at));
    if response.drag_started_by(egui::PointerButton::Primary) {
        local.viewport.grab = pressed.and_then(|at| gizmo.at(shown, at));
    }
    if let Some(grab) = local.viewport.grab
        && response.drag_delta() != Vec2::ZERO
    {
        let (turn, grab) = gizmo.rotate(shown, grab, response.drag_delta());
        local.viewport.grab = Some(grab);
        let world = (turn * gizmo.world).normalize();
        let parent = gizmo.world * gizmo.local.conjugate();
        let degrees = manual_degrees(gizmo.rest, parent.conjugate() * world);
        // A tenth of a degree is finer than a pointer, and keeps the link short.
        let degrees = degrees.map(|angle| (10.0 * angle).round() / 10.0);
        out.commands.push(Command::SetPose { joint: gizmo.joint, degrees: Some(degrees) });
    }
    let active = local.viewport.grab.or(hover);
    // A moving gizmo is hard to grab.
    local.holds_time |= active.is_some();
    gizmo.paint(ui, painter, shown, active);
    local.viewport.grab.is_some()
}

fn gizmo(response: &Response, shown: &Shown<'_>) -> Option<Gizmo> {
    let model = shown.library.active()?;
    let joint = shown.state.selection.joint?;
    let index = model.asset.skeleton.joint_of_source(joint)?;
    let character = shown.frame.characters.first()?;
    let matrix = character.world_from_joint.get(index.get())?;
    // The rings of a mirrored joint would rotate it the wrong way: it has only the sliders.
    let world = Some(Transform::from_matrix(&(*matrix).into())).filter(Transform::is_upright)?.rotation;
    let rest = model.asset.skeleton.rest().get(index)?.rotation;
    let local = shown.frame.pose().get(index)?.rotation;
    let pane = pane_at(shown, response.rect, response.hover_pos());
    let position = Vec3::from(matrix.translation);
    let view = &shown.frame.view;
    let depth = (view.projection_from_view * view.view_from_world * position.extend(1.0)).w;
    let radius = RADIUS_POINTS * 2.0 * depth / (view.projection_from_view.y_axis.y * pane.height().max(1.0));
    let usable = world.is_finite() && radius.is_finite() && radius > 0.0;
    usable.then_some(Gizmo { joint, position, rest, local, world, radius, pane })
}

impl Gizmo {
    fn axis(&self, axis: usize) -> Vec3 {
        self.world * Vec3::AXES[axis]
    }

    /// Points of a ring as unit vectors from the joint.
    fn ring(&self, axis: usize) -> impl Iterator<Item = Vec3> {
        let from = self.world * Vec3::AXES[(axis + 1) % 3];
        let axis = self.axis(axis);
        (0..=STEPS)
            .map(move |step| Quat::from_axis_angle(axis, std::f32::consts::TAU * step as f32 / STEPS as f32) * from)
    }

    fn on_screen(&self, shown: &Shown<'_>, arm: Vec3) -> Option<Pos2> {
        to_screen(shown, self.pane, self.position + self.radius * arm)
    }

    fn at(&self, shown: &Shown<'_>, at: Pos2) -> Option<Grab> {
        let mut nearest: Option<(f32, Grab)> = None;
        for axis in 0..3 {
            for arm in self.ring(axis) {
                let Some(point) = self.on_screen(shown, arm) else { continue };
                let distance = point.distance(at);
                if distance < GRAB_POINTS && nearest.is_none_or(|(best, _)| distance < best) {
                    nearest = Some((distance, Grab::Ring(axis, arm)));
                }
            }
        }
        let disc = || {
            let middle = to_screen(shown, self.pane, self.position)?;
            (middle.distance(at) < DISC * RADIUS_POINTS).then_some(Grab::Disc)
        };
        nearest.map(|(_, grab)| grab).or_else(disc)
    }

    /// The world-space rotation for a pointer movement, and the grab after it.
    fn rotate(&self, shown: &Shown<'_>, grab: Grab, moved: Vec2) -> (Quat, Grab) {
        match grab {
            Grab::Ring(axis, arm) => {
                let (about, step) = (self.axis(axis), 0.01);
                // Screen-space velocity of the grabbed point per radian.
                let ahead = Quat::from_axis_angle(about, step) * arm;
                let speed = match (self.on_screen(shown, arm), self.on_screen(shown, ahead)) {
                    (Some(from), Some(to)) => (to - from) / step,
                    _ => Vec2::ZERO,
                };
                // The lower bound keeps a ring that is seen edge-on usable.
                let radians = moved.dot(speed) / speed.length_sq().max(0.1 * RADIUS_POINTS * RADIUS_POINTS);
                let turn = Quat::from_axis_angle(about, radians);
                (turn, Grab::Ring(axis, (turn * arm).normalize_or(arm)))
            }
            Grab::Disc => {
                let camera = shown.frame.view.view_from_world.inverse();
                let (right, up) = (camera.x_axis.truncate(), camera.y_axis.truncate());
                let turn = Quat::from_axis_angle(up.normalize_or(Vec3::Y), moved.x * RADIANS_PER_POINT)
                    * Quat::from_axis_angle(right.normalize_or(Vec3::X), moved.y * RADIANS_PER_POINT);
                (turn, grab)
            }
        }
    }

    fn paint(&self, ui: &Ui, painter: &Painter, shown: &Shown<'_>, lit: Option<Grab>) {
        let painter = painter.with_clip_rect(self.pane);
        let towards_eye = (shown.frame.view.eye - self.position).normalize_or(Vec3::Z);
        if let Some(middle) = to_screen(shown, self.pane, self.position) {
            let strong = matches!(lit, Some(Grab::Disc));
            let fill = style::palette(ui).accent.gamma_multiply(if strong { 0.3 } else { 0.12 });
            painter.circle_filled(middle, DISC * RADIUS_POINTS, fill);
        }
        for (axis, color) in COLORS.into_iter().enumerate() {
            let strong = matches!(lit, Some(Grab::Ring(lit, _)) if lit == axis);
            let front = Stroke::new(if strong { 4.5 } else { 2.5 }, color);
            // The half behind the joint is faded.
            let back = Stroke { color: color.gamma_multiply(0.25), ..front };
            let mut previous: Option<Pos2> = None;
            for arm in self.ring(axis) {
                let point = self.on_screen(shown, arm);
                let stroke = if arm.dot(towards_eye) < -0.05 { back } else { front };
                if let Some((from, to)) = previous.zip(point) {
                    painter.add(Shape::line_segment([from, to], stroke));
                }
                previous = point;
            }
        }
    }
}
