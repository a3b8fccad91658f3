//! `VRMC_materials_mtoon`, the toon shading of VRM 1.0.

use gaitway_character::anim::{TextureSlot, ToonColor};
use gaitway_character::mesh::{Material, OutlineMode, Toon};
use serde_json::{Map, Value};

use super::material_reader::{TextureReader, ignore, read_numbers, read_textures};
use crate::error::Problem;

pub const MTOON: &str = "VRMC_materials_mtoon";
/// Colours by path below a material's `extensions`.
pub const COLORS: [(&str, ToonColor); 4] = [
    ("VRMC_materials_mtoon/shadeColorFactor", ToonColor::ShadeColor),
    ("VRMC_materials_mtoon/matcapFactor", ToonColor::MatcapColor),
    ("VRMC_materials_mtoon/parametricRimColorFactor", ToonColor::RimColor),
    ("VRMC_materials_mtoon/outlineColorFactor", ToonColor::OutlineColor),
];
/// Textures by path below a material's `extensions`.
pub const TEXTURES: [(&str, TextureSlot); 6] = [
    ("VRMC_materials_mtoon/shadeMultiplyTexture", TextureSlot::ShadeMultiply),
    ("VRMC_materials_mtoon/shadingShiftTexture", TextureSlot::ShadingShift),
    ("VRMC_materials_mtoon/matcapTexture", TextureSlot::Matcap),
    ("VRMC_materials_mtoon/rimMultiplyTexture", TextureSlot::RimMultiply),
    ("VRMC_materials_mtoon/outlineWidthMultiplyTexture", TextureSlot::OutlineWidth),
    ("VRMC_materials_mtoon/uvAnimationMaskTexture", TextureSlot::UvAnimationMask),
];

/// Adds MToon to a material whose other members have been read. It replaces lobes and KHR_materials_unlit.
pub fn read(
    extensions: &Map<String, Value>,
    material: &mut Material,
    reader: &mut TextureReader<'_>,
) -> Result<(), Problem> {
    match extensions.get(MTOON) {
        Some(Value::Object(_)) => {}
        Some(other) => {
            ignore(reader, MTOON, "an object", other);
            return Ok(());
        }
        None => return Ok(()),
    }
    let mut toon = Toon::default();
    for (path, color) in COLORS {
        read_numbers(extensions, path, AsMut::<[f32; 3]>::as_mut(toon.color_mut(color)), reader);
    }
    for (name, number) in [
        ("shadingShiftFactor", &mut toon.shading_shift),
        ("shadingShiftTexture/scale", &mut toon.shading_shift_scale),
        ("shadingToonyFactor", &mut toon.shading_toony),
        ("giEqualizationFactor", &mut toon.gi_equalization),
        ("parametricRimFresnelPowerFactor", &mut toon.rim_fresnel_power),
        ("parametricRimLiftFactor", &mut toon.rim_lift),
        ("rimLightingMixFactor", &mut toon.rim_lighting_mix),
        ("outlineWidthFactor", &mut toon.outline_width),
        ("outlineLightingMixFactor", &mut toon.outline_lighting_mix),
        ("uvAnimationScrollXSpeedFactor", &mut toon.uv_scroll.x),
        ("uvAnimationScrollYSpeedFactor", &mut toon.uv_scroll.y),
        ("uvAnimationRotationSpeedFactor", &mut toon.uv_rotation),
    ] {
        read_numbers(extensions, &format!("{MTOON}/{name}"), std::slice::from_mut(number), reader);
    }
    let mode = &extensions[MTOON]["outlineWidthMode"];
    toon.outline_mode = match mode.as_str() {
        Some("worldCoordinates") => OutlineMode::World,
        Some("screenCoordinates") => OutlineMode::Screen,
        Some("none") => OutlineMode::None,
        _ => {
            if !mode.is_null() {
                let path = format!("{MTOON}.outlineWidthMode");
                ignore(reader, &path, "“none”, “worldCoordinates” or “screenCoordinates”", mode);
            }
            OutlineMode::None
        }
    };
    material.shade_as_toon(toon);
    read_textures(extensions, &TEXTURES, material, reader)?;
    Ok(())
}
