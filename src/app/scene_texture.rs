//! The scene in its own texture, drawn only when something it depends on has changed.

use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState};

use crate::frame::Frame;
use crate::library::Model;
use crate::render::{Blit, RenderStats, Renderer, RendererOptions, UploadError};
use crate::state::Background;

pub(super) struct SceneTexture {
    gpu: RenderState,
    renderer: Renderer,
    /// Size of the texture on the screen, and whether it is opaque.
    shown: Option<([u32; 2], bool)>,
}

impl SceneTexture {
    pub fn new(gpu: RenderState, samples: u32) -> Self {
        let renderer = Renderer::new(&gpu.device, &gpu.queue, RendererOptions { samples });
        let blit = Blit::new(&gpu.device, gpu.target_format);
        gpu.renderer.write().callback_resources.insert(blit);
        Self { gpu, renderer, shown: None }
    }

    /// Brings a model to the device, and with it what else may be drawn; everything else is let go.
    pub fn upload(&mut self, model: &Model, beside: Option<&Model>) -> Result<(), UploadError> {
        self.renderer.upload(&self.gpu.device, &self.gpu.queue, model)?;
        if let Some(beside) = beside {
            self.renderer.upload(&self.gpu.device, &self.gpu.queue, beside)?;
        }
        self.renderer.retain(&[model.id, beside.unwrap_or(model).id]);
        Ok(())
    }

    /// Draws at a size in pixels.
    pub fn draw(&mut self, frame: &Frame, size: [u32; 2]) {
        let device = &self.gpu.device;
        let view = self.renderer.draw(device, &self.gpu.queue, frame, size);
        let shown = Some((size, frame.look.background != Background::Transparent));
        if self.shown != shown
            && let Some(blit) = self.gpu.renderer.write().callback_resources.get_mut::<Blit>()
        {
            blit.show(device, view, frame.look.background != Background::Transparent);
            self.shown = shown;
        }
    }

    /// Draws a picture that is not for the screen, into a texture that nothing else will be drawn into.
    pub fn draw_apart(&mut self, frame: &Frame, size: [u32; 2]) -> (wgpu::Device, wgpu::Queue, wgpu::Texture) {
        self.renderer.draw(&self.gpu.device, &self.gpu.queue, frame, size);
        let picture = self.last_picture();
        self.renderer.give_output_away(&self.gpu.device);
        self.shown = None;
        picture
    }

    /// What paints the last picture into a rectangle of its size.
    pub fn paint(&self, rect: egui::Rect) -> egui::PaintCallback {
        Callback::new_paint_callback(rect, Paint)
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

/// The [`Blit`] is kept by egui's renderer, since it may not go to another thread.
struct Paint;

impl CallbackTrait for Paint {
    fn paint(
        &self,
        _info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        if let Some(blit) = resources.get::<Blit>() {
            blit.draw(pass);
        }
    }
}
