//! Everything that is loaded: assets with their decoded images, and what is derived from them once and kept.

mod extent;
mod image;
mod inspect;
mod model;
mod motion;
mod rig;
pub mod sample;

pub use image::ImageData;
pub use inspect::{inspect, warning_documents};
pub use model::{Model, ModelId};
pub use motion::{BorrowError, BorrowedClip, Motion, map_for};
pub use rig::{Rig, RigBone};

use crate::retarget::JointMap;

fn borrow_motion(
    model: &Model,
    motion: &Motion,
    index: usize,
    map: Option<&JointMap>,
) -> Result<Vec<BorrowedClip>, BorrowError> {
    let (map, _) = map_for(&model.asset, &motion.asset, map);
    let resolved = map.resolve(&model.asset, &motion.asset);
    let resolved = resolved.map_err(|problem| BorrowError::Map { motion: motion.source.clone(), problem })?;
    motion::borrow(model.body(), motion, index, &resolved, |clip| rig::root_of(&model.asset, clip))
}

/// The loaded models, in the order they were opened.
#[derive(Debug, Default)]
pub struct Library {
    models: Vec<Model>,
    /// Files that the shown model borrows clips from.
    motions: Vec<Motion>,
    /// What the borrowed clips were made with; none when they are to be made.
    borrowed_with: Option<Option<JointMap>>,
    borrow_errors: Vec<BorrowError>,
    next_id: u64,
}

impl Library {
    /// Replaces everything by one model.
    pub fn set(&mut self, mut model: Model) -> ModelId {
        self.next_id += 1;
        model.id = ModelId(self.next_id);
        self.models.clear();
        self.models.push(model);
        self.borrowed_with = None;
        ModelId(self.next_id)
    }

    /// Takes everything out, so that it can be put back when what follows does not work.
    pub fn take(&mut self) -> Vec<Model> {
        std::mem::take(&mut self.models)
    }

    /// Undoes [`Library::take`].
    pub fn put_back(&mut self, models: Vec<Model>) {
        self.models = models;
        self.borrowed_with = None;
    }

    pub fn motions(&self) -> &[Motion] {
        &self.motions
    }

    /// Replaces the files that clips are borrowed from.
    pub fn set_motions(&mut self, motions: Vec<Motion>) {
        self.motions = motions;
        self.borrowed_with = None;
    }

    /// Makes the borrowed clips of the shown model, if anything that they hang on has changed; true when it has. Without a
    /// map, one is proposed for each motion. What does not work is in [`Library::borrow_errors`]; the rest is there.
    pub fn borrow(&mut self, map: Option<&JointMap>) -> bool {
        if self.borrowed_with.as_ref().is_some_and(|with| with.as_ref() == map) {
            return false;
        }
        self.borrowed_with = Some(map.cloned());
        self.borrow_errors.clear();
        let Some(model) = self.models.first_mut() else { return true };
        let mut borrowed = Vec::new();
        for (index, motion) in self.motions.iter().enumerate() {
            match borrow_motion(model, motion, index, map) {
                Ok(clips) => borrowed.extend(clips),
                Err(error) => self.borrow_errors.push(error),
            }
        }
        model.set_borrowed(borrowed);
        true
    }

    /// Why motions could not be borrowed, as of the last [`Library::borrow`].
    pub fn borrow_errors(&self) -> &[BorrowError] {
        &self.borrow_errors
    }

    pub fn models(&self) -> &[Model] {
        &self.models
    }

    /// The model that is shown and edited.
    pub fn active(&self) -> Option<&Model> {
        self.models.first()
    }

    pub fn get(&self, id: ModelId) -> Option<&Model> {
        self.models.iter().find(|model| model.id == id)
    }
}
