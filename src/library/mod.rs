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

use std::sync::OnceLock;

use crate::retarget::{Figures, FootTrack, JointMap, MapError, Proposal, propose};

/// Which model is shown and which files it borrows from.
#[derive(Debug, Clone)]
pub struct Loaded {
    pub model: ModelId,
    pub motions: Vec<Motion>,
}

fn borrow_motion(
    model: &Model,
    motion: &Motion,
    index: usize,
    map: Option<&JointMap>,
) -> Result<Vec<BorrowedClip>, BorrowError> {
    let (map, proposal) = map_for(&model.asset, &motion.asset, map);
    let resolved = match proposal {
        Some(proposal) if proposal.pairs.is_empty() => Err(MapError::NothingInCommon),
        _ => map.resolve(&model.asset, &motion.asset),
    };
    let resolved = resolved.map_err(|problem| BorrowError::Map { motion: motion.source.clone(), problem })?;
    motion::borrow(model.body(), motion, index, &resolved, |clip| rig::root_of(&model.asset, clip))
}

/// The loaded models, one of which is shown, and the motions that it borrows.
#[derive(Debug, Default)]
pub struct Library {
    /// In the order they were opened.
    models: Vec<Model>,
    /// Off the list, the one that was closed last at the end.
    closed: Vec<Model>,
    shown: ModelId,
    /// Files that the shown model borrows clips from.
    motions: Vec<Motion>,
    /// The map for each motion that the borrowed clips were made with; none when they are to be made.
    borrowed_with: Option<Vec<Option<JointMap>>>,
    /// What would be proposed for each motion over the shown model, once somebody has asked.
    proposals: Vec<OnceLock<Proposal>>,
    borrow_errors: Vec<BorrowError>,
    next_id: u64,
}

impl Library {
    /// As many models are held: each keeps its meshes and images.
    pub const MOST_MODELS: usize = 8;
    /// Every clip of every motion is made over for the model, which takes time and memory.
    pub const MOST_MOTIONS: usize = 64;

    /// Replaces everything by one model.
    pub fn set(&mut self, model: Model) -> ModelId {
        self.models.clear();
        self.closed.clear();
        self.add(model)
    }

    /// Takes in one more model and shows it.
    pub fn add(&mut self, mut model: Model) -> ModelId {
        self.next_id += 1;
        model.id = ModelId(self.next_id);
        self.models.push(model);
        self.show(ModelId(self.next_id));
        ModelId(self.next_id)
    }

    /// Lets go of closed models and then of the oldest others until there are no more than [`Library::MOST_MODELS`]; gives
    /// the others back.
    pub fn trim(&mut self) -> Vec<Model> {
        let spare = (self.models.len() + self.closed.len()).saturating_sub(Self::MOST_MODELS);
        self.closed.drain(..spare.min(self.closed.len()));
        let mut gone = Vec::new();
        while self.models.len() > Self::MOST_MODELS
            && let Some(oldest) = self.models.iter().position(|model| model.id != self.shown)
        {
            gone.push(self.models.remove(oldest));
        }
        gone
    }

    /// Shows one of the models, which puts a closed one back on the list; false when it is not there.
    pub fn show(&mut self, id: ModelId) -> bool {
        let is_there = self.get(id).is_some();
        if let Some(at) = self.closed.iter().position(|model| model.id == id) {
            self.models.push(self.closed.remove(at));
        }
        if is_there && self.shown != id {
            self.shown = id;
            self.forget_borrowed();
        }
        is_there
    }

    /// Lets go of a model for good, other than the one that is shown.
    pub fn remove(&mut self, id: ModelId) {
        let shown = self.shown;
        self.models.retain(|model| model.id == shown || model.id != id);
    }

    /// Takes a model, other than the one that is shown, off the list; while there is room it can come back.
    pub fn close(&mut self, id: ModelId) {
        if let Some(at) = self.models.iter().position(|model| model.id == id && id != self.shown) {
            self.closed.push(self.models.remove(at));
        }
    }

    /// Which models are on the list.
    pub fn listed(&self) -> Vec<ModelId> {
        self.models.iter().map(|model| model.id).collect()
    }

    /// Puts these models on the list, and the one that is shown, and closes the others.
    pub fn set_listed(&mut self, ids: &[ModelId]) {
        let place = |model: &Model| ids.iter().position(|&id| id == model.id);
        let all = self.closed.drain(..).chain(self.models.drain(..));
        (self.models, self.closed) = all.partition(|model| place(model).is_some() || model.id == self.shown);
        self.models.sort_by_key(|model| place(model).unwrap_or(ids.len()));
    }

    /// What is shown and what it borrows, to come back to.
    pub fn loaded(&self) -> Loaded {
        Loaded { model: self.shown, motions: self.motions.clone() }
    }

    /// Shows what was shown before; false when that model has gone.
    pub fn restore(&mut self, loaded: Loaded) -> bool {
        let is_there = self.show(loaded.model);
        if is_there {
            self.set_motions(loaded.motions);
        }
        is_there
    }

    fn forget_borrowed(&mut self) {
        self.borrowed_with = None;
        self.proposals = self.motions.iter().map(|_| OnceLock::new()).collect();
    }

    pub fn motions(&self) -> &[Motion] {
        &self.motions
    }

    /// Replaces the files that clips are borrowed from.
    pub fn set_motions(&mut self, mut motions: Vec<Motion>) {
        for motion in motions.iter_mut().filter(|motion| motion.stage_id == ModelId::default()) {
            self.next_id += 1;
            motion.stage_id = ModelId(self.next_id);
        }
        self.motions = motions;
        self.forget_borrowed();
    }

    /// What is proposed for a motion over the shown model; worked out once.
    pub fn proposal(&self, motion: usize) -> Option<&Proposal> {
        let (model, slot) = (self.active()?, self.proposals.get(motion)?);
        let motion = self.motions.get(motion)?;
        Some(slot.get_or_init(|| propose(&model.asset, &motion.asset)))
    }

    /// Makes the borrowed clips of the shown model, if anything that they hang on has changed; true when it has. Without a
    /// map, one is proposed for each motion. What does not work is in [`Library::borrow_errors`]; the rest is there.
    pub fn borrow(&mut self, map: Option<&JointMap>) -> bool {
        let maps = vec![map.cloned(); self.motions.len()];
        self.borrow_each(maps)
    }

    /// As [`Library::borrow`], with a map for each motion.
    pub fn borrow_each(&mut self, maps: Vec<Option<JointMap>>) -> bool {
        if self.borrowed_with.as_ref() == Some(&maps) {
            return false;
        }
        self.borrow_errors.clear();
        let mut borrowed = Vec::new();
        let shown = self.shown;
        if let Some(model) = self.models.iter_mut().find(|model| model.id == shown) {
            for (index, motion) in self.motions.iter().enumerate() {
                match borrow_motion(model, motion, index, maps.get(index).and_then(Option::as_ref)) {
                    Ok(clips) => borrowed.extend(clips),
                    Err(error) => self.borrow_errors.push(error),
                }
            }
            model.set_borrowed(borrowed);
        }
        self.borrowed_with = Some(maps);
        true
    }

    /// The figures of a clip that the shown model has borrowed; none for its own.
    pub fn figures(&self, clip: usize) -> Option<&Figures> {
        Some(&self.measured(clip)?.0)
    }

    /// What the feet of the shown model do in a clip that it has borrowed.
    pub fn foot_tracks(&self, clip: usize) -> &[FootTrack] {
        self.measured(clip).map_or(&[], |(_, tracks)| tracks)
    }

    fn measured(&self, clip: usize) -> Option<&(Figures, Vec<FootTrack>)> {
        let model = self.active()?;
        let borrowed = model.borrowed(clip)?;
        borrowed.measured(model.body(), self.motions.get(borrowed.motion)?)
    }

    /// Why motions could not be borrowed, as of the last [`Library::borrow`].
    pub fn borrow_errors(&self) -> &[BorrowError] {
        &self.borrow_errors
    }

    /// Those on the list.
    pub fn models(&self) -> &[Model] {
        &self.models
    }

    /// The model that is shown and edited.
    pub fn active(&self) -> Option<&Model> {
        self.get(self.shown)
    }

    /// A model, whether it is on the list or closed.
    pub fn get(&self, id: ModelId) -> Option<&Model> {
        self.models.iter().chain(&self.closed).find(|model| model.id == id)
    }
}
