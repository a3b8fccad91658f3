//! The rest pose that motion is measured from: a skeleton's nodes, a skin's bind pose, a pose of a clip, or the model's
//! own. Rotations come from orthonormalized matrices, so scaled or rotated ancestors are harmless.

use gaitway_character::anim::{Clip, Skeleton};
use gaitway_character::asset::{Asset, BoundTransform, Humanoid};
use glam::DQuat;

use super::same_rig::{OwnRest, Resting, SharedRest, shared_rest};
use super::stance::{Stance, Standing, best_standing, face_as_file, is_moment_of};
use super::up::find_up;
use crate::map::{ResolvedMap, RestChoice};
use crate::pose::{Local, Scratch, WorldPose, clip_locals, node_locals};

/// Origin of the motion's rest pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RestOrigin {
    /// The joint map chooses it.
    Map,
    /// The motion's skin, or its nodes where no skin covers a joint.
    Motion,
    /// The model, which has the same rig: names, hierarchy and local frames.
    Model,
    /// The moment of the clip, in seconds, that looks most like a rest.
    Moment(f32),
    /// The mean of the clip.
    Mean,
}

/// The motion's rest pose: its origin and confidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundRest {
    /// Where it comes from.
    pub origin: RestOrigin,
    /// 0 (a mid-motion pose) to 1 (the map says so, the rig is the same, or the body is upright and symmetric).
    pub confidence: f64,
    /// Whether the body lies throughout the clip, and would stand on the ground if another axis were up.
    pub is_up_doubtful: bool,
}

impl FoundRest {
    /// Whether the motion's own rest looks like a mid-motion pose and no replacement is certain.
    pub fn is_doubtful(&self) -> bool {
        self.confidence < MIN_CONFIDENCE
    }
}

/// A rest below this is replaced, and a replacement below it is reported as doubtful.
const MIN_CONFIDENCE: f64 = 0.5;

/// The source's rest.
#[derive(Debug)]
pub struct SourceRest {
    pub locals: Vec<Local>,
    /// Local transforms of joints that the clip does not animate.
    pub unmoved: Vec<Local>,
    /// Turns the source's model space into the target's, if both are the same rig.
    pub target_from_source: Option<DQuat>,
    /// Whether the hips are at their rest position. If not, the target's is used.
    pub is_in_place: bool,
    pub found: FoundRest,
}

/// Inputs of [`source_rest`].
#[derive(Clone, Copy)]
pub struct RestInput<'a> {
    pub source: &'a Asset,
    pub source_slots: &'a Humanoid,
    pub clip: &'a Clip,
    pub target: &'a Skeleton,
    /// See [`target_rest`].
    pub target_rest: &'a [Local],
    pub map: &'a ResolvedMap,
}

/// Returns the source's rest pose, standing as its clip stands.
pub fn source_rest(input: RestInput) -> SourceRest {
    let RestInput { source, source_slots, clip, map, .. } = input;
    let mut rest = chosen_rest(input);
    let up = find_up(&source.skeleton, source_slots, clip, &rest.locals, map.rest.up);
    up.apply(&source.skeleton, &mut rest.locals);
    rest.target_from_source = rest.target_from_source.map(|turn| turn * up.turn.conjugate());
    rest.found.is_up_doubtful = up.is_doubtful;
    rest
}

/// Returns the source's rest pose, whichever way is up in it. `Auto` uses the model's if the rig is the same, and a pose of the
/// clip if the body does not stand in its own.
fn chosen_rest(input: RestInput) -> SourceRest {
    let RestInput { source, source_slots: slots, clip, map, .. } = input;
    let skeleton = &source.skeleton;
    let choice = map.rest.motion;
    let locals = chosen_locals(source, Some(clip), choice);
    let rest = |locals, origin, confidence| SourceRest {
        locals,
        unmoved: node_locals(skeleton),
        target_from_source: None,
        is_in_place: true,
        found: FoundRest { origin, confidence, is_up_doubtful: false },
    };
    if choice != RestChoice::Auto {
        return rest(locals, RestOrigin::Map, 1.0);
    }
    let stance = Stance::of(&WorldPose::new(skeleton, locals.clone(), DQuat::IDENTITY), slots);
    let is_standing = stance.is_some_and(|stance| stance.confidence() >= MIN_CONFIDENCE);
    let target = Resting { skeleton: input.target, locals: input.target_rest };
    let own = OwnRest { resting: Resting { skeleton, locals: &locals }, is_standing };
    // Rotations of a declared humanoid are relative to its own rest, whatever the names of its bones.
    let shared = if source.humanoid.is_none() { shared_rest(target, own, clip, map) } else { None };
    if let Some(SharedRest { locals, unmoved, target_from_source }) = shared {
        return SourceRest {
            unmoved,
            target_from_source: Some(target_from_source),
            is_in_place: is_standing,
            ..rest(locals, RestOrigin::Model, 1.0)
        };
    }
    let confidence = stance.map_or(1.0, Stance::confidence);
    // A rest that is a moment of the clip, and less upright and symmetric than rests are, is a pose in motion.
    let is_rest = is_standing && (confidence >= 1.0 || !is_moment_of(skeleton, clip, &locals));
    let better = stance.filter(|_| !is_rest);
    match better.and_then(|stance| best_standing(skeleton, slots, clip, stance)) {
        Some(Standing { locals: mut standing, stance, time_secs }) => {
            face_as_file(skeleton, slots, &locals, &mut standing);
            rest(standing, time_secs.map_or(RestOrigin::Mean, RestOrigin::Moment), stance.confidence())
        }
        None => rest(locals, RestOrigin::Motion, confidence),
    }
}

/// Returns the target's rest pose.
pub fn target_rest(target: &Asset, choice: RestChoice) -> Vec<Local> {
    chosen_locals(target, target.clips.first(), choice)
}

/// Rotations and translations of one pose. `Auto` is [`Asset::reference_pose`]. Without a clip, the first frame is the nodes' rest.
fn chosen_locals(asset: &Asset, clip: Option<&Clip>, choice: RestChoice) -> Vec<Local> {
    let skeleton = &asset.skeleton;
    match (choice, clip) {
        (RestChoice::Auto, _) => bound(skeleton, asset.reference_transforms()),
        (RestChoice::Bind, _) => bound(skeleton, asset.bind_transforms()),
        (RestChoice::FirstFrame, Some(clip)) => {
            clip_locals(skeleton, clip, clip.first_key_secs(), &mut Scratch::default())
        }
        (RestChoice::Node | RestChoice::FirstFrame, _) => node_locals(skeleton),
    }
}

/// The nodes' rest, and where the skin covers a joint, the pose that it was bound in.
fn bound(skeleton: &Skeleton, transforms: Vec<BoundTransform>) -> Vec<Local> {
    let mut locals = node_locals(skeleton);
    let reflection = skeleton.reflection();
    for (joint, BoundTransform { translation, rotation }) in skeleton.joints().zip(transforms) {
        // What mirrors the body is above it, and no part of its pose.
        if reflection.changes(joint) {
            continue;
        }
        let local = &mut locals[joint.get()];
        local.translation = translation.unwrap_or(local.translation);
        local.rotation = rotation.unwrap_or(local.rotation);
    }
    locals
}
