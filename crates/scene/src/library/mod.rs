//! Everything that is loaded: models, the motions they borrow, and data derived from them once.

mod borrowed;
mod clips;
mod extent;
mod image;
mod inspect;
mod lints;
mod model;
mod motion;
mod rig;
mod take;

pub use borrowed::{BorrowError, BorrowedClip, map_for, proposal_for, with_expressions};
pub use clips::{
    ClipCopy, ClipEdits, ClipId, Clips, CopyId, ModelClip, MotionId, REST_POSE, SavedNames, clip_file_name,
};
use gaitway_character::anim::Clip;
use gaitway_character::asset::{Panorama, SharedBytes};
use gaitway_character::mesh::Bounds;
use gaitway_character::sort::sort_by_key;
use gaitway_formats::FileSet;
use gaitway_retarget::{Figures, FootTrack, JointMap, MapError, Proposal, RestChoice, has_expressions_alone};
pub use image::{ImageData, Images};
pub use inspect::{inspect, warning_documents};
pub use lints::joint_of_place;
pub use model::{Derived, Finding, Model, ModelId, container_of};
pub use motion::{Motion, names_checksum};
pub use rig::{Rig, RigBone};
pub use take::{
    BakedTake, Held, LayeredClip, LookTarget, Moment, Outgoing, Take, TakeSampler, manual_degrees, manual_rotation,
};

use std::sync::{Arc, OnceLock};

/// The active model and the files it borrows from.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The active model.
    pub model: ModelId,
    /// The motions it borrows, in order.
    pub motions: Vec<Motion>,
}

/// The files a model or motion was read from, and the name of its main file.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelFiles {
    /// All files that were opened together, including the buffers and images that the main file refers to.
    pub set: FileSet,
    /// Path of the main file in `set`.
    pub name: String,
}

/// A loaded environment.
#[derive(Debug, Clone)]
pub struct Environment {
    /// The URL or file name by which views refer to it.
    pub origin: String,
    /// Its light.
    pub panorama: Arc<Panorama>,
    /// The file that it was read from.
    pub file: SharedBytes,
    /// Whether it is one of the user's local files.
    pub is_own: bool,
}

fn borrow_motion(
    model: &Model,
    motion: &Motion,
    map: Option<&JointMap>,
) -> Result<Vec<Arc<BorrowedClip>>, BorrowError> {
    let (map, proposal) = map_for(model, motion, map);
    let resolved = match proposal {
        Some(proposal) if proposal.pairs.is_empty() && !has_expressions_alone(&motion.asset) => {
            Err(MapError::NothingInCommon)
        }
        _ => map.resolve(&model.asset, &motion.asset),
    };
    let resolved = resolved.map_err(|problem| BorrowError::Map { motion: motion.source.clone(), problem })?;
    let root_of = |clip: &_| rig::root_of(&model.asset, clip);
    borrowed::borrow(model.body(), motion, &resolved, root_of)
}

/// What is derived from the active model and a motion.
#[derive(Debug, Default)]
struct Pairing {
    /// The map that the borrowed clips were baked with; `None` was the proposed one.
    baked_with: Option<Arc<JointMap>>,
    /// The proposed map, computed on demand.
    proposal: OnceLock<Proposal>,
    /// See [`names_checksum`]; computed on demand.
    checksum: OnceLock<u32>,
}

/// The loaded models, one of which is active, and the motions it borrows.
#[derive(Debug, Default)]
pub struct Library {
    /// In the order they were opened.
    models: Vec<Model>,
    /// Unlisted models, in the order they were closed.
    closed: Vec<Model>,
    active: ModelId,
    /// Files that the active model borrows clips from.
    motions: Vec<Motion>,
    /// One for each motion.
    pairings: Vec<Pairing>,
    /// Whether the borrowed clips are those of the pairings' maps.
    is_baked: bool,
    borrow_errors: Vec<BorrowError>,
    /// The most recent last.
    environments: Vec<Environment>,
    bounds: take::BoundsCache,
    next_id: u64,
}

impl Library {
    /// Maximum number of models held at once; each keeps its meshes and images.
    pub const MAX_MODELS: usize = 8;
    /// Maximum number of motions held at once; every clip of each is retargeted, which takes time and memory.
    pub const MAX_MOTIONS: usize = 64;

    /// Maximum number of environments held at once; undo and other links may return to them.
    pub const MAX_ENVIRONMENTS: usize = 4;

    /// Adds an environment, replacing any of the same origin.
    pub fn add_environment(&mut self, environment: Environment) {
        self.environments.retain(|known| known.origin != environment.origin);
        if self.environments.len() == Self::MAX_ENVIRONMENTS {
            self.environments.remove(0);
        }
        self.environments.push(environment);
    }

    /// The loaded environments, the most recent last.
    pub fn environments(&self) -> &[Environment] {
        &self.environments
    }

    /// Finds an environment by its origin.
    pub fn environment(&self, origin: &str) -> Option<&Environment> {
        self.environments.iter().find(|known| known.origin == origin)
    }

    /// Adds a model and activates it.
    pub fn add(&mut self, mut model: Model) -> ModelId {
        self.next_id += 1;
        model.id = ModelId(self.next_id);
        self.models.push(model);
        self.show(ModelId(self.next_id));
        ModelId(self.next_id)
    }

    /// Gives a model that was added before its images had arrived those of its `complete` file. Nothing else about it changes.
    pub fn complete(&mut self, id: ModelId, complete: Model) {
        let mut models = self.models.iter_mut().chain(&mut self.closed);
        if let Some(model) = models.find(|model| model.id == id) {
            model.complete(complete);
        }
    }

    /// Evicts closed models, then the oldest others, down to [`Library::MAX_MODELS`]; those that are `precious` come last.
    /// Returns the evicted models that were listed.
    pub fn trim(&mut self, precious: impl Fn(ModelId) -> bool) -> Vec<Model> {
        let spare = (self.models.len() + self.closed.len()).saturating_sub(Self::MAX_MODELS);
        self.closed.drain(..spare.min(self.closed.len()));
        let mut evicted = Vec::new();
        while self.models.len() > Self::MAX_MODELS {
            let inactive = self.models.iter().enumerate().filter(|(_, model)| model.id != self.active);
            // Of several, the first.
            let Some((at, _)) = inactive.min_by_key(|(_, model)| precious(model.id)) else { break };
            evicted.push(self.models.remove(at));
        }
        evicted
    }

    /// Activates a model, listing it again if it was closed; false if it is not in the library.
    pub fn show(&mut self, id: ModelId) -> bool {
        let is_there = self.get(id).is_some();
        if let Some(at) = self.closed.iter().position(|model| model.id == id) {
            let place = self.models.partition_point(|known| known.id < id);
            self.models.insert(place, self.closed.remove(at));
        }
        if is_there && self.active != id {
            self.active = id;
            self.forget_borrowed();
        }
        is_there
    }

    /// Removes a listed model, unless it is active.
    pub fn remove(&mut self, id: ModelId) {
        let active = self.active;
        self.models.retain(|model| model.id == active || model.id != id);
    }

    /// Unlists a model, unless it is active. It can be listed again until it is evicted.
    pub fn close(&mut self, id: ModelId) {
        if let Some(at) = self.models.iter().position(|model| model.id == id && id != self.active) {
            self.closed.push(self.models.remove(at));
        }
    }

    /// Returns the listed models.
    pub fn listed(&self) -> Vec<ModelId> {
        self.models.iter().map(|model| model.id).collect()
    }

    /// Lists these models and the active one, and closes all others.
    pub fn set_listed(&mut self, ids: &[ModelId]) {
        let all = self.closed.drain(..).chain(self.models.drain(..));
        (self.models, self.closed) = all.partition(|model| ids.contains(&model.id) || model.id == self.active);
        sort_by_key(&mut self.models, |model| model.id);
    }

    /// Captures the active model and its motions for [`Library::restore`].
    pub fn loaded(&self) -> Loaded {
        Loaded { model: self.active, motions: self.motions.clone() }
    }

    /// Restores what [`Library::loaded`] captured; false if the model has been evicted.
    pub fn restore(&mut self, loaded: Loaded) -> bool {
        let is_there = self.show(loaded.model);
        if is_there {
            self.set_motions(loaded.motions);
        }
        is_there
    }

    fn forget_borrowed(&mut self) {
        self.is_baked = false;
        self.pairings = self.motions.iter().map(|_| Pairing::default()).collect();
    }

    /// Returns the files that clips are borrowed from.
    pub fn motions(&self) -> &[Motion] {
        &self.motions
    }

    /// Finds a file that clips are borrowed from.
    pub fn motion(&self, id: &MotionId) -> Option<&Motion> {
        self.motions.iter().find(|motion| motion.id() == id)
    }

    /// Replaces the files that clips are borrowed from. Those that were in the list before, or are opened again, keep their
    /// identity.
    pub fn set_motions(&mut self, mut motions: Vec<Motion>) {
        for motion in motions.iter_mut().filter(|motion| motion.stage_id == ModelId::default()) {
            self.next_id += 1;
            motion.stage_id = ModelId(self.next_id);
        }
        MotionId::assign(&mut motions);
        self.motions = motions;
        self.forget_borrowed();
    }

    /// Returns the active model, a motion and what is derived from the two.
    fn pairing(&self, id: &MotionId) -> Option<(&Model, &Motion, &Pairing)> {
        let mut pairings = self.motions.iter().zip(&self.pairings);
        let (motion, pairing) = pairings.find(|(motion, _)| motion.id() == id)?;
        Some((self.active()?, motion, pairing))
    }

    /// Returns the proposed map of a motion to the active model, cached.
    pub fn proposal(&self, motion: &MotionId) -> Option<&Proposal> {
        let (model, motion, pairing) = self.pairing(motion)?;
        Some(pairing.proposal.get_or_init(|| proposal_for(model, motion)))
    }

    /// Returns the [`names_checksum`] of the active model and a motion, cached.
    pub fn names_checksum(&self, motion: &MotionId) -> Option<u32> {
        let (model, motion, pairing) = self.pairing(motion)?;
        Some(*pairing.checksum.get_or_init(|| names_checksum(&model.asset, &motion.asset)))
    }

    /// Returns the map that a motion's clips were baked with. It stays the same allocation until the map changes.
    pub fn baked_map(&self, motion: &MotionId) -> Option<&Arc<JointMap>> {
        self.pairing(motion)?.2.baked_with.as_ref()
    }

    /// Bakes the active model's borrowed clips if their inputs have changed, with one map per motion; returns whether
    /// they had changed. A motion without a map gets the proposed one. Clips of motions whose map is unchanged are
    /// kept. Motions that fail are reported by [`Library::borrow_errors`]; the others still work.
    pub fn borrow_each(&mut self, maps: Vec<Option<JointMap>>) -> bool {
        let mut is_unchanged = vec![self.is_baked; self.motions.len()];
        let maps = maps.into_iter().chain(std::iter::repeat_with(|| None));
        for ((pairing, map), is_unchanged) in self.pairings.iter_mut().zip(maps).zip(&mut is_unchanged) {
            *is_unchanged &= pairing.baked_with.as_deref() == map.as_ref();
            if !*is_unchanged {
                pairing.baked_with = map.map(Arc::new);
            }
        }
        let is_changed = !self.is_baked || is_unchanged.contains(&false);
        if is_changed {
            self.bake(&is_unchanged);
        }
        self.is_baked = true;
        is_changed
    }

    /// Bakes the clips of the motions that aren't unchanged.
    fn bake(&mut self, is_unchanged: &[bool]) {
        self.borrow_errors.clear();
        let active = self.active;
        let Some(model) = self.models.iter_mut().find(|model| model.id == active) else { return };
        let before = model.shared_borrowed();
        let mut borrowed = Vec::new();
        for ((motion, pairing), is_unchanged) in self.motions.iter().zip(&self.pairings).zip(is_unchanged) {
            let kept = before.iter().filter(|clip| *is_unchanged && clip.motion == *motion.id());
            let kept: Vec<_> = kept.cloned().collect();
            if !kept.is_empty() {
                borrowed.extend(kept);
                continue;
            }
            match borrow_motion(model, motion, pairing.baked_with.as_deref()) {
                Ok(clips) => borrowed.extend(clips),
                Err(error) => self.borrow_errors.push(error),
            }
        }
        model.set_borrowed(&borrowed);
    }

    /// Replaces what the user has done to the active model's clips: copies, names and changes. Only clips whose changes or
    /// originals differ from before are computed again; returns whether any edit differs from before.
    pub fn edit_clips(&mut self, edits: &ClipEdits) -> bool {
        self.active_mut().is_some_and(|model| model.edit_clips(edits))
    }

    fn active_mut(&mut self) -> Option<&mut Model> {
        self.models.iter_mut().find(|model| model.id == self.active)
    }

    /// Quality figures of a borrowed clip; none for the model's own clips.
    pub fn figures(&self, clip: &ClipId) -> Option<&Figures> {
        Some(&self.measured(clip)?.0)
    }

    /// Foot-contact tracks of a borrowed clip.
    pub fn foot_tracks(&self, clip: &ClipId) -> &[FootTrack] {
        self.measured(clip).map_or(&[], |(_, tracks)| tracks)
    }

    /// A borrowed clip retargeted from another rest of its motion; `None` for the model's own clips.
    pub fn clip_from_rest(&self, clip: &ClipId, rest: RestChoice) -> Option<&Clip> {
        let model = self.active()?;
        let borrowed = model.clip(clip)?.borrowed()?;
        let clips = borrowed.clips_by_rest(model.body(), self.motion(&borrowed.motion)?.body());
        RestChoice::ALL.iter().zip(clips).find_map(|(of, clip)| (*of == rest).then_some(clip))
    }

    fn measured(&self, clip: &ClipId) -> Option<&(Figures, Vec<FootTrack>)> {
        let model = self.active()?;
        let borrowed = model.clip(clip)?.borrowed()?;
        borrowed.measured(model.body(), self.motion(&borrowed.motion)?.body())
    }

    /// World-space bounds of a take in a scene, with nothing hidden, cached. `in_place` removes the root's ground-plane travel.
    pub fn bounds(&self, take: &Take<'_>, scene: Option<usize>, in_place: bool) -> Bounds {
        self.bounds.get(take, scene, in_place)
    }

    /// Errors of the last [`Library::borrow_each`].
    pub fn borrow_errors(&self) -> &[BorrowError] {
        &self.borrow_errors
    }

    /// The listed models.
    pub fn models(&self) -> &[Model] {
        &self.models
    }

    /// The model that is shown and edited.
    pub fn active(&self) -> Option<&Model> {
        self.get(self.active)
    }

    /// Finds a model, listed or closed.
    pub fn get(&self, id: ModelId) -> Option<&Model> {
        self.models.iter().chain(&self.closed).find(|model| model.id == id)
    }
}
