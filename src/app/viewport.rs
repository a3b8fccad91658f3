//! The viewport: evaluates and draws the editor's state, but only when something it depends on has changed.

use eframe::egui_wgpu::RenderState;
use gaitway_scene::editor::Editor;
use gaitway_scene::frame::{Frame, evaluate};
use gaitway_scene::library::{Library, Model, ModelId};
use gaitway_scene::state::{Background, Display, ViewerState, source_on_stage};

use super::scene_texture::SceneTexture;

pub(super) struct Viewport {
    pub scene: SceneTexture,
    pub frame: Frame,
    /// Size in pixels of the last image; `None` before the first.
    drawn_size: Option<[u32; 2]>,
    needs_redraw: bool,
    /// Whether the image on screen can be refined.
    can_refine: bool,
    /// When the image on screen was drawn, on egui's clock.
    drawn_at_secs: f64,
    /// The model on the device, and the source beside it.
    uploaded: Option<(ModelId, Option<ModelId>)>,
}

impl Viewport {
    pub fn new(gpu: RenderState) -> Self {
        let scene = SceneTexture::new(gpu);
        Self {
            scene,
            frame: Frame::default(),
            drawn_size: None,
            needs_redraw: true,
            can_refine: false,
            drawn_at_secs: 0.0,
            uploaded: None,
        }
    }

    /// Uploads a model if it fits on the device; the editor asks for this before it activates one.
    pub fn admit(&mut self, model: &Model) -> Result<(), String> {
        self.scene.upload(model, None).map_err(|error| error.to_string())?;
        self.uploaded = Some((model.id, None));
        Ok(())
    }

    /// Evaluates a view that has changed since the last image, without drawing it. Call it before the panels are laid out: they read
    /// the frame, and a message may have opened another model.
    pub fn keep_up(&mut self, editor: &mut Editor) {
        // Before the first image, the frame is empty.
        if let Some(size) = self.drawn_size {
            self.update_frame(editor, size);
        }
    }

    /// Evaluates the view if it changed.
    fn update_frame(&mut self, editor: &mut Editor, size: [u32; 2]) {
        if editor.take_needs_redraw() || self.drawn_size != Some(size) {
            evaluate(editor.library(), editor.state(), aspect(size), &mut self.frame);
            self.needs_redraw = true;
        }
    }

    /// Draws the view if it changed; otherwise, once it has been still for a moment, refines its image by one sample.
    /// Returns the seconds until the next sample, if the image can be refined. `now_secs` is egui's clock.
    pub fn draw(&mut self, editor: &mut Editor, size: [u32; 2], now_secs: f64) -> Option<f64> {
        /// Longer than the pauses within an interaction, which refinement would slow down.
        const STILL_SECS: f64 = 0.25;
        self.update_frame(editor, size);
        if self.needs_redraw {
            self.draw_frame(editor, size);
            self.drawn_at_secs = now_secs;
        }
        let wait_secs = self.drawn_at_secs + STILL_SECS - now_secs;
        if self.can_refine && wait_secs <= 0.0 {
            self.can_refine = self.scene.refine(&self.frame);
        }
        self.can_refine.then_some(wait_secs.max(0.0))
    }

    fn draw_frame(&mut self, editor: &Editor, size: [u32; 2]) {
        let (library, state) = (editor.library(), editor.state());
        let source = source_on_stage(library, state).map(|source| source.model);
        let key = library.active().map(|model| (model.id, source.map(|source| source.id)));
        if let Some(model) = library.active().filter(|_| self.uploaded != key) {
            // A source too large for the device shows only its bones.
            let _ = self.scene.upload(model, source);
            self.uploaded = key;
        }
        self.scene.draw(&self.frame, size);
        self.drawn_size = Some(size);
        self.needs_redraw = false;
        self.can_refine = self.scene.can_refine();
    }

    /// Refines the image on screen completely.
    pub fn refine(&mut self) {
        while self.can_refine {
            self.can_refine = self.scene.refine(&self.frame);
        }
    }

    /// Returns the size of an image that was requested at this size: smaller with the same aspect ratio if the device
    /// cannot draw it.
    pub fn picture_size(&self, size: [u32; 2]) -> [u32; 2] {
        fitted(size, self.scene.max_size())
    }

    /// Draws a view that is not for the screen. The texture stays as it is until the next image is drawn. The viewport is redrawn
    /// afterwards.
    pub fn draw_off_screen(
        &mut self,
        library: &Library,
        state: &ViewerState,
        size: [u32; 2],
        transparent: bool,
    ) -> (wgpu::Device, wgpu::Queue, wgpu::Texture) {
        let background = if transparent { Background::Transparent } else { state.display.background };
        let state = ViewerState { display: Display { background, ..state.display }, ..state.clone() };
        let mut frame = Frame::default();
        evaluate(library, &state, aspect(size), &mut frame);
        frame.remove_axes();
        self.needs_redraw = true;
        self.scene.draw_off_screen(&frame, size)
    }

    /// Keeps the texture of the last image as it is for good.
    pub fn give_image_away(&mut self) {
        self.scene.give_image_away();
    }
}

/// Scales a size down to `max` pixels a side.
pub(super) fn fitted(size: [u32; 2], max: u32) -> [u32; 2] {
    let factor = f64::from(max) / f64::from(size[0].max(size[1]).max(max));
    size.map(|side| ((f64::from(side) * factor).round() as u32).max(1))
}

fn aspect([width, height]: [u32; 2]) -> f32 {
    width as f32 / height as f32
}

#[cfg(test)]
mod tests {
    use super::fitted;

    #[test]
    fn images_too_large_for_the_device_keep_their_aspect() {
        assert_eq!(fitted([3840, 2160], 2048), [2048, 1152]);
        assert_eq!(fitted([1080, 4096], 2048), [540, 2048]);
        assert_eq!(fitted([3840, 2160], 4096), [3840, 2160]);
        assert_eq!(fitted([4096, 1], 2048), [2048, 1]);
    }
}
