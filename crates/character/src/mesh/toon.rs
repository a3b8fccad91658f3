//! MToon, the toon shading of avatars (`VRMC_materials_mtoon-1.0`).

use glam::{Vec2, Vec3};

use super::texture::TextureRef;
use crate::anim::{TextureSlot, ToonColor};

/// Number of slots in [`Toon::textures`].
const TEXTURES: usize = TextureSlot::ALL.len() - TextureSlot::ShadeMultiply as usize;

/// The unit of [`Toon::outline_width`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OutlineMode {
    /// No outline.
    #[default]
    None,
    /// Metres.
    World,
    /// Fractions of the viewport's height.
    Screen,
}

/// What MToon adds to a material's base colour, normals and emission. Factors multiply the matching textures; colours
/// are linear RGB.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Toon {
    /// Replaces the base colour where the surface is unlit.
    pub shade_color: Vec3,
    /// Added to the cosine between normal and light; above 0, more of the surface is lit.
    pub shading_shift: f32,
    /// Factor on the texture that is added to [`Self::shading_shift`].
    pub shading_shift_scale: f32,
    /// Sharpness of the boundary between lit and shade colour, from 0 to 1.
    pub shading_toony: f32,
    /// How far ambient light is averaged over all normals, from 0 to 1.
    pub gi_equalization: f32,
    /// Factor on the matcap texture; unused without one.
    pub matcap_color: Vec3,
    /// Added at grazing angles.
    pub rim_color: Vec3,
    /// Exponent of the rim's falloff.
    pub rim_fresnel_power: f32,
    /// Widens the rim.
    pub rim_lift: f32,
    /// How much matcap and rim depend on the light, from 0 to 1.
    pub rim_lighting_mix: f32,
    /// Unit of [`Self::outline_width`].
    pub outline_mode: OutlineMode,
    /// Distance between surface and outline.
    pub outline_width: f32,
    /// Colour of the outline.
    pub outline_color: Vec3,
    /// How much of the surface's shading the outline takes on, from 0 to 1.
    pub outline_lighting_mix: f32,
    /// Speed at which texture coordinates move, in UV units per second.
    pub uv_scroll: Vec2,
    /// Speed at which texture coordinates turn about (0.5, 0.5), in radians per second.
    pub uv_rotation: f32,
    /// Textures by slot, from [`TextureSlot::ShadeMultiply`] on.
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
            uv_scroll: Vec2::ZERO,
            uv_rotation: 0.0,
            textures: [None; TEXTURES],
        }
    }
}

impl Toon {
    /// Returns a colour to change.
    pub fn color_mut(&mut self, color: ToonColor) -> &mut Vec3 {
        match color {
            ToonColor::ShadeColor => &mut self.shade_color,
            ToonColor::MatcapColor => &mut self.matcap_color,
            ToonColor::RimColor => &mut self.rim_color,
            ToonColor::OutlineColor => &mut self.outline_color,
        }
    }

    /// Returns the texture in a slot; `None` for slots that don't belong to MToon.
    pub fn texture(&self, slot: TextureSlot) -> Option<TextureRef> {
        let index = (slot as usize).checked_sub(TextureSlot::ShadeMultiply as usize)?;
        *self.textures.get(index)?
    }

    /// Returns the texture in a slot; `None` for slots that don't belong to MToon.
    pub fn texture_mut(&mut self, slot: TextureSlot) -> Option<&mut Option<TextureRef>> {
        let index = (slot as usize).checked_sub(TextureSlot::ShadeMultiply as usize)?;
        self.textures.get_mut(index)
    }

    /// Whether it draws an outline.
    pub fn has_outline(&self) -> bool {
        self.outline_mode != OutlineMode::None && self.outline_width > 0.0
    }
}
