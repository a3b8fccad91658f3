//! Figures that need no more than a few moments of the clip, spread evenly.

use gaitway_character::anim::{Clip, JointIndex, Pose, SampleCursor, model_from_joint};
use gaitway_character::asset::Humanoid;
use glam::Affine3A;

use super::facing::{Heading, Legs, facing_path_error};
use super::limbs::{coverage, limbs};
use super::played::PlayedClip;
use super::stretch::SkinEdges;
use crate::feet::Soles;
use crate::pose::PartialPose;
use crate::transfer::{CopyPolicy, Transfer, removed_travel};

/// Steps between moments: the rate, and the fewest and most of a clip.
const STEPS_PER_SEC: f32 = 4.0;
const MIN_STEPS: f32 = 8.0;
const MAX_STEPS: f32 = 48.0;

/// Part of [`Figures`](super::Figures).
#[derive(Debug, Default)]
pub struct Moments {
    pub worst_stretch: Option<(f64, JointIndex)>,
    pub worst_tear: Option<(f64, JointIndex)>,
    pub mean_stretch: Option<f64>,
    pub idle_chains: Vec<String>,
    pub coverage: Option<f64>,
    pub facing_path_error_degrees: Option<f64>,
}

/// Plays the clip at some moments. `soles` are the target's.
pub fn moments(transfer: &Transfer, slots: [&Humanoid; 2], clip: &Clip, soles: Soles) -> Moments {
    let skeleton = transfer.target_skeleton;
    let steps = (clip.duration_secs() * STEPS_PER_SEC).clamp(MIN_STEPS, MAX_STEPS) as usize;
    let times: Vec<f32> = (0..=steps).map(|step| clip.duration_secs() * step as f32 / steps as f32).collect();
    let mut model_from_joints = Vec::new();
    model_from_joint(skeleton, skeleton.rest(), Affine3A::IDENTITY, &mut model_from_joints);
    let mut skin = SkinEdges::new(transfer.target, &model_from_joints);
    let mut limbs = limbs(transfer, slots);

    let removed = removed_travel(transfer, &times);
    let [source_legs, target_legs] = [Legs::of_source(transfer), Legs::of_target(transfer, soles)];
    let mut headings = Vec::new();
    let mut source_pose =
        PartialPose::new(transfer.tracks.skeleton, transfer.alignment.source.world_from_model, source_legs.joints());
    let mut played = PlayedClip::new(transfer, &target_legs.joints().collect::<Vec<_>>());

    // Offsets are the model's at its rest, which isn't that of its nodes where a skin was bound otherwise.
    let reflection = skeleton.reflection();
    let offsets = skeleton.joints().zip(&transfer.alignment.target.locals);
    let offsets: Vec<_> =
        offsets.map(|(joint, local)| (joint, reflection.translation(joint, local.translation).as_vec3())).collect();
    // Where joints move on their parents as their sources do, the motion stretches the body on purpose: on the same skeleton, and
    // between creatures.
    let takes_translations = CopyPolicy::new(transfer).translations || transfer.alignment.pair_of_slot.is_empty();
    let mut in_place = Vec::new();
    let (mut pose, mut cursor) = (Pose::default(), SampleCursor::default());
    for (index, &time) in times.iter().enumerate() {
        pose.copy_from(skeleton.rest());
        clip.sample(skeleton, time, &mut cursor, &mut pose);
        model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut model_from_joints);
        offsets.iter().for_each(|&(joint, offset)| pose.set_translation(joint, offset));
        model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut in_place);
        skin.add(&model_from_joints, &in_place);
        for limb in &mut limbs {
            let mut source = transfer.tracks.locals_at(time);
            limb.add(|joint| pose.local(joint).rotation.as_dquat(), |joint| source(joint).rotation);
        }
        if let Some(hips) = transfer.hips_pair() {
            let source = source_pose.update(transfer.tracks.locals_at(time));
            let target = played.in_pose(&pose);
            let turn_back = removed.turn(time).conjugate();
            let restored = removed.restored(transfer, target, hips.target, index, turn_back);
            headings.push([
                Heading::new(&source_legs, source, source.position(hips.source)),
                Heading::new(&target_legs, target, restored).turned(turn_back),
            ]);
        }
    }
    Moments {
        worst_stretch: skin.worst(),
        worst_tear: skin.worst_tear().filter(|_| !takes_translations),
        mean_stretch: skin.mean(),
        idle_chains: limbs.iter().filter(|limb| limb.is_idle()).map(|limb| limb.name.clone()).collect(),
        coverage: coverage(&limbs),
        facing_path_error_degrees: facing_path_error([&source_legs, &target_legs], &headings),
    }
}
