//! Puts the transferred channels together into a clip of the target.

use std::collections::HashSet;

use gaitway_character::anim::{Channel, ChannelError, Clip, ClipBuilder, JointIndex, Keys, Property};
use gaitway_character::sort::sort_by;

use super::budget::MAX_ANCESTORS;
use super::contacts::{Bodies, Scene, grounded_knees, kept_limbs, leaning_trunk};
use super::feet::{self, Planting};
use super::keys::channel::NewChannel;
use super::map::{Contacts, Feet};
use super::pose::{Local, ancestry, node_locals};
use super::transfer::{
    CopyPolicy, RotationLaw, Transfer, copied_channels, detached_channels, detached_ends, expression_channels,
    extraction_joint, follower_channels, hips_channels, rotation_laws, twist_channels,
};

/// Why a clip cannot be retargeted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RetargetError {
    /// The motion has no clips at all.
    #[error("the motion has no clip")]
    NoClips,
    /// The clip index is out of range.
    #[error("the motion has no clip {index}; it has {count}")]
    NoSuchClip {
        /// The index that was asked for.
        index: usize,
        /// Number of the motion's clips.
        count: usize,
    },
    /// The map has no pairs.
    #[error(
        "no joint of the model follows a joint of the motion: name pairs in a joint map (`gaitway map` writes one to start from)"
    )]
    NoPairs,
    /// The mapped joints lie below too many others.
    #[error(
        "the joints lie too deep below each other: all mapped ones together may have at most {MAX_ANCESTORS} ancestors"
    )]
    TooDeep,
    /// The motion animates expressions alone, and the model has none of them.
    #[error("the motion animates expressions alone; the model has none of them, and no morph targets of their names")]
    NoExpressions,
    /// A retargeted channel is invalid.
    #[error("joint “{joint}” cannot be written: {problem}")]
    Channel {
        /// Name of the target joint.
        joint: String,
        /// What is wrong with its channel.
        problem: ChannelError,
    },
}

/// The retargeted clip, and how it was made.
#[derive(Debug, Clone)]
pub struct Retargeted {
    /// For the target's skeleton, under the source clip's name.
    pub clip: Clip,
    /// Target metres per source metre of travel; None if nothing travels.
    pub hips_scale: Option<f64>,
    /// Number of keys in the source channels that were used.
    pub keys_in: usize,
    /// Number of keys in the channels that were written.
    pub keys_out: usize,
    /// Joints whose keys are not the source's own: more than one rotation moves between them and their mapped ancestor.
    pub resampled: Vec<JointIndex>,
    /// The options ask for root motion to be extracted, but no joint above the hips is free to carry it.
    pub nowhere_to_extract: bool,
    /// The clip before its feet were planted and its contacts kept, if either was.
    pub unplanted: Option<Clip>,
    /// What planting did; `None` if feet aren't planted, the map has no whole leg, or the clip is too long.
    pub planting: Option<Planting>,
}

/// Retargets the clip, then plants its feet, keeps its contacts and moves twist joints and helpers, if the map asks for it.
pub fn bake<'a>(transfer: &Transfer, bodies: impl FnOnce() -> Option<&'a Bodies>) -> Result<Retargeted, RetargetError> {
    let made = bake_body(transfer, bodies)?;
    let mut channels = twist_channels(transfer, &made.clip);
    channels.extend(follower_channels(transfer, &made.clip));
    if channels.is_empty() { Ok(made) } else { made.with_replaced(transfer, in_file(transfer, channels)) }
}

/// Converts channels from the mirror, where mirrored bodies are retargeted, to those of the file.
fn in_file(transfer: &Transfer, channels: Vec<NewChannel>) -> Vec<NewChannel> {
    let reflection = transfer.target_skeleton.reflection();
    channels.into_iter().map(|channel| channel.in_mirror(reflection)).collect()
}

impl Retargeted {
    /// Replaces channels of the clip by others of the same joint and property.
    fn with_replaced(self, transfer: &Transfer, others: Vec<NewChannel>) -> Result<Self, RetargetError> {
        let mut channels = NewChannel::corrected(&self.clip, &self.resampled, &[], None, Vec::new());
        let replaced = written(&others);
        channels.retain(|channel| !replaced.contains(&(channel.joint, channel.keys.property())));
        channels.extend(others);
        Ok(Self { unplanted: self.unplanted, planting: self.planting, ..build(transfer, channels)? })
    }
}

fn bake_body<'a>(
    transfer: &Transfer,
    bodies: impl FnOnce() -> Option<&'a Bodies>,
) -> Result<Retargeted, RetargetError> {
    let planted = bake_planted(transfer)?;
    let bodies = if transfer.map.contacts == Contacts::Keep { bodies() } else { None };
    let kept = bodies.map(|bodies| bake_kept(transfer, bodies, &planted)).transpose()?.flatten();
    let Some(built) = kept else { return Ok(planted) };
    Ok(Retargeted { unplanted: planted.unplanted.or(Some(planted.clip)), planting: planted.planting, ..built })
}

/// Brings knees to the ground, leans the trunk, then moves hands to where they rest and limbs out of the body; `None` if there is
/// nothing to do, or the clip is too long.
fn bake_kept(transfer: &Transfer, bodies: &Bodies, planted: &Retargeted) -> Result<Option<Retargeted>, RetargetError> {
    let rebuilt = |channels: Option<Vec<NewChannel>>| {
        channels.map(|channels| build(transfer, reattached(transfer, channels)?)).transpose()
    };
    let Some(mut scene) = Scene::new(transfer, bodies, &planted.clip) else { return Ok(None) };
    let mut kept: Option<Retargeted> = None;
    for corrected in [grounded_knees, leaning_trunk] {
        let Retargeted { clip, resampled, .. } = kept.as_ref().unwrap_or(planted);
        if let Some(next) = rebuilt(corrected(&scene, clip, resampled))? {
            scene = scene.playing(&next.clip);
            kept = Some(next);
        }
    }
    let Retargeted { clip, resampled, .. } = kept.as_ref().unwrap_or(planted);
    Ok(rebuilt(kept_limbs(scene, clip, resampled))?.or(kept))
}

fn bake_planted(transfer: &Transfer) -> Result<Retargeted, RetargetError> {
    let unplanted = bake_unplanted(transfer)?;
    let planted = match transfer.map.feet {
        Feet::Off => None,
        Feet::Plant => feet::planted_channels(transfer, &unplanted.clip, &unplanted.resampled),
    };
    let Some((channels, planting)) = planted else { return Ok(unplanted) };
    let built = build(transfer, reattached(transfer, channels)?)?;
    Ok(Retargeted { unplanted: Some(unplanted.clip), planting: Some(planting), ..built })
}

/// Moves detached ends of limbs to where planting or contacts put their limbs.
fn reattached(transfer: &Transfer, mut channels: Vec<NewChannel>) -> Result<Vec<NewChannel>, RetargetError> {
    let ends = detached_ends(transfer);
    if !ends.is_empty() {
        let is_end = |joint: JointIndex| ends.iter().any(|(end, _)| *end == joint);
        channels.retain(|channel| !(is_end(channel.joint) && channel.keys.property() == Property::Translation));
        let so_far = build(transfer, channels.clone())?;
        channels.extend(detached_channels(transfer, &ends, &so_far.clip));
    }
    Ok(channels)
}

fn bake_unplanted(transfer: &Transfer) -> Result<Retargeted, RetargetError> {
    let (laws, root_turn) = rotation_laws(transfer);
    let rest = node_locals(transfer.target_skeleton);
    let pairs = transfer.map.pairs.iter().zip(&laws);
    let mut channels: Vec<NewChannel> =
        pairs.filter_map(|(pair, law)| law.channel(pair.target, rest[pair.target.get()].rotation)).collect();
    for &joint in transfer.turns.unpaired() {
        let law = transfer.turns.of(joint).map(|turn| RotationLaw::new(transfer, joint, turn));
        channels.extend(law.and_then(|law| law.channel(joint, rest[joint.get()].rotation)));
    }

    let policy = CopyPolicy::new(transfer);
    let copied = copied_channels(transfer, policy);
    let copies = written(&copied);
    if let Some(hips) = transfer.hips.filter(|_| !policy.path) {
        channels.extend(hips_channels(transfer, hips, &laws, root_turn.as_ref()));
    }
    let ends = detached_ends(transfer);
    if !policy.is_same_skeleton {
        let new = written(&channels);
        let moves = |joint: JointIndex| {
            let channel = (joint, Property::Translation);
            new.contains(&channel) || copies.contains(&channel) || ends.iter().any(|(end, _)| *end == joint)
        };
        let offsets = rest_translations(transfer, &rest, moves);
        channels.extend(offsets);
    }
    let mut channels = in_file(transfer, channels);
    // In an equal skeleton, the copied translations keep the ends in place.
    let detached = if ends.is_empty() || (policy.translations && policy.is_same_skeleton) {
        Vec::new()
    } else {
        let so_far = build(transfer, channels.clone())?;
        detached_channels(transfer, &ends, &so_far.clip)
    };
    let is_copied = |joint: JointIndex| copied.iter().any(|channel| channel.joint == joint);
    let detached: Vec<NewChannel> = detached.into_iter().filter(|channel| !is_copied(channel.joint)).collect();
    let mut expressions = expression_channels(transfer);
    expressions.retain(|new| !copies.contains(&(new.joint, Property::MorphWeights)));
    channels.extend(expressions);
    channels.extend(copied);
    channels.extend(detached);
    build(transfer, channels)
}

/// Returns the joints and properties that channels animate.
fn written(channels: &[NewChannel]) -> HashSet<(JointIndex, Property)> {
    channels.iter().map(|channel| (channel.joint, channel.keys.property())).collect()
}

/// Returns constant translations for mapped joints whose rest isn't where their nodes are, so that limbs are as long as in the rest
/// that their rotations are measured from.
fn rest_translations(transfer: &Transfer, nodes: &[Local], moves: impl Fn(JointIndex) -> bool) -> Vec<NewChannel> {
    let elsewhere = transfer.map.pairs.iter().filter_map(|pair| {
        let rest = transfer.alignment.target.locals[pair.target.get()].translation;
        let is_elsewhere = rest != nodes[pair.target.get()].translation && !moves(pair.target);
        is_elsewhere.then(|| NewChannel::constant(pair.target, Keys::Translation(vec![rest.as_vec3()])))
    });
    elsewhere.collect()
}

/// Builds the clip from its channels.
fn build(transfer: &Transfer, mut channels: Vec<NewChannel>) -> Result<Retargeted, RetargetError> {
    let (skeleton, source_clip) = (transfer.target_skeleton, transfer.tracks.clip);
    let written = written(&channels);
    let mut builder = ClipBuilder::new(source_clip.name(), skeleton);
    let mut resampled: Vec<JointIndex> = Vec::new();
    let last = channels.iter().filter_map(|channel| channel.times.last().copied()).fold(0.0, f32::max);
    // The clip lasts as long as its source, even if the joint that moves last is not mapped.
    if let Some(channel) = channels.first_mut().filter(|_| last < source_clip.duration_secs()) {
        channel.hold_until(source_clip.duration_secs());
    }
    let keys_out = channels.iter().map(|channel| channel.times.len()).sum();
    for channel in channels {
        resampled.extend(Some(channel.joint).filter(|_| channel.resampled));
        builder
            .channel(channel.joint, channel.interpolation, &channel.times, channel.keys)
            .map_err(|problem| RetargetError::Channel { joint: skeleton.name(channel.joint).to_owned(), problem })?;
    }
    sort_by(&mut resampled, Ord::cmp);
    resampled.dedup();
    let has_no_extraction_joint = || transfer.hips.is_none_or(|hips| extraction_joint(transfer, hips).is_none());
    Ok(Retargeted {
        clip: builder.build(),
        hips_scale: transfer.hips.map(|hips| hips.scale),
        keys_in: count_source_keys(transfer, &written),
        keys_out,
        resampled,
        nowhere_to_extract: transfer.map.root.extract && has_no_extraction_joint(),
        unplanted: None,
        planting: None,
    })
}

/// Properties that are carried over channel by channel. A rotation follows from all rotations that lead to its joint.
const NOT_ROTATIONS: [Property; 3] = [Property::Translation, Property::Scale, Property::MorphWeights];

/// Number of keys in the source channels behind these target properties: rotations of all joints on the way to a mapped
/// one, everything that carries the hips, and what was copied.
fn count_source_keys(transfer: &Transfer, written: &HashSet<(JointIndex, Property)>) -> usize {
    let Transfer { map, tracks, .. } = *transfer;
    let mut leads_to_mapped = vec![false; tracks.skeleton.len()];
    let mut carried = HashSet::new();
    for pair in &map.pairs {
        ancestry(tracks.skeleton, pair.source).for_each(|joint| leads_to_mapped[joint.get()] = true);
        let copied = NOT_ROTATIONS.into_iter().filter(|&property| written.contains(&(pair.target, property)));
        carried.extend(copied.map(|property| (pair.source, property)));
    }
    let hips = transfer.hips_pair().filter(|hips| written.contains(&(hips.target, Property::Translation)));
    let carriers = hips.into_iter().flat_map(|hips| ancestry(tracks.skeleton, hips.source));
    carried.extend(carriers.flat_map(|joint| NOT_ROTATIONS.map(|property| (joint, property))));
    let is_used = |channel: &&Channel| match channel.keys.property() {
        Property::Rotation => leads_to_mapped[channel.joint.get()],
        property => carried.contains(&(channel.joint, property)),
    };
    let channels = tracks.clip.channels().iter().filter(is_used).filter(|channel| !tracks.is_muted(channel));
    channels.map(|channel| tracks.clip.timelines()[channel.timeline as usize].len()).sum()
}
