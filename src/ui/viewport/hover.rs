//! Hovering and selecting joints in the viewport.

use egui::{Pos2, Rect};
use gaitway_scene::frame::{PickedJoint, pick_joint};
use gaitway_scene::state::{Command, source_on_stage};

use super::canvas::Canvas;
use super::panes::{pane_at, to_ndc};
use crate::ui::tabs::formula;
use crate::ui::{Output, Shown, UiState, motion};

/// How close to a bone a click selects its joint.
const PICK_POINTS: f32 = 10.0;

/// Hovering labels a joint. A click selects it, or the joint that moves the surface there, and a click beside the model closes an
/// open sheet, otherwise deselects. While the source is on the stage, the hovered joint is labelled on both skeletons, and a click
/// on a source joint selects the joint mapped to it.
pub fn show(canvas: Canvas<'_>, local: &mut UiState, out: &mut Output) {
    if motion::clicking(canvas, local, out) {
        return;
    }
    let Canvas { response, shown, .. } = canvas;
    let at = |position: Pos2| joint_at(shown, response.rect, position);
    let hovered = response.hover_pos().filter(|_| !response.dragged()).and_then(at);
    let of_model = |picked| match picked {
        PickedJoint::Model(joint) => Some(joint),
        PickedJoint::Source(_) => partner(shown, picked).and_then(|picked| match picked {
            PickedJoint::Model(joint) => Some(joint),
            PickedJoint::Source(_) => None,
        }),
    };
    // Labels appear under the pointer only while bones are drawn.
    local.viewport.hovered = hovered.filter(|_| shown.frame.bones.iter().any(|bone| bone.visible));
    local.viewport.hovered_joint = local.viewport.hovered.and_then(of_model);
    // A click beside an open menu only closes it.
    if response.clicked() && !local.had_popup {
        let clicked = response.interact_pointer_pos().and_then(|position| match at(position) {
            Some(picked) => of_model(picked),
            None => formula::joint_of_surface(shown, response.rect, position),
        });
        if clicked.is_none() && local.layout.sheet.take().is_some() {
            return;
        }
        if clicked != shown.state.selection.joint {
            out.commands.push(Command::SelectJoint(clicked));
        }
    }
}

/// The joint mapped to this one, while both skeletons are on the stage.
pub fn partner(shown: &Shown<'_>, picked: PickedJoint) -> Option<PickedJoint> {
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

/// The joint of the bone under a point.
fn joint_at(shown: &Shown<'_>, rect: Rect, position: Pos2) -> Option<PickedJoint> {
    let pane = pane_at(shown, rect, Some(position));
    let tolerance = 2.0 * PICK_POINTS / pane.height().max(1.0);
    pick_joint(shown.frame, to_ndc(pane, position), tolerance)
}
