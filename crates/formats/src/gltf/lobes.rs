//! The material extensions that add lobes: KHR_materials_specular, clearcoat, sheen and so on.
//!
//! Tables of JSON paths list their factors and textures; animation pointers share them.
//! KHR_materials_pbrSpecularGlossiness is converted to a dielectric with a specular colour.

use gaitway_character::anim::{LobeFactor, TextureSlot};
use gaitway_character::mesh::{Lobes, Material};
use glam::{Vec3, Vec4};
use serde_json::{Map, Value};

use super::material_reader::{TextureReader, ignore, member, read_numbers, read_textures};
use crate::error::Problem;

pub const SPECULAR_GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";
pub const EXTENSIONS: [&str; 10] = [
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_volume",
];
/// Factors by path below a material's `extensions`.
pub const FACTORS: [(&str, LobeFactor); 21] = [
    ("KHR_materials_ior/ior", LobeFactor::Ior),
    ("KHR_materials_specular/specularFactor", LobeFactor::Specular),
    ("KHR_materials_specular/specularColorFactor", LobeFactor::SpecularColor),
    ("KHR_materials_clearcoat/clearcoatFactor", LobeFactor::Clearcoat),
    ("KHR_materials_clearcoat/clearcoatRoughnessFactor", LobeFactor::ClearcoatRoughness),
    ("KHR_materials_clearcoat/clearcoatNormalTexture/scale", LobeFactor::ClearcoatNormalScale),
    ("KHR_materials_sheen/sheenColorFactor", LobeFactor::SheenColor),
    ("KHR_materials_sheen/sheenRoughnessFactor", LobeFactor::SheenRoughness),
    ("KHR_materials_iridescence/iridescenceFactor", LobeFactor::Iridescence),
    ("KHR_materials_iridescence/iridescenceIor", LobeFactor::IridescenceIor),
    ("KHR_materials_iridescence/iridescenceThicknessMinimum", LobeFactor::IridescenceThicknessMin),
    ("KHR_materials_iridescence/iridescenceThicknessMaximum", LobeFactor::IridescenceThicknessMax),
    ("KHR_materials_anisotropy/anisotropyStrength", LobeFactor::Anisotropy),
    ("KHR_materials_anisotropy/anisotropyRotation", LobeFactor::AnisotropyRotation),
    ("KHR_materials_transmission/transmissionFactor", LobeFactor::Transmission),
    ("KHR_materials_volume/thicknessFactor", LobeFactor::Thickness),
    ("KHR_materials_volume/attenuationDistance", LobeFactor::AttenuationDistance),
    ("KHR_materials_volume/attenuationColor", LobeFactor::AttenuationColor),
    ("KHR_materials_dispersion/dispersion", LobeFactor::Dispersion),
    ("KHR_materials_diffuse_transmission/diffuseTransmissionFactor", LobeFactor::DiffuseTransmission),
    ("KHR_materials_diffuse_transmission/diffuseTransmissionColorFactor", LobeFactor::DiffuseTransmissionColor),
];
/// Textures by path below a material's `extensions`.
pub const TEXTURES: [(&str, TextureSlot); 14] = [
    ("KHR_materials_specular/specularTexture", TextureSlot::Specular),
    ("KHR_materials_specular/specularColorTexture", TextureSlot::SpecularColor),
    ("KHR_materials_clearcoat/clearcoatTexture", TextureSlot::Clearcoat),
    ("KHR_materials_clearcoat/clearcoatRoughnessTexture", TextureSlot::ClearcoatRoughness),
    ("KHR_materials_clearcoat/clearcoatNormalTexture", TextureSlot::ClearcoatNormal),
    ("KHR_materials_sheen/sheenColorTexture", TextureSlot::SheenColor),
    ("KHR_materials_sheen/sheenRoughnessTexture", TextureSlot::SheenRoughness),
    ("KHR_materials_iridescence/iridescenceTexture", TextureSlot::Iridescence),
    ("KHR_materials_iridescence/iridescenceThicknessTexture", TextureSlot::IridescenceThickness),
    ("KHR_materials_anisotropy/anisotropyTexture", TextureSlot::Anisotropy),
    ("KHR_materials_transmission/transmissionTexture", TextureSlot::Transmission),
    ("KHR_materials_volume/thicknessTexture", TextureSlot::Thickness),
    ("KHR_materials_diffuse_transmission/diffuseTransmissionTexture", TextureSlot::DiffuseTransmission),
    ("KHR_materials_diffuse_transmission/diffuseTransmissionColorTexture", TextureSlot::DiffuseTransmissionColor),
];
/// Adds lobes to a material whose other members have been read.
pub fn read(
    extensions: &Map<String, Value>,
    material: &mut Material,
    reader: &mut TextureReader<'_>,
) -> Result<(), Problem> {
    let mut found = false;
    for name in EXTENSIONS.iter().chain([&SPECULAR_GLOSSINESS]) {
        match extensions.get(*name) {
            Some(Value::Object(_)) => found = true,
            Some(other) => ignore(reader, name, "an object", other),
            None => {}
        }
    }
    if !found {
        return Ok(());
    }
    let mut lobes = Box::<Lobes>::default();
    for (path, factor) in FACTORS {
        read_numbers(extensions, path, lobes.factor_mut(factor), reader);
    }
    material.lobes = Some(lobes);
    read_textures(extensions, &TEXTURES, material, reader)?;
    if extensions.get(SPECULAR_GLOSSINESS).is_some_and(Value::is_object) {
        convert_specular_glossiness(extensions, material, reader)?;
    }
    Ok(())
}

/// Converts KHR_materials_pbrSpecularGlossiness, whose specular colour is the reflectance at normal incidence. Without
/// metal and with an index of refraction of 0, KHR_materials_specular's is the same. Glossiness stays in the texture's
/// alpha.
fn convert_specular_glossiness(
    extensions: &Map<String, Value>,
    material: &mut Material,
    reader: &mut TextureReader<'_>,
) -> Result<(), Problem> {
    let path = |member: &str| format!("{SPECULAR_GLOSSINESS}/{member}");
    let (mut diffuse, mut specular, mut glossiness) = ([1.0; 4], [1.0; 3], [1.0]);
    read_numbers(extensions, &path("diffuseFactor"), &mut diffuse, reader);
    read_numbers(extensions, &path("specularFactor"), &mut specular, reader);
    read_numbers(extensions, &path("glossinessFactor"), &mut glossiness, reader);
    let mut texture = |name: &str| {
        reader.extension_texture(member(extensions, &path(name)), &format!("extensions.{SPECULAR_GLOSSINESS}.{name}"))
    };
    material.base_color_texture = texture("diffuseTexture")?;
    let specular_texture = texture("specularGlossinessTexture")?;
    material.base_color = Vec4::from(diffuse);
    material.metallic = 0.0;
    material.roughness = 1.0 - glossiness[0];
    material.metallic_roughness_texture = None;
    if let Some(lobes) = material.lobes.as_deref_mut() {
        lobes.ior = 0.0;
        lobes.specular = 1.0;
        lobes.specular_color = Vec3::from(specular);
        lobes.glossiness_in_specular_color = specular_texture.is_some();
    }
    material.set_texture(TextureSlot::Specular, None);
    material.set_texture(TextureSlot::SpecularColor, specular_texture);
    Ok(())
}
