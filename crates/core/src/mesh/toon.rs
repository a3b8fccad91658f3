//! MToon, the toon shading of avatars (`VRMC_materials_mtoon-1.0`). Colours are linear.

use glam::Vec3;

use super::TextureRef;
use crate::anim::{TextureSlot, ToonColor};

/// Number of slots in [`Toon::textures`].
const TEXTURES: usize = TextureSlot::ALL.len() - TextureSlot::ShadeMultiply as usize;

/// What [`Toon::outline_width`] is measured in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OutlineMode {
    /// There is no outline.
    #[default]
    None,
    /// Metres.
    World,
    /// The height of the picture.
    Screen,
}

/// What MToon adds to a material's base colour, normals and emission. Factors are multiplied with the matching textures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Toon {
    /// Replaces the base colour where a light doesn't reach.
    pub shade_color: Vec3,
    /// Added to the cosine between normal and light, so that more of the surface is lit.
    pub shading_shift: f32,
    /// Factor on the texture that is added to [`Self::shading_shift`].
    pub shading_shift_scale: f32,
    /// How sharp the boundary between the colours is, from 0 to 1.
    pub shading_toony: f32,
    /// How little the light of the environment depends on the normal, from 0 to 1.
    pub gi_equalization: f32,
    /// Factor on the matcap texture, without which it has no effect.
    pub matcap_color: Vec3,
    /// Added towards grazing angles.
    pub rim_color: Vec3,
    /// Exponent of the rim's falloff.
    pub rim_fresnel_power: f32,
    /// Widens the rim.
    pub rim_lift: f32,
    /// How much matcap and rim depend on the light, from 0 to 1.
    pub rim_lighting_mix: f32,
    /// What [`Self::outline_width`] is measured in.
    pub outline_mode: OutlineMode,
    /// Distance between surface and outline.
    pub outline_width: f32,
    /// Colour of the outline.
    pub outline_color: Vec3,
    /// How much the outline takes on the shaded colour, from 0 to 1.
    pub outline_lighting_mix: f32,
    /// By slot, from [`TextureSlot::ShadeMultiply`] on.
    pub textures: [Option<TextureRef>; TEXTURES],
}

impl Default for Toon {
    /// The defaults of the specification.
    fn default() -> Self {
        Self {
            shade_color: Vec3::ZERO,
            shading_shift: 0.0,
            shading_shift_scale: 1.0,
            shading_toony: 0.9,
            gi_equalization: 0.9,
            matcap_color: Vec3::ONE,
            rim_color: Vec3::ZERO,
            rim_fresnel_power: 5.0,
            rim_lift: 0.0,
            rim_lighting_mix: 1.0,
            outline_mode: OutlineMode::None,
            outline_width: 0.0,
            outline_color: Vec3::ZERO,
            outline_lighting_mix: 1.0,
            textures: [None; TEXTURES],
        }
    }
}

impl Toon {
    /// The place of a colour.
    pub fn color_mut(&mut self, color: ToonColor) -> &mut Vec3 {
        match color {
            ToonColor::ShadeColor => &mut self.shade_color,
            ToonColor::MatcapColor => &mut self.matcap_color,
            ToonColor::RimColor => &mut self.rim_color,
            ToonColor::OutlineColor => &mut self.outline_color,
        }
    }

    /// Returns the texture in a slot of MToon; `None` for the others.
    pub fn texture(&self, slot: TextureSlot) -> Option<TextureRef> {
        let index = (slot as usize).checked_sub(TextureSlot::ShadeMultiply as usize)?;
        *self.textures.get(index)?
    }

    /// The place of a texture; `None` for slots that are not those of MToon.
    pub fn texture_mut(&mut self, slot: TextureSlot) -> Option<&mut Option<TextureRef>> {
        let index = (slot as usize).checked_sub(TextureSlot::ShadeMultiply as usize)?;
        self.textures.get_mut(index)
    }

    /// Whether there is an outline to draw.
    pub fn has_outline(&self) -> bool {
        self.outline_mode != OutlineMode::None && self.outline_width > 0.0
    }
}
