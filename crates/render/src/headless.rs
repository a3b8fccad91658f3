//! Devices without a window, and reading pixels back: for the command line, tests and screenshots.

use std::sync::Arc;
#[cfg(target_arch = "wasm32")]
use std::sync::atomic::AtomicBool;
use std::sync::atomic::{AtomicU8, Ordering};

/// Why no device could be created.
#[derive(Debug, thiserror::Error)]
pub enum HeadlessError {
    /// None of the enabled back ends has an adapter.
    #[error("no graphics adapter was found ({0}); install a Vulkan driver, for example Mesa's llvmpipe")]
    NoAdapter(#[from] wgpu::RequestAdapterError),
    /// The adapter cannot create a device with the requested limits.
    #[error("the graphics adapter did not provide a device: {0}")]
    NoDevice(#[from] wgpu::RequestDeviceError),
}

/// Creates a device without a window.
#[cfg(not(target_arch = "wasm32"))]
pub fn headless_device() -> Result<(wgpu::Device, wgpu::Queue, wgpu::AdapterInfo), HeadlessError> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::from_env().unwrap_or(wgpu::Backends::PRIMARY | wgpu::Backends::GL);
    let instance = wgpu::Instance::new(descriptor);
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::HighPerformance,
        ..Default::default()
    }))?;
    let (device, queue) = pollster::block_on(adapter.request_device(&device_descriptor(&adapter)))?;
    Ok((device, queue, adapter.get_info()))
}

/// Requests WebGL2's limits of every device, so that what works on one works on all; only texture sizes use the adapter's.
pub fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
    wgpu::DeviceDescriptor {
        label: Some("gaitway"),
        required_features: adapter.features() & super::texture::COMPRESSED_FORMATS,
        required_limits: wgpu::Limits::downlevel_webgl2_defaults().using_resolution(adapter.limits()),
        ..Default::default()
    }
}

/// Reads an Rgba8Unorm texture with `COPY_SRC` usage, such as [`super::Renderer::output`], into RGBA rows from the top.
/// Converts premultiplied to straight alpha. Empty if the device was lost.
pub async fn read_pixels(device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture) -> Vec<u8> {
    let (width, height) = (texture.width(), texture.height());
    let row_bytes = 4 * width;
    let padded_row_bytes = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read-back"),
        size: u64::from(padded_row_bytes) * u64::from(height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded_row_bytes),
                rows_per_image: None,
            },
        },
        texture.size(),
    );
    queue.submit([encoder.finish()]);
    if !map(device, &buffer).await {
        return Vec::new();
    }
    let Ok(mapped) = buffer.slice(..).get_mapped_range() else { return Vec::new() };
    let mut pixels = Vec::with_capacity((row_bytes * height) as usize);
    for row in mapped.chunks_exact(padded_row_bytes as usize) {
        pixels.extend_from_slice(&row[..row_bytes as usize]);
    }
    drop(mapped);
    // A page would keep it until garbage collection, which may be too late for the frames of a video.
    buffer.destroy();
    for pixel in pixels.chunks_exact_mut(4) {
        let alpha = u32::from(pixel[3]);
        if alpha != 0 && alpha != 255 {
            for channel in &mut pixel[..3] {
                *channel = ((u32::from(*channel) * 255 + alpha / 2) / alpha).min(255) as u8;
            }
        }
    }
    pixels
}

/// Waits until the buffer is mapped. Native code blocks; a page polls once per turn of the event loop, because WebGL2
/// calls back only when polled.
async fn map(device: &wgpu::Device, buffer: &wgpu::Buffer) -> bool {
    const WAITING: u8 = 0;
    const MAPPED: u8 = 1;
    const FAILED: u8 = 2;
    let state = Arc::new(AtomicU8::new(WAITING));
    let from_callback = state.clone();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        from_callback.store(if result.is_ok() { MAPPED } else { FAILED }, Ordering::Release);
    });
    #[cfg(not(target_arch = "wasm32"))]
    if device.poll(wgpu::PollType::wait_indefinitely()).is_err() {
        return false;
    }
    #[cfg(target_arch = "wasm32")]
    if !poll_while(device, || state.load(Ordering::Acquire) == WAITING).await {
        return false;
    }
    state.load(Ordering::Acquire) == MAPPED
}

/// Resolves when all work submitted so far is done or the device is lost.
#[cfg(target_arch = "wasm32")]
pub async fn finished(device: &wgpu::Device, queue: &wgpu::Queue) {
    let works = Arc::new(AtomicBool::new(true));
    let from_callback = works.clone();
    queue.on_submitted_work_done(move || from_callback.store(false, Ordering::Release));
    poll_while(device, || works.load(Ordering::Acquire)).await;
}

/// Polls the device once per turn of the event loop; false if it was lost.
#[cfg(target_arch = "wasm32")]
async fn poll_while(device: &wgpu::Device, waits: impl Fn() -> bool) -> bool {
    while waits() {
        if device.poll(wgpu::PollType::Poll).is_err() {
            return false;
        }
        next_turn().await;
    }
    true
}

/// Resolves in a later turn of the page's event loop.
#[cfg(target_arch = "wasm32")]
pub async fn next_turn() {
    use wasm_bindgen::JsCast;
    let promise = js_sys::Promise::new(&mut |resolve, _| {
        let set_timeout = js_sys::Reflect::get(&js_sys::global(), &"setTimeout".into());
        if let Some(set_timeout) = set_timeout.ok().and_then(|value| value.dyn_into::<js_sys::Function>().ok()) {
            // Every page has timers.
            let _ = set_timeout.call2(&wasm_bindgen::JsValue::UNDEFINED, &resolve, &1.into());
        }
    });
    let _ = wasm_bindgen_futures::JsFuture::from(promise).await;
}
