//! What clips animate besides joints, in the Info tab: materials, lights, cameras, visibility,
//! expressions and single morph weights.

use egui::Ui;

use super::report::{aligned, fact};
use crate::anim::{CameraProperty, LightProperty, MaterialProperty, PropertyChannel, PropertyTarget, TextureSlot};
use crate::library::Model;
use crate::state::title;
use crate::ui::{Shown, controls, text};

/// Further properties of a clip are not listed.
const MAX_LISTED: usize = 200;

/// One list per clip; that of the current clip is open and has the current values.
pub fn show(ui: &mut Ui, shown: &Shown<'_>, model: &Model) {
    let animated = |index: &usize| model.clip(*index).is_some_and(|clip| !clip.properties().is_empty());
    let mut clips = (0..model.clip_count()).filter(animated).peekable();
    if clips.peek().is_none() {
        return;
    }
    controls::section(ui, "ANIMATED PROPERTIES");
    for index in clips {
        let (Some(clip), is_current) = (model.clip(index), shown.frame.clip == Some(index)) else { continue };
        let title = text::counted(&model.clip_titles()[index], clip.properties().len());
        let header = egui::CollapsingHeader::new(title).id_salt(("animated", index)).default_open(is_current);
        header.show(ui, |ui| {
            for channel in clip.properties().iter().take(MAX_LISTED) {
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
            (called(material, "Material", number), material_property(property))
        }
        PropertyTarget::Light(number, property) => {
            let light = asset.lights.iter().find(|light| light.number == number);
            (
                called(light.map(|light| asset.skeleton.name(light.joint)), "Light", number),
                light_property(property).to_owned(),
            )
        }
        PropertyTarget::Camera(number, property) => {
            let camera = asset.cameras.iter().find(|camera| camera.number == number);
            (called(camera.map(|camera| &*camera.name), "Camera", number), camera_property(property).to_owned())
        }
        PropertyTarget::Visibility(joint) => {
            (title(Some(shown.state), asset, joint).into_owned(), text::VISIBILITY.to_owned())
        }
        PropertyTarget::LookAt => ("Eyes".to_owned(), "direction".to_owned()),
        PropertyTarget::Expression(number) => {
            let name = asset.avatar.expressions.get(number).map(|expression| &*expression.name);
            (called(name, "Expression", number), "expression".to_owned())
        }
        PropertyTarget::MorphWeight(joint, target) => {
            (title(Some(shown.state), asset, joint).into_owned(), format!("morph weight {target}"))
        }
    };
    text::option_of(&subject, &property)
}

fn material_property(property: MaterialProperty) -> String {
    let texture = |slot: TextureSlot, what: &str| format!("{} texture {what}", words(&format!("{slot:?}")));
    match property {
        MaterialProperty::BaseColor => text::BASE_COLOR.to_owned(),
        MaterialProperty::Metallic => "metallic".to_owned(),
        MaterialProperty::Roughness => "roughness".to_owned(),
        MaterialProperty::Emissive => "emissive colour".to_owned(),
        MaterialProperty::EmissiveStrength => "emissive strength".to_owned(),
        MaterialProperty::AlphaCutoff => "alpha cutoff".to_owned(),
        MaterialProperty::NormalScale => "normal scale".to_owned(),
        MaterialProperty::OcclusionStrength => "occlusion strength".to_owned(),
        MaterialProperty::UvOffset(slot) => texture(slot, "offset"),
        MaterialProperty::UvRotation(slot) => texture(slot, "rotation"),
        MaterialProperty::UvScale(slot) => texture(slot, "scale"),
        MaterialProperty::Lobe(factor) => words(&format!("{factor:?}")),
        MaterialProperty::Toon(color) => words(&format!("{color:?}")),
    }
}

/// Spells a variant's name: "sheen colour" for `SheenColor`.
fn words(name: &str) -> String {
    let mut words = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !words.is_empty() {
            words.push(' ');
        }
        words.push(letter.to_ascii_lowercase());
    }
    words.replace("color", "colour").replace("metallic ", "metallic-")
}

fn light_property(property: LightProperty) -> &'static str {
    match property {
        LightProperty::Color => "colour",
        LightProperty::Intensity => "intensity",
        LightProperty::Range => "range",
        LightProperty::InnerCone => "inner cone angle",
        LightProperty::OuterCone => "outer cone angle",
    }
}

fn camera_property(property: CameraProperty) -> &'static str {
    match property {
        CameraProperty::YFov => "field of view",
        CameraProperty::YMag => "height",
        CameraProperty::Near => "near plane",
        CameraProperty::Far => "far plane",
    }
}
