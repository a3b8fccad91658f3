//! Images on the GPU, with mip levels drawn by the GPU.

use std::collections::HashMap;

use super::flush;
use super::shaders;
use crate::library::ImageData;
use crate::mesh::{Filter, MipFilter, Sampler, Wrap};

/// Draws mip levels.
pub(super) struct MipMaker {
    module: wgpu::ShaderModule,
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    pipelines: HashMap<wgpu::TextureFormat, wgpu::RenderPipeline>,
}

impl MipMaker {
    pub fn new(device: &wgpu::Device) -> Self {
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("mips"),
            entries: &[
                wgpu::BindGroupLayoutEntry {
                    binding: 0,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Texture {
                        sample_type: wgpu::TextureSampleType::Float { filterable: true },
                        view_dimension: wgpu::TextureViewDimension::D2,
                        multisampled: false,
                    },
                    count: None,
                },
                wgpu::BindGroupLayoutEntry {
                    binding: 1,
                    visibility: wgpu::ShaderStages::FRAGMENT,
                    ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                    count: None,
                },
            ],
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("mips"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self { module: shaders::MIPS.module(device), layout, sampler, pipelines: HashMap::new() }
    }

    /// Fills all levels below the first.
    fn fill(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture) {
        let format = texture.format();
        let pipeline = self.pipelines.entry(format).or_insert_with(|| {
            let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some("mips"),
                bind_group_layouts: &[Some(&self.layout)],
                immediate_size: 0,
            });
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some("mips"),
                layout: Some(&pipeline_layout),
                vertex: wgpu::VertexState {
                    module: &self.module,
                    entry_point: Some("full_screen"),
                    compilation_options: Default::default(),
                    buffers: &[],
                },
                primitive: Default::default(),
                depth_stencil: None,
                multisample: Default::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &self.module,
                    entry_point: Some("halve"),
                    compilation_options: Default::default(),
                    targets: &[Some(format.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        });
        let level_view = |level| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                base_mip_level: level,
                mip_level_count: Some(1),
                ..Default::default()
            })
        };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("mips") });
        for level in 1..texture.mip_level_count() {
            let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("mips"),
                layout: &self.layout,
                entries: &[
                    wgpu::BindGroupEntry {
                        binding: 0,
                        resource: wgpu::BindingResource::TextureView(&level_view(level - 1)),
                    },
                    wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&self.sampler) },
                ],
            });
            let target = level_view(level);
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("mips"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &target,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &bind_group, &[]);
            pass.draw(0..3, 0..1);
        }
        queue.submit([encoder.finish()]);
    }

    /// The image with all its mip levels; none when it has no pixels or is a browser's handle larger than the device
    /// can hold. Other images that are too large are halved until they fit. Each is submitted by itself: a browser's graphics
    /// process answers others between submissions only.
    pub fn upload(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        image: &ImageData,
        srgb: bool,
    ) -> Option<wgpu::TextureView> {
        let most = device.limits().max_texture_dimension_2d;
        let create = |width: u32, height: u32| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("image"),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: width.max(height).ilog2() + 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: if srgb { wgpu::TextureFormat::Rgba8UnormSrgb } else { wgpu::TextureFormat::Rgba8Unorm },
                usage: wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::COPY_DST
                    | wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            })
        };
        let texture = match image {
            ImageData::Rgba8 { width, height, pixels } => {
                let (mut width, mut height) = (*width, *height);
                if width == 0 || height == 0 || pixels.len() as u64 != 4 * u64::from(width) * u64::from(height) {
                    return None;
                }
                let mut smaller: Option<Vec<u8>> = None;
                while width > most || height > most {
                    smaller = Some(halved(smaller.as_deref().unwrap_or(pixels), width, height));
                    (width, height) = ((width / 2).max(1), (height / 2).max(1));
                }
                let texture = create(width, height);
                queue.write_texture(
                    texture.as_image_copy(),
                    smaller.as_deref().unwrap_or(pixels),
                    wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None },
                    texture.size(),
                );
                texture
            }
            #[cfg(target_arch = "wasm32")]
            ImageData::Bitmap(bitmap) => {
                let (width, height) = (bitmap.width(), bitmap.height());
                if width == 0 || height == 0 || width > most || height > most {
                    return None;
                }
                let texture = create(width, height);
                queue.copy_external_image_to_texture(
                    &wgpu::CopyExternalImageSourceInfo {
                        source: wgpu::ExternalImageSource::ImageBitmap(bitmap.clone()),
                        origin: wgpu::Origin2d::ZERO,
                        flip_y: false,
                    },
                    wgpu::CopyExternalImageDestInfo {
                        texture: &texture,
                        mip_level: 0,
                        origin: wgpu::Origin3d::ZERO,
                        aspect: wgpu::TextureAspect::All,
                        color_space: wgpu::PredefinedColorSpace::Srgb,
                        premultiplied_alpha: false,
                    },
                    texture.size(),
                );
                texture
            }
        };
        flush(queue);
        self.fill(device, queue, &texture);
        Some(texture.create_view(&Default::default()))
    }
}

/// Every second pixel of every second row: only for images beyond the device's limit, which are mipmapped afterwards.
fn halved(pixels: &[u8], width: u32, height: u32) -> Vec<u8> {
    let (new_width, new_height) = ((width / 2).max(1), (height / 2).max(1));
    let mut out = Vec::with_capacity((4 * new_width * new_height) as usize);
    for y in 0..new_height {
        for x in 0..new_width {
            let at = 4 * ((2 * y).min(height - 1) as usize * width as usize + (2 * x).min(width - 1) as usize);
            out.extend_from_slice(&pixels[at..at + 4]);
        }
    }
    out
}

/// One flat colour.
pub(super) fn single_texel(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    format: wgpu::TextureFormat,
    bytes: &[u8],
) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("single texel"),
        size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    queue.write_texture(
        texture.as_image_copy(),
        bytes,
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(bytes.len() as u32), rows_per_image: None },
        texture.size(),
    );
    texture.create_view(&Default::default())
}

pub(super) fn sampler(device: &wgpu::Device, sampler: &Sampler, anisotropy: u16) -> wgpu::Sampler {
    let wrap = |wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::ClampToEdge => wgpu::AddressMode::ClampToEdge,
        Wrap::MirroredRepeat => wgpu::AddressMode::MirrorRepeat,
    };
    let filter = |filter| match filter {
        Filter::Nearest => wgpu::FilterMode::Nearest,
        Filter::Linear => wgpu::FilterMode::Linear,
    };
    let smooth = sampler.mag == Filter::Linear && sampler.min == Filter::Linear && sampler.mip == MipFilter::Linear;
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("material"),
        address_mode_u: wrap(sampler.wrap_u),
        address_mode_v: wrap(sampler.wrap_v),
        mag_filter: filter(sampler.mag),
        min_filter: filter(sampler.min),
        mipmap_filter: match sampler.mip {
            MipFilter::None | MipFilter::Nearest => wgpu::MipmapFilterMode::Nearest,
            MipFilter::Linear => wgpu::MipmapFilterMode::Linear,
        },
        // A little above 0, or the smaller filter would never be chosen over the larger.
        lod_max_clamp: if sampler.mip == MipFilter::None { 0.25 } else { 32.0 },
        anisotropy_clamp: if smooth { anisotropy } else { 1 },
        ..Default::default()
    })
}
