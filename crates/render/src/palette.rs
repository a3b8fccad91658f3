//! The palette texture: palettes and morph weights of all draws in a frame, read by palette.wgsl.

use gaitway_character::mesh::PaletteEntry;

/// Texels per row; must match palette.wgsl.
const WIDTH: usize = 1280;
const ENTRY_TEXELS: usize = 5;

type Texel = [f32; 4];

/// An Rgba32Float texture, rebuilt for each frame: clear, push the palettes, push the morph weights, upload.
pub struct PaletteTexture {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    /// Texels of the next upload and of the last one.
    texels: Vec<Texel>,
    uploaded: Vec<Texel>,
}

impl PaletteTexture {
    /// Creates a texture of one row, with nothing uploaded.
    pub fn new(device: &wgpu::Device) -> Self {
        let (texture, view) = create(device, 1);
        Self { texture, view, texels: Vec::new(), uploaded: Vec::new() }
    }

    /// Returns the view to bind. [`Self::upload`] returns whether it was replaced.
    pub fn view(&self) -> &wgpu::TextureView {
        &self.view
    }

    /// Discards the texels of the next upload. The texture keeps its content.
    pub fn clear(&mut self) {
        self.texels.clear();
    }

    /// Appends a palette; call this before any [`Self::push_morph_weights`]. Returns the index of the first entry.
    pub fn push_palette(&mut self, palette: &[PaletteEntry]) -> u32 {
        let first = self.texels.len() / ENTRY_TEXELS;
        self.texels.extend(palette.iter().flatten().map(|texel| texel.to_array()));
        first as u32
    }

    /// Appends the non-zero weights. Returns the index of the first texel and their number.
    pub fn push_morph_weights(&mut self, weights: &[f32]) -> (u32, u32) {
        let first = self.texels.len();
        let active = weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0);
        self.texels.extend(active.map(|(target, &weight)| [target as f32, weight, 0.0, 0.0]));
        (first as u32, (self.texels.len() - first) as u32)
    }

    /// Uploads the texels, as far as they fit. Returns whether the view was replaced.
    pub fn upload(&mut self, device: &wgpu::Device, queue: &wgpu::Queue) -> bool {
        if self.texels == self.uploaded {
            return false;
        }
        let max_rows = device.limits().max_texture_dimension_2d as usize;
        let rows = self.texels.len().div_ceil(WIDTH).clamp(1, max_rows);
        let grown = rows > self.texture.height() as usize;
        if grown {
            (self.texture, self.view) = create(device, rows.next_power_of_two().min(max_rows) as u32);
        }
        let length = self.texels.len();
        self.texels.resize(rows * WIDTH, [0.0; 4]);
        queue.write_texture(
            self.texture.as_image_copy(),
            bytemuck::cast_slice(&self.texels),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(16 * WIDTH as u32), rows_per_image: None },
            wgpu::Extent3d { width: WIDTH as u32, height: rows as u32, depth_or_array_layers: 1 },
        );
        self.texels.truncate(length);
        std::mem::swap(&mut self.texels, &mut self.uploaded);
        grown
    }
}

fn create(device: &wgpu::Device, rows: u32) -> (wgpu::Texture, wgpu::TextureView) {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("palette"),
        size: wgpu::Extent3d { width: WIDTH as u32, height: rows, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let view = texture.create_view(&Default::default());
    (texture, view)
}
