//! Progressive refinement of a picture drawn with one sample per pixel: draws the whole scene again, shifted by a
//! fraction of a pixel, and accumulates the average.
//!
//! On software adapters four samples per pixel take twice as long, so a changing view has one. Once it has been still for a
//! moment, the other samples follow, one per frame; then nothing is drawn. Saved images and videos have all of them at once.

use super::full_screen::{FullScreenPipeline, sampled_texture_group, sampled_texture_layout};
use super::layouts::pipeline_layout;
use super::shaders;
use super::targets::SCENE_FORMAT;

/// Sample positions in pixels relative to the pixel's centre, which is their mean. An unrefined picture has only the
/// first.
pub(super) const SAMPLE_OFFSETS: [[f32; 2]; 4] = [[0.0, 0.0], [0.375, -0.125], [-0.125, 0.375], [-0.25, -0.25]];

/// Accumulates samples in a picture.
pub(super) struct Accumulator {
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    pipeline: wgpu::RenderPipeline,
}

impl Accumulator {
    pub fn new(device: &wgpu::Device) -> Self {
        let layout = sampled_texture_layout(device, "accumulate");
        let module = shaders::BLIT.module(device);
        let mix = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::Constant,
            dst_factor: wgpu::BlendFactor::OneMinusConstant,
            operation: wgpu::BlendOperation::Add,
        };
        let pipeline = FullScreenPipeline {
            label: "accumulate",
            module: &module,
            layout: &pipeline_layout(device, "accumulate", &[Some(&layout)]),
            vertex: "full_viewport",
            fragment: "blit",
            constants: &[],
            target: wgpu::ColorTargetState {
                format: SCENE_FORMAT,
                blend: Some(wgpu::BlendState { color: mix, alpha: mix }),
                write_mask: wgpu::ColorWrites::ALL,
            },
        }
        .create(device);
        let sampler =
            device.create_sampler(&wgpu::SamplerDescriptor { label: Some("accumulate"), ..Default::default() });
        Self { layout, sampler, pipeline }
    }

    /// Binds the texture that a sample is drawn into.
    pub fn bind(&self, device: &wgpu::Device, sample: &wgpu::TextureView) -> wgpu::BindGroup {
        sampled_texture_group(device, "accumulate", &self.layout, sample, &self.sampler)
    }

    /// Blends a sample into the picture with a weight from 0 to 1.
    pub fn add(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sample: &wgpu::BindGroup,
        picture: &wgpu::TextureView,
        weight: f64,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("accumulate"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: picture,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_blend_constant(wgpu::Color { r: weight, g: weight, b: weight, a: weight });
        pass.set_bind_group(0, sample, &[]);
        pass.draw(0..3, 0..1);
    }
}
