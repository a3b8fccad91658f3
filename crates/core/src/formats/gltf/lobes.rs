//! The material extensions that add lobes: KHR_materials_specular, clearcoat, sheen and so on.
//!
//! Tables of JSON paths list their factors and textures; animation pointers share them.
//! KHR_materials_pbrSpecularGlossiness is converted to a dielectric with a specular colour.

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
/// Maximum number of textures of a material. WebGL2 has 16 texture units, of which lighting, skinning and transmission
/// take eight.
const MAX_TEXTURES: usize = 8;
/// The textures to drop first if a material has too many, least noticeable first.
const DISPENSABLE: [TextureSlot; 12] = [
    TextureSlot::ShadingShift,
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
    drop_surplus_textures(material, reader);
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

/// Reads textures by their paths into slots of the material.
pub fn read_textures(
    extensions: &Map<String, Value>,
    table: &[(&str, TextureSlot)],
    material: &mut Material,
    reader: &mut TextureReader<'_>,
) -> Result<(), Problem> {
    for &(path, slot) in table {
        let name = format!("extensions.{}", path.replace('/', "."));
        let texture = reader.extension_texture(member(extensions, path), &name)?;
        material.set_texture(slot, texture);
    }
    Ok(())
}

/// Keeps at most [`MAX_TEXTURES`] textures, with a warning that names the others.
pub fn drop_surplus_textures(material: &mut Material, reader: &mut TextureReader<'_>) {
    let count = TextureSlot::ALL.into_iter().filter(|&slot| material.texture(slot).is_some()).count();
    let surplus = count.saturating_sub(MAX_TEXTURES);
    let dispensable = DISPENSABLE.into_iter().filter(|&slot| material.texture(slot).is_some());
    let dropped: Vec<TextureSlot> = dispensable.take(surplus).collect();
    for &slot in &dropped {
        material.set_texture(slot, None);
    }
    if surplus > 0 {
        let names: Vec<&str> = TEXTURES
            .iter()
            .chain(&super::mtoon::TEXTURES)
            .filter(|(_, slot)| dropped.contains(slot))
            .map(|(path, _)| *path)
            .collect();
        let problem =
            format!("{count} textures, of which only {MAX_TEXTURES} can be shown; shown without {}", names.join(", "));
        reader.warnings.push(Warning::Other { code: "texture-count", place: reader.material.to_owned(), problem });
    }
}

/// Returns the value at a path of member names separated by `/`.
pub fn member<'a>(extensions: &'a Map<String, Value>, path: &str) -> Option<&'a Value> {
    let (extension, rest) = path.split_once('/')?;
    rest.split('/').try_fold(extensions.get(extension)?, |value, key| value.get(key))
}

/// Reads a number, or an array of numbers as long as `out`. Leaves `out` unchanged if the member is missing, or with a
/// warning if it is anything else.
pub fn read_numbers(extensions: &Map<String, Value>, path: &str, out: &mut [f32], reader: &mut TextureReader<'_>) {
    let Some(value) = member(extensions, path).filter(|value| !value.is_null()) else { return };
    let number = |value: &Value| value.as_f64().map(|value| value as f32).filter(|value| value.is_finite());
    let list = match out.len() {
        1 => std::slice::from_ref(value),
        _ => value.as_array().map_or(&[][..], Vec::as_slice),
    };
    let numbers: Vec<f32> = list.iter().filter_map(number).collect();
    match numbers.len() == out.len() && list.len() == out.len() {
        true => out.copy_from_slice(&numbers),
        false => {
            let expected = if out.len() == 1 { "a number".to_owned() } else { format!("{} numbers", out.len()) };
            ignore(reader, &path.replace('/', "."), &expected, value);
        }
    }
}

/// Warns that a member below the material's `extensions` is ignored.
pub fn ignore(reader: &mut TextureReader<'_>, path: &str, expected: &str, found: &Value) {
    let place = format!("{}.extensions.{path}", reader.material);
    let problem = format!("expected {expected}, found {found}; it is ignored");
    reader.warnings.push(Warning::Other { code: "material", place, problem });
}
