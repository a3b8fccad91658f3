//! The picture of everything opaque that transmissive surfaces let through, with mip levels for rough ones.

use super::full_screen::{FullScreenPipeline, sampled_texture_group, sampled_texture_layout};
use super::pipelines::pipeline_layout;
use super::shaders::{self, Shader};

/// Decodes what is copied, so that mip levels average light.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// Makes such pictures.
pub(super) struct BehindMaker {
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    copy: wgpu::RenderPipeline,
    halve: wgpu::RenderPipeline,
}

pub(super) struct Behind {
    pub view: wgpu::TextureView,
    /// Of each mip level: the texture it is made from, and where it goes.
    levels: Vec<(wgpu::BindGroup, wgpu::TextureView)>,
}

impl BehindMaker {
    pub fn new(device: &wgpu::Device) -> Self {
        let layout = sampled_texture_layout(device, "behind");
        let pipeline_layout = pipeline_layout(device, "behind", &[Some(&layout)]);
        let pipeline = |shader: &Shader, vertex, fragment, constants| {
            FullScreenPipeline {
                label: "behind",
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
                label: Some("behind"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            copy: pipeline(&shaders::BLIT, "full_viewport", "blit", &[("ENCODING_TARGET", 1.0)]),
            halve: pipeline(&shaders::MIPS, "full_screen", "halve", &[]),
            layout,
        }
    }

    /// Creates the textures. `picture` is gamma-encoded and has this size.
    pub fn behind(&self, device: &wgpu::Device, picture: &wgpu::TextureView, [width, height]: [u32; 2]) -> Behind {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("behind"),
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
        let sources = [picture].into_iter().chain(&targets);
        let groups = sources.map(|source| sampled_texture_group(device, "behind", &self.layout, source, &self.sampler));
        let levels = groups.zip(targets.iter().cloned()).collect();
        Behind { view: texture.create_view(&Default::default()), levels }
    }

    /// Copies the picture as it is at this point of the encoder, and makes its mip levels.
    pub fn record(&self, behind: &Behind, encoder: &mut wgpu::CommandEncoder) {
        let pipelines = [&self.copy].into_iter().chain(std::iter::repeat(&self.halve));
        for ((source, target), pipeline) in behind.levels.iter().zip(pipelines) {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("behind"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: target,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, source, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}
