//! The scene in its own texture, drawn only when something it depends on has changed.

use eframe::egui_wgpu::RenderState;

use crate::frame::Frame;
use crate::library::Model;
use crate::render::{RenderStats, Renderer, RendererOptions, UploadError};

pub(super) struct SceneTexture {
    gpu: RenderState,
    renderer: Renderer,
    /// The texture as egui knows it, and the size it was registered at.
    shown: Option<(egui::TextureId, [u32; 2])>,
}

impl SceneTexture {
    pub fn new(gpu: RenderState, samples: u32) -> Self {
        let renderer = Renderer::new(&gpu.device, &gpu.queue, RendererOptions { samples });
        Self { gpu, renderer, shown: None }
    }

    pub fn upload(&mut self, model: &Model) -> Result<(), UploadError> {
        self.renderer.upload(&self.gpu.device, &self.gpu.queue, model)?;
        self.renderer.retain(&[model.id]);
        Ok(())
    }

    /// Draws at a size in pixels.
    pub fn draw(&mut self, frame: &Frame, size: [u32; 2]) {
        let device = &self.gpu.device;
        let view = self.renderer.draw(device, &self.gpu.queue, frame, size);
        match self.shown {
            Some((_, shown_size)) if shown_size == size => {}
            Some((id, _)) => {
                let filter = wgpu::FilterMode::Linear;
                self.gpu.renderer.write().update_egui_texture_from_wgpu_texture(device, view, filter, id);
                self.shown = Some((id, size));
            }
            None => {
                let filter = wgpu::FilterMode::Linear;
                let id = self.gpu.renderer.write().register_native_texture(device, view, filter);
                self.shown = Some((id, size));
            }
        }
    }

    pub fn texture(&self) -> Option<egui::TextureId> {
        self.shown.map(|(id, _)| id)
    }

    pub fn stats(&self) -> RenderStats {
        self.renderer.stats()
    }

    pub fn largest_size(&self) -> u32 {
        self.gpu.device.limits().max_texture_dimension_2d
    }

    /// What is needed to read the last picture back, free of this struct's lifetime.
    pub fn last_picture(&self) -> (wgpu::Device, wgpu::Queue, wgpu::Texture) {
        (self.gpu.device.clone(), self.gpu.queue.clone(), self.renderer.output().clone())
    }
}
