//! Metallic-roughness materials as defined in glTF 2.0 §3.9. Colours are linear.

use glam::{Vec3, Vec4, Vec4Swizzles};

use super::lobes::Lobes;
use super::texture::{TextureRef, UvTransform};
use super::toon::Toon;
use crate::anim::{MaterialProperty, TextureSlot};

/// How alpha is interpreted, `alphaMode` in glTF.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    Opaque,
    /// Fully opaque where alpha reaches the cutoff, invisible elsewhere.
    Mask {
        /// `alphaCutoff` in glTF, 0.5 by default.
        cutoff: f32,
    },
    /// Blended over what is behind it.
    Blend,
}

/// A metallic-roughness material. Factors are multiplied with the matching textures.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// The name in the file; may be empty.
    pub name: String,
    /// Linear RGBA, also multiplied with the vertex colours.
    pub base_color: Vec4,
    /// 0 for dielectrics, 1 for metals.
    pub metallic: f32,
    /// Perceptual roughness, from 0 (smooth) to 1.
    pub roughness: f32,
    /// Linear RGB, not yet multiplied by [`Self::emissive_strength`].
    pub emissive: Vec3,
    /// Factor on [`Self::emissive`] (KHR_materials_emissive_strength); 1 by default.
    pub emissive_strength: f32,
    /// Multiplies X and Y of the normal texture.
    pub normal_scale: f32,
    /// How much the occlusion texture darkens, from 0 (not at all) to 1.
    pub occlusion_strength: f32,
    /// How alpha is interpreted.
    pub alpha_mode: AlphaMode,
    /// Whether back faces are drawn.
    pub double_sided: bool,
    /// Whether base colour is shown without lighting (KHR_materials_unlit).
    pub unlit: bool,
    /// sRGB.
    pub base_color_texture: Option<TextureRef>,
    /// Linear: roughness in green, metallic in blue.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Linear.
    pub normal_texture: Option<TextureRef>,
    /// Linear: occlusion in red.
    pub occlusion_texture: Option<TextureRef>,
    /// sRGB.
    pub emissive_texture: Option<TextureRef>,
    /// Clearcoat, sheen, transmission and so on; `None` for plain metallic-roughness.
    pub lobes: Option<Box<Lobes>>,
    /// MToon shading, which has no lobes, metalness, roughness, occlusion or vertex colours.
    pub toon: Option<Box<Toon>>,
}

impl Default for Material {
    /// glTF's default material.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Vec4::ONE,
            metallic: 1.0,
            roughness: 1.0,
            emissive: Vec3::ZERO,
            emissive_strength: 1.0,
            normal_scale: 1.0,
            occlusion_strength: 1.0,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
            unlit: false,
            base_color_texture: None,
            metallic_roughness_texture: None,
            normal_texture: None,
            occlusion_texture: None,
            emissive_texture: None,
            lobes: None,
            toon: None,
        }
    }
}

impl Material {
    /// Copies everything but the name. Allocates only if `other` has lobes or MToon and this does not.
    pub fn copy_values(&mut self, other: &Self) {
        let (name, mut lobes, mut toon) = (std::mem::take(&mut self.name), self.lobes.take(), self.toon.take());
        lobes.clone_from(&other.lobes);
        toon.clone_from(&other.toon);
        *self = Self { name, lobes, toon, ..*other };
    }

    /// Sets an animated property. Ignored if the material lacks what it belongs to: the alpha mask, a texture, lobes or
    /// MToon.
    pub fn set(&mut self, property: MaterialProperty, value: Vec4) {
        match property {
            MaterialProperty::BaseColor => self.base_color = value,
            MaterialProperty::Metallic => self.metallic = value.x,
            MaterialProperty::Roughness => self.roughness = value.x,
            MaterialProperty::Emissive => self.emissive = value.xyz(),
            MaterialProperty::EmissiveStrength => self.emissive_strength = value.x,
            MaterialProperty::AlphaCutoff => {
                if let AlphaMode::Mask { cutoff } = &mut self.alpha_mode {
                    *cutoff = value.x;
                }
            }
            MaterialProperty::NormalScale => self.normal_scale = value.x,
            MaterialProperty::OcclusionStrength => self.occlusion_strength = value.x,
            MaterialProperty::UvOffset(slot) => self.change_uvs(slot, |uvs| uvs.offset = value.xy()),
            MaterialProperty::UvRotation(slot) => self.change_uvs(slot, |uvs| uvs.rotation_radians = value.x),
            MaterialProperty::UvScale(slot) => self.change_uvs(slot, |uvs| uvs.scale = value.xy()),
            MaterialProperty::Lobe(factor) => {
                if let Some(lobes) = &mut self.lobes {
                    let components = lobes.factor_mut(factor);
                    components.copy_from_slice(&value.to_array()[..components.len()]);
                }
            }
            MaterialProperty::Toon(color) => {
                if let Some(toon) = &mut self.toon {
                    *toon.color_mut(color) = value.xyz();
                }
            }
        }
    }

    /// Switches to MToon shading and drops everything that MToon doesn't use.
    pub fn shade_as_toon(&mut self, toon: Toon) {
        self.toon = Some(Box::new(toon));
        self.lobes = None;
        self.unlit = false;
        self.metallic_roughness_texture = None;
        self.occlusion_texture = None;
    }

    /// Returns the names of the extensions that have an effect on the material, as glTF writes them.
    pub fn extensions(&self) -> Vec<&'static str> {
        let mut textures = TextureSlot::ALL.into_iter().filter_map(|slot| self.texture(slot));
        let is_transformed = textures.any(|texture| texture.uv_transform != UvTransform::IDENTITY);
        let of_material = [
            ("KHR_materials_unlit", self.unlit),
            ("VRMC_materials_mtoon", self.toon.is_some()),
            ("KHR_materials_emissive_strength", self.emissive_strength != 1.0),
            ("KHR_texture_transform", is_transformed),
        ];
        let of_lobes = self.lobes.as_ref().map(|lobes| lobes.extensions());
        of_material
            .into_iter()
            .chain(of_lobes.into_iter().flatten())
            .filter_map(|(name, has_effect)| has_effect.then_some(name))
            .collect()
    }

    /// Returns the texture in a slot.
    pub fn texture(&self, slot: TextureSlot) -> Option<TextureRef> {
        match slot {
            TextureSlot::BaseColor => self.base_color_texture,
            TextureSlot::MetallicRoughness => self.metallic_roughness_texture,
            TextureSlot::Normal => self.normal_texture,
            TextureSlot::Occlusion => self.occlusion_texture,
            TextureSlot::Emissive => self.emissive_texture,
            _ if slot >= TextureSlot::ShadeMultiply => self.toon.as_ref()?.texture(slot),
            _ => self.lobes.as_ref()?.texture(slot),
        }
    }

    /// Returns the UV set that tangents are computed from; `None` if nothing needs tangents.
    pub fn tangent_uv_set(&self) -> Option<usize> {
        let slots = [TextureSlot::Normal, TextureSlot::ClearcoatNormal, TextureSlot::Anisotropy];
        let texture = slots.into_iter().find_map(|slot| self.texture(slot));
        let is_anisotropic = || self.lobes.as_ref().is_some_and(|lobes| lobes.anisotropy > 0.0);
        texture.map(|texture| texture.uv_set).or_else(|| is_anisotropic().then_some(0))
    }

    /// Sets the texture in a slot. Ignored if the material lacks the lobes or the MToon that the slot belongs to.
    pub fn set_texture(&mut self, slot: TextureSlot, texture: Option<TextureRef>) {
        if let Some(place) = self.texture_mut(slot) {
            *place = texture;
        }
    }

    /// Returns the texture in a slot; `None` if the material lacks the lobes or the MToon that the slot belongs to.
    pub fn texture_mut(&mut self, slot: TextureSlot) -> Option<&mut Option<TextureRef>> {
        Some(match slot {
            TextureSlot::BaseColor => &mut self.base_color_texture,
            TextureSlot::MetallicRoughness => &mut self.metallic_roughness_texture,
            TextureSlot::Normal => &mut self.normal_texture,
            TextureSlot::Occlusion => &mut self.occlusion_texture,
            TextureSlot::Emissive => &mut self.emissive_texture,
            _ if slot >= TextureSlot::ShadeMultiply => self.toon.as_mut()?.texture_mut(slot)?,
            _ => self.lobes.as_mut()?.texture_mut(slot)?,
        })
    }

    fn change_uvs(&mut self, slot: TextureSlot, change: impl FnOnce(&mut UvTransform)) {
        if let Some(Some(texture)) = self.texture_mut(slot) {
            change(&mut texture.uv_transform);
        }
    }
}
