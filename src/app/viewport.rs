//! The viewport: evaluates and draws the editor's state, but only when something it depends on has changed.

use eframe::egui_wgpu::RenderState;

use super::scene_texture::SceneTexture;
use crate::editor::Editor;
use crate::frame::{Frame, evaluate};
use crate::library::{Model, ModelId};
use crate::state::{Background, Display, ViewerState, source_on_stage};

pub(super) struct Viewport {
    pub scene: SceneTexture,
    pub frame: Frame,
    /// Size in pixels of the last image; `None` before the first.
    drawn_size: Option<[u32; 2]>,
    needs_redraw: bool,
    /// The model on the device, and the source beside it.
    uploaded: Option<(ModelId, Option<ModelId>)>,
}

impl Viewport {
    pub fn new(gpu: RenderState, samples: u32) -> Self {
        let scene = SceneTexture::new(gpu, samples);
        Self { scene, frame: Frame::default(), drawn_size: None, needs_redraw: true, uploaded: None }
    }

    /// Uploads a model if it fits on the device; the editor asks for this before it activates one.
    pub fn admit(&mut self, model: &Model) -> Result<(), String> {
        self.scene.upload(model, None).map_err(|error| error.to_string())?;
        self.uploaded = Some((model.id, None));
        Ok(())
    }

    pub fn draw(&mut self, editor: &mut Editor, size: [u32; 2]) {
        self.needs_redraw |= editor.take_needs_redraw();
        if !self.needs_redraw && self.drawn_size == Some(size) {
            return;
        }
        let (library, state) = (editor.library(), editor.state());
        let source = source_on_stage(library, state).map(|source| source.model);
        let key = library.active().map(|model| (model.id, source.map(|source| source.id)));
        if let Some(model) = library.active().filter(|_| self.uploaded != key) {
            // A source too large for the device shows only its bones.
            let _ = self.scene.upload(model, source);
            self.uploaded = key;
        }
        evaluate(library, state, aspect(size), &mut self.frame);
        self.scene.draw(&self.frame, size);
        self.drawn_size = Some(size);
        self.needs_redraw = false;
    }

    /// Draws the current view at another size, to a texture of its own. The viewport is redrawn afterwards.
    pub fn draw_to_texture(
        &mut self,
        editor: &Editor,
        [width, height]: [u32; 2],
        transparent: bool,
    ) -> (wgpu::Device, wgpu::Queue, wgpu::Texture) {
        let max = self.scene.max_size();
        let size = [width.clamp(1, max), height.clamp(1, max)];
        let state = editor.state();
        let background = if transparent { Background::Transparent } else { state.display.background };
        let state = ViewerState { display: Display { background, ..state.display }, ..state.clone() };
        let mut frame = Frame::default();
        evaluate(editor.library(), &state, aspect(size), &mut frame);
        self.needs_redraw = true;
        self.scene.draw_to_texture(&frame, size)
    }
}

fn aspect([width, height]: [u32; 2]) -> f32 {
    width as f32 / height as f32
}
