//! Labels in the viewport: joint names, and what each pane of a comparison shows.

use egui::{Painter, Rect, Ui, pos2, vec2};
use gaitway_scene::frame::PickedJoint;
use gaitway_scene::state::{Comparison, compared_rests, source_on_stage, title};

use super::hover::partner;
use super::legend;
use super::panes::{label_height, pane_index, pane_rects, to_screen};
use crate::ui::tabs::{display, formula};
use crate::ui::tracks::short;
use crate::ui::{Shown, UiState, style, text};

/// Labels the selected and the hovered joint, and the panes of the comparison. Call once the frame has been evaluated, or
/// the labels lag behind the scene.
pub fn labels(ui: &Ui, rect: Rect, shown: Shown<'_>, local: &mut UiState) {
    if !rect.is_positive() {
        return;
    }
    let painter = ui.painter_at(rect);
    pane_labels(ui, &painter, rect, &shown);
    legend::show(ui, &painter, rect.with_max_y(rect.bottom() - label_height(&shown)), &shown);
    if local.motion.is_clicking() {
        return;
    }
    let pointer = ui.input(|input| input.pointer.hover_pos()).filter(|at| rect.contains(*at));
    let panes = pane_rects(&shown, rect);
    let index = pane_index(&panes, pointer);
    let pane = panes[index];
    formula::mark(ui, &painter, (index, pane), &shown, local);
    let both = |picked: Option<PickedJoint>| [picked, picked.and_then(|picked| partner(&shown, picked))];
    let selected = both(shown.state.selection.joint.map(PickedJoint::Model));
    for picked in selected.into_iter().flatten() {
        label(ui, &painter, pane, &shown, picked, true);
    }
    for picked in both(local.viewport.hovered).into_iter().flatten().filter(|&picked| !selected.contains(&Some(picked)))
    {
        label(ui, &painter, pane, &shown, picked, false);
    }
}

/// A ring around a joint and its name above it; with the source on the stage, also the joint's rotation error.
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
    let mut text = short(&title(state, asset, joint)).to_owned();
    if let (PickedJoint::Model(_), Some(source)) = (picked, &source) {
        let pair = source.borrowed.pairs.iter().find(|pair| pair.target == joint);
        let error = pair.and_then(|pair| {
            let world_from_source = characters.last()?.world_from_joint.get(pair.source.get())?;
            pair.error_radians(character.world_from_joint.get(joint.get())?, world_from_source)
        });
        text += &error.map_or(" · unmapped".to_owned(), |error| format!(" · {:.1}° error", error.to_degrees()));
    }
    let palette = style::palette(ui);
    let color = if strong { palette.on_accent } else { palette.text };
    let galley = painter.layout_no_wrap(text, style::SMALL, color);
    let half = galley.size().x / 2.0 + 8.0;
    let x = position.x.clamp(pane.left() + half, (pane.right() - half).max(pane.left() + half));
    let frame = Rect::from_center_size(pos2(x, position.y - 24.0), galley.size() + vec2(16.0, 6.0));
    let fill = if strong { palette.accent } else { palette.panel.gamma_multiply(0.92) };
    painter.rect_filled(frame, style::CORNER, fill);
    painter.galley(frame.center() - galley.size() / 2.0, galley, color);
    painter.circle_stroke(position, 6.0, egui::Stroke::new(2.0, palette.accent));
    Some(())
}

/// What each pane of the comparison shows, and the lines between them.
fn pane_labels(ui: &Ui, painter: &Painter, rect: Rect, shown: &Shown<'_>) {
    let panes = pane_rects(shown, rect);
    if panes.len() < 2 {
        return;
    }
    let palette = style::palette(ui);
    for (index, (pane, character)) in panes.iter().zip(&shown.frame.characters).enumerate() {
        let text = match shown.frame.comparison {
            Some(Comparison::Rests(chosen)) => text::rest_choice(compared_rests(chosen)[index]),
            _ => display::title(character.skinning),
        };
        let galley = painter.layout_no_wrap(text.to_owned(), style::SMALL, palette.text);
        let middle = pos2(pane.center().x, pane.bottom() - 18.0);
        painter.rect_filled(
            Rect::from_center_size(middle, galley.size() + vec2(16.0, 6.0)),
            style::CORNER,
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
