//! The scene, rendered to a texture of its own. It holds encoded values, which the screen shows as they are.

use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState};
use gaitway_render::{Blit, RenderStats, Renderer, RendererOptions, UploadError};
use gaitway_scene::frame::Frame;
use gaitway_scene::library::{Model, ModelId};
use gaitway_scene::state::Background;

pub(super) struct SceneTexture {
    gpu: RenderState,
    renderer: Renderer,
    /// Size of the texture on screen, and whether it is opaque.
    displayed: Option<([u32; 2], bool)>,
}

impl SceneTexture {
    pub fn new(gpu: RenderState) -> Self {
        let options = RendererOptions::for_adapter(&gpu.adapter.get_info());
        let renderer = Renderer::new(&gpu.device, &gpu.queue, options);
        let blit = Blit::new(&gpu.device, gpu.target_format);
        gpu.renderer.write().callback_resources.insert(blit);
        Self { gpu, renderer, displayed: None }
    }

    /// Uploads a model, and optionally the source beside it; evicts all others.
    pub fn upload(&mut self, model: &Model, beside: Option<&Model>) -> Result<(), UploadError> {
        self.renderer.upload(&self.gpu.device, &self.gpu.queue, model)?;
        if let Some(beside) = beside {
            self.renderer.upload(&self.gpu.device, &self.gpu.queue, beside)?;
        }
        self.renderer.retain(&[model.id, beside.unwrap_or(model).id]);
        Ok(())
    }

    /// Uploads an image of the next model, so that this need not be done in the frame that shows it.
    #[cfg(target_arch = "wasm32")]
    pub fn upload_image(&mut self, image: &web_sys::ImageBitmap, srgb: bool) {
        self.renderer.images().prepare(&self.gpu.device, &self.gpu.queue, image, srgb);
    }

    /// Frees the images of a model that doesn't come after all.
    #[cfg(target_arch = "wasm32")]
    pub fn forget_images(&mut self) {
        self.renderer.images().forget();
    }

    /// Draws at a size in pixels.
    pub fn draw(&mut self, frame: &Frame, size: [u32; 2]) {
        let device = &self.gpu.device;
        let view = self.renderer.draw(device, &self.gpu.queue, frame, size);
        let is_opaque = frame.look.background != Background::Transparent;
        let displayed = Some((size, is_opaque));
        if self.displayed != displayed
            && let Some(blit) = self.gpu.renderer.write().callback_resources.get_mut::<Blit>()
        {
            blit.show(device, view, is_opaque);
            self.displayed = displayed;
        }
    }

    /// Whether the last image can be refined.
    pub fn can_refine(&self) -> bool {
        self.renderer.can_refine()
    }

    /// Adds a sample per pixel to the image on screen, which must show this frame. Returns whether it can be refined
    /// further.
    pub fn refine(&mut self, frame: &Frame) -> bool {
        self.renderer.refine(&self.gpu.device, &self.gpu.queue, frame)
    }

    /// Draws an image that is not for the screen. The screen keeps the one before, unless that has the same size.
    pub fn draw_off_screen(&mut self, frame: &Frame, size: [u32; 2]) -> (wgpu::Device, wgpu::Queue, wgpu::Texture) {
        self.renderer.draw_refined(&self.gpu.device, &self.gpu.queue, frame, size);
        self.displayed = None;
        self.last_image()
    }

    /// Never draws to the texture of the last image again.
    pub fn give_image_away(&mut self) {
        self.renderer.give_output_away(&self.gpu.device);
    }

    /// Returns the callback that paints the last image into a rectangle of its size.
    pub fn paint(&self, rect: egui::Rect) -> egui::PaintCallback {
        Callback::new_paint_callback(rect, Paint)
    }

    pub fn stats(&self) -> RenderStats {
        self.renderer.stats()
    }

    /// Makes the panels' thumbnails of a model's images, by index in the asset, in place of `old`.
    pub fn thumbnails(&self, model: ModelId, old: &[Option<egui::TextureId>]) -> Vec<Option<egui::TextureId>> {
        let mut panels = self.gpu.renderer.write();
        old.iter().flatten().for_each(|id| panels.free_texture(id));
        let views = self.renderer.thumbnails(&self.gpu.device, &self.gpu.queue, model);
        let mut register =
            |view: wgpu::TextureView| panels.register_native_texture(&self.gpu.device, &view, wgpu::FilterMode::Linear);
        views.into_iter().map(|view| view.map(&mut register)).collect()
    }

    /// Memory of the uploaded models in bytes: geometry and images.
    pub fn device_bytes(&self) -> [u64; 2] {
        self.renderer.device_bytes()
    }

    pub fn max_size(&self) -> u32 {
        self.gpu.device.limits().max_texture_dimension_2d
    }

    /// Returns what reading the last image back takes, independent of this struct's lifetime.
    pub fn last_image(&self) -> (wgpu::Device, wgpu::Queue, wgpu::Texture) {
        (self.gpu.device.clone(), self.gpu.queue.clone(), self.renderer.output().clone())
    }
}

/// Paints with the [`Blit`], which egui's renderer keeps because it is not `Send` on the web.
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
