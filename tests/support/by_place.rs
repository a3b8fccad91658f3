//! Clips and motions by their place in the list, as tests count them.

use std::sync::Arc;

use gaitway_scene::library::{ClipId, Library, Model, ModelClip, Motion, MotionId};

/// Clips of a model: its own, then borrowed ones, then copies.
pub trait ByPlace {
    /// The clip at this place.
    fn clip_at(&self, place: usize) -> &ModelClip;
    /// Its identity.
    fn id_at(&self, place: usize) -> ClipId;
    /// All display names.
    fn titles(&self) -> Vec<&str>;
}

impl ByPlace for Model {
    fn clip_at(&self, place: usize) -> &ModelClip {
        self.clips().iter().nth(place).unwrap_or_else(|| panic!("no clip {place} of {}", self.clips().len()))
    }

    fn id_at(&self, place: usize) -> ClipId {
        self.clip_at(place).id().clone()
    }

    fn titles(&self) -> Vec<&str> {
        self.clips().titles().collect()
    }
}

/// The identity of a motion.
pub fn motion_at(library: &Library, place: usize) -> MotionId {
    library.motions()[place].id().clone()
}

/// The identity of a motion that is the first from a file of this name.
pub fn motion_called(name: &str) -> MotionId {
    let mut library = Library::default();
    library.set_motions(vec![Motion::new(name.to_owned(), Arc::default())]);
    motion_at(&library, 0)
}
