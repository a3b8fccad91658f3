//! Metallic-roughness materials as defined in glTF 2.0 §3.9. Colours are linear.

use glam::{Vec2, Vec3, Vec4};

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AlphaMode {
    Opaque,
    Mask { cutoff: f32 },
    Blend,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    pub name: String,
    pub base_color: Vec4,
    pub metallic: f32,
    pub roughness: f32,
    /// Includes the factor of KHR_materials_emissive_strength.
    pub emissive: Vec3,
    pub normal_scale: f32,
    pub occlusion_strength: f32,
    pub alpha_mode: AlphaMode,
    pub double_sided: bool,
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
        }
    }
}

/// A texture in a material slot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureRef {
    /// Index into the asset's textures.
    pub texture: usize,
    /// 0 or 1.
    pub uv_set: usize,
    pub uv_transform: UvTransform,
}

/// KHR_texture_transform: `uv' = offset + R(rotation) · scale · uv`, rotation counter-clockwise in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UvTransform {
    pub offset: Vec2,
    pub rotation_radians: f32,
    pub scale: Vec2,
}

impl UvTransform {
    pub const IDENTITY: Self = Self { offset: Vec2::ZERO, rotation_radians: 0.0, scale: Vec2::ONE };
}

/// An image and its sampler.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texture {
    /// Index into the asset's images; none if the file has no image in a supported format.
    pub image: Option<usize>,
    pub sampler: Sampler,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Wrap {
    Repeat,
    ClampToEdge,
    MirroredRepeat,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Filter {
    Nearest,
    Linear,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MipFilter {
    None,
    Nearest,
    Linear,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Sampler {
    pub mag: Filter,
    pub min: Filter,
    pub mip: MipFilter,
    pub wrap_u: Wrap,
    pub wrap_v: Wrap,
}

impl Default for Sampler {
    fn default() -> Self {
        Self {
            mag: Filter::Linear,
            min: Filter::Linear,
            mip: MipFilter::Linear,
            wrap_u: Wrap::Repeat,
            wrap_v: Wrap::Repeat,
        }
    }
}
