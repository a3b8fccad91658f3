//! Image textures, with mip levels generated on the GPU unless the image has its own.

use std::collections::HashMap;

use gaitway_character::mesh::{Filter, MipFilter, Sampler, Wrap};
use gaitway_ktx2::{Format, Formats, Texture as Ktx2};
use gaitway_scene::library::ImageData;

use super::flush;
use super::full_screen::{FullScreenPipeline, draw_full_screen, sampled_texture_group, sampled_texture_layout};
use super::layouts::pipeline_layout;
use super::shaders;

/// The compressed formats that are used where a device has them.
pub(super) const COMPRESSED_FORMATS: wgpu::Features = wgpu::Features::TEXTURE_COMPRESSION_BC
    .union(wgpu::Features::TEXTURE_COMPRESSION_ETC2)
    .union(wgpu::Features::TEXTURE_COMPRESSION_ASTC);

/// Returns the compressed formats that a device with these features can sample.
pub fn texture_formats(features: wgpu::Features) -> Formats {
    let pairs = [
        (wgpu::Features::TEXTURE_COMPRESSION_BC, Formats::BC7),
        (wgpu::Features::TEXTURE_COMPRESSION_ETC2, Formats::ETC2),
        (wgpu::Features::TEXTURE_COMPRESSION_ASTC, Formats::ASTC),
    ];
    let has = |(feature, format): (wgpu::Features, Formats)| if features.contains(feature) { format.0 } else { 0 };
    Formats(pairs.into_iter().map(has).sum())
}

/// Uploads images and generates their mip levels.
pub struct ImageUploader {
    module: wgpu::ShaderModule,
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    pipelines: HashMap<wgpu::TextureFormat, wgpu::RenderPipeline>,
    /// Bitmaps uploaded in advance, each with whether it is decoded from sRGB.
    #[cfg(target_arch = "wasm32")]
    ready: Vec<(web_sys::ImageBitmap, bool, Option<wgpu::TextureView>)>,
}

impl ImageUploader {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("mips"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let layout = sampled_texture_layout(device, "mips");
        Self {
            module: shaders::MIPS.module(device),
            layout,
            sampler,
            pipelines: HashMap::new(),
            #[cfg(target_arch = "wasm32")]
            ready: Vec::new(),
        }
    }

    /// Uploads a bitmap of the next model, so that this need not be done in the frame that shows it.
    #[cfg(target_arch = "wasm32")]
    pub fn prepare(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, bitmap: &web_sys::ImageBitmap, srgb: bool) {
        let view = self.upload(device, queue, &ImageData::Bitmap(bitmap.clone()), srgb);
        self.ready.push((bitmap.clone(), srgb, view));
    }

    /// Frees the bitmaps that no model has taken.
    #[cfg(target_arch = "wasm32")]
    pub fn forget(&mut self) {
        self.ready.clear();
    }

    /// Submits an upload with the passes that fill every level below the first `given`.
    fn fill(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture, given: u32) {
        if given == texture.mip_level_count() {
            flush(queue);
            return;
        }
        let format = texture.format();
        let pipeline = self.pipelines.entry(format).or_insert_with(|| {
            FullScreenPipeline {
                label: "mips",
                module: &self.module,
                layout: &pipeline_layout(device, "mips", &[Some(&self.layout)]),
                vertex: "full_screen",
                fragment: "halve",
                constants: &[],
                target: format.into(),
            }
            .create(device)
        });
        let level_view = |level| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                base_mip_level: level,
                mip_level_count: Some(1),
                ..Default::default()
            })
        };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("mips") });
        for level in given..texture.mip_level_count() {
            let bind_group = sampled_texture_group(device, "mips", &self.layout, &level_view(level - 1), &self.sampler);
            draw_full_screen(&mut encoder, "mips", &level_view(level), pipeline, &bind_group);
        }
        queue.submit([encoder.finish()]);
    }

    /// Uploads an image and its mip levels; none if it has no pixels, or if it is a browser's bitmap or a KTX2 image larger than
    /// the device supports. Other oversized images are halved until they fit. Each image is a submission of its own,
    /// because a browser's graphics process serves other clients only between submissions.
    pub(super) fn upload(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        image: &ImageData,
        srgb: bool,
    ) -> Option<wgpu::TextureView> {
        #[cfg(target_arch = "wasm32")]
        if let ImageData::Bitmap(bitmap) = image
            && let Some(at) = self.ready.iter().position(|(ready, is_srgb, _)| ready == bitmap && *is_srgb == srgb)
        {
            return self.ready.swap_remove(at).2;
        }
        let (texture, given) = match image {
            ImageData::Rgba8 { width, height, pixels } => {
                (upload_pixels(device, queue, [*width, *height], pixels, srgb)?, 1)
            }
            ImageData::Ktx2(image) => (upload_levels(device, queue, image, srgb)?, image.levels),
            #[cfg(target_arch = "wasm32")]
            ImageData::Bitmap(bitmap) => (upload_bitmap(device, queue, bitmap, srgb)?, 1),
        };
        self.fill(device, queue, &texture, given);
        Some(texture.create_view(&Default::default()))
    }
}

/// A texture with room for the `given` mip levels of its image and for those to be generated.
fn image_texture(
    device: &wgpu::Device,
    [width, height]: [u32; 2],
    format: Format,
    given: u32,
    srgb: bool,
) -> wgpu::Texture {
    /// The longer edge of the smallest level that is generated: smaller ones would only show where a model is as small as they are,
    /// and take a pass each.
    const MIN_EDGE: u32 = 4;
    use wgpu::TextureUsages as Usages;
    let format = wgpu_format(format, srgb);
    let generated = if format.is_compressed() { Usages::empty() } else { Usages::RENDER_ATTACHMENT };
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some("image"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: ((width.max(height) / MIN_EDGE).max(1).ilog2() + 1).max(given),
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: Usages::TEXTURE_BINDING | Usages::COPY_DST | generated,
        view_formats: &[],
    })
}

fn wgpu_format(format: Format, srgb: bool) -> wgpu::TextureFormat {
    let format = match format {
        Format::Rgba8 => wgpu::TextureFormat::Rgba8Unorm,
        Format::Bc7 => wgpu::TextureFormat::Bc7RgbaUnorm,
        Format::Etc2Rgb => wgpu::TextureFormat::Etc2Rgb8Unorm,
        Format::Etc2Rgba => wgpu::TextureFormat::Etc2Rgba8Unorm,
        Format::Astc4x4 => {
            wgpu::TextureFormat::Astc { block: wgpu::AstcBlock::B4x4, channel: wgpu::AstcChannel::Unorm }
        }
    };
    if srgb { format.add_srgb_suffix() } else { format }
}

/// Uploads the levels that a KTX2 image has: all of them if it is compressed.
fn upload_levels(device: &wgpu::Device, queue: &wgpu::Queue, image: &Ktx2, srgb: bool) -> Option<wgpu::Texture> {
    let size = [image.width, image.height];
    let max_size = device.limits().max_texture_dimension_2d;
    let format = wgpu_format(image.format, srgb);
    if size.into_iter().any(|edge| edge > max_size) || !device.features().contains(format.required_features()) {
        return None;
    }
    let texture = image_texture(device, size, image.format, image.levels, srgb);
    for (mip_level, ([width, height], bytes)) in (0..).zip(image.levels()) {
        let (bytes_per_row, _) = image.format.layout([width, height]);
        queue.write_texture(
            wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() },
            bytes,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(bytes_per_row), rows_per_image: None },
            // Levels smaller than a block are copied as a whole one.
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 }.physical_size(format),
        );
    }
    Some(texture)
}

/// Uploads the first level, halving the image until the device supports its size.
fn upload_pixels(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    [mut width, mut height]: [u32; 2],
    pixels: &[u8],
    srgb: bool,
) -> Option<wgpu::Texture> {
    if width == 0 || height == 0 || pixels.len() as u64 != 4 * u64::from(width) * u64::from(height) {
        return None;
    }
    let max_size = device.limits().max_texture_dimension_2d;
    let mut smaller: Option<Vec<u8>> = None;
    while width > max_size || height > max_size {
        smaller = Some(halved(smaller.as_deref().unwrap_or(pixels), width, height));
        (width, height) = ((width / 2).max(1), (height / 2).max(1));
    }
    let texture = image_texture(device, [width, height], Format::Rgba8, 1, srgb);
    queue.write_texture(
        texture.as_image_copy(),
        smaller.as_deref().unwrap_or(pixels),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None },
        texture.size(),
    );
    Some(texture)
}

/// Uploads the first level.
#[cfg(target_arch = "wasm32")]
fn upload_bitmap(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    bitmap: &web_sys::ImageBitmap,
    srgb: bool,
) -> Option<wgpu::Texture> {
    let size = [bitmap.width(), bitmap.height()];
    let max_size = device.limits().max_texture_dimension_2d;
    if size.contains(&0) || size.into_iter().any(|edge| edge > max_size) {
        return None;
    }
    let texture = image_texture(device, size, Format::Rgba8, 1, srgb);
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
    Some(texture)
}

/// Keeps every second pixel of every second row. Only for images over the device's limit, which get mipmaps afterwards.
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

/// Returns the memory of a texture with all its levels in bytes.
pub(super) fn texture_bytes(view: &wgpu::TextureView) -> u64 {
    let texture = view.texture();
    let format = texture.format();
    let (block_width, block_height) = format.block_dimensions();
    let block_bytes = u64::from(format.block_copy_size(None).unwrap_or(0));
    let level = |level: u32| {
        let blocks = |edge: u32, block: u32| u64::from((edge >> level).max(1).div_ceil(block));
        blocks(texture.width(), block_width) * blocks(texture.height(), block_height) * block_bytes
    };
    (0..texture.mip_level_count()).map(level).sum()
}

/// Creates a texture of a single texel.
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
        // Slightly above 0, or minification would use the magnification filter.
        lod_max_clamp: if sampler.mip == MipFilter::None { 0.25 } else { 32.0 },
        anisotropy_clamp: if smooth { anisotropy } else { 1 },
        ..Default::default()
    })
}
