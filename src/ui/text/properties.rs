//! Properties that clips animate besides joints, in the Info tab.

use std::borrow::Cow;

use gaitway_character::anim::{CameraProperty, LightProperty, LobeFactor, MaterialProperty, TextureSlot, ToonColor};

/// Value of an animated visibility.
pub const SHOWN: &str = "shown";
/// Value of an animated visibility.
pub const HIDDEN: &str = "hidden";
/// Property of a material that a clip can animate.
pub const BASE_COLOR: &str = "base colour";
/// Property of a node that a clip can animate.
pub const VISIBILITY: &str = "visibility";

/// Returns the name of a material property that a clip can animate.
pub fn material_property(property: MaterialProperty) -> Cow<'static, str> {
    let of_texture = |slot, what: &str| format!("{} texture {what}", map_name(slot)).into();
    match property {
        MaterialProperty::BaseColor => BASE_COLOR.into(),
        MaterialProperty::Metallic => "metallic".into(),
        MaterialProperty::Roughness => "roughness".into(),
        MaterialProperty::Emissive => "emissive colour".into(),
        MaterialProperty::EmissiveStrength => "emissive strength".into(),
        MaterialProperty::AlphaCutoff => "alpha cutoff".into(),
        MaterialProperty::NormalScale => "normal scale".into(),
        MaterialProperty::OcclusionStrength => "occlusion strength".into(),
        MaterialProperty::UvOffset(slot) => of_texture(slot, "offset"),
        MaterialProperty::UvRotation(slot) => of_texture(slot, "rotation"),
        MaterialProperty::UvScale(slot) => of_texture(slot, "scale"),
        MaterialProperty::Lobe(factor) => lobe_factor(factor).into(),
        MaterialProperty::Toon(color) => toon_color(color).into(),
    }
}

/// Returns the name of a material's map.
pub fn map_name(slot: TextureSlot) -> &'static str {
    match slot {
        TextureSlot::BaseColor => BASE_COLOR,
        TextureSlot::MetallicRoughness => "metallic-roughness",
        TextureSlot::Normal => "normal",
        TextureSlot::Occlusion => "occlusion",
        TextureSlot::Emissive => "emissive",
        TextureSlot::Specular => "specular",
        TextureSlot::SpecularColor => "specular colour",
        TextureSlot::Clearcoat => "clearcoat",
        TextureSlot::ClearcoatRoughness => "clearcoat roughness",
        TextureSlot::ClearcoatNormal => "clearcoat normal",
        TextureSlot::SheenColor => "sheen colour",
        TextureSlot::SheenRoughness => "sheen roughness",
        TextureSlot::Iridescence => "iridescence",
        TextureSlot::IridescenceThickness => "iridescence thickness",
        TextureSlot::Anisotropy => "anisotropy",
        TextureSlot::Transmission => "transmission",
        TextureSlot::Thickness => "thickness",
        TextureSlot::DiffuseTransmission => "diffuse transmission",
        TextureSlot::DiffuseTransmissionColor => "diffuse transmission colour",
        TextureSlot::ShadeMultiply => "shade multiply",
        TextureSlot::ShadingShift => "shading shift",
        TextureSlot::Matcap => "matcap",
        TextureSlot::RimMultiply => "rim multiply",
        TextureSlot::OutlineWidth => "outline width",
        TextureSlot::UvAnimationMask => "UV animation mask",
    }
}

fn lobe_factor(factor: LobeFactor) -> &'static str {
    match factor {
        LobeFactor::Ior => "index of refraction",
        LobeFactor::Specular => "specular",
        LobeFactor::SpecularColor => "specular colour",
        LobeFactor::Clearcoat => "clearcoat",
        LobeFactor::ClearcoatRoughness => "clearcoat roughness",
        LobeFactor::ClearcoatNormalScale => "clearcoat normal scale",
        LobeFactor::SheenColor => "sheen colour",
        LobeFactor::SheenRoughness => "sheen roughness",
        LobeFactor::Iridescence => "iridescence",
        LobeFactor::IridescenceIor => "iridescence index of refraction",
        LobeFactor::IridescenceThicknessMin => "min. iridescence thickness",
        LobeFactor::IridescenceThicknessMax => "max. iridescence thickness",
        LobeFactor::Anisotropy => "anisotropy",
        LobeFactor::AnisotropyRotation => "anisotropy rotation",
        LobeFactor::Transmission => "transmission",
        LobeFactor::Thickness => "thickness",
        LobeFactor::AttenuationDistance => "attenuation distance",
        LobeFactor::AttenuationColor => "attenuation colour",
        LobeFactor::Dispersion => "dispersion",
        LobeFactor::DiffuseTransmission => "diffuse transmission",
        LobeFactor::DiffuseTransmissionColor => "diffuse transmission colour",
    }
}

fn toon_color(color: ToonColor) -> &'static str {
    match color {
        ToonColor::ShadeColor => "shade colour",
        ToonColor::MatcapColor => "matcap colour",
        ToonColor::RimColor => "rim colour",
        ToonColor::OutlineColor => "outline colour",
    }
}

/// Returns the name of a light property that a clip can animate.
pub fn light_property(property: LightProperty) -> &'static str {
    match property {
        LightProperty::Color => "colour",
        LightProperty::Intensity => "intensity",
        LightProperty::Range => "range",
        LightProperty::InnerCone => "inner cone angle",
        LightProperty::OuterCone => "outer cone angle",
    }
}

/// Returns the name of a camera property that a clip can animate.
pub fn camera_property(property: CameraProperty) -> &'static str {
    match property {
        CameraProperty::YFov => "field of view",
        CameraProperty::YMag => "height",
        CameraProperty::Near => "near plane",
        CameraProperty::Far => "far plane",
    }
}
