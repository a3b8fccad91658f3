//! Buffers that primitives share: a device creates one large buffer sooner than many small ones.

use std::ops::Range;

/// Puts data into as few buffers as possible. They can be used once the pool is dropped.
pub struct Pool<'a> {
    device: &'a wgpu::Device,
    label: &'static str,
    usage: wgpu::BufferUsages,
    /// Bytes that are still to come, aligned.
    left: u64,
    /// The current buffer, mapped, and how much of it is taken.
    current: Option<(wgpu::Buffer, u64)>,
}

/// A part of a shared buffer.
#[derive(Clone)]
pub struct Pooled {
    buffer: wgpu::Buffer,
    range: Range<u64>,
}

/// Maximum bytes of a buffer, unless a single part is larger: until the device takes it, the program's memory holds a copy.
const BUFFER_BYTES: u64 = 16 << 20;

/// The least distance of parts that are mapped one by one.
fn aligned(bytes: u64) -> u64 {
    bytes.next_multiple_of(wgpu::MAP_ALIGNMENT)
}

impl<'a> Pool<'a> {
    /// Expects parts with these numbers of bytes, in any order.
    pub fn new(
        device: &'a wgpu::Device,
        label: &'static str,
        usage: wgpu::BufferUsages,
        parts: impl Iterator<Item = u64>,
    ) -> Self {
        Self { device, label, usage, left: parts.map(aligned).sum(), current: None }
    }

    /// Adds a part: a multiple of four bytes, at least four, and no more than the device's buffers can have.
    pub fn add(&mut self, bytes: &[u8]) -> Pooled {
        let size = aligned(bytes.len() as u64);
        let (buffer, start) = match &self.current {
            Some((buffer, taken)) if buffer.size() - taken >= size => (buffer.clone(), *taken),
            _ => (self.next_buffer(size), 0),
        };
        let range = start..start + bytes.len() as u64;
        // Fails only if the device is lost.
        if let Ok(mut mapped) = buffer.get_mapped_range_mut(range.clone()) {
            mapped.copy_from_slice(bytes);
        }
        self.left = self.left.saturating_sub(size);
        self.current = Some((buffer.clone(), start + size));
        Pooled { buffer, range }
    }

    fn next_buffer(&mut self, min_size: u64) -> wgpu::Buffer {
        self.finish();
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(self.label),
            size: self.left.min(BUFFER_BYTES).max(min_size),
            usage: self.usage,
            mapped_at_creation: true,
        })
    }

    fn finish(&mut self) {
        if let Some((buffer, _)) = self.current.take() {
            buffer.unmap();
        }
    }
}

impl Drop for Pool<'_> {
    fn drop(&mut self) {
        self.finish();
    }
}

impl Pooled {
    pub fn slice(&self) -> wgpu::BufferSlice<'_> {
        self.buffer.slice(self.range.clone())
    }

    /// Returns its size in bytes.
    pub fn size(&self) -> u64 {
        self.range.end - self.range.start
    }
}
