//! Holds joints and weights still throughout a clip.

use gaitway_character::anim::{Clip, JointIndex, PropertyTarget, Skeleton};
use glam::Quat;

use super::track::{Target, Track, Tracks};

/// Values that a clip has at any time, instead of its keys.
#[derive(Debug, Clone, Default)]
pub struct HeldValues {
    /// Local rotations of joints.
    pub rotations: Vec<(JointIndex, Quat)>,
    /// Weights by index in [`Pose::morph_weights`](gaitway_character::anim::Pose::morph_weights).
    pub morph_weights: Vec<(usize, f32)>,
    /// Weights by index in [`Avatar::expressions`](gaitway_character::avatar::Avatar::expressions).
    pub expressions: Vec<(usize, f32)>,
}

/// Returns a clip, as long as the given one, in which some values hold still. Other channels keep their keys.
pub fn hold_values(skeleton: &Skeleton, clip: &Clip, held: &HeldValues) -> Clip {
    let mut tracks = Tracks::of(clip);
    for &(joint, rotation) in &held.rotations {
        tracks.replace(Track::constant(Target::Rotation(joint), &rotation.to_array()));
    }
    for &(index, weight) in &held.expressions {
        tracks.replace(Track::constant(Target::Property(PropertyTarget::Expression(index)), &[weight]));
    }
    for &(index, weight) in &held.morph_weights {
        hold_morph_weight(&mut tracks, skeleton, index, weight);
    }
    tracks.build(clip.name(), skeleton)
}

/// A channel of all weights of a mesh stays one, and gets the weight in each key.
fn hold_morph_weight(tracks: &mut Tracks, skeleton: &Skeleton, index: usize, weight: f32) {
    let Some(joint) = skeleton.joints().find(|&joint| skeleton.morph_range(joint).contains(&index)) else { return };
    let range = skeleton.morph_range(joint);
    let target = index - range.start;
    tracks.tracks.retain(|track| track.target != Target::Property(PropertyTarget::MorphWeight(joint, target)));
    tracks.ensure(Target::Weights(joint), &skeleton.rest().morph_weights[range.clone()]);
    let mut weights = vec![0.0; range.len()];
    weights[target] = weight;
    for track in tracks.tracks.iter_mut().filter(|track| track.target == Target::Weights(joint)) {
        track.map(|numbers| numbers[target] = 0.0, &weights);
    }
}
