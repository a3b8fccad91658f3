//! A material's lobes or MToon on the GPU: the permutation of the shader and the uniform's values.

use gaitway_character::anim::{LobeFactor, MaterialProperty, PropertyTarget, TextureSlot};
use gaitway_character::asset::Asset;
use gaitway_character::mesh::{Lobes, Material, OutlineMode, Toon};
use glam::Vec3;

use super::shaders::SurfacePermutation as Permutation;
use super::uniforms::MaterialUniform;

/// Returns the bits of MToon, or of the lobes that are visible at rest or that a clip animates. `index` is that of the
/// material in the asset.
pub(super) fn visible(asset: &Asset, index: Option<usize>, material: &Material) -> u64 {
    if material.toon.is_some() {
        return Permutation::TOON;
    }
    let Some(lobes) = material.lobes.as_deref() else { return 0 };
    visible_at_rest(lobes) | index.map_or(0, |index| animated(asset, index))
}

fn visible_at_rest(lobes: &Lobes) -> u64 {
    let default = Lobes::default();
    let has_specular = (lobes.ior, lobes.specular, lobes.specular_color)
        != (default.ior, default.specular, default.specular_color)
        || [TextureSlot::Specular, TextureSlot::SpecularColor].iter().any(|&slot| lobes.texture(slot).is_some());
    [
        (Permutation::SPECULAR, has_specular),
        (Permutation::GLOSSINESS, lobes.glossiness_in_specular_color),
        (Permutation::CLEARCOAT, lobes.clearcoat > 0.0),
        (Permutation::SHEEN, lobes.sheen_color.max_element() > 0.0),
        (Permutation::IRIDESCENCE, lobes.iridescence > 0.0),
        (Permutation::ANISOTROPY, lobes.anisotropy > 0.0),
        (Permutation::TRANSMISSION, lobes.transmission > 0.0),
        (Permutation::VOLUME, lobes.thickness > 0.0),
        (Permutation::DISPERSION, lobes.dispersion > 0.0),
        (Permutation::DIFFUSE_TRANSMISSION, lobes.diffuse_transmission > 0.0),
    ]
    .into_iter()
    .map(|(lobe, is_visible)| if is_visible { lobe } else { 0 })
    .sum()
}

fn animated(asset: &Asset, material: usize) -> u64 {
    let targets = asset.clips.iter().flat_map(|clip| clip.properties()).map(|channel| channel.target);
    let lobe_of_target = |target| match target {
        PropertyTarget::Material(index, MaterialProperty::Lobe(factor)) if index == material => lobe_of(factor),
        _ => 0,
    };
    targets.fold(0, |lobes, target| lobes | lobe_of_target(target))
}

/// Returns the lobe that a factor can make visible, if any.
fn lobe_of(factor: LobeFactor) -> u64 {
    match factor {
        LobeFactor::Ior | LobeFactor::Specular | LobeFactor::SpecularColor => Permutation::SPECULAR,
        LobeFactor::Clearcoat => Permutation::CLEARCOAT,
        LobeFactor::SheenColor => Permutation::SHEEN,
        LobeFactor::Iridescence => Permutation::IRIDESCENCE,
        LobeFactor::Anisotropy => Permutation::ANISOTROPY,
        LobeFactor::Transmission => Permutation::TRANSMISSION,
        LobeFactor::Thickness => Permutation::VOLUME,
        LobeFactor::Dispersion => Permutation::DISPERSION,
        LobeFactor::DiffuseTransmission => Permutation::DIFFUSE_TRANSMISSION,
        _ => 0,
    }
}

/// Returns the permutation with these lobes, except those without effect, and with the maps that they use.
pub(super) fn permutation(mut lobes: u64, has_map: impl Fn(TextureSlot) -> bool) -> Permutation {
    if lobes & (Permutation::TRANSMISSION | Permutation::DIFFUSE_TRANSMISSION) == 0 {
        lobes &= !Permutation::VOLUME;
    }
    if lobes & Permutation::TRANSMISSION == 0 || lobes & Permutation::VOLUME == 0 {
        lobes &= !Permutation::DISPERSION;
    }
    if lobes == 0 {
        return Permutation::PLAIN;
    }
    let maps = TextureSlot::ALL.into_iter().filter(|&slot| uses_map(lobes, slot) && has_map(slot));
    Permutation(maps.fold(lobes, |bits, slot| bits | Permutation::map_bit(slot)))
}

/// Whether a surface with these lobes reads a map.
fn uses_map(lobes: u64, slot: TextureSlot) -> bool {
    match slot {
        TextureSlot::Specular | TextureSlot::SpecularColor => lobes & Permutation::SPECULAR != 0,
        TextureSlot::Clearcoat | TextureSlot::ClearcoatRoughness | TextureSlot::ClearcoatNormal => {
            lobes & Permutation::CLEARCOAT != 0
        }
        TextureSlot::SheenColor | TextureSlot::SheenRoughness => lobes & Permutation::SHEEN != 0,
        TextureSlot::Iridescence | TextureSlot::IridescenceThickness => lobes & Permutation::IRIDESCENCE != 0,
        TextureSlot::Anisotropy => lobes & Permutation::ANISOTROPY != 0,
        TextureSlot::Transmission => lobes & Permutation::TRANSMISSION != 0,
        TextureSlot::Thickness => lobes & Permutation::VOLUME != 0,
        TextureSlot::DiffuseTransmission | TextureSlot::DiffuseTransmissionColor => {
            lobes & Permutation::DIFFUSE_TRANSMISSION != 0
        }
        TextureSlot::MetallicRoughness | TextureSlot::Occlusion => lobes & Permutation::TOON == 0,
        TextureSlot::ShadeMultiply
        | TextureSlot::ShadingShift
        | TextureSlot::Matcap
        | TextureSlot::RimMultiply
        | TextureSlot::OutlineWidth
        | TextureSlot::UvAnimationMask => lobes & Permutation::TOON != 0,
        TextureSlot::BaseColor | TextureSlot::Normal | TextureSlot::Emissive => true,
    }
}

/// Writes the factors of lobes.
pub(super) fn write_lobes(lobes: &Lobes, uniform: &mut MaterialUniform) {
    let ior = lobes.ior.max(0.0);
    let ratio = (ior - 1.0) / (ior + 1.0);
    let transmittance = lobes.attenuation_color.clamp(Vec3::splat(1e-6), Vec3::ONE);
    let absorption = match lobes.attenuation_distance > 0.0 {
        true => -transmittance.ln() / lobes.attenuation_distance.max(1e-6),
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
    uniform.uv_rotation = toon.uv_rotation;
    uniform.uv_scroll = toon.uv_scroll.to_array();
}
