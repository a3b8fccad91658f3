//! Files that the person gets: the joint map in force, the model with a borrowed clip.

use super::App;
use crate::formats::{write_model, write_motion};
use crate::retarget::{bake_layers, baking};
use crate::state::{map_in_force, named};
use crate::ui::{Saved, short_name};

/// What to write, and how to call it.
pub(super) struct FileToSave {
    pub name: String,
    pub bytes: Vec<u8>,
    /// What the person should know about it.
    pub remark: Option<String>,
}

impl App {
    pub(super) fn file_to_save(&self, what: Saved) -> Result<FileToSave, String> {
        match what {
            Saved::Map { motion } => self.map_file(motion),
            Saved::Model { clip } => self.model_file(clip),
        }
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

    /// The model's own file with the clip behind its clips; skeleton and clip alone where there is no file.
    fn model_file(&self, clip: usize) -> Result<FileToSave, String> {
        let model = self.library.active().ok_or("there is no model")?;
        let borrowed = model.borrowed(clip).ok_or("this clip is one of the model's own")?;
        let baking = baking(&borrowed.clip, &borrowed.layers, None);
        let layered = !borrowed.layers.is_empty();
        let baked = layered.then(|| bake_layers(&model.asset, &borrowed.clip, &borrowed.layers, &baking));
        let clips = [baked.as_ref().unwrap_or(&borrowed.clip)];
        let mut remark = None;
        let bytes = match &self.model_files {
            Some((files, name)) if !name.to_lowercase().ends_with(".bvh") => {
                write_model(files, name, &model.asset.skeleton, &clips)
            }
            _ => {
                remark =
                    Some("Skeleton and clip alone: this model has no file that a clip could be added to.".to_owned());
                write_motion(&model.asset, &clips)
            }
        };
        if layered && !baking.seamless {
            remark = Some(
                "The model's own clip does not come out even with the borrowed one: the loop shows a seam.".to_owned(),
            );
        }
        let motion = self.library.motions().get(borrowed.motion).map_or("motion", |motion| &motion.source);
        let name = format!("{}-{}.glb", stem(&model.source), stem(motion));
        Ok(FileToSave { name, bytes: bytes.map_err(|error| error.to_string())?, remark })
    }
}

/// A file's name without its ending.
fn stem(source: &str) -> String {
    let name = short_name(source);
    name.rsplit_once('.').map_or(name.clone(), |(stem, _)| stem.to_owned())
}
