//! Picking in the viewport: a joint of the model, then its source, in the viewport if the motion's skeleton is shown there,
//! otherwise in the list.

use std::sync::Arc;

use egui::{Align2, Area, Context, Galley, Id, Order, Painter, Pos2, Rect, Stroke, pos2, vec2};
use gaitway_character::anim::JointIndex;
use gaitway_scene::frame::Character;
use gaitway_scene::library::MotionId;
use gaitway_scene::state::{Command, title};

use super::Pairing;
use super::picker::Picking;
use crate::ui::viewport::{Canvas, panes};
use crate::ui::{Output, Sheet, Shown, Tab, UiState, style, text};

/// What the next click in the viewport picks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Clicking {
    /// A joint of the model, to choose a source for.
    Target { motion: MotionId },
    /// The source of this joint of the model.
    Source { motion: MotionId, target: usize },
}

/// Maximum distance of a click or touch from a joint.
const REACH_POINTS: f32 = 28.0;

/// Whether the motion's own skeleton is shown, so that its joints can be picked.
pub(super) fn source_is_shown(shown: &Shown<'_>, pairing: &Pairing<'_>) -> bool {
    source_character(shown, pairing).is_some()
}

fn source_character<'a>(shown: &Shown<'a>, pairing: &Pairing<'_>) -> Option<&'a Character> {
    let stage = pairing.motion.stage().id;
    shown.frame.characters.iter().skip(1).find(|character| character.model == stage)
}

/// Stops picking; returns whether it was active.
pub(in crate::ui) fn stop(local: &mut UiState) -> bool {
    local.motion.clicking.take().is_some()
}

/// While picking, handles the pointer, paints a dot on every joint that can be picked, and returns true.
pub(in crate::ui) fn show(canvas: Canvas<'_>, local: &mut UiState, out: &mut Output) -> bool {
    let Canvas { ui, painter, response, shown } = canvas;
    let Some(clicking) = local.motion.clicking.clone() else { return false };
    let (Clicking::Target { motion } | Clicking::Source { motion, .. }) = &clicking;
    let Some(pairing) = Pairing::of(shown, motion) else {
        local.motion.clicking = None;
        return false;
    };
    let (asset, character, joints) = match clicking {
        Clicking::Target { .. } => {
            let joints = local.motion.contents(shown, &pairing).rows.iter().map(|row| row.joint).collect();
            (&pairing.model.asset, shown.frame.characters.first(), joints)
        }
        Clicking::Source { .. } => {
            let joints: Vec<JointIndex> = pairing.motion.asset.skeleton.joints().collect();
            (&pairing.motion.asset, source_character(shown, &pairing), joints)
        }
    };
    let pane = panes::pane_at(shown, response.rect, response.hover_pos());
    let places = places(shown, pane, character, &joints);
    let palette = style::palette(ui);
    let dot = |at: Pos2, radius: f32| {
        painter.circle(at, radius, palette.accent, Stroke::new(1.5, palette.panel));
    };
    places.iter().for_each(|&(_, at)| dot(at, 3.5));
    local.viewport.hovered_joint = None;
    let state = matches!(clicking, Clicking::Target { .. }).then_some(shown.state);
    if let Some((joint, at)) = response.hover_pos().and_then(|position| nearest(&places, position)) {
        dot(at, 6.0);
        let galley = painter.layout_no_wrap(title(state, asset, joint).into_owned(), style::SMALL, palette.on_accent);
        name_tag(painter, at, galley, &palette);
    }
    let clicked = response.interact_pointer_pos().filter(|_| response.clicked());
    if let Some((joint, _)) = clicked.and_then(|position| nearest(&places, position)) {
        let number = asset.skeleton.source_index(joint);
        match clicking {
            Clicking::Target { .. } => {
                out.commands.push(Command::SelectJoint(Some(number)));
                if source_is_shown(shown, &pairing) {
                    local.motion.clicking = Some(Clicking::Source { motion: motion.clone(), target: number });
                } else {
                    local.motion.picking = Some(Picking::new(motion.clone(), number));
                    finish(local);
                }
            }
            Clicking::Source { target, .. } => {
                out.commands.push(Command::SetSource { motion: motion.clone(), target, source: Some(number) });
                finish(local);
            }
        }
        ui.ctx().request_repaint();
    }
    true
}

/// Paints a name above a joint.
fn name_tag(painter: &Painter, at: Pos2, name: Arc<Galley>, palette: &style::Palette) {
    let tag = Rect::from_center_size(at - vec2(0.0, 24.0), name.size() + vec2(16.0, 6.0));
    painter.rect_filled(tag, style::CORNER, palette.accent);
    painter.galley(tag.center() - name.size() / 2.0, name, palette.on_accent);
}

/// Returns to the table, and reopens the sheet that made room for the viewport.
fn finish(local: &mut UiState) {
    local.motion.clicking = None;
    local.layout.tab = Tab::Motion;
    local.layout.sheet = Some(Sheet::Inspector);
}

/// Screen positions of joints.
fn places(
    shown: &Shown<'_>,
    pane: Rect,
    character: Option<&Character>,
    joints: &[JointIndex],
) -> Vec<(JointIndex, Pos2)> {
    let Some(character) = character else { return Vec::new() };
    let place = |&joint: &JointIndex| {
        let world = character.world_from_joint.get(joint.get())?;
        Some((joint, panes::to_screen(shown, pane, world.translation.into())?))
    };
    joints.iter().filter_map(place).collect()
}

fn nearest(places: &[(JointIndex, Pos2)], position: Pos2) -> Option<(JointIndex, Pos2)> {
    let near = places.iter().filter(|(_, at)| at.distance(position) <= REACH_POINTS);
    near.min_by(|(_, a), (_, b)| a.distance(position).total_cmp(&b.distance(position))).copied()
}

/// Says over the viewport what to click, and offers alternatives.
pub(in crate::ui) fn banner(context: &Context, picture: Rect, shown: &Shown<'_>, local: &mut UiState) {
    let Some(clicking) = local.motion.clicking.clone() else { return };
    let (Clicking::Target { motion } | Clicking::Source { motion, .. }) = &clicking;
    let Some(pairing) = Pairing::of(shown, motion) else { return };
    let what = match clicking {
        Clicking::Target { .. } => text::PICK_TARGET.to_owned(),
        Clicking::Source { target, .. } => {
            let asset = &pairing.model.asset;
            let joint = asset.skeleton.joint_of_source(target);
            let name = joint.map_or_else(String::new, |joint| pairing.target_title(joint).into_owned());
            text::pick_source_of(&name)
        }
    };
    let area = Area::new(Id::unique("clicking"))
        .order(Order::Foreground)
        .pivot(Align2::CENTER_TOP)
        .fixed_pos(pos2(picture.center().x, picture.top() + 54.0));
    area.show(context, |ui| {
        let palette = style::palette(ui);
        let frame = egui::Frame::new()
            .fill(palette.panel)
            .stroke(Stroke::new(1.0, palette.accent))
            .corner_radius(style::WINDOW_CORNER)
            .inner_margin(egui::Margin::symmetric(12, 8));
        frame.show(ui, |ui| {
            ui.set_max_width((picture.width() - 56.0).clamp(120.0, 420.0));
            ui.add(egui::Label::new(what).wrap());
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing = vec2(6.0, 6.0);
                if let Clicking::Source { target, .. } = clicking
                    && ui.button(text::CHOOSE_FROM_LIST).clicked()
                {
                    local.motion.picking = Some(Picking::new(motion.clone(), target));
                    finish(local);
                }
                if ui.button(text::DONE_PICKING).on_hover_text("Esc does the same").clicked() {
                    finish(local);
                }
            });
        });
    });
}
