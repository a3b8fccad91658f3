//! Files that clips are borrowed from, and the borrowed clips.

use std::sync::{Arc, OnceLock};

use glam::Affine3A;

use super::model::{DEFAULT_FRAMES_PER_SEC, frames_per_sec};
use super::{Model, ModelId};
use crate::anim::{Clip, JointIndex};
use crate::asset::{Asset, Humanoid};
use crate::retarget::{
    Body, Figures, FootTrack, JointMap, LayerClip, MapError, Proposal, ResolvedMap, RetargetError, Retargeting,
    StagePair, layer_clips, propose, recognize,
};

/// A loaded file whose clips others may borrow.
#[derive(Debug, Clone)]
pub struct Motion {
    /// As [`Model::source`].
    pub source: String,
    /// As [`Model::origin`].
    pub origin: String,
    /// As [`Model::is_own`].
    pub is_own: bool,
    pub asset: Arc<Asset>,
    pub slots: Humanoid,
    /// Given by the library.
    pub(super) stage_id: ModelId,
    stage: Arc<OnceLock<Model>>,
}

impl Motion {
    pub fn new(source: String, asset: Arc<Asset>) -> Self {
        let slots = recognize(&asset).humanoid();
        Self {
            origin: source.clone(),
            is_own: false,
            source,
            asset,
            slots,
            stage_id: ModelId::default(),
            stage: Arc::default(),
        }
    }

    /// The file as something to look at, without its images; made when somebody first asks.
    pub fn stage(&self) -> &Model {
        self.stage.get_or_init(|| {
            let images = vec![None; self.asset.images.len()];
            let mut model = Model::new(self.source.clone(), self.asset.clone(), images);
            model.id = self.stage_id;
            model
        })
    }

    /// Tells it from every other motion that the library has had.
    pub fn id(&self) -> ModelId {
        self.stage_id
    }

    pub fn body(&self) -> Body<'_> {
        Body { asset: &self.asset, slots: &self.slots }
    }
}

/// A clip of a motion made over for a model: plays like one of its own.
#[derive(Debug)]
pub struct BorrowedClip {
    pub clip: Clip,
    /// What joints without a source do meanwhile.
    pub layers: Vec<LayerClip>,
    /// Index into [`super::Library::motions`], and into that file's clips.
    pub motion: usize,
    pub source_clip: usize,
    pub root: Option<JointIndex>,
    /// That the source's keys were set at.
    pub frames_per_sec: f64,
    /// Where the source stands in this model's space.
    pub model_from_source: Affine3A,
    pub pairs: Vec<StagePair>,
    map: Arc<ResolvedMap>,
    measured: OnceLock<Option<(Figures, Vec<FootTrack>)>>,
    /// How long a change to or from this clip takes.
    pub crossfade_secs: f64,
}

impl BorrowedClip {
    /// How well the clip does what its source does; measured when somebody first asks.
    pub(super) fn measured(&self, model: Body<'_>, motion: &Motion) -> Option<&(Figures, Vec<FootTrack>)> {
        let measure = || {
            let pair = Retargeting::new(model, motion.body(), self.source_clip, &self.map).ok()?;
            let made = pair.bake().ok()?;
            Some(pair.measure(&made.clip, made.unplanted.as_ref()))
        };
        self.measured.get_or_init(measure).as_ref()
    }
}

/// Why a motion cannot be borrowed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BorrowError {
    #[error("{motion}: {problem}")]
    Map { motion: String, problem: MapError },
    #[error("{motion}: {problem}")]
    Retarget { motion: String, problem: RetargetError },
}

/// The map that is in force between two files: the given one, or what is proposed.
pub fn map_for(model: &Asset, motion: &Asset, map: Option<&JointMap>) -> (JointMap, Option<Proposal>) {
    match map {
        Some(map) => (map.clone(), None),
        None => {
            let proposal = propose(model, motion);
            (proposal.to_map(model, motion), Some(proposal))
        }
    }
}

/// All clips of a motion over a model.
pub(super) fn borrow(
    model: Body<'_>,
    motion: &Motion,
    index: usize,
    map: &ResolvedMap,
    root_of: impl Fn(&Clip) -> Option<JointIndex>,
) -> Result<Vec<BorrowedClip>, BorrowError> {
    let layers = layer_clips(model.asset, map);
    let shared = Arc::new(map.clone());
    let clips = 0..motion.asset.clips.len().max(1);
    let borrow = |source_clip| {
        let error = |problem| BorrowError::Retarget { motion: motion.source.clone(), problem };
        let pair = Retargeting::new(model, motion.body(), source_clip, map).map_err(error)?;
        let baked = pair.bake().map_err(error)?;
        let root = root_of(&baked.clip);
        Ok(BorrowedClip {
            clip: baked.clip,
            layers: layers.clone(),
            motion: index,
            source_clip,
            root,
            frames_per_sec: motion.asset.clips.get(source_clip).map_or(DEFAULT_FRAMES_PER_SEC, frames_per_sec),
            model_from_source: pair.model_from_source(),
            pairs: pair.stage_pairs(),
            map: shared.clone(),
            measured: OnceLock::new(),
            crossfade_secs: map.crossfade_secs,
        })
    };
    clips.map(borrow).collect()
}
