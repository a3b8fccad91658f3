//! Files that the person gets: the joint map in force, the model with a borrowed clip, the clip alone, a picture.

use super::App;
use crate::anim::Clip;
use crate::files::{ModelFiles, encode_png};
use crate::formats::{write_model, write_motion};
use crate::frame::{Frame, evaluate};
use crate::library::Model;
use crate::render::read_pixels;
use crate::retarget::{bake_layers, baking};
use crate::state::{Background, ViewerState, active_clip, map_in_force, named, written_skeleton};
use crate::ui::{Saved, short_name};

/// What to write, and how to call it.
pub(super) struct FileToSave {
    pub name: String,
    pub bytes: Vec<u8>,
    /// What the person should know about it.
    pub remark: Option<String>,
}

impl App {
    pub(super) fn file_to_save(&mut self, what: Saved) -> Result<FileToSave, String> {
        match what {
            Saved::Map { motion } => self.map_file(motion),
            Saved::Model { clip } => self.model_file(clip),
            Saved::Clip { clip } => self.clip_file(clip),
            Saved::Whole { posed } => self.whole_file(posed),
            // On the page reading back takes turns of its event loop: [`App::act`] waits for it.
            #[cfg(target_arch = "wasm32")]
            Saved::Picture { .. } => Err("a picture is saved once it has been read back".to_owned()),
            #[cfg(not(target_arch = "wasm32"))]
            Saved::Picture { size, transparent } => {
                let picture = self.draw_for_file(size, transparent);
                Ok(FileToSave { name: self.picture_name(), bytes: pollster::block_on(picture)?, remark: None })
            }
        }
    }

    /// As the model, and when the clip plays it.
    fn file_stem(&self) -> String {
        let model = self.library.active();
        let clip = model.and_then(|model| model.clip_titles().get(active_clip(model, &self.state)?));
        let parts = [model.map(|model| stem(&model.source)), clip.cloned()];
        let name = parts.into_iter().flatten().collect::<Vec<_>>().join("-");
        name.chars()
            .map(|letter| if letter.is_alphanumeric() || "-_. ".contains(letter) { letter } else { '-' })
            .collect()
    }

    pub(super) fn picture_name(&self) -> String {
        format!("{}.png", self.file_stem())
    }

    pub(super) fn video_name(&self) -> String {
        format!("{}.webm", self.file_stem())
    }

    /// Draws the present view at another size, and reads it back as a PNG. The picture on the screen is drawn anew after.
    pub(super) fn draw_for_file(
        &mut self,
        [width, height]: [u32; 2],
        transparent: bool,
    ) -> impl Future<Output = Result<Vec<u8>, String>> + use<> {
        let largest = self.scene.largest_size();
        let size = [width.clamp(1, largest), height.clamp(1, largest)];
        let background = if transparent { Background::Transparent } else { self.state.background };
        let state = ViewerState { background, ..self.state.clone() };
        let mut frame = Frame::default();
        evaluate(&self.library, &state, size[0] as f32 / size[1] as f32, &mut frame);
        let (device, queue, texture) = self.scene.draw_apart(&frame, size);
        self.dirty = true;
        async move {
            let pixels = read_pixels(&device, &queue, &texture).await;
            let png = encode_png(texture.width(), texture.height(), &pixels);
            png.ok_or_else(|| "the picture could not be read back from the graphics device".to_owned())
        }
    }

    /// One clip with the skeleton it moves.
    fn clip_file(&self, clip: usize) -> Result<FileToSave, String> {
        let model = self.library.active().ok_or("there is no model")?;
        let made = self.baked_clip(clip)?;
        let clip = made.clip.as_ref().or_else(|| model.clip(clip)).ok_or("there is no such clip")?;
        let bytes = write_motion(&model.asset, &written_skeleton(model, &self.state, None), &[clip])
            .map_err(|error| error.to_string())?;
        Ok(FileToSave { name: format!("{}.glb", self.file_stem()), bytes, remark: made.remark })
    }

    /// With names instead of numbers, for people to read.
    fn map_file(&self, motion: usize) -> Result<FileToSave, String> {
        let gone = || "there is no motion any more".to_owned();
        let (model, about) = (self.library.active().ok_or_else(gone)?, self.library.motions().get(motion));
        let about = about.ok_or_else(gone)?;
        let map = map_in_force(&self.library, &self.state, motion).unwrap_or_default();
        let json = named(&map, &model.asset, &about.asset).to_json().map_err(|error| error.to_string())?;
        let name = format!("{}-{}.json", stem(&model.source), stem(&about.source));
        Ok(FileToSave { name, bytes: json.into_bytes(), remark: None })
    }

    fn model_files(&self, model: &Model) -> Option<&ModelFiles> {
        self.shelf.get(&model.id)?.files.as_ref()
    }

    /// A model that is not a glTF as one.
    fn whole_file(&self, posed: bool) -> Result<FileToSave, String> {
        let model = self.library.active().ok_or("there is no model")?;
        let ModelFiles { set, name } = self.model_files(model).ok_or("this model has no file")?;
        let mut frame = Frame::default();
        evaluate(&self.library, &self.state, 1.0, &mut frame);
        let skeleton = written_skeleton(model, &self.state, posed.then_some(frame.pose()));
        let bytes = write_model(set, name, &skeleton, &[]).map_err(|error| error.to_string())?;
        Ok(FileToSave { name: format!("{}.glb", stem(&model.source)), bytes, remark: None })
    }

    fn baked_clip(&self, clip: usize) -> Result<BakedClip, String> {
        let model = self.library.active().ok_or("there is no model")?;
        let Some(borrowed) = model.borrowed(clip).filter(|borrowed| !borrowed.layers.is_empty()) else {
            return Ok(BakedClip { clip: None, remark: None });
        };
        let baking = baking(&borrowed.clip, &borrowed.layers, None);
        let clip = bake_layers(&model.asset, &borrowed.clip, &borrowed.layers, &baking);
        let seam = "The model's own clip does not come out even with the borrowed one: the loop shows a seam.";
        Ok(BakedClip { clip: Some(clip), remark: (!baking.seamless).then(|| seam.to_owned()) })
    }

    /// The model's own file with the clip behind its clips; skeleton and clip alone where there is no file.
    fn model_file(&self, clip: usize) -> Result<FileToSave, String> {
        let model = self.library.active().ok_or("there is no model")?;
        let borrowed = model.borrowed(clip).ok_or("this clip is one of the model's own")?;
        let baked = self.baked_clip(clip)?;
        let clips = [baked.clip.as_ref().unwrap_or(&borrowed.clip)];
        let mut remark = None;
        let skeleton = written_skeleton(model, &self.state, None);
        let bytes = match self.model_files(model) {
            Some(ModelFiles { set, name }) if !name.to_lowercase().ends_with(".bvh") => {
                write_model(set, name, &skeleton, &clips)
            }
            _ => {
                remark =
                    Some("Skeleton and clip alone: this model has no file that a clip could be added to.".to_owned());
                write_motion(&model.asset, &skeleton, &clips)
            }
        };
        let remark = baked.remark.or(remark);
        let motion = self.library.motions().get(borrowed.motion).map_or("motion", |motion| &motion.source);
        let name = format!("{}-{}.glb", stem(&model.source), stem(motion));
        Ok(FileToSave { name, bytes: bytes.map_err(|error| error.to_string())?, remark })
    }
}

/// A clip with what plays below it, where anything does.
struct BakedClip {
    clip: Option<Clip>,
    remark: Option<String>,
}

/// A file's name without its ending.
fn stem(source: &str) -> String {
    let name = short_name(source);
    name.rsplit_once('.').map_or(name.clone(), |(stem, _)| stem.to_owned())
}
