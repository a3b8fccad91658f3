//! Textures of materials: image, sampler, and how texture coordinates are transformed (glTF 2.0 §3.8).

use glam::Vec2;

/// A texture in a material slot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureRef {
    /// Index into the asset's textures.
    pub texture: usize,
    /// 0 or 1.
    pub uv_set: usize,
    /// Identity if the file has none.
    pub uv_transform: UvTransform,
}

/// KHR_texture_transform: `uv' = offset + R(rotation) · scale · uv`, rotation counter-clockwise in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UvTransform {
    /// In UV units: 1 is the width or height of the image.
    pub offset: Vec2,
    /// Counter-clockwise.
    pub rotation_radians: f32,
    /// Per axis, applied before rotation.
    pub scale: Vec2,
}

impl UvTransform {
    /// Leaves texture coordinates unchanged.
    pub const IDENTITY: Self = Self { offset: Vec2::ZERO, rotation_radians: 0.0, scale: Vec2::ONE };
}

/// An image and its sampler.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texture {
    /// Index into the asset's images; none if the file has no image in a supported format.
    pub image: Option<usize>,
    /// Filtering and wrapping; the default if the file has no sampler.
    pub sampler: Sampler,
}

/// How texture coordinates outside 0 to 1 are wrapped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// Tiles.
    Repeat,
    /// Extends the texels at the edge.
    ClampToEdge,
    /// Tiles, mirroring every other copy.
    MirroredRepeat,
}

/// How texels of one mip level are filtered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Filter {
    /// The nearest texel.
    Nearest,
    /// Bilinear.
    Linear,
}

/// How mip levels are combined, the second half of `minFilter` in glTF.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MipFilter {
    /// Only the largest level is used.
    None,
    /// The nearest level.
    Nearest,
    /// Blends the two nearest levels.
    Linear,
}

/// How a texture is filtered and wrapped; linear with mipmaps and repeating by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Sampler {
    /// Magnification filter.
    pub mag: Filter,
    /// Minification filter within a mip level.
    pub min: Filter,
    /// Minification filter between mip levels.
    pub mip: MipFilter,
    /// Wrapping of U, `wrapS` in glTF.
    pub wrap_u: Wrap,
    /// Wrapping of V, `wrapT` in glTF.
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
