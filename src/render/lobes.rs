//! What the GPU gets of a material's lobes or MToon: the variant of the shader and the uniform.

use glam::Vec3;

use super::shaders::SurfaceVariant as Variant;
use super::uniforms::MaterialUniform;
use crate::anim::{LobeFactor, MaterialProperty, PropertyTarget, TextureSlot};
use crate::asset::Asset;
use crate::mesh::{Lobes, Material, OutlineMode, Toon};

/// Returns MToon, or the lobes that a material, whose index in the asset this is, shows or that a clip can show, as bits of a variant.
pub(super) fn visible(asset: &Asset, index: Option<usize>, material: &Material) -> u64 {
    if material.toon.is_some() {
        return Variant::TOON;
    }
    let Some(lobes) = material.lobes.as_deref() else { return 0 };
    at_rest(lobes) | index.map_or(0, |index| animated(asset, index))
}

fn at_rest(lobes: &Lobes) -> u64 {
    let default = Lobes::default();
    let has_specular = (lobes.ior, lobes.specular, lobes.specular_color)
        != (default.ior, default.specular, default.specular_color)
        || [TextureSlot::Specular, TextureSlot::SpecularColor].iter().any(|&slot| lobes.texture(slot).is_some());
    [
        (Variant::SPECULAR, has_specular),
        (Variant::GLOSSINESS, lobes.glossiness_in_specular_color),
        (Variant::CLEARCOAT, lobes.clearcoat > 0.0),
        (Variant::SHEEN, lobes.sheen_color.max_element() > 0.0),
        (Variant::IRIDESCENCE, lobes.iridescence > 0.0),
        (Variant::ANISOTROPY, lobes.anisotropy > 0.0),
        (Variant::TRANSMISSION, lobes.transmission > 0.0),
        (Variant::VOLUME, lobes.thickness > 0.0),
        (Variant::DISPERSION, lobes.dispersion > 0.0),
        (Variant::DIFFUSE_TRANSMISSION, lobes.diffuse_transmission > 0.0),
    ]
    .into_iter()
    .map(|(lobe, is_visible)| if is_visible { lobe } else { 0 })
    .sum()
}

fn animated(asset: &Asset, material: usize) -> u64 {
    let targets = asset.clips.iter().flat_map(|clip| clip.properties()).map(|channel| channel.target);
    let lobes = targets.map(|target| match target {
        PropertyTarget::Material(index, MaterialProperty::Lobe(factor)) if index == material => lobe_of(factor),
        _ => 0,
    });
    lobes.fold(0, |all, lobe| all | lobe)
}

fn lobe_of(factor: LobeFactor) -> u64 {
    match factor {
        LobeFactor::Ior | LobeFactor::Specular | LobeFactor::SpecularColor => Variant::SPECULAR,
        LobeFactor::Clearcoat => Variant::CLEARCOAT,
        LobeFactor::SheenColor => Variant::SHEEN,
        LobeFactor::Iridescence => Variant::IRIDESCENCE,
        LobeFactor::Anisotropy => Variant::ANISOTROPY,
        LobeFactor::Transmission => Variant::TRANSMISSION,
        LobeFactor::Thickness => Variant::VOLUME,
        LobeFactor::Dispersion => Variant::DISPERSION,
        LobeFactor::DiffuseTransmission => Variant::DIFFUSE_TRANSMISSION,
        _ => 0,
    }
}

/// Returns the variant for these lobes: with the maps that are there and that they use.
pub(super) fn variant(mut lobes: u64, has_map: impl Fn(TextureSlot) -> bool) -> Variant {
    if lobes & (Variant::TRANSMISSION | Variant::DIFFUSE_TRANSMISSION) == 0 {
        lobes &= !Variant::VOLUME;
    }
    if lobes & Variant::TRANSMISSION == 0 || lobes & Variant::VOLUME == 0 {
        lobes &= !Variant::DISPERSION;
    }
    if lobes == 0 {
        return Variant::PLAIN;
    }
    let is_used = |slot: TextureSlot| match slot {
        TextureSlot::Specular | TextureSlot::SpecularColor => lobes & Variant::SPECULAR != 0,
        TextureSlot::Clearcoat | TextureSlot::ClearcoatRoughness | TextureSlot::ClearcoatNormal => {
            lobes & Variant::CLEARCOAT != 0
        }
        TextureSlot::SheenColor | TextureSlot::SheenRoughness => lobes & Variant::SHEEN != 0,
        TextureSlot::Iridescence | TextureSlot::IridescenceThickness => lobes & Variant::IRIDESCENCE != 0,
        TextureSlot::Anisotropy => lobes & Variant::ANISOTROPY != 0,
        TextureSlot::Transmission => lobes & Variant::TRANSMISSION != 0,
        TextureSlot::Thickness => lobes & Variant::VOLUME != 0,
        TextureSlot::DiffuseTransmission | TextureSlot::DiffuseTransmissionColor => {
            lobes & Variant::DIFFUSE_TRANSMISSION != 0
        }
        TextureSlot::MetallicRoughness | TextureSlot::Occlusion => lobes & Variant::TOON == 0,
        TextureSlot::ShadeMultiply
        | TextureSlot::ShadingShift
        | TextureSlot::Matcap
        | TextureSlot::RimMultiply
        | TextureSlot::OutlineWidth => lobes & Variant::TOON != 0,
        TextureSlot::BaseColor | TextureSlot::Normal | TextureSlot::Emissive => true,
    };
    let maps = TextureSlot::ALL.into_iter().filter(|&slot| is_used(slot) && has_map(slot));
    Variant(maps.fold(lobes, |bits, slot| bits | 1 << slot as u32))
}

/// Writes the factors of lobes.
pub(super) fn write_uniform(lobes: &Lobes, uniform: &mut MaterialUniform) {
    let ior = lobes.ior.max(0.0);
    let ratio = (ior - 1.0) / (ior + 1.0);
    let absorption = match lobes.attenuation_distance > 0.0 {
        true => {
            -lobes.attenuation_color.clamp(Vec3::splat(1e-6), Vec3::ONE).ln() / lobes.attenuation_distance.max(1e-6)
        }
        false => Vec3::ZERO,
    };
    let (sin, cos) = lobes.anisotropy_rotation.sin_cos();
    uniform.specular_color = (lobes.specular_color * ratio * ratio).to_array();
    uniform.specular = lobes.specular.clamp(0.0, 1.0);
    uniform.sheen_color = lobes.sheen_color.clamp(Vec3::ZERO, Vec3::ONE).to_array();
    uniform.sheen_roughness = lobes.sheen_roughness;
    uniform.absorption = absorption.to_array();
    uniform.thickness = lobes.thickness.max(0.0);
    uniform.diffuse_transmission_color = lobes.diffuse_transmission_color.to_array();
    uniform.diffuse_transmission = lobes.diffuse_transmission;
    uniform.clearcoat = lobes.clearcoat;
    uniform.clearcoat_roughness = lobes.clearcoat_roughness;
    uniform.clearcoat_normal_scale = lobes.clearcoat_normal_scale;
    uniform.ior = ior;
    uniform.iridescence = lobes.iridescence;
    uniform.iridescence_ior = lobes.iridescence_ior.max(1.0);
    uniform.iridescence_thickness = [lobes.iridescence_thickness_min, lobes.iridescence_thickness_max];
    uniform.anisotropy_direction = [cos, sin];
    uniform.anisotropy = lobes.anisotropy;
    uniform.transmission = lobes.transmission;
    uniform.dispersion = lobes.dispersion.max(0.0);
}

/// Writes the factors of MToon.
pub(super) fn write_toon(toon: &Toon, uniform: &mut MaterialUniform) {
    uniform.shading_shift = toon.shading_shift;
    uniform.shading_shift_scale = toon.shading_shift_scale;
    uniform.shading_toony = toon.shading_toony;
    uniform.shade_color = toon.shade_color.to_array();
    uniform.gi_equalization = toon.gi_equalization;
    uniform.matcap_color = toon.matcap_color.to_array();
    uniform.rim_lighting_mix = toon.rim_lighting_mix;
    uniform.rim_color = toon.rim_color.to_array();
    // 0 to the power of 0 is undefined in shaders.
    uniform.rim_fresnel_power = toon.rim_fresnel_power.max(1e-5);
    uniform.rim_lift = toon.rim_lift;
    uniform.outline_color = toon.outline_color.to_array();
    uniform.outline_lighting_mix = toon.outline_lighting_mix;
    uniform.outline_width = toon.outline_width;
    uniform.outline_on_screen = u32::from(toon.outline_mode == OutlineMode::Screen);
}
