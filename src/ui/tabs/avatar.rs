//! Avatars: expressions, gaze and spring bones in the Display tab, licence and authors in the Info tab.

use egui::Ui;
use gaitway_character::avatar::Avatar;
use gaitway_scene::library::{LookTarget, Model};
use gaitway_scene::state::{Command, title};
use glam::Vec3;

use super::facts::fact;
use crate::ui::controls::{self, SliderSettings};
use crate::ui::{Output, Shown, text};

/// Shows the controls of gaze, spring bones and expressions that the model has.
pub fn controls(ui: &mut Ui, shown: &Shown<'_>, model: &Model, out: &mut Output) {
    let avatar = &model.asset.avatar;
    let has_springs = !avatar.springs.joints().is_empty();
    if avatar.look_at.is_some() || has_springs {
        controls::section(ui, "AVATAR");
    }
    if avatar.look_at.is_some() {
        look_at(ui, shown, out);
    }
    if has_springs && controls::switch(ui, text::SPRINGS, shown.state.display.springs) {
        out.commands.push(Command::SetSprings(!shown.state.display.springs));
    }
    expressions(ui, shown, avatar, out);
}

fn look_at(ui: &mut Ui, shown: &Shown<'_>, out: &mut Output) {
    let now = shown.state.display.look_at;
    // The first point is the camera's position.
    let point = if let LookTarget::Point(point) = now { point } else { shown.frame.view.eye };
    let choices = [
        (LookTarget::Off, text::LOOK_OFF),
        (LookTarget::Camera, text::LOOK_AT_CAMERA),
        (LookTarget::Point(point), text::LOOK_AT_POINT),
    ];
    ui.label(text::EYES);
    if let Some(target) = controls::segmented_about(ui, text::EYES, Some(now), &choices) {
        out.commands.push(Command::SetLookAt(target));
    }
    if let LookTarget::Point(mut point) = now
        && coordinates(ui, text::EYES, &mut point)
    {
        out.commands.push(Command::SetLookAt(LookTarget::Point(point)));
    }
}

/// Fields for the coordinates of a point; returns whether it was changed. Their accessible names begin with the topic.
pub fn coordinates(ui: &mut Ui, topic: &str, point: &mut Vec3) -> bool {
    let before = *point;
    ui.horizontal(|ui| {
        let width = ((ui.available_width() - 2.0 * ui.spacing().item_spacing.x) / 3.0).min(80.0);
        for (coordinate, name) in [(&mut point.x, "X "), (&mut point.y, "Y "), (&mut point.z, "Z ")] {
            let field = controls::number(ui, [width, 26.0], coordinate, |field| {
                field
                    .speed(0.02)
                    .max_decimals(2)
                    .prefix(name)
                    .suffix(" m")
                    // Values that round to zero have no sign.
                    .custom_formatter(|value, decimals| {
                        let value = egui::emath::round_to_decimals(value, 2) + 0.0;
                        egui::emath::format_with_decimals_in_range(value, decimals)
                    })
            });
            controls::named(&field, || text::labelled(topic, name.trim_end()));
        }
    });
    *point != before
}

/// Shows a slider per expression. It follows the clip until the user moves it.
fn expressions(ui: &mut Ui, shown: &Shown<'_>, avatar: &Avatar, out: &mut Output) {
    let mut expressions = avatar.expressions.iter().enumerate().filter(|(_, one)| one.has_effect()).peekable();
    if expressions.peek().is_none() {
        return;
    }
    controls::section(ui, "EXPRESSIONS");
    let edited = &shown.state.character.edits.expressions;
    if ui.add_enabled(!edited.is_empty(), egui::Button::new(text::RESET_EXPRESSIONS)).clicked() {
        out.commands.push(Command::ClearExpressions);
    }
    for (index, expression) in expressions {
        let weight = edited.get(&expression.name).or_else(|| shown.frame.expressions().get(index));
        let value = f64::from(weight.copied().unwrap_or(0.0));
        let settings = SliderSettings { range: (0.0, 1.0), default: 0.0, decimals: 2, suffix: "", logarithmic: false };
        let new =
            ui.push_id(("expression", index), |ui| controls::slider(ui, &expression.title, value, settings)).inner;
        if let Some(weight) = new {
            let name = expression.name.clone();
            out.commands.push(Command::SetExpression { name, weight: Some(weight as f32) });
        }
    }
}

/// Shows title, authors, terms of use, and how first-person cameras treat meshes.
pub fn facts(ui: &mut Ui, shown: &Shown<'_>, model: &Model) {
    let avatar = &model.asset.avatar;
    if avatar.meta.is_empty() && avatar.first_person.is_empty() {
        return;
    }
    controls::section(ui, "AVATAR");
    controls::card(ui, |ui| {
        for (key, value) in &avatar.meta {
            fact(ui, &text::split_words(key), value);
        }
        for (joint, flag) in &avatar.first_person {
            let mesh = title(Some(shown.state), &model.asset, *joint);
            fact(ui, &text::first_person(&mesh), &text::split_words(flag));
        }
    });
}
