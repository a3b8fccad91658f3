//! Light from all around: an environment prefiltered by roughness into a small cube map, with diffuse light as nine spherical
//! harmonics, and the table of how much of it a surface reflects. All of it is computed on the CPU in a few milliseconds:
//! floating-point render targets are optional on WebGL2, and compiling shaders for it would take longer.

mod cube;
mod reflectance;
mod setups;

use glam::Vec3;

use self::cube::Cube;
pub(super) use self::setups::KeyLight;
use self::setups::Surroundings;
use crate::state::LightSetup;

/// Edge length of the sharpest level in texels.
const SIZE: usize = 128;

pub(super) struct Environment {
    pub setup: LightSetup,
    pub view: wgpu::TextureView,
    /// Irradiance coefficients divided by π, in the order of light.wgsl.
    pub irradiance: [[f32; 4]; 9],
    /// Index of the roughest level of the cube map.
    pub last_level: u32,
    pub key: KeyLight,
}

impl Environment {
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, setup: LightSetup) -> Self {
        let surroundings = Surroundings::of(setup);
        let cube = Cube::new(SIZE, |direction| surroundings.radiance(direction));
        let levels = cube.filtered(1);
        Self {
            setup,
            view: upload(device, queue, &levels),
            irradiance: cube.irradiance(),
            last_level: levels.len() as u32 - 1,
            key: surroundings.key,
        }
    }
}

/// Filters between texels and levels, and clamps to the edges.
pub(super) fn sampler(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("environment"),
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
        let texels: Vec<[u16; 4]> =
            colors.iter().map(|color| color.extend(1.0).to_array().map(half_from_float)).collect();
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
