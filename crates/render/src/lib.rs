//! Draws a [`Frame`](gaitway_scene::frame::Frame) into a texture with wgpu. Independent of the state and the user interface.
//!
//! All back ends share one path within WebGL2's limits: palettes and morph targets are textures read with
//! `textureLoad`. A picture takes a shadow pass and a single scene pass (two with transmissive surfaces), whose
//! fragment stages write display-ready colours; without multisampling, further scene passes refine it.
//!
//! Lit surfaces are tone-mapped and encoded where they are drawn. So unlit colours and overlays come out exactly as given,
//! and no pass over the whole picture is needed; blending happens in encoded values.

#![forbid(unsafe_code)]
// Files are untrusted: whatever is wrong with them must be reported, never panic.
#![warn(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

mod blit;
mod draw_list;
mod environment;
mod frame_uniform;
mod full_screen;
pub mod geometry;
mod headless;
mod layouts;
mod light;
mod lobes;
mod model;
mod overlay;
pub mod palette;
mod pipelines;
mod pool;
mod refine;
mod renderer;
pub mod shaders;
mod shadow;
mod targets;
mod texture;
mod thumbnail;
mod transmission;
mod uniform_buffer;
pub mod uniforms;
mod upload_error;

pub use blit::Blit;
#[cfg(not(target_arch = "wasm32"))]
pub use headless::headless_device;
pub use headless::{HeadlessError, device_descriptor, read_pixels};
#[cfg(target_arch = "wasm32")]
pub use headless::{finished, next_turn};
pub use renderer::{RenderStats, Renderer, RendererOptions};
#[cfg(target_arch = "wasm32")]
pub use texture::ImageUploader;
pub use texture::texture_formats;
pub use upload_error::UploadError;

/// Submits the work recorded so far. A browser's graphics process serves other clients only between submissions, so each
/// expensive step gets a submission of its own.
fn flush(queue: &wgpu::Queue) {
    queue.submit([]);
}
