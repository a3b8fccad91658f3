//! Saving files for the user: the editor's exports, and images, which take the graphics device.

use gaitway_render::read_pixels;
use gaitway_scene::editor::ExportedFile;
use gaitway_scene::library::Model;

use super::App;
#[cfg(target_arch = "wasm32")]
use super::Message;
use crate::files::{encode_png, has_ktx2};
use crate::ui::Saved;

impl App {
    /// Saves a file.
    pub(super) fn save(&mut self, what: Saved) {
        // In the page, an image arrives in a later turn of the event loop.
        #[cfg(target_arch = "wasm32")]
        if let Saved::Picture { size, transparent } = what {
            let (image, inbox) = (self.image(size, transparent), self.inbox.clone());
            wasm_bindgen_futures::spawn_local(async move {
                inbox.send(match image.await {
                    Ok(file) => Message::Save(file),
                    Err(error) => Message::Saved(Err(error)),
                });
            });
            return;
        }
        match self.file(what) {
            Ok(file) => self.host.save_file(file, &self.inbox),
            Err(error) => self.add_error(&error),
        }
    }

    /// Saves a self-contained page that shows the scene.
    pub(super) fn save_page(&mut self) {
        let has_ktx2 = self.editor.library().active().is_some_and(|model| has_ktx2(&model.asset));
        match self.editor.scene() {
            Ok(scene) => self.host.save_page(scene, has_ktx2),
            Err(error) => self.add_error(&error),
        }
    }

    fn file(&mut self, what: Saved) -> Result<ExportedFile, String> {
        match what {
            Saved::File(export) => self.editor.export(&export),
            #[cfg(target_arch = "wasm32")]
            Saved::Picture { .. } => Err("images are saved once they have been read back".to_owned()),
            #[cfg(not(target_arch = "wasm32"))]
            Saved::Picture { size, transparent } => pollster::block_on(self.image(size, transparent)),
        }
    }

    /// Renders the current view at another size as a PNG.
    fn image(
        &mut self,
        asked: [u32; 2],
        transparent: bool,
    ) -> impl Future<Output = Result<ExportedFile, String>> + use<> {
        let name = format!("{}.png", self.editor.file_stem());
        let size = self.viewport.picture_size(asked);
        let is_bare = self.editor.library().active().is_some_and(Model::awaits_images);
        let remark = if size == asked {
            is_bare.then(|| "The model's images have not arrived, so it shows none.".to_owned())
        } else {
            let ([width, height], [asked_width, asked_height]) = (size, asked);
            Some(format!("It is {width} × {height} pixels: this device can't draw {asked_width} × {asked_height}."))
        };
        let (device, queue, texture) =
            self.viewport.draw_off_screen(self.editor.library(), self.editor.state(), size, transparent);
        self.viewport.give_image_away();
        async move { Ok(ExportedFile { name, bytes: read_png(&device, &queue, &texture).await?, remark }) }
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
