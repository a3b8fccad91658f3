//! A model shown before its images have arrived. It is replaced once its file is complete; see `Editor::complete`.
//!
//! The complete file takes the usual path, and what it gives takes this model's place. Parsing it a second time takes
//! milliseconds, and so no other code has to know how to add images to a model. Until then it is neither exported nor
//! recorded.
//!
//! This is only for a page that starts with a link to a single file: one that shows something already keeps that until the
//! next model is complete.

use gaitway_character::anim::TextureSlot;
use gaitway_character::asset::Asset;
use gaitway_formats::{Early, FileSet, LoadOptions, early, load_named};
use gaitway_scene::library::{ImageData, Images, Model, container_of};
use gaitway_scene::state::{EnvironmentChoice, MotionMap, ViewerState};

/// Watches the download of a model for the moment from which it can be shown.
pub struct EarlyWatch<'a> {
    /// What a view lists to open the file again.
    origin: String,
    show: &'a dyn Fn(Model),
    /// Nothing can be done with fewer bytes.
    needed_bytes: usize,
}

impl<'a> EarlyWatch<'a> {
    /// Returns a watch that calls `show` at most once; `None` if a view's model isn't all that it downloads.
    pub fn of(view: &ViewerState, show: &'a dyn Fn(Model)) -> Option<Self> {
        let [model] = &view.character.sources.model[..] else { return None };
        let is_all = view.character.sources.motion.is_empty()
            && !view.character.retarget.map.iter().any(|map| matches!(map, MotionMap::File(_)))
            && !matches!(view.lighting.environment, EnvironmentChoice::File(_));
        // A sample may consist of several files, and an archive does.
        let is_file = !model.starts_with("sample:") && container_of(model) == model;
        (is_all && is_file).then(|| Self { origin: model.clone(), show, needed_bytes: 0 })
    }

    /// Must be called with all that has arrived of the file `name`, whenever more of it has.
    pub fn notice(&mut self, name: &str, bytes: &[u8]) {
        if bytes.len() < self.needed_bytes {
            return;
        }
        self.needed_bytes = match early(bytes) {
            Some(Early::Wait(bytes)) => bytes,
            Some(Early::Ready(glb)) => {
                // Errors are those of the complete file.
                open(&self.origin, name, glb).into_iter().for_each(self.show);
                usize::MAX
            }
            None => usize::MAX,
        };
    }
}

fn open(origin: &str, name: &str, glb: Vec<u8>) -> Option<Model> {
    let mut files = FileSet::default();
    files.insert(name, glb);
    let asset = load_named(&files, name, &LoadOptions { awaits_images: true, ..LoadOptions::default() }).ok()?;
    let images = Images::Awaited(stand_ins(&asset));
    Some(Model::new(origin.to_owned(), asset, images))
}

/// Returns a texel for each image. With a texture in its place, a surface already has the shaders that it keeps.
fn stand_ins(asset: &Asset) -> Vec<Option<ImageData>> {
    let mut images = vec![None; asset.images.len()];
    for material in &asset.materials {
        for slot in TextureSlot::ALL {
            let texture = material.texture(slot).and_then(|reference| asset.textures.get(reference.texture));
            if let Some(image) = texture.and_then(|texture| images.get_mut(texture.image?)) {
                image.get_or_insert_with(|| ImageData::Rgba8 { width: 1, height: 1, pixels: texel(slot).into() });
            }
        }
    }
    images
}

fn texel(slot: TextureSlot) -> [u8; 4] {
    match slot {
        TextureSlot::Normal | TextureSlot::ClearcoatNormal => [128, 128, 255, 255],
        // Rough, not metallic and not occluded.
        TextureSlot::MetallicRoughness => [255, 255, 0, 255],
        TextureSlot::Emissive | TextureSlot::Matcap | TextureSlot::ShadingShift => [0, 0, 0, 255],
        _ => [255; 4],
    }
}
