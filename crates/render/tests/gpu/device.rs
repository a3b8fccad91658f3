//! The device that tests draw with.

use gaitway_render::headless_device;

use crate::adapter::or_skipped;

pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
}

pub fn gpu() -> Option<Gpu> {
    or_skipped(headless_device()).map(|(device, queue, _)| Gpu { device, queue })
}

/// The other back end: wgpu treats OpenGL ES like WebGL2, with the same shader translation. Not every machine with a
/// Vulkan driver has OpenGL as well, so this is never required.
pub fn gl() -> Option<Gpu> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::GL;
    let instance = wgpu::Instance::new(descriptor);
    let adapter = pollster::block_on(instance.request_adapter(&Default::default()));
    let Ok(adapter) = adapter.inspect_err(|problem| eprintln!("skipped: {problem}")) else { return None };
    let required_limits = wgpu::Limits::downlevel_webgl2_defaults().using_resolution(adapter.limits());
    let descriptor = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).unwrap();
    Some(Gpu { device, queue })
}

impl Gpu {
    /// Reads a texture whose texels have `size` bytes, without row padding.
    pub fn read(&self, texture: &wgpu::Texture, size: u32) -> Vec<u8> {
        let (row, height) = (size * texture.width(), texture.height());
        let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(padded * height),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: None },
            },
            texture.size(),
        );
        self.queue.submit([encoder.finish()]);
        buffer.map_async(wgpu::MapMode::Read, .., |result| result.unwrap());
        self.device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        let mapped = buffer.get_mapped_range(..).unwrap();
        mapped.chunks_exact(padded as usize).flat_map(|line| &line[..row as usize]).copied().collect()
    }
}
