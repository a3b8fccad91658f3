//! Render targets of a picture.

use super::transmission::TransmissionBuffer;

pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth24Plus;
pub(super) const SCENE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

pub(super) struct Targets {
    /// Resolved into `output`; none with one sample per pixel, which is drawn into `output` directly.
    pub multisampled: Option<wgpu::TextureView>,
    pub depth: wgpu::TextureView,
    pub output: wgpu::Texture,
    pub output_view: wgpu::TextureView,
    /// Target of the further samples of a refined picture; created when first needed.
    pub sample: Option<wgpu::TextureView>,
    /// Created for the first picture with transmissive surfaces.
    pub transmission: Option<TransmissionBuffer>,
}

impl Targets {
    pub fn new(device: &wgpu::Device, size: [u32; 2], samples: u32) -> Self {
        use wgpu::TextureUsages as Usages;
        let texture = |label, format, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let view = |texture: wgpu::Texture| texture.create_view(&Default::default());
        let attachment = Usages::RENDER_ATTACHMENT;
        let output = texture("picture", SCENE_FORMAT, 1, attachment | Usages::TEXTURE_BINDING | Usages::COPY_SRC);
        Self {
            multisampled: (samples > 1).then(|| view(texture("scene samples", SCENE_FORMAT, samples, attachment))),
            depth: view(texture("depth", DEPTH_FORMAT, samples, attachment)),
            output_view: output.create_view(&Default::default()),
            output,
            sample: None,
            transmission: None,
        }
    }

    /// Returns the target for further samples, created on first use.
    pub fn sample_target(&mut self, device: &wgpu::Device) -> wgpu::TextureView {
        let size = self.output.size();
        let create = || {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some("sample"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: SCENE_FORMAT,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            });
            texture.create_view(&Default::default())
        };
        self.sample.get_or_insert_with(create).clone()
    }

    pub fn size(&self) -> [u32; 2] {
        [self.output.width(), self.output.height()]
    }
}
