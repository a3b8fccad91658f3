//! The optional lobes of a material: glTF's extensions of the metallic-roughness model.

use std::slice;

use glam::Vec3;

use super::texture::TextureRef;
use crate::anim::{LobeFactor, TextureSlot};

/// Number of slots in [`Lobes::textures`].
const TEXTURES: usize = TextureSlot::ShadeMultiply as usize - TextureSlot::Specular as usize;

/// What a material has beyond metallic-roughness. The default changes nothing. Factors multiply the matching textures;
/// colours are linear RGB.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lobes {
    /// Index of refraction (KHR_materials_ior); 0 means total reflection at all angles.
    pub ior: f32,
    /// Weight of the dielectric reflection (KHR_materials_specular), from 0 to 1.
    pub specular: f32,
    /// Colour of the dielectric reflection at normal incidence; may exceed 1.
    pub specular_color: Vec3,
    /// Whether the alpha of the specular colour texture is glossiness, a factor on 1 − roughness. Set for materials
    /// converted from KHR_materials_pbrSpecularGlossiness.
    pub glossiness_in_specular_color: bool,
    /// Weight of the clearcoat (KHR_materials_clearcoat), from 0 to 1.
    pub clearcoat: f32,
    /// Perceptual roughness of the clearcoat.
    pub clearcoat_roughness: f32,
    /// Scale of X and Y of the clearcoat normal texture.
    pub clearcoat_normal_scale: f32,
    /// Colour of the sheen (KHR_materials_sheen); black for none.
    pub sheen_color: Vec3,
    /// Perceptual roughness of the sheen.
    pub sheen_roughness: f32,
    /// Weight of the thin film (KHR_materials_iridescence), from 0 to 1.
    pub iridescence: f32,
    /// Index of refraction of the thin film.
    pub iridescence_ior: f32,
    /// Thickness of the film in nanometres where its texture is 0.
    pub iridescence_thickness_min: f32,
    /// Thickness of the film in nanometres where its texture is 1, or without a texture.
    pub iridescence_thickness_max: f32,
    /// How much highlights are stretched (KHR_materials_anisotropy), from 0 to 1.
    pub anisotropy: f32,
    /// Direction in which highlights are stretched: radians, counter-clockwise from the tangent.
    pub anisotropy_rotation: f32,
    /// Fraction of light that passes through (KHR_materials_transmission), from 0 to 1.
    pub transmission: f32,
    /// Thickness of the volume below the surface, in the mesh's units (KHR_materials_volume); 0 for thin walls.
    pub thickness: f32,
    /// Distance in metres at which white light has become [`Self::attenuation_color`]; infinite for a clear volume.
    pub attenuation_distance: f32,
    /// Colour of white light after [`Self::attenuation_distance`].
    pub attenuation_color: Vec3,
    /// 20 divided by the Abbe number (KHR_materials_dispersion); 0 for none.
    pub dispersion: f32,
    /// Fraction of diffuse light that passes through (KHR_materials_diffuse_transmission), from 0 to 1.
    pub diffuse_transmission: f32,
    /// Colour of diffusely transmitted light.
    pub diffuse_transmission_color: Vec3,
    /// Textures by slot, from [`TextureSlot::Specular`] on.
    pub textures: [Option<TextureRef>; TEXTURES],
}

impl Default for Lobes {
    fn default() -> Self {
        Self {
            ior: 1.5,
            specular: 1.0,
            specular_color: Vec3::ONE,
            glossiness_in_specular_color: false,
            clearcoat: 0.0,
            clearcoat_roughness: 0.0,
            clearcoat_normal_scale: 1.0,
            sheen_color: Vec3::ZERO,
            sheen_roughness: 0.0,
            iridescence: 0.0,
            iridescence_ior: 1.3,
            iridescence_thickness_min: 100.0,
            iridescence_thickness_max: 400.0,
            anisotropy: 0.0,
            anisotropy_rotation: 0.0,
            transmission: 0.0,
            thickness: 0.0,
            attenuation_distance: f32::INFINITY,
            attenuation_color: Vec3::ONE,
            dispersion: 0.0,
            diffuse_transmission: 0.0,
            diffuse_transmission_color: Vec3::ONE,
            textures: [None; TEXTURES],
        }
    }
}

fn components(color: &mut Vec3) -> &mut [f32] {
    AsMut::<[f32; 3]>::as_mut(color)
}

impl Lobes {
    /// Returns the extensions, each with whether it changes anything at rest.
    pub(super) fn extensions(&self) -> [(&'static str, bool); 9] {
        let has = |slots: &[TextureSlot]| slots.iter().any(|&slot| self.texture(slot).is_some());
        let is_specular = self.specular != 1.0
            || self.specular_color != Vec3::ONE
            || has(&[TextureSlot::Specular, TextureSlot::SpecularColor]);
        [
            ("KHR_materials_ior", self.ior != Self::default().ior),
            ("KHR_materials_specular", is_specular),
            ("KHR_materials_clearcoat", self.clearcoat > 0.0),
            ("KHR_materials_sheen", self.sheen_color.max_element() > 0.0),
            ("KHR_materials_iridescence", self.iridescence > 0.0),
            ("KHR_materials_anisotropy", self.anisotropy > 0.0),
            ("KHR_materials_transmission", self.transmission > 0.0),
            ("KHR_materials_volume", self.thickness > 0.0),
            ("KHR_materials_diffuse_transmission", self.diffuse_transmission > 0.0),
        ]
    }

    /// Returns the components of a factor, [`LobeFactor::width`] of them.
    pub fn factor_mut(&mut self, factor: LobeFactor) -> &mut [f32] {
        slice::from_mut(match factor {
            LobeFactor::Ior => &mut self.ior,
            LobeFactor::Specular => &mut self.specular,
            LobeFactor::SpecularColor => return components(&mut self.specular_color),
            LobeFactor::Clearcoat => &mut self.clearcoat,
            LobeFactor::ClearcoatRoughness => &mut self.clearcoat_roughness,
            LobeFactor::ClearcoatNormalScale => &mut self.clearcoat_normal_scale,
            LobeFactor::SheenColor => return components(&mut self.sheen_color),
            LobeFactor::SheenRoughness => &mut self.sheen_roughness,
            LobeFactor::Iridescence => &mut self.iridescence,
            LobeFactor::IridescenceIor => &mut self.iridescence_ior,
            LobeFactor::IridescenceThicknessMin => &mut self.iridescence_thickness_min,
            LobeFactor::IridescenceThicknessMax => &mut self.iridescence_thickness_max,
            LobeFactor::Anisotropy => &mut self.anisotropy,
            LobeFactor::AnisotropyRotation => &mut self.anisotropy_rotation,
            LobeFactor::Transmission => &mut self.transmission,
            LobeFactor::Thickness => &mut self.thickness,
            LobeFactor::AttenuationDistance => &mut self.attenuation_distance,
            LobeFactor::AttenuationColor => return components(&mut self.attenuation_color),
            LobeFactor::Dispersion => &mut self.dispersion,
            LobeFactor::DiffuseTransmission => &mut self.diffuse_transmission,
            LobeFactor::DiffuseTransmissionColor => return components(&mut self.diffuse_transmission_color),
        })
    }

    /// Returns the texture in a slot; `None` for slots that don't belong to lobes.
    pub fn texture(&self, slot: TextureSlot) -> Option<TextureRef> {
        let index = (slot as usize).checked_sub(TextureSlot::Specular as usize)?;
        *self.textures.get(index)?
    }

    /// Returns the texture in a slot; `None` for slots that don't belong to lobes.
    pub fn texture_mut(&mut self, slot: TextureSlot) -> Option<&mut Option<TextureRef>> {
        let index = (slot as usize).checked_sub(TextureSlot::Specular as usize)?;
        self.textures.get_mut(index)
    }
}
