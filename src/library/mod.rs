//! Everything that is loaded: assets with their decoded images, and what is derived from them once and kept.

mod extent;
mod image;
mod inspect;
mod model;
mod rig;
pub mod sample;

pub use image::ImageData;
pub use inspect::{inspect, warning_documents};
pub use model::{Model, ModelId};
pub use rig::{Rig, RigBone};

/// The loaded models, in the order they were opened.
#[derive(Debug, Default)]
pub struct Library {
    models: Vec<Model>,
    next_id: u64,
}

impl Library {
    /// Replaces everything by one model.
    pub fn set(&mut self, mut model: Model) -> ModelId {
        self.next_id += 1;
        model.id = ModelId(self.next_id);
        self.models.clear();
        self.models.push(model);
        ModelId(self.next_id)
    }

    /// Takes everything out, so that it can be put back when what follows does not work.
    pub fn take(&mut self) -> Vec<Model> {
        std::mem::take(&mut self.models)
    }

    /// Undoes [`Library::take`].
    pub fn put_back(&mut self, models: Vec<Model>) {
        self.models = models;
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
