//! The picture itself: what pointer and fingers do to the camera, which joint is under the pointer, and the few buttons
//! that lie on top. The pixels are filled in by whoever draws the scene.

use egui::layers::ShapeIdx;
use egui::{Align, Layout, PaintCallback, Painter, PointerButton, Pos2, Rect, Response, Sense, Shape, Ui, pos2, vec2};
use glam::Vec2;

use super::gizmo;
use crate::frame::{PickedJoint, pick_joint};
use crate::state::{Command, source_on_stage, title};
use crate::ui::icons::{Icon, icon_button};
use crate::ui::tabs::{display, formula};
use crate::ui::{Output, Sheet, Shown, UiAction, UiState, is_narrow, keys, motion, style};

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
        if local.recording {
            if ui.input(|input| input.key_pressed(egui::Key::Escape)) || response.clicked() {
                out.actions.push(UiAction::StopRecording);
            }
            return PictureSlot { painter, index, rect };
        }
        if !gizmo::show(ui, &painter, &response, &shown, local, out) {
            camera(ui, &response, &shown, out);
        }
        if !formula::point_at_vertex(&response, &shown, local, out) {
            joints(ui, &painter, &response, &shown, local, out);
        }
        keys::listen(ui.ctx(), &shown, local, out);
        if !shown.state.page.embed {
            buttons(ui, rect, local, out);
        }
    }
    PictureSlot { painter, index, rect }
}

/// Shows that there is nothing behind a transparent picture.
fn checkerboard(painter: &Painter, rect: Rect, shown: &Shown<'_>, palette: style::Palette) {
    if shown.state.display.background != crate::state::Background::Transparent || shown.state.page.embed {
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

fn camera(ui: &Ui, response: &Response, shown: &Shown<'_>, out: &mut Output) {
    let height = pane_at(shown, response.rect, None).height().max(1.0);
    let pan = |by: egui::Vec2| Command::Pan { right: -by.x / height, up: by.y / height };
    let zoom = |factor: f32, at: Option<Pos2>| {
        let from_middle = at.map_or(egui::Vec2::ZERO, |at| at - pane_at(shown, response.rect, Some(at)).center());
        Command::Zoom { factor, right: from_middle.x / height, up: -from_middle.y / height }
    };
    let (touch, shift) = ui.input(|input| (input.multi_touch(), input.modifiers.shift));
    if let Some(touch) = touch.filter(|touch| response.rect.contains(touch.start_pos)) {
        if touch.zoom_delta > 0.0 && touch.zoom_delta != 1.0 {
            out.commands.push(zoom(1.0 / touch.zoom_delta, Some(touch.center_pos)));
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

/// Hover names a joint, a click chooses it, a click beside all of them chooses none. With the source on the stage, what is
/// under the pointer is lit on both sides; a click on the source's joint chooses the one that follows it.
fn joints(ui: &Ui, painter: &Painter, response: &Response, shown: &Shown<'_>, local: &mut UiState, out: &mut Output) {
    if motion::clicking(ui, painter, response, shown, local, out) {
        return;
    }
    let at = |position: Pos2| joint_at(shown, response.rect, position);
    let hovered = response.hover_pos().filter(|_| !response.dragged()).and_then(at);
    let of_model = |picked| match picked {
        PickedJoint::Model(joint) => Some(joint),
        PickedJoint::Source(_) => partner(shown, picked).and_then(|picked| match picked {
            PickedJoint::Model(joint) => Some(joint),
            PickedJoint::Source(_) => None,
        }),
    };
    // Names come and go under the pointer only where there is something to point at.
    local.hovered = hovered.filter(|_| shown.frame.look.skeleton);
    local.hovered_joint = local.hovered.and_then(of_model);
    if response.clicked() {
        if local.sheet.take().is_some() {
            return;
        }
        let clicked = response.interact_pointer_pos().and_then(at).and_then(of_model);
        if clicked != shown.state.selection.joint {
            out.commands.push(Command::SelectJoint(clicked));
        }
    }
}

/// Names of the chosen joint and of the one under the pointer, and of what is compared: painted when the frame that they
/// belong to has been evaluated, or they would trail behind.
pub fn labels(ui: &Ui, rect: Rect, shown: Shown<'_>, local: &mut UiState) {
    if !rect.is_positive() || local.recording {
        return;
    }
    let painter = ui.painter_at(rect);
    compared(ui, &painter, rect, &shown);
    if local.motion.is_clicking() {
        return;
    }
    let pointer = ui.input(|input| input.pointer.hover_pos()).filter(|at| rect.contains(*at));
    let pane = pane_at(&shown, rect, pointer);
    formula::mark(ui, &painter, pane, &shown, local);
    let both = |picked: Option<PickedJoint>| [picked, picked.and_then(|picked| partner(&shown, picked))];
    let chosen = both(shown.state.selection.joint.map(PickedJoint::Model));
    for picked in chosen.into_iter().flatten() {
        label(ui, &painter, pane, &shown, picked, true);
    }
    for picked in both(local.hovered).into_iter().flatten().filter(|&picked| !chosen.contains(&Some(picked))) {
        label(ui, &painter, pane, &shown, picked, false);
    }
}

/// The joint on the other side of the map, while both sides are on the stage.
fn partner(shown: &Shown<'_>, picked: PickedJoint) -> Option<PickedJoint> {
    let source = source_on_stage(shown.library, shown.state)?;
    let skeletons = [&shown.library.active()?.asset.skeleton, &source.model.asset.skeleton];
    let mut pairs = source.borrowed.pairs.iter();
    match picked {
        PickedJoint::Model(joint) => {
            let joint = skeletons[0].joint_of_source(joint)?;
            let pair = pairs.find(|pair| pair.target == joint)?;
            Some(PickedJoint::Source(skeletons[1].source_index(pair.source)))
        }
        PickedJoint::Source(joint) => {
            let joint = skeletons[1].joint_of_source(joint)?;
            let pair = pairs.find(|pair| pair.source == joint)?;
            Some(PickedJoint::Model(skeletons[0].source_index(pair.target)))
        }
    }
}

/// A ring around a joint and its name above it; where both sides are on the stage, how far apart they are.
fn label(ui: &Ui, painter: &Painter, pane: Rect, shown: &Shown<'_>, picked: PickedJoint, strong: bool) -> Option<()> {
    let model = shown.library.active()?;
    let source = source_on_stage(shown.library, shown.state);
    let characters = &shown.frame.characters;
    let (asset, joint, character) = match picked {
        PickedJoint::Model(joint) => (&model.asset, joint, characters.first()?),
        PickedJoint::Source(joint) => (&source.as_ref()?.model.asset, joint, characters.last()?),
    };
    let joint = asset.skeleton.joint_of_source(joint)?;
    let position = to_screen(shown, pane, character.world_from_joint.get(joint.get())?.translation.into())?;
    let state = matches!(picked, PickedJoint::Model(_)).then_some(shown.state);
    let mut text = title(state, asset, joint).into_owned();
    if let (PickedJoint::Model(_), Some(source)) = (picked, &source) {
        let pair = source.borrowed.pairs.iter().find(|pair| pair.target == joint);
        let error = pair.and_then(|pair| {
            let world_from_source = characters.last()?.world_from_joint.get(pair.source.get())?;
            pair.error_radians(character.world_from_joint.get(joint.get())?, world_from_source)
        });
        text += &error.map_or(" · follows nothing".to_owned(), |error| format!(" · {:.1}° apart", error.to_degrees()));
    }
    let palette = style::palette(ui);
    let color = if strong { palette.on_accent } else { palette.text };
    let galley = painter.layout_no_wrap(text, egui::FontId::proportional(13.0), color);
    let half = galley.size().x / 2.0 + 8.0;
    let x = position.x.clamp(pane.left() + half, (pane.right() - half).max(pane.left() + half));
    let box_ = Rect::from_center_size(pos2(x, position.y - 24.0), galley.size() + vec2(16.0, 6.0));
    let fill = if strong { palette.accent } else { palette.panel.gamma_multiply(0.92) };
    painter.rect_filled(box_, 6.0, fill);
    painter.galley(box_.center() - galley.size() / 2.0, galley, color);
    painter.circle_stroke(position, 6.0, egui::Stroke::new(2.0, palette.accent));
    Some(())
}

/// The names of the skinning modes, where they are compared.
fn compared(ui: &Ui, painter: &Painter, rect: Rect, shown: &Shown<'_>) {
    let panes = pane_rects(shown, rect);
    if panes.len() < 2 {
        return;
    }
    let palette = style::palette(ui);
    for (pane, character) in panes.iter().zip(&shown.frame.characters) {
        let text = display::title(character.skinning).to_owned();
        let galley = painter.layout_no_wrap(text, egui::FontId::proportional(13.0), palette.text);
        let middle = pos2(pane.center().x, pane.bottom() - 18.0);
        painter.rect_filled(
            Rect::from_center_size(middle, galley.size() + vec2(16.0, 6.0)),
            6.0,
            palette.panel.gamma_multiply(0.86),
        );
        painter.galley(middle - galley.size() / 2.0, galley, palette.text);
        if pane.left() > rect.left() + 1.0 {
            painter.vline(pane.left(), pane.y_range(), egui::Stroke::new(1.0, palette.line));
        }
        if pane.top() > rect.top() + 1.0 {
            painter.hline(pane.x_range(), pane.top(), egui::Stroke::new(1.0, palette.line));
        }
    }
}

fn pane_rects(shown: &Shown<'_>, rect: Rect) -> Vec<Rect> {
    let [columns, rows] = shown.frame.panes.map(|count| count.max(1));
    let size = rect.size() / vec2(columns as f32, rows as f32);
    let at = |row: u32, column: u32| Rect::from_min_size(rect.min + vec2(column as f32, row as f32) * size, size);
    (0..rows).flat_map(|row| (0..columns).map(move |column| at(row, column))).collect()
}

/// The pane of the picture under a point, the first one by default.
pub fn pane_at(shown: &Shown<'_>, rect: Rect, position: Option<Pos2>) -> Rect {
    let panes = pane_rects(shown, rect);
    let under = position.and_then(|position| panes.iter().find(|pane| pane.contains(position)));
    under.or(panes.first()).copied().unwrap_or(rect)
}

/// A world-space point on the screen, in this pane of the picture; none behind the camera.
pub fn to_screen(shown: &Shown<'_>, rect: Rect, world: glam::Vec3) -> Option<Pos2> {
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

/// The joint of the drawn bone under a point of the screen.
fn joint_at(shown: &Shown<'_>, rect: Rect, position: Pos2) -> Option<PickedJoint> {
    let rect = pane_at(shown, rect, Some(position));
    let part = (position - rect.min) / rect.size();
    let point = Vec2::new(2.0 * part.x - 1.0, 1.0 - 2.0 * part.y);
    let tolerance = 2.0 * PICK_POINTS / rect.height().max(1.0);
    pick_joint(shown.frame, point, tolerance)
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
        if local.has_gallery && icon_button(ui, Icon::Samples, "Samples", false).clicked() {
            out.actions.push(UiAction::ShowGallery);
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
