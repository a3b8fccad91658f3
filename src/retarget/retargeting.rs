//! A clip of one skeleton, a joint map, and out comes a clip of the other skeleton: the parts put together.

use super::align::rest::{ancestry, better_rest_secs, chosen_locals, clip_locals, node_locals};
use super::align::swing::{Alignment, align};
use super::keys::track::Motion;
use super::map::{Feet, Keep, RestChoice};
use super::map::{Pair, ResolvedMap};
use super::transfer::copy::{Carry, same_skeleton};
use super::transfer::root::{Hips, RootMotion};
use super::transfer::rotation::{NewChannel, RotationLaw, Yaw};
use crate::anim::{ChannelError, Clip, ClipBuilder, JointIndex, Property};
use crate::asset::{Asset, Humanoid};

/// One side of a pair: a file, and which of its joints is which part of a body.
#[derive(Debug, Clone, Copy)]
pub struct Body<'a> {
    pub asset: &'a Asset,
    pub slots: &'a Humanoid,
}

#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RetargetError {
    #[error("the motion has no clip")]
    NoClips,
    #[error("the motion has no clip {index}; it has {count}")]
    NoSuchClip { index: usize, count: usize },
    #[error(
        "no joint of the model follows a joint of the motion: name pairs in a joint map (`gaitway map` writes one to start from)"
    )]
    NoPairs,
    #[error("joint “{joint}” cannot be written: {problem}")]
    Channel { joint: String, problem: ChannelError },
}

/// What has been made, and how.
#[derive(Debug, Clone)]
pub struct Retargeted {
    /// Over the model's skeleton, under the source clip's name.
    pub clip: Clip,
    /// Target metres per source metre of travel; none when nothing travels.
    pub hips_scale: Option<f64>,
    /// Keys of the source channels that were used, and of the channels that were written.
    pub keys_in: usize,
    pub keys_out: usize,
    /// Joints whose keys are not the source's: more than one rotation moves between them and their mapped ancestor.
    pub resampled: Vec<JointIndex>,
    /// The options ask for a root joint above the hips and there is none that is free.
    pub nowhere_to_extract: bool,
    /// The clip before its feet were planted, if they were.
    pub unplanted: Option<Clip>,
}

/// A pair of skeletons brought together for one clip: everything that figures and feet need besides the clip itself.
#[derive(Debug)]
pub struct Retargeting<'a> {
    pub(super) model: Body<'a>,
    pub(super) source: Body<'a>,
    pub(super) source_clip: &'a Clip,
    pub(super) map: &'a ResolvedMap,
    pub(super) motion: Motion<'a>,
    pub(super) alignment: Alignment,
    pub(super) hips: Option<Hips>,
}

impl<'a> Retargeting<'a> {
    /// `clip` is an index into the motion's clips; `map` was resolved against these two files.
    ///
    /// # Errors
    /// When there is no such clip, or the map has no pairs.
    pub fn new(model: Body<'a>, source: Body<'a>, clip: usize, map: &'a ResolvedMap) -> Result<Self, RetargetError> {
        let clips = &source.asset.clips;
        let source_clip = match clips.get(clip) {
            Some(clip) => clip,
            None if clips.is_empty() => return Err(RetargetError::NoClips),
            None => return Err(RetargetError::NoSuchClip { index: clip, count: clips.len() }),
        };
        if map.pairs.is_empty() {
            return Err(RetargetError::NoPairs);
        }
        let (target_skeleton, source_skeleton) = (&model.asset.skeleton, &source.asset.skeleton);
        let motion = Motion::new(source_skeleton, source_clip, &map.muted);
        let mut source_locals = chosen_locals(source_skeleton, &source.asset.skins, Some(source_clip), map.rest.motion);
        if map.rest.motion == RestChoice::Auto
            && let Some(time_secs) = better_rest_secs(source_skeleton, source.slots, &source_locals, source_clip)
        {
            source_locals = clip_locals(source_skeleton, source_clip, time_secs);
        }
        let target_nodes = node_locals(target_skeleton);
        let own_clip = model.asset.clips.first();
        let mut target_locals = chosen_locals(target_skeleton, &model.asset.skins, own_clip, map.rest.model);
        for (local, node) in target_locals.iter_mut().zip(&target_nodes) {
            // What is played moves from the nodes' own places.
            (local.translation, local.scale) = (node.translation, node.scale);
        }
        let alignment = align(
            map,
            [source_skeleton, target_skeleton],
            [source.slots, model.slots],
            source_locals,
            target_locals,
            &target_nodes,
        );
        let hips = Hips::new(map, &alignment, [source.slots, model.slots], target_skeleton, &motion);
        Ok(Self { model, source, source_clip, map, motion, alignment, hips })
    }

    pub(super) fn laws(&self) -> Vec<RotationLaw<'_>> {
        let law = |index| RotationLaw::new(self.map, index, &self.alignment, &self.model.asset.skeleton, &self.motion);
        (0..self.map.pairs.len()).map(law).collect()
    }

    pub(super) fn root(&self) -> Option<RootMotion<'_>> {
        self.hips.map(|hips| RootMotion {
            map: self.map,
            hips,
            alignment: &self.alignment,
            target_skeleton: &self.model.asset.skeleton,
            motion: &self.motion,
        })
    }

    /// Rotation laws with what the root's options take from them, and the turn that goes to the root joint.
    pub(super) fn turned_laws(&self) -> (Vec<RotationLaw<'_>>, Option<Yaw>) {
        let mut laws = self.laws();
        let turn = self.root().and_then(|root| root.stop_turning(&mut laws));
        (laws, turn)
    }

    /// Makes the clip.
    ///
    /// # Errors
    /// When the source's keys do not make a valid channel.
    pub fn bake(&self) -> Result<Retargeted, RetargetError> {
        let unplanted = self.unplanted()?;
        match self.map.feet {
            Feet::Off => Ok(unplanted),
            Feet::Plant => self.plant(unplanted),
        }
    }

    fn unplanted(&self) -> Result<Retargeted, RetargetError> {
        let (laws, root_turn) = self.turned_laws();
        let rest = node_locals(&self.model.asset.skeleton);
        let mut channels: Vec<NewChannel> = self
            .map
            .pairs
            .iter()
            .zip(&laws)
            .filter_map(|(pair, law)| law.channel(pair.target, rest[pair.target.get()].rotation))
            .collect();
        let copied = self.copied_channels();
        let root = self.root();
        let hips_copied = root.as_ref().is_some_and(|root| {
            let hips = self.map.pairs[root.hips.pair].target;
            root.keeps_all() && self.translations_kept() && copied.iter().any(|channel| channel.joint == hips)
        });
        let nowhere_to_extract =
            self.map.root.extract && root.as_ref().is_none_or(|root| root.extraction_joint().is_none());
        if let Some(root) = root.filter(|_| !hips_copied) {
            channels.extend(root.channels(&laws, root_turn.as_ref()));
        }
        let translated = |joint: JointIndex| copied.iter().any(|channel| channel.joint == joint);
        let detached = self.detached(&channels, &translated)?;
        channels.extend(copied);
        channels.extend(detached);
        self.finish(channels, nowhere_to_extract)
    }

    /// What keeps ends of limbs in their places that do not hang on them, but for those that move by themselves.
    fn detached(
        &self,
        channels: &[NewChannel],
        translated: &impl Fn(JointIndex) -> bool,
    ) -> Result<Vec<NewChannel>, RetargetError> {
        // The same skeleton has its ends where its own translations put them.
        if !self.has_detached_ends() || (self.translations_kept() && self.same()) {
            return Ok(Vec::new());
        }
        let so_far = self.finish(channels.to_vec(), false)?;
        let found = self.detached_channels(&so_far.clip);
        Ok(found.into_iter().filter(|channel| !translated(channel.joint)).collect())
    }

    fn translations_kept(&self) -> bool {
        match self.map.translations {
            Keep::Keep => true,
            Keep::Drop => false,
            Keep::Auto => self.same(),
        }
    }

    fn same(&self) -> bool {
        same_skeleton(self.map, &self.model.asset.skeleton, &self.source.asset.skeleton)
    }

    /// Translations, scales and morph weights that come along as they are.
    fn copied_channels(&self) -> Vec<NewChannel> {
        let same = self.same();
        let scales = match self.map.scales {
            Keep::Keep => true,
            Keep::Drop => false,
            Keep::Auto => same,
        };
        let translations = self.translations_kept();
        let skeletons = [&self.source.asset.skeleton, &self.model.asset.skeleton];
        let locals = skeletons.map(node_locals);
        let rests = [(skeletons[0], &locals[0][..]), (skeletons[1], &locals[1][..])];
        let hips_scale = self.hips.map_or(1.0, |hips| hips.scale);
        let root = self.root();
        let root_is_free = root.as_ref().is_none_or(RootMotion::keeps_all);
        // On the way to the hips only a path that nobody asks to change may be copied joint by joint; between different
        // skeletons the hips take up what their ancestors do.
        let on_path = |joint: JointIndex| {
            root.as_ref().is_some_and(|root| {
                let hips = self.map.pairs[root.hips.pair].target;
                ancestry(skeletons[1], hips).any(|ancestor| ancestor == joint)
            })
        };
        let mut channels = Vec::new();
        for pair in &self.map.pairs {
            let morphs = match skeletons[1].name(pair.target) == skeletons[0].name(pair.source) {
                true => skeletons[1].morph_range(pair.target).len(),
                false => 0,
            };
            for channel in self.source_clip.channels().iter().filter(|channel| channel.joint == pair.source) {
                let property = channel.keys.property();
                let wanted = match property {
                    Property::Translation => translations && (!on_path(pair.target) || (same && root_is_free)),
                    Property::Scale => scales,
                    Property::MorphWeights => morphs > 0,
                    Property::Rotation => false,
                };
                if wanted && !self.map.muted.contains(&(pair.source, property)) {
                    let carry = Carry::new(pair, same, hips_scale, &self.alignment, rests);
                    channels.extend(carry.channel(self.source_clip, channel, morphs));
                }
            }
        }
        channels
    }

    /// Keys of the source channels that went into these target properties: rotations of all joints on the way to a mapped
    /// one, all that carries the hips, and what was copied.
    fn keys_in(&self, written: &[(JointIndex, Property)]) -> usize {
        let skeleton = &self.source.asset.skeleton;
        let above = |source: JointIndex, joint: JointIndex| ancestry(skeleton, source).any(|other| other == joint);
        let hips = self.hips.map(|hips| self.map.pairs[hips.pair]);
        let mut on_the_way = vec![false; skeleton.len()];
        for pair in &self.map.pairs {
            ancestry(skeleton, pair.source).for_each(|joint| on_the_way[joint.get()] = true);
        }
        let used = |joint: JointIndex, property: Property| match property {
            Property::Rotation => on_the_way[joint.get()],
            property => {
                let copied = |pair: &Pair| pair.source == joint && written.contains(&(pair.target, property));
                let carries =
                    |pair: Pair| written.contains(&(pair.target, Property::Translation)) && above(pair.source, joint);
                self.map.pairs.iter().any(copied) || hips.is_some_and(carries)
            }
        };
        let muted = |joint, property| self.map.muted.contains(&(joint, property));
        let channels = self.source_clip.channels().iter().filter(|channel| {
            let property = channel.keys.property();
            used(channel.joint, property) && !muted(channel.joint, property)
        });
        channels.map(|channel| self.source_clip.timelines()[channel.timeline as usize].len()).sum()
    }

    pub(super) fn finish(
        &self,
        mut channels: Vec<NewChannel>,
        nowhere_to_extract: bool,
    ) -> Result<Retargeted, RetargetError> {
        let skeleton = &self.model.asset.skeleton;
        let written: Vec<(JointIndex, Property)> =
            channels.iter().map(|channel| (channel.joint, channel.keys.property())).collect();
        let mut builder = ClipBuilder::new(self.source_clip.name(), skeleton);
        let mut resampled: Vec<JointIndex> = Vec::new();
        let last = channels.iter().filter_map(|channel| channel.times.last().copied()).fold(0.0, f32::max);
        // A clip lasts as long as its source, also when what ends it is not mapped.
        if let Some(channel) = channels.first_mut().filter(|_| last < self.source_clip.duration_secs()) {
            channel.hold_until(self.source_clip.duration_secs());
        }
        let keys_out = channels.iter().map(|channel| channel.times.len()).sum();
        for channel in channels {
            if channel.resampled && !resampled.contains(&channel.joint) {
                resampled.push(channel.joint);
            }
            builder.channel(channel.joint, channel.interpolation, &channel.times, channel.keys).map_err(|problem| {
                RetargetError::Channel { joint: skeleton.name(channel.joint).to_owned(), problem }
            })?;
        }
        let keys_in = self.keys_in(&written);
        resampled.sort();
        Ok(Retargeted {
            clip: builder.build(),
            hips_scale: self.hips.map(|hips| hips.scale),
            keys_in,
            keys_out,
            resampled,
            nowhere_to_extract,
            unplanted: None,
        })
    }
}
