//! Small opaque copies of a model's images for the panels, gamma-encoded.

use super::full_screen::{FullScreenPipeline, draw_full_screen, sampled_texture_group, sampled_texture_layout};
use super::layouts::pipeline_layout;
use super::shaders;

/// Width and height in pixels.
const SIZE: u32 = 64;
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Draws thumbnails of images, given with whether sampling decodes them from sRGB.
pub(super) fn thumbnails<'a>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    images: impl Iterator<Item = Option<(&'a wgpu::TextureView, bool)>>,
) -> Vec<Option<wgpu::TextureView>> {
    let layout = sampled_texture_layout(device, "thumbnails");
    let module = shaders::MIPS.module(device);
    let pipelines = [0.0, 1.0].map(|encode| {
        FullScreenPipeline {
            label: "thumbnails",
            module: &module,
            layout: &pipeline_layout(device, "thumbnails", &[Some(&layout)]),
            vertex: "full_screen",
            fragment: "thumbnail",
            constants: &[("ENCODE", encode)],
            target: FORMAT.into(),
        }
        .create(device)
    });
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("thumbnails"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("thumbnails") });
    let mut draw = |(image, is_srgb): (&wgpu::TextureView, bool)| {
        let target = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("thumbnail"),
            size: wgpu::Extent3d { width: SIZE, height: SIZE, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            // Read back by tests.
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = target.create_view(&Default::default());
        let group = sampled_texture_group(device, "thumbnail", &layout, image, &sampler);
        draw_full_screen(&mut encoder, "thumbnail", &view, &pipelines[usize::from(is_srgb)], &group);
        view
    };
    let views = images.map(|image| image.map(&mut draw)).collect();
    queue.submit([encoder.finish()]);
    views
}
