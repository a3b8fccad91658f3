//! Clips of other files, retargeted to a model.
//!
//! In the page and the window only `Library::borrow_each` resolves maps: it compares each motion's map with the last one
//! baked, and resolves and bakes again if they differ or if the model or the motions have been replaced. Clips share the
//! `ResolvedMap` that they were baked with. It lives as long as they do, so it needs no key and can't be stale.

use std::sync::{Arc, OnceLock};

use gaitway_character::anim::{Clip, JointIndex, PropertyTarget};
use gaitway_character::asset::Asset;
use gaitway_formats::file_stem;
use gaitway_retarget::{
    Body, Figures, FootTrack, FoundRest, JointMap, LayerClip, MapError, Planting, Proposal, ResolvedMap, RestChoice,
    RetargetError, Retargeting, StagePair, has_expressions_alone, layer_clips, propose_recognized,
};
use glam::Affine3A;

use super::{Model, Motion, MotionId};

/// A clip of a motion retargeted to a model; plays like one of the model's own.
#[derive(Debug)]
pub struct BorrowedClip {
    /// For the model's skeleton.
    pub clip: Clip,
    /// Layers that animate the joints without a source.
    pub layers: Vec<LayerClip>,
    /// The motion that it is retargeted from.
    pub motion: MotionId,
    /// Index into the motion's clips.
    pub source_clip: usize,
    /// What it is called if its file gives it no name of its own; see [`file_title`].
    pub(super) file_title: String,
    /// The root-motion joint, which carries the character. `None` if nothing is translated.
    pub root: Option<JointIndex>,
    /// Frame rate the source was authored at; retargeting may add keys between its frames.
    pub frames_per_sec: f64,
    /// Places the source in this model's space.
    pub model_from_source: Affine3A,
    /// Which pose the motion is measured from, and how sure that is.
    pub motion_rest: FoundRest,
    /// Result of foot planting; `None` if the map doesn't plant the feet.
    pub planting: Option<Planting>,
    /// Every pair of the joint map, to compare the model with the source beside it.
    pub pairs: Vec<StagePair>,
    map: Arc<ResolvedMap>,
    measured: OnceLock<Option<(Figures, Vec<FootTrack>)>>,
    clips_by_rest: OnceLock<Vec<Clip>>,
    /// Crossfade to and from this clip.
    pub crossfade_secs: f64,
}

impl BorrowedClip {
    /// The rest that the motion is measured from, as the joint map chooses it.
    pub fn rest_choice(&self) -> RestChoice {
        self.map.rest.motion
    }

    /// The clip retargeted from each rest of the motion, in the order of [`RestChoice::ALL`], baked on first use. Falls
    /// back to this clip for a rest from which that fails.
    pub(super) fn clips_by_rest(&self, model: Body<'_>, motion: Body<'_>) -> &[Clip] {
        let from = |choice| {
            let mut map = ResolvedMap::clone(&self.map);
            map.rest.motion = choice;
            Some(Retargeting::new(model, motion, self.source_clip, &map).ok()?.bake().ok()?.clip)
        };
        let all = || RestChoice::ALL.map(|choice| from(choice).unwrap_or_else(|| self.clip.clone())).into();
        self.clips_by_rest.get_or_init(all)
    }

    /// Measures how well the clip matches its source, on first use.
    pub(super) fn measured(&self, model: Body<'_>, motion: Body<'_>) -> Option<&(Figures, Vec<FootTrack>)> {
        let measure = || {
            let pair = Retargeting::new(model, motion, self.source_clip, &self.map).ok()?;
            let made = pair.bake().ok()?;
            Some(pair.measure(&made.clip, made.unplanted.as_ref()))
        };
        self.measured.get_or_init(measure).as_ref()
    }
}

/// Why a motion cannot be borrowed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BorrowError {
    /// The joint map does not fit, or none could be proposed.
    #[error("{motion}: {problem}")]
    Map {
        /// [`Motion::source`](super::Motion::source) of the motion.
        motion: String,
        /// What is wrong with the map.
        problem: MapError,
    },
    /// The map fits, but the motion has no clip, or one cannot be retargeted.
    #[error("{motion}: {problem}")]
    Retarget {
        /// [`Motion::source`](super::Motion::source) of the motion.
        motion: String,
        /// Why retargeting failed.
        problem: RetargetError,
    },
}

/// Proposes a map between two files from what was recognized in them.
pub fn proposal_for(model: &Model, motion: &Motion) -> Proposal {
    let (targets, sources) = (model.recognition().clone(), motion.recognition().clone());
    propose_recognized(&model.asset, &motion.asset, targets, sources)
}

/// Returns the active map between two files: the given one, or else the proposal.
pub fn map_for(model: &Model, motion: &Motion, map: Option<&JointMap>) -> (JointMap, Option<Proposal>) {
    match map {
        Some(map) => (map.clone(), None),
        None => {
            let proposal = proposal_for(model, motion);
            (proposal.to_map(&model.asset, &motion.asset), Some(proposal))
        }
    }
}

/// Adds the expressions that a clip of a motion animates and the model has, and the gaze, to the retargeted clip.
///
/// # Errors
/// If the motion animates nothing else, and nothing that the model has.
pub fn with_expressions(clip: Clip, model: &Asset, motion: &Asset, source_clip: usize) -> Result<Clip, RetargetError> {
    let target_of_model = |target| match target {
        PropertyTarget::Expression(index) => {
            let name = &motion.avatar.expressions.get(index)?.name;
            model.avatar.expression(name).map(PropertyTarget::Expression)
        }
        PropertyTarget::LookAt => model.avatar.look_at.map(|_| target),
        _ => None,
    };
    let clip = match motion.clips.get(source_clip) {
        Some(source) => clip.with_properties_of(source, &target_of_model),
        None => clip,
    };
    let is_still = clip.channels().is_empty() && clip.properties().is_empty();
    if is_still && has_expressions_alone(motion) { Err(RetargetError::NoExpressions) } else { Ok(clip) }
}

/// Retargets all clips of a motion to a model.
pub(super) fn borrow(
    model: Body<'_>,
    lender: &Motion,
    map: &ResolvedMap,
    root_of: impl Fn(&Clip) -> Option<JointIndex>,
) -> Result<Vec<Arc<BorrowedClip>>, BorrowError> {
    let (motion, source) = (lender.body(), &*lender.source);
    let layers = layer_clips(model.asset, map);
    let shared = Arc::new(map.clone());
    let clips = 0..motion.asset.clips.len().max(1);
    let borrow = |source_clip| {
        let error = |problem| BorrowError::Retarget { motion: source.to_owned(), problem };
        let pair = Retargeting::new(model, motion, source_clip, map).map_err(error)?;
        let baked = pair.bake().map_err(error)?;
        let root = root_of(&baked.clip);
        let clip = with_expressions(baked.clip, model.asset, motion.asset, source_clip).map_err(error)?;
        Ok(Arc::new(BorrowedClip {
            clip,
            layers: layers.clone(),
            motion: lender.id().clone(),
            source_clip,
            file_title: file_title(source, source_clip, motion.asset.clips.len()),
            root,
            frames_per_sec: motion
                .asset
                .clips
                .get(source_clip)
                .map_or(Clip::DEFAULT_FRAMES_PER_SEC, Clip::frames_per_sec),
            model_from_source: pair.model_from_source(),
            motion_rest: pair.motion_rest(),
            planting: baked.planting,
            pairs: pair.stage_pairs(),
            map: shared.clone(),
            measured: OnceLock::new(),
            clips_by_rest: OnceLock::new(),
            crossfade_secs: map.crossfade_secs,
        }))
    };
    clips.map(borrow).collect()
}

/// Names a clip after its file, with its number there if the file has several.
pub(super) fn file_title(source: &str, clip: usize, count: usize) -> String {
    let stem = file_stem(source.strip_prefix("sample:").unwrap_or(source));
    if count > 1 { format!("{stem} {clip}") } else { stem.to_owned() }
}
