//! Saving files for the user: the editor's exports, and images, which take the graphics device.

use super::App;
#[cfg(target_arch = "wasm32")]
use super::Message;
use crate::editor::ExportedFile;
use crate::files::encode_png;
use crate::render::read_pixels;
use crate::ui::{PathPrompt, PathPurpose, Saved};

impl App {
    /// Saves a file, or asks for its path if the platform needs one.
    pub(super) fn save(&mut self, what: Saved) {
        // In the page, an image arrives in a later turn of the event loop.
        #[cfg(target_arch = "wasm32")]
        if let Saved::Picture { size, transparent } = what {
            let (image, name, inbox) = (self.image(size, transparent), self.image_name(), self.inbox.clone());
            wasm_bindgen_futures::spawn_local(async move {
                inbox.send(match image.await {
                    Ok(bytes) => Message::Save(name, bytes),
                    Err(error) => Message::Failed(error),
                });
            });
            return;
        }
        match self.file(what) {
            Ok(file) => self.deliver(what, file),
            Err(error) => self.add_error(&error),
        }
    }

    fn deliver(&mut self, what: Saved, file: ExportedFile) {
        if self.host.save_file(&file.name, &file.bytes) {
            self.toast(file.remark.unwrap_or_else(|| format!("Saved {}.", file.name)));
        } else {
            self.panels.messages.path_prompt = Some(PathPrompt { purpose: PathPurpose::Save(what), path: file.name });
        }
    }

    /// Writes a file to the path that the user typed.
    pub(super) fn save_to(&mut self, what: Saved, path: &str) {
        match self.file(what).and_then(|file| self.host.save_path(path, &file.bytes)) {
            Ok(()) => self.toast(format!("Saved as {path}.")),
            Err(error) => self.add_error(&error),
        }
    }

    fn file(&mut self, what: Saved) -> Result<ExportedFile, String> {
        match what {
            Saved::File(export) => self.editor.export(export),
            #[cfg(target_arch = "wasm32")]
            Saved::Picture { .. } => Err("images are saved once they have been read back".to_owned()),
            #[cfg(not(target_arch = "wasm32"))]
            Saved::Picture { size, transparent } => {
                let bytes = pollster::block_on(self.image(size, transparent))?;
                Ok(ExportedFile { name: self.image_name(), bytes, remark: None })
            }
        }
    }

    fn image_name(&self) -> String {
        format!("{}.png", self.editor.file_stem())
    }

    pub(super) fn video_name(&self) -> String {
        format!("{}.webm", self.editor.file_stem())
    }

    /// Renders the current view at another size as a PNG.
    fn image(&mut self, size: [u32; 2], transparent: bool) -> impl Future<Output = Result<Vec<u8>, String>> + use<> {
        let (device, queue, texture) = self.viewport.draw_to_texture(&self.editor, size, transparent);
        async move { read_png(&device, &queue, &texture).await }
    }

    /// Starts reading the viewport back as a PNG for each script that requested it.
    pub(super) fn answer_screenshots(&mut self) {
        for reply in self.screenshots.drain(..) {
            let (device, queue, texture) = self.viewport.scene.last_image();
            let screenshot = async move { reply(read_png(&device, &queue, &texture).await) };
            #[cfg(target_arch = "wasm32")]
            wasm_bindgen_futures::spawn_local(screenshot);
            #[cfg(not(target_arch = "wasm32"))]
            pollster::block_on(screenshot);
        }
    }
}

async fn read_png(device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture) -> Result<Vec<u8>, String> {
    let pixels = read_pixels(device, queue, texture).await;
    let png = encode_png(texture.width(), texture.height(), &pixels);
    png.ok_or_else(|| "couldn't read the image back from the graphics device".to_owned())
}
