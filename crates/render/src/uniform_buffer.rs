//! A uniform on the GPU, uploaded when it changes.

use bytemuck::Pod;

pub(super) struct UniformBuffer<T> {
    buffer: wgpu::Buffer,
    written: T,
}

impl<T: Pod> UniformBuffer<T> {
    /// All zeros, as new buffers are.
    pub fn new(device: &wgpu::Device, label: &str) -> Self {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: size_of::<T>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { buffer, written: T::zeroed() }
    }

    pub fn write(&mut self, queue: &wgpu::Queue, uniform: T) {
        if bytemuck::bytes_of(&uniform) != bytemuck::bytes_of(&self.written) {
            queue.write_buffer(&self.buffer, 0, bytemuck::bytes_of(&uniform));
            self.written = uniform;
        }
    }

    pub fn written(&self) -> &T {
        &self.written
    }

    pub fn binding(&self) -> wgpu::BindingResource<'_> {
        self.buffer.as_entire_binding()
    }
}
