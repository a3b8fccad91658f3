//! Rings around the chosen joint in the picture: a ring turns it about one of its own axes, the disc between them freely.

use egui::{Color32, Painter, Pos2, Rect, Response, Shape, Stroke, Ui, Vec2};
use glam::{Quat, Vec3};

use super::picture::{pane_at, to_screen};
use crate::anim::Transform;
use crate::state::{Command, degrees_by_hand};
use crate::ui::{Output, Shown, UiState, style};

const RADIUS_POINTS: f32 = 72.0;
/// The disc for free turning, as a share of the rings.
const DISC: f32 = 0.55;
/// How far beside a ring a press still means it.
const GRAB_POINTS: f32 = 9.0;
const RADIANS_PER_POINT: f32 = 0.01;
const STEPS: usize = 48;
const COLORS: [Color32; 3] =
    [Color32::from_rgb(240, 70, 76), Color32::from_rgb(92, 190, 66), Color32::from_rgb(70, 126, 250)];

/// What is being dragged.
#[derive(Debug, Clone, Copy)]
pub enum Grab {
    /// A ring, and where on it, as a unit vector from the joint.
    Ring(usize, Vec3),
    Disc,
}

/// The chosen joint, as the rings need it.
struct Handle {
    joint: usize,
    place: Vec3,
    rest: Quat,
    local: Quat,
    world: Quat,
    /// Of the rings, metres.
    radius: f32,
    rect: Rect,
}

/// Paints the rings where turning by hand is on, and turns the joint; true when the pointer is theirs.
pub fn show(
    ui: &Ui,
    painter: &Painter,
    response: &Response,
    shown: &Shown<'_>,
    local: &mut UiState,
    out: &mut Output,
) -> bool {
    let wanted = local.turning && !shown.state.page.embed;
    let Some(handle) = wanted.then(|| handle(response, shown)).flatten() else {
        local.grab = None;
        return false;
    };
    if response.drag_stopped() || !ui.input(|input| input.pointer.primary_down()) {
        local.grab = None;
    }
    let hover = response.hover_pos().and_then(|at| handle.under(shown, at));
    let pressed = ui.input(|input| input.pointer.press_origin()).filter(|at| response.rect.contains(*at));
    if response.drag_started_by(egui::PointerButton::Primary) {
        local.grab = pressed.and_then(|at| handle.under(shown, at));
    }
    if let Some(grab) = local.grab
        && response.drag_delta() != Vec2::ZERO
    {
        let (turn, grab) = handle.turned(shown, grab, response.drag_delta());
        local.grab = Some(grab);
        let world = (turn * handle.world).normalize();
        let parent = handle.world * handle.local.conjugate();
        let degrees = degrees_by_hand(handle.rest, parent.conjugate() * world);
        // Tenths of a degree are finer than a pointer, and keep the link short.
        let degrees = degrees.map(|angle| (10.0 * angle).round() / 10.0);
        out.commands.push(Command::SetPose { joint: handle.joint, degrees: Some(degrees) });
    }
    let aimed_at = local.grab.or(hover);
    // What moves is hard to take hold of.
    local.holds_time |= aimed_at.is_some();
    handle.paint(ui, painter, shown, aimed_at);
    local.grab.is_some()
}

fn handle(response: &Response, shown: &Shown<'_>) -> Option<Handle> {
    let model = shown.library.active()?;
    let joint = shown.state.selection.joint?;
    let index = model.asset.skeleton.joint_of_source(joint)?;
    let character = shown.frame.characters.first()?;
    let matrix = character.world_from_joint.get(index.get())?;
    // The rings of a mirrored joint would turn it the wrong way round: it has its sliders.
    let world = Some(Transform::from_matrix(&(*matrix).into())).filter(Transform::is_upright)?.rotation;
    let rest = model.asset.skeleton.rest().locals.get(index.get())?.rotation;
    let local = shown.frame.pose().locals.get(index.get())?.rotation;
    let pane = pane_at(shown, response.rect, response.hover_pos());
    let place = Vec3::from(matrix.translation);
    let view = &shown.frame.view;
    let depth = (view.projection_from_view * view.view_from_world * place.extend(1.0)).w;
    let radius = RADIUS_POINTS * 2.0 * depth / (view.projection_from_view.y_axis.y * pane.height().max(1.0));
    let usable = world.is_finite() && radius.is_finite() && radius > 0.0;
    usable.then_some(Handle { joint, place, rest, local, world, radius, rect: pane })
}

impl Handle {
    fn axis(&self, axis: usize) -> Vec3 {
        self.world * Vec3::AXES[axis]
    }

    /// Points of a ring: unit vectors from the joint.
    fn ring(&self, axis: usize) -> impl Iterator<Item = Vec3> {
        let from = self.world * Vec3::AXES[(axis + 1) % 3];
        let axis = self.axis(axis);
        (0..=STEPS)
            .map(move |step| Quat::from_axis_angle(axis, std::f32::consts::TAU * step as f32 / STEPS as f32) * from)
    }

    fn on_screen(&self, shown: &Shown<'_>, arm: Vec3) -> Option<Pos2> {
        to_screen(shown, self.rect, self.place + self.radius * arm)
    }

    fn under(&self, shown: &Shown<'_>, at: Pos2) -> Option<Grab> {
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
            let middle = to_screen(shown, self.rect, self.place)?;
            (middle.distance(at) < DISC * RADIUS_POINTS).then_some(Grab::Disc)
        };
        nearest.map(|(_, grab)| grab).or_else(disc)
    }

    /// The turn in world space that a movement of the pointer asks for, and where the ring is held then.
    fn turned(&self, shown: &Shown<'_>, grab: Grab, moved: Vec2) -> (Quat, Grab) {
        match grab {
            Grab::Ring(axis, arm) => {
                let (about, step) = (self.axis(axis), 0.01);
                // How far the held point goes on the screen per radian.
                let ahead = Quat::from_axis_angle(about, step) * arm;
                let speed = match (self.on_screen(shown, arm), self.on_screen(shown, ahead)) {
                    (Some(from), Some(to)) => (to - from) / step,
                    _ => Vec2::ZERO,
                };
                // Where a ring is seen from its edge, as if it were a little open.
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
        let painter = painter.with_clip_rect(self.rect);
        let towards_eye = (shown.frame.view.eye - self.place).normalize_or(Vec3::Z);
        if let Some(middle) = to_screen(shown, self.rect, self.place) {
            let strong = matches!(lit, Some(Grab::Disc));
            let fill = style::palette(ui).accent.gamma_multiply(if strong { 0.3 } else { 0.12 });
            painter.circle_filled(middle, DISC * RADIUS_POINTS, fill);
        }
        for (axis, color) in COLORS.into_iter().enumerate() {
            let strong = matches!(lit, Some(Grab::Ring(lit, _)) if lit == axis);
            let mut before: Option<Pos2> = None;
            for arm in self.ring(axis) {
                let point = self.on_screen(shown, arm);
                if let (Some(from), Some(to)) = (before, point) {
                    // The far half is behind the joint.
                    let color = if arm.dot(towards_eye) < -0.05 { color.gamma_multiply(0.25) } else { color };
                    let width = if strong { 4.5 } else { 2.5 };
                    painter.add(Shape::line_segment([from, to], Stroke::new(width, color)));
                }
                before = point;
            }
        }
    }
}
