//! A finished picture onto the screen, in somebody else's render pass.

use super::shaders;

/// Draws a picture over the whole viewport of a pass that has one colour target, one sample a pixel and no depth.
///
/// egui's own way of showing a texture runs a long shader for every pixel, which takes as long as drawing the scene where
/// the CPU draws.
pub struct Blit {
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    opaque: wgpu::RenderPipeline,
    blended: wgpu::RenderPipeline,
    /// What is shown, and whether anything shows through it.
    shown: Option<(wgpu::BindGroup, bool)>,
}

impl Blit {
    /// `target` is the format of the pass's target, which shows values as they are or, when it is an sRGB one, encodes
    /// them.
    pub fn new(device: &wgpu::Device, target: wgpu::TextureFormat) -> Self {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty,
            count: None,
        };
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("blit"),
            entries: &[entry(0, texture), entry(1, sampler)],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("blit"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let module = shaders::BLIT.module(device);
        let constants = [("ENCODING_TARGET", f64::from(u8::from(target.is_srgb())))];
        let pipeline = |blend| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("blit"),
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some("full_viewport"),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: Default::default(),
                depth_stencil: None,
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some("blit"),
                    compilation_options: wgpu::PipelineCompilationOptions {
                        constants: &constants,
                        zero_initialize_workgroup_memory: false,
                    },
                    targets: &[Some(wgpu::ColorTargetState {
                        format: target,
                        blend,
                        write_mask: wgpu::ColorWrites::ALL,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Self {
            sampler: device.create_sampler(&wgpu::SamplerDescriptor { label: Some("blit"), ..Default::default() }),
            opaque: pipeline(None),
            blended: pipeline(Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING)),
            layout,
            shown: None,
        }
    }

    /// What is shown from now on: gamma-encoded, alpha premultiplied. `opaque`: nothing shows through.
    pub fn show(&mut self, device: &wgpu::Device, picture: &wgpu::TextureView, opaque: bool) {
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("blit"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(picture) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&self.sampler) },
            ],
        });
        self.shown = Some((group, opaque));
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some((group, opaque)) = &self.shown else { return };
        pass.set_pipeline(if *opaque { &self.opaque } else { &self.blended });
        pass.set_bind_group(0, group, &[]);
        pass.draw(0..3, 0..1);
    }
}
