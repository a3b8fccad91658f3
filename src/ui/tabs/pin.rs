//! Pins the selected joint: a section of its card.

use egui::Ui;
use gaitway_character::anim::{JointIndex, TimeRange};
use gaitway_character::asset::Slot;
use gaitway_retarget::{Pin, PinGoal, PinTimes};
use gaitway_scene::library::Model;
use gaitway_scene::state::{Command, active_take, play_range, title};
use glam::Vec3;

use super::avatar::coordinates;
use crate::ui::controls::{self, SliderSettings};
use crate::ui::{Output, Shown, text};

const BLEND: SliderSettings =
    SliderSettings { range: (0.0, 2.0), default: DEFAULT_BLEND_SECS, decimals: 2, suffix: " s", logarithmic: false };
const DEFAULT_BLEND_SECS: f64 = 0.25;

/// Shows a choice of goals: a head looks, other joints are held if they are at the end of two bones.
pub fn show(ui: &mut Ui, shown: &Shown<'_>, model: &Model, joint: JointIndex, out: &mut Output) {
    let skeleton = &model.asset.skeleton;
    let number = skeleton.source_index(joint);
    let before = shown.state.character.edits.pins.get(&number).copied();
    let allows = |goal| active_take(model, shown.state).pinning(None).allows(number, goal);
    let is_head = model.recognition().slot(joint) == Some(Slot::Head);
    let Some(character) = shown.frame.characters.first() else { return };
    let world_from = |joint: JointIndex| character.world_from_joint[joint.get()];
    let position = Vec3::from(world_from(joint).translation);
    // The offset that leaves a joint where it is.
    let at_joint = |other: JointIndex| {
        let at = world_from(other).inverse().transform_point3(position);
        PinGoal::Joint(skeleton.source_index(other), at)
    };
    let now = before.map(|pin| pin.goal);
    let point_now = match now {
        Some(PinGoal::Point(at) | PinGoal::Look(at)) => at,
        _ if is_head => rounded(model, beside_sight(position, shown.frame.view.eye)),
        _ => rounded(model, position),
    };
    let others = || skeleton.joints().filter(|&other| model.rig().is_real(other) && allows(at_joint(other)));
    let mut pin = before;
    let chosen = if is_head {
        let goals = [
            (None, text::NOT_PINNED),
            (Some(PinGoal::Look(point_now)), text::LOOK_POINT),
            (Some(PinGoal::Camera), text::LOOK_CAMERA),
        ];
        ui.label(text::LOOK);
        controls::segmented_about(ui, text::LOOK, Some(now), &goals)
    } else if allows(PinGoal::Point(point_now)) {
        let joint_now = match now {
            Some(goal @ PinGoal::Joint(..)) => Some(goal),
            _ => others().next().map(at_joint),
        };
        let goals = [
            (None, text::NOT_PINNED),
            (Some(PinGoal::Point(point_now)), text::PIN_TO_POINT),
            (joint_now, text::PIN_TO_JOINT),
        ];
        let goals = &goals[..if joint_now.is_some() { 3 } else { 2 }];
        ui.label(text::PIN);
        controls::segmented_about(ui, text::PIN, Some(now), goals)
    } else {
        return;
    };
    if let Some(goal) = chosen {
        pin = goal.map(|goal| Pin { goal, times: before.and_then(|pin| pin.times) });
    }
    if let Some(pin) = &mut pin {
        goal(ui, shown, model, &mut pin.goal, others().map(|other| (other, at_joint(other))));
        times(ui, shown, &mut pin.times);
    }
    if pin != before {
        out.commands.push(Command::SetPin { joint: number, pin });
    }
}

/// Returns a point in front of a head, halfway to the camera and a bit to the side: on the way, its handle would cover the head.
fn beside_sight(head: Vec3, eye: Vec3) -> Vec3 {
    let away = eye - head;
    head + 0.5 * away + 0.1 * away.length() * away.cross(Vec3::Y).normalize_or_zero()
}

/// Coordinates of the goal, and the joint that another is held at.
fn goal(
    ui: &mut Ui,
    shown: &Shown<'_>,
    model: &Model,
    goal: &mut PinGoal,
    others: impl Iterator<Item = (JointIndex, PinGoal)>,
) {
    let skeleton = &model.asset.skeleton;
    match goal {
        PinGoal::Point(at) => _ = coordinates(ui, text::PINNED_TO, at),
        PinGoal::Look(at) => _ = coordinates(ui, text::LOOK, at),
        PinGoal::Joint(other, _) => {
            let other = skeleton.joint_of_source(*other);
            let name = |joint| title(Some(shown.state), &model.asset, joint).into_owned();
            let chosen = other.map(name).unwrap_or_default();
            controls::chooser(ui, "pinned to", text::PINNED_TO, &chosen, |ui| {
                for (joint, at) in others {
                    if controls::option(ui, other == Some(joint), &name(joint)) {
                        *goal = at;
                    }
                }
            });
        }
        PinGoal::Camera => return,
    }
    controls::hint(ui, text::PIN_HINT);
}

/// Limits the pin to the range of the clip that is playing.
fn times(ui: &mut Ui, shown: &Shown<'_>, times: &mut Option<PinTimes>) {
    let Some(clip) = shown.clip() else { return };
    let TimeRange { start_secs, end_secs } = play_range(clip, shown.state);
    let in_range = |blend_secs| Some(PinTimes { start_secs, end_secs, blend_secs });
    if controls::switch(ui, text::PIN_IN_RANGE, times.is_some()) {
        *times = if times.is_some() { None } else { in_range(DEFAULT_BLEND_SECS) };
    }
    if let Some(limits) = times {
        controls::hint(ui, text::pin_times(*limits));
        limits.blend_secs = controls::slider(ui, text::BLEND, limits.blend_secs, BLEND).unwrap_or(limits.blend_secs);
        let other = in_range(limits.blend_secs).filter(|other| other != limits);
        if other.is_some() && ui.button(text::PIN_TO_RANGE).clicked() {
            *times = other;
        }
    }
}

/// Rounds a point to a power of ten that is finer than a pointer, for a person a millimetre: this keeps the link short.
pub fn rounded(model: &Model, at: Vec3) -> Vec3 {
    let size = model.rest_bounds().diagonal().clamp(1e-3, 1e6);
    let steps = 10_f32.powf(3.0 - size.log10().floor());
    // Zero has no sign in fields and links.
    (steps * at).round() / steps + Vec3::ZERO
}
