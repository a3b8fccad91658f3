//! What clips animate besides joints, in the Info tab: materials, lights, cameras, visibility, expressions and single
//! morph weights.

use egui::Ui;
use gaitway_character::anim::{PropertyChannel, PropertyTarget};
use gaitway_scene::library::Model;
use gaitway_scene::state::title;

use super::facts::{aligned, fact};
use crate::ui::{Shown, controls, text};

/// Further properties of a clip are not listed.
const MAX_LISTED: usize = 200;

/// One list per clip; that of the current clip is open and has the current values.
pub fn show(ui: &mut Ui, shown: &Shown<'_>, model: &Model) {
    let mut clips = model.clips().iter().filter(|clip| !clip.clip().properties().is_empty()).peekable();
    if clips.peek().is_none() {
        return;
    }
    controls::section(ui, "ANIMATED PROPERTIES");
    for clip in clips {
        let (properties, is_current) = (clip.clip().properties(), shown.frame.clip.as_ref() == Some(clip.id()));
        let title = text::counted(clip.title(), properties.len());
        let header = egui::CollapsingHeader::new(title).id_salt(("animated", clip.id())).default_open(is_current);
        header.show(ui, |ui| {
            for channel in properties.iter().take(MAX_LISTED) {
                let value = if is_current { value(shown, model, channel) } else { None };
                fact(ui, &name(shown, model, channel.target), &value.unwrap_or_default());
            }
        });
    }
}

/// Returns the current value.
fn value(shown: &Shown<'_>, model: &Model, channel: &PropertyChannel) -> Option<String> {
    let frame = shown.frame;
    match channel.target {
        PropertyTarget::MorphWeight(joint, target) => {
            let range = model.asset.skeleton.morph_range(joint);
            Some(aligned(&[*frame.pose().morph_weights.get(range)?.get(target)?]).concat())
        }
        PropertyTarget::Visibility(_) => {
            let is_visible = frame.properties().get(channel.target)?.x != 0.0;
            Some(if is_visible { text::SHOWN } else { text::HIDDEN }.to_owned())
        }
        target => {
            let numbers = frame.properties().get(target)?.to_array();
            Some(aligned(&numbers[..target.width()]).join("  "))
        }
    }
}

fn name(shown: &Shown<'_>, model: &Model, target: PropertyTarget) -> String {
    let asset = &model.asset;
    let called = |name: Option<&str>, kind: &str, number: usize| match name {
        Some(name) if !name.is_empty() => name.to_owned(),
        _ => format!("{kind} {number}"),
    };
    let (subject, property) = match target {
        PropertyTarget::Material(number, property) => {
            let material = asset.materials.get(number).map(|material| &*material.name);
            (called(material, "Material", number), text::material_property(property).into_owned())
        }
        PropertyTarget::Light(number, property) => {
            let light = asset.lights.iter().find(|light| light.number == number);
            (
                called(light.map(|light| asset.skeleton.name(light.joint)), "Light", number),
                text::light_property(property).to_owned(),
            )
        }
        PropertyTarget::Camera(number, property) => {
            let camera = asset.cameras.iter().find(|camera| camera.number == number);
            (called(camera.map(|camera| &*camera.name), "Camera", number), text::camera_property(property).to_owned())
        }
        PropertyTarget::Visibility(joint) => {
            (title(Some(shown.state), asset, joint).into_owned(), text::VISIBILITY.to_owned())
        }
        PropertyTarget::LookAt => ("Eyes".to_owned(), "gaze direction".to_owned()),
        PropertyTarget::Expression(index) => {
            let name = asset.avatar.expressions.get(index).map(|expression| &*expression.name);
            (called(name, "Expression", index), "expression".to_owned())
        }
        PropertyTarget::MorphWeight(joint, target) => {
            (title(Some(shown.state), asset, joint).into_owned(), format!("morph weight {target}"))
        }
    };
    text::labelled(&subject, &property)
}
