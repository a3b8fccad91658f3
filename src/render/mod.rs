//! Draws a [`Frame`](crate::frame::Frame) with wgpu into its own texture. Knows no state and no user interface.
//!
//! One path on all back ends, within WebGL2's limits: palettes and morph targets are textures read with `textureLoad`.
//! A picture is a shadow map and one pass, whose stages write the colours that are shown.

mod blit;
mod draw_list;
mod environment;
mod frame_uniform;
pub mod geometry;
mod headless;
mod model;
mod overlay;
pub mod palette;
mod pipelines;
mod renderer;
pub mod shaders;
mod shadow;
mod targets;
mod texture;
pub mod uniforms;

pub use blit::Blit;
#[cfg(target_arch = "wasm32")]
pub use headless::finished;
#[cfg(not(target_arch = "wasm32"))]
pub use headless::headless_device;
pub use headless::{HeadlessError, read_pixels};
pub use renderer::{RenderStats, Renderer, RendererOptions, UploadError};

/// Hands over what was asked of the device so far. A browser's graphics process answers others between submissions only, so
/// what takes long there is handed over by itself.
fn flush(queue: &wgpu::Queue) {
    queue.submit([]);
}
