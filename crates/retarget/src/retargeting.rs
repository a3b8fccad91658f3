//! The public entry: two bodies, a clip and a joint map, aligned once and then baked, measured or staged.

use std::sync::OnceLock;

use gaitway_character::anim::Clip;
use glam::Affine3A;

use super::align::rest::{FoundRest, RestInput, SourceRest, source_rest, target_rest};
use super::align::{Alignment, Rest, align};
use super::bake::{RetargetError, Retargeted, bake};
use super::body::Anatomy;
use super::budget::are_too_deep;
use super::contacts::Bodies;
use super::keys::tracks::SourceTracks;
use super::map::{Chains, ResolvedMap, has_expressions_alone};
use super::measure::{Figures, FootTrack, MeasuredClip, StagePair, measure, model_from_source, stage_pairs};
use super::pose::node_locals;
use super::side::Body;
use super::transfer::{Hips, HipsInput, Transfer, Turns, match_hips};

/// A clip and a model, aligned by a joint map.
#[derive(Debug)]
pub struct Retargeting<'a> {
    model: Body<'a>,
    source: Body<'a>,
    map: &'a ResolvedMap,
    tracks: SourceTracks<'a>,
    alignment: Alignment,
    /// The model's; empty unless the map shares chains.
    anatomy: Anatomy,
    turns: Turns,
    hips: Option<Hips>,
    rest: FoundRest,
    /// Fitted to the meshes when first needed; `None` if no limb is mapped.
    bodies: OnceLock<Option<Bodies>>,
}

impl<'a> Retargeting<'a> {
    /// Aligns the rests. `clip` is an index into the motion's clips; `map` was resolved against these two assets.
    ///
    /// # Errors
    /// If there is no such clip, or the map has no pairs.
    pub fn new(model: Body<'a>, source: Body<'a>, clip: usize, map: &'a ResolvedMap) -> Result<Self, RetargetError> {
        let clips = &source.asset.clips;
        let source_clip = match clips.get(clip) {
            Some(clip) => clip,
            None if clips.is_empty() => return Err(RetargetError::NoClips),
            None => return Err(RetargetError::NoSuchClip { index: clip, count: clips.len() }),
        };
        if map.pairs.is_empty() && !has_expressions_alone(source.asset) {
            return Err(RetargetError::NoPairs);
        }
        if are_too_deep(&model.asset.skeleton, &source.asset.skeleton, &map.pairs) {
            return Err(RetargetError::TooDeep);
        }
        let target_nodes = node_locals(&model.asset.skeleton);
        let target_skeleton = &model.asset.skeleton;
        let target_locals = target_rest(model.asset, map.rest.model);
        let SourceRest { locals, unmoved, target_from_source, is_in_place, found } = source_rest(RestInput {
            source: source.asset,
            source_slots: source.slots,
            clip: source_clip,
            target: target_skeleton,
            target_rest: &target_locals,
            map,
        });
        let source_rest = Rest { asset: source.asset, slots: source.slots, locals };
        let target_rest = Rest { asset: model.asset, slots: model.slots, locals: target_locals };
        let [source_anatomy, anatomy] = match map.chains {
            Chains::Off => [Anatomy::default(), Anatomy::default()],
            Chains::Share => [source, model].map(|body| Anatomy::new(body.asset, body.slots)),
        };
        let tracks = SourceTracks::new(&source.asset.skeleton, source_clip, &map.muted, &unmoved);
        let turns = Turns::new(map, &tracks, [&source_anatomy, &anatomy], target_skeleton.len());
        let alignment = align(map, &source_rest, &target_rest, &target_nodes, turns.unpaired(), target_from_source);
        let hips = match_hips(HipsInput {
            map,
            alignment: &alignment,
            tracks: &tracks,
            target: model.asset,
            source_slots: source.slots,
            target_slots: model.slots,
        });
        let hips = hips.map(|hips| if is_in_place { hips } else { hips.resting_as_target() });
        Ok(Self { model, source, map, tracks, alignment, anatomy, turns, hips, rest: found, bodies: OnceLock::new() })
    }

    /// Returns the motion's rest pose: its origin and confidence.
    pub fn motion_rest(&self) -> FoundRest {
        self.rest
    }

    fn transfer(&self) -> Transfer<'_> {
        Transfer {
            map: self.map,
            source: self.source.asset,
            tracks: &self.tracks,
            target_skeleton: &self.model.asset.skeleton,
            target: self.model.asset,
            alignment: &self.alignment,
            anatomy: &self.anatomy,
            turns: &self.turns,
            hips: self.hips.as_ref(),
        }
    }

    fn bodies(&self) -> Option<&Bodies> {
        let slots = [self.source.slots, self.model.slots];
        self.bodies.get_or_init(|| Bodies::new(&self.transfer(), slots)).as_ref()
    }

    /// Retargets the clip.
    ///
    /// # Errors
    /// If the source's keys do not make a valid channel.
    pub fn bake(&self) -> Result<Retargeted, RetargetError> {
        bake(&self.transfer(), || self.bodies())
    }

    /// Measures what [`Retargeting::bake`] returned.
    pub fn figures(&self, retargeted: &Retargeted) -> Figures {
        self.measure(&retargeted.clip, retargeted.unplanted.as_ref()).0
    }

    /// Measures any clip of the model. Orientations are compared in `unplanted`, the same clip without planted feet and
    /// kept contacts, if there is one.
    pub fn measure(&self, clip: &Clip, unplanted: Option<&Clip>) -> (Figures, Vec<FootTrack>) {
        let slots = [self.source.slots, self.model.slots];
        measure(&self.transfer(), self.bodies(), slots, MeasuredClip { clip, unplanted })
    }

    /// Brings the source into the model's space: facing the same way, with the hips at the same place and height.
    pub fn model_from_source(&self) -> Affine3A {
        let skeletons = [&self.source.asset.skeleton, &self.model.asset.skeleton];
        model_from_source(&self.alignment, self.hips.as_ref(), skeletons)
    }

    /// All pairs of the map, for showing the source beside the model.
    pub fn stage_pairs(&self) -> Vec<StagePair> {
        stage_pairs(self.map, &self.alignment)
    }
}
