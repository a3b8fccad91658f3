//! The transmission buffer: a copy of everything opaque, which transmissive surfaces refract. Rough ones read its mip
//! levels.
//!
//! The scene pass ends before transmissive surfaces, and another one draws the rest. The copy is already tone-mapped, so the
//! shader inverts the tone mapping: what is seen through clear glass looks the same as beside it.

use super::full_screen::{FullScreenPipeline, draw_full_screen, sampled_texture_group, sampled_texture_layout};
use super::layouts::pipeline_layout;
use super::shaders::{self, Shader};

/// sRGB, so that mip levels average linear light.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

const LABEL: &str = "transmission";

/// Creates and fills transmission buffers.
pub(super) struct TransmissionPass {
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    copy: wgpu::RenderPipeline,
    halve: wgpu::RenderPipeline,
}

/// A texture as large as the image, with all its mip levels.
pub(super) struct TransmissionBuffer {
    pub view: wgpu::TextureView,
    /// The source and the target of each mip level.
    levels: Vec<(wgpu::BindGroup, wgpu::TextureView)>,
}

impl TransmissionPass {
    pub fn new(device: &wgpu::Device) -> Self {
        let layout = sampled_texture_layout(device, LABEL);
        let pipeline_layout = pipeline_layout(device, LABEL, &[Some(&layout)]);
        let pipeline = |shader: &Shader, vertex, fragment, constants| {
            FullScreenPipeline {
                label: LABEL,
                module: &shader.module(device),
                layout: &pipeline_layout,
                vertex,
                fragment,
                constants,
                target: FORMAT.into(),
            }
            .create(device)
        };
        Self {
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some(LABEL),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            copy: pipeline(&shaders::BLIT, "full_viewport", "blit", &[("ENCODING_TARGET", 1.0)]),
            halve: pipeline(&shaders::MIPS, "full_screen", "halve", &[]),
            layout,
        }
    }

    /// Creates a buffer for copies of `image`, which is gamma-encoded and has this size.
    pub fn create_buffer(
        &self,
        device: &wgpu::Device,
        image: &wgpu::TextureView,
        [width, height]: [u32; 2],
    ) -> TransmissionBuffer {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(LABEL),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: width.max(height).ilog2() + 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let targets = (0..texture.mip_level_count()).map(|level| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                base_mip_level: level,
                mip_level_count: Some(1),
                ..Default::default()
            })
        });
        let targets: Vec<wgpu::TextureView> = targets.collect();
        let sources = [image].into_iter().chain(&targets);
        let groups = sources.map(|source| self.bind(device, source));
        let levels = groups.zip(targets.iter().cloned()).collect();
        TransmissionBuffer { view: texture.create_view(&Default::default()), levels }
    }

    /// Binds an image of the same size, to copy it instead of the first one.
    pub fn bind(&self, device: &wgpu::Device, image: &wgpu::TextureView) -> wgpu::BindGroup {
        sampled_texture_group(device, LABEL, &self.layout, image, &self.sampler)
    }

    /// Copies the buffer's image, or `other`, into the buffer and generates its mip levels.
    pub fn record(
        &self,
        buffer: &TransmissionBuffer,
        encoder: &mut wgpu::CommandEncoder,
        other: Option<&wgpu::BindGroup>,
    ) {
        let pipelines = [&self.copy].into_iter().chain(std::iter::repeat(&self.halve));
        for (level, ((source, target), pipeline)) in buffer.levels.iter().zip(pipelines).enumerate() {
            let source = other.filter(|_| level == 0).unwrap_or(source);
            draw_full_screen(encoder, LABEL, target, pipeline, source);
        }
    }
}
