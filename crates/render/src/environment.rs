//! Image-based lighting: a small cube map of the environment prefiltered by roughness, another of its irradiance, and
//! the table of how much of it a surface reflects. All are computed on the CPU, in milliseconds for a set-up and
//! noticeably longer for an image: floating-point render targets are optional on WebGL2, and compiling shaders would
//! take longer.

mod cube;
mod reflectance;
mod setups;

use std::sync::Arc;

use gaitway_character::asset::Panorama;
use gaitway_scene::frame::Frame;
use gaitway_scene::state::LightSetup;
use glam::Vec3;

use self::cube::Cube;
pub(super) use self::setups::DirectionalLight;
use self::setups::Surroundings;

/// Edge length of the sharpest level in texels, of set-ups and of images.
const SIZES: [usize; 2] = [128, 256];
/// Width and height in pixels of the panorama of a set-up.
const SETUP_PANORAMA: [usize; 2] = [1024, 512];
/// More samples than set-ups need: images have small bright spots, and nobody waits for a first picture.
const IMAGE_QUALITY: usize = 12;

/// What an environment is made from.
#[derive(Clone)]
pub(super) enum Source {
    /// No light, until the first picture chooses one.
    Dark,
    Setup(LightSetup),
    Image(Arc<Panorama>),
}

impl Source {
    pub fn of(frame: &Frame) -> Self {
        frame.panorama.clone().map_or(Self::Setup(frame.look.light), Self::Image)
    }
}

impl PartialEq for Source {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Dark, Self::Dark) => true,
            (Self::Setup(a), Self::Setup(b)) => a == b,
            (Self::Image(a), Self::Image(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

pub(super) struct Environment {
    pub source: Source,
    pub view: wgpu::TextureView,
    /// Cube map of the radiance that a white diffuse surface reflects, by its normal.
    pub irradiance: wgpu::TextureView,
    /// Index of the roughest level of the cube map.
    pub last_level: u32,
    pub key: DirectionalLight,
}

impl Environment {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, source: Source) -> Self {
        let (cube, quality, key) = match &source {
            Source::Dark => (Cube::new(4, |_| Vec3::ZERO), 1, None),
            Source::Setup(setup) => {
                let surroundings = Surroundings::of(*setup);
                (Cube::new(SIZES[0], |direction| surroundings.radiance(direction)), 1, Some(surroundings.key))
            }
            Source::Image(image) => {
                // Averages over four points a texel.
                let cube = Cube::new(2 * SIZES[1], |direction| image.radiance(direction)).halved();
                (cube, IMAGE_QUALITY, None)
            }
        };
        let levels = cube.filtered(quality);
        let key = key.unwrap_or_else(|| shadow_only(cube.mean_direction()));
        let irradiance = upload(device, queue, &[cube.irradiance()]);
        Self { source, view: upload(device, queue, &levels), irradiance, last_level: levels.len() as u32 - 1, key }
    }

    /// Draws the environment from a panorama, for a sharp background.
    pub fn panorama(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> wgpu::TextureView {
        match &self.source {
            Source::Dark => upload_panorama(device, queue, 1, &[Vec3::ZERO]),
            Source::Image(image) => upload_panorama(device, queue, image.width(), image.pixels()),
            Source::Setup(setup) => {
                let surroundings = Surroundings::of(*setup);
                let [width, height] = SETUP_PANORAMA;
                let directions =
                    (0..width * height).map(|at| panorama_direction(at % width, at / width, SETUP_PANORAMA));
                let pixels: Vec<Vec3> = directions.map(|direction| surroundings.radiance(direction)).collect();
                upload_panorama(device, queue, width, &pixels)
            }
        }
    }
}

/// An image contains its lights, so it has no key light. The shadow falls away from the mean direction of its light.
fn shadow_only(mean_direction: Vec3) -> DirectionalLight {
    // For uniform light, the mean direction is only rounding errors.
    let Vec3 { x, y, z } = if mean_direction.length() < 1e-3 { Vec3::Y } else { mean_direction };
    let direction = Vec3::new(x, 0.0, z).normalize_or_zero() + Vec3::Y * (y / x.hypot(z).max(1e-6)).clamp(0.7, 3.0);
    DirectionalLight { direction: direction.normalize_or(Vec3::Y), color: Vec3::ZERO }
}

/// Inverts [`Panorama::radiance`]'s mapping for the center of a pixel.
fn panorama_direction(x: usize, y: usize, [width, height]: [usize; 2]) -> Vec3 {
    let turn = ((x as f32 + 0.5) / width as f32 - 0.5) * std::f32::consts::TAU;
    let (sin, cos) = ((y as f32 + 0.5) / height as f32 * std::f32::consts::PI).sin_cos();
    Vec3::new(sin * turn.cos(), cos, sin * turn.sin())
}

fn upload_panorama(device: &wgpu::Device, queue: &wgpu::Queue, width: usize, pixels: &[Vec3]) -> wgpu::TextureView {
    let (width, height) = (width as u32, (pixels.len() / width) as u32);
    let extent = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("panorama"),
        size: extent,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let texels: Vec<[u16; 4]> = pixels.iter().map(|&color| half_texel(color)).collect();
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(8 * width), rows_per_image: Some(height) };
    queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&texels), layout, extent);
    texture.create_view(&Default::default())
}

fn half_texel(color: Vec3) -> [u16; 4] {
    color.extend(1.0).to_array().map(half_from_float)
}

/// Filters between texels and levels. Repeats in U, so that panoramas have no seam, and clamps in V.
pub(super) fn sampler(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("environment"),
        address_mode_u: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}

/// The table of light.wgsl's `directional_albedo`.
pub(super) fn reflectance_table(device: &wgpu::Device, queue: &wgpu::Queue) -> wgpu::TextureView {
    let size = reflectance::SIZE as u32;
    let extent = wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("reflectance"),
        size: extent,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rg16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let texels: Vec<[u16; 2]> = reflectance::table().into_iter().map(|texel| texel.map(half_from_float)).collect();
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * size), rows_per_image: Some(size) };
    queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&texels), layout, extent);
    texture.create_view(&Default::default())
}

/// Each level has its edge length and its texels, face by face.
fn upload(device: &wgpu::Device, queue: &wgpu::Queue, levels: &[(usize, Vec<Vec3>)]) -> wgpu::TextureView {
    let extent = |size| wgpu::Extent3d { width: size, height: size, depth_or_array_layers: 6 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("environment"),
        size: extent(levels[0].0 as u32),
        mip_level_count: levels.len() as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (level, (size, colors)) in levels.iter().enumerate() {
        let size = *size as u32;
        let texels: Vec<[u16; 4]> = colors.iter().map(|&color| half_texel(color)).collect();
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(8 * size), rows_per_image: Some(size) };
        let target = wgpu::TexelCopyTextureInfo { mip_level: level as u32, ..texture.as_image_copy() };
        queue.write_texture(target, bytemuck::cast_slice(&texels), layout, extent(size));
    }
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::Cube),
        ..Default::default()
    })
}

/// Converts a finite number from 0 to 65,504 to half-precision bits, flushing subnormals to 0.
fn half_from_float(value: f32) -> u16 {
    let bits = value.clamp(0.0, 65_504.0).to_bits() + 0x1000;
    let exponent = (bits >> 23) as i32 - 127 + 15;
    if exponent <= 0 { 0 } else { ((exponent as u16) << 10) | ((bits >> 13) & 0x3ff) as u16 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_floats_keep_eleven_bits() {
        for (value, bits) in [(0.0, 0), (1.0, 0x3c00), (0.5, 0x3800), (2.0, 0x4000), (1.5, 0x3e00), (65_504.0, 0x7bff)]
        {
            assert_eq!(half_from_float(value), bits, "{value}");
        }
    }
}
