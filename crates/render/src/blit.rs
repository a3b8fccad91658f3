//! Copies a finished picture to the screen inside the caller's render pass.

use super::full_screen::{FullScreenPipeline, sampled_texture_group, sampled_texture_layout};
use super::layouts::pipeline_layout;
use super::shaders;

/// Draws a picture over the whole viewport of a pass with one colour target, one sample per pixel and no depth.
///
/// egui's own shader for textures is long; on software adapters it takes as much time as the scene itself.
pub struct Blit {
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    opaque: wgpu::RenderPipeline,
    blended: wgpu::RenderPipeline,
    /// Bind group of the current picture, and whether the picture is opaque.
    current: Option<(wgpu::BindGroup, bool)>,
}

impl Blit {
    /// `target` is the format of the pass's colour target. An sRGB format encodes what is written to it; any other stores it
    /// unchanged.
    pub fn new(device: &wgpu::Device, target: wgpu::TextureFormat) -> Self {
        let layout = sampled_texture_layout(device, "blit");
        let module = shaders::BLIT.module(device);
        let pipeline = |blend| {
            FullScreenPipeline {
                label: "blit",
                module: &module,
                layout: &pipeline_layout(device, "blit", &[Some(&layout)]),
                vertex: "full_viewport",
                fragment: "blit",
                constants: &[("ENCODING_TARGET", f64::from(u8::from(target.is_srgb())))],
                target: wgpu::ColorTargetState { format: target, blend, write_mask: wgpu::ColorWrites::ALL },
            }
            .create(device)
        };
        Self {
            sampler: device.create_sampler(&wgpu::SamplerDescriptor { label: Some("blit"), ..Default::default() }),
            opaque: pipeline(None),
            blended: pipeline(Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING)),
            layout,
            current: None,
        }
    }

    /// Sets the picture to draw: gamma-encoded, with premultiplied alpha. Pass `opaque` if no pixel is transparent.
    pub fn show(&mut self, device: &wgpu::Device, picture: &wgpu::TextureView, opaque: bool) {
        let group = sampled_texture_group(device, "blit", &self.layout, picture, &self.sampler);
        self.current = Some((group, opaque));
    }

    /// Draws the current picture; nothing before the first [`Self::show`].
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some((group, opaque)) = &self.current else { return };
        pass.set_pipeline(if *opaque { &self.opaque } else { &self.blended });
        pass.set_bind_group(0, group, &[]);
        pass.draw(0..3, 0..1);
    }
}
