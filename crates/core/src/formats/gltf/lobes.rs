//! The extensions of a material that add lobes to it: KHR_materials_specular, clearcoat, sheen and so on.
//!
//! Their factors and textures are all read the same way, from a table of JSON paths, which animation pointers share.
//! KHR_materials_pbrSpecularGlossiness is converted: its two reflections become those of a dielectric without metal.

use glam::{Vec3, Vec4};
use serde_json::{Map, Value};

use super::materials::TextureReader;
use crate::anim::{LobeFactor, TextureSlot};
use crate::asset::Warning;
use crate::formats::error::Problem;
use crate::mesh::{Lobes, Material};

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
/// Below a material's `extensions`.
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
/// Below a material's `extensions`.
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
/// Textures that a material can have. WebGL2 has 16; light, skinning and what is behind glass take eight.
const MAX_TEXTURES: usize = 8;
/// The first of these are missed the least.
const DISPENSABLE: [TextureSlot; 11] = [
    TextureSlot::IridescenceThickness,
    TextureSlot::SheenRoughness,
    TextureSlot::Specular,
    TextureSlot::Thickness,
    TextureSlot::ClearcoatRoughness,
    TextureSlot::ClearcoatNormal,
    TextureSlot::Iridescence,
    TextureSlot::DiffuseTransmissionColor,
    TextureSlot::Anisotropy,
    TextureSlot::SheenColor,
    TextureSlot::Clearcoat,
];

/// Reads the lobes of a material whose other members have been read.
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
    for (path, slot) in TEXTURES {
        let texture = reader.lobe(member(extensions, path), &format!("extensions.{}", path.replace('/', ".")))?;
        if let Some(place) = lobes.texture_mut(slot) {
            *place = texture;
        }
    }
    material.lobes = Some(lobes);
    if extensions.get(SPECULAR_GLOSSINESS).is_some_and(Value::is_object) {
        convert_specular_glossiness(extensions, material, reader)?;
    }
    drop_textures(material, reader);
    Ok(())
}

/// With an index of refraction of 0 and no metal, the specular colour is the reflectance at normal incidence, as it is in
/// KHR_materials_pbrSpecularGlossiness. Glossiness stays where it is, in alpha of the specular colour texture.
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
    let mut texture =
        |name: &str| reader.lobe(member(extensions, &path(name)), &format!("extensions.{SPECULAR_GLOSSINESS}.{name}"));
    material.base_color_texture = texture("diffuseTexture")?;
    let specular_texture = texture("specularGlossinessTexture")?;
    material.base_color = Vec4::from(diffuse);
    material.metallic = 0.0;
    material.roughness = 1.0 - glossiness[0];
    material.metallic_roughness_texture = None;
    if let Some(lobes) = &mut material.lobes {
        lobes.ior = 0.0;
        lobes.specular = 1.0;
        lobes.specular_color = Vec3::from(specular);
        lobes.glossiness_in_specular_color = specular_texture.is_some();
        for (slot, texture) in [(TextureSlot::Specular, None), (TextureSlot::SpecularColor, specular_texture)] {
            if let Some(place) = lobes.texture_mut(slot) {
                *place = texture;
            }
        }
    }
    Ok(())
}

fn drop_textures(material: &mut Material, reader: &mut TextureReader<'_>) {
    let count = TextureSlot::ALL.into_iter().filter(|&slot| material.texture(slot).is_some()).count();
    let surplus = count.saturating_sub(MAX_TEXTURES);
    let dispensable = DISPENSABLE.into_iter().filter(|&slot| material.texture(slot).is_some());
    let dropped: Vec<TextureSlot> = dispensable.take(surplus).collect();
    for &slot in &dropped {
        if let Some(place) = material.texture_mut(slot) {
            *place = None;
        }
    }
    if surplus > 0 {
        let names: Vec<&str> =
            TEXTURES.iter().filter(|(_, slot)| dropped.contains(slot)).map(|(path, _)| *path).collect();
        let problem =
            format!("{count} textures; only {MAX_TEXTURES} can be shown at once, without {}", names.join(", "));
        reader.warnings.push(Warning::Other { code: "texture-count", place: reader.material.to_owned(), problem });
    }
}

/// Returns the value at a path of members.
pub fn member<'a>(extensions: &'a Map<String, Value>, path: &str) -> Option<&'a Value> {
    let (extension, rest) = path.split_once('/')?;
    rest.split('/').try_fold(extensions.get(extension)?, |value, key| value.get(key))
}

/// Leaves `out` as it is if the member is missing or not as many numbers as that.
pub fn read_numbers(extensions: &Map<String, Value>, path: &str, out: &mut [f32], reader: &mut TextureReader<'_>) {
    let Some(value) = member(extensions, path).filter(|value| !value.is_null()) else { return };
    let number = |value: &Value| value.as_f64().map(|value| value as f32).filter(|value| value.is_finite());
    let single = std::slice::from_ref(value);
    let list = if out.len() == 1 { single } else { value.as_array().map_or(&[][..], Vec::as_slice) };
    let numbers: Vec<f32> = list.iter().filter_map(number).collect();
    match numbers.len() == out.len() && list.len() == out.len() {
        true => out.copy_from_slice(&numbers),
        false => {
            let expected = if out.len() == 1 { "a number".to_owned() } else { format!("{} numbers", out.len()) };
            ignore(reader, &path.replace('/', "."), &expected, value);
        }
    }
}

/// Warns about a member below the material's `extensions`.
pub fn ignore(reader: &mut TextureReader<'_>, path: &str, expected: &str, found: &Value) {
    let place = format!("{}.extensions.{path}", reader.material);
    let problem = format!("expected {expected}, found {found}; it is ignored");
    reader.warnings.push(Warning::Other { code: "material", place, problem });
}
