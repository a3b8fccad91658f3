//! The pose of a take at a time.

use gaitway_character::anim::{Pose, PropertyValues, SampleCursor};
use gaitway_retarget::ClipOverLayers;
use glam::Vec3;

use super::avatar::AvatarPose;
use super::layers::LayerSampler;
use super::{Take, whole};

/// A time in a take.
#[derive(Debug, Clone, Copy, Default)]
pub struct Moment<'a> {
    /// How long the clip has played; runs on beyond the range.
    pub elapsed_secs: f64,
    /// The clip that fades out, during a crossfade.
    pub from: Option<Outgoing<'a>>,
}

/// The clip that a crossfade comes from.
#[derive(Debug, Clone, Copy)]
pub struct Outgoing<'a> {
    /// The clip; `None` is the rest pose.
    pub clip: Option<ClipOverLayers<'a>>,
    /// How long it had played when the crossfade began; it plays on.
    pub time_secs: f64,
    /// Time since then.
    pub elapsed_secs: f64,
    /// Length of the crossfade.
    pub length_secs: f64,
}

/// A pose, with the buffers to sample the next one without allocating.
#[derive(Debug, Default)]
pub struct TakeSampler {
    /// The pose sampled last; empty before that.
    pub pose: Pose,
    /// What the clip animates besides joints, sampled together with the pose.
    pub properties: PropertyValues,
    cursor: SampleCursor,
    before: Pose,
    before_properties: PropertyValues,
    before_cursor: SampleCursor,
    layers: LayerSampler,
    avatar: AvatarPose,
}

impl TakeSampler {
    /// Samples the pose of a moment: [`Self::sample_motion`], then [`Self::apply_avatar`].
    pub fn sample(&mut self, take: &Take<'_>, moment: Moment<'_>, eye: Option<Vec3>) {
        self.sample_motion(take, moment);
        self.apply_avatar(take, moment.elapsed_secs, eye);
    }

    /// Samples the rest pose, layers below the clip, the clip, a crossfade, the layers over it, then joints that are held. A
    /// crossfade doesn't blend properties but switches them halfway, and layers leave them alone. Allocates nothing once the
    /// buffers have grown.
    pub fn sample_motion(&mut self, take: &Take<'_>, Moment { elapsed_secs, from }: Moment<'_>) {
        let time_secs = take.clip_secs(elapsed_secs);
        take.sample_clip(time_secs, elapsed_secs, &mut self.cursor, &mut self.pose);
        sample_properties(take.clip, time_secs, &mut self.cursor, &mut self.properties);
        if let Some(outgoing) = from {
            self.fade(take, outgoing);
        }
        self.layers.apply(take, elapsed_secs, &mut self.pose);
        take.held.pose_joints(take.model, &mut self.pose);
    }

    fn fade(&mut self, take: &Take<'_>, Outgoing { clip, time_secs, elapsed_secs, length_secs }: Outgoing<'_>) {
        let before = Take { clip, range: whole(clip), ..*take };
        let weight = if length_secs > 0.0 { (elapsed_secs / length_secs).clamp(0.0, 1.0) } else { 1.0 };
        let played_secs = time_secs + elapsed_secs;
        let time_secs = before.clip_secs(played_secs);
        before.sample_clip(time_secs, played_secs, &mut self.before_cursor, &mut self.before);
        sample_properties(clip, time_secs, &mut self.before_cursor, &mut self.before_properties);
        if weight < 0.5 {
            std::mem::swap(&mut self.properties, &mut self.before_properties);
        }
        // Smoothstep: eases in and out.
        self.pose.blend(&self.before, (weight * weight * (3.0 - 2.0 * weight)) as f32);
    }

    /// Applies pins and the avatar to the sampled motion, then morph weights that are held. `eye` is the camera's position in world
    /// space, without which nothing follows the camera. Allocates only when the spring simulation restarts.
    pub fn apply_avatar(&mut self, take: &Take<'_>, elapsed_secs: f64, eye: Option<Vec3>) {
        if !take.pins.is_empty() {
            take.pinning(eye).apply(take.clip_secs(elapsed_secs), &mut self.pose);
        }
        self.avatar.apply(take, elapsed_secs, eye, &mut self.pose, &mut self.properties);
        take.held.set_morph_weights(take.model, &mut self.pose);
    }

    /// The weights of the avatar's expressions from the clip or set manually, before expressions override each other.
    pub fn expressions(&self) -> &[f32] {
        &self.avatar.weights
    }
}

impl Take<'_> {
    /// Samples the clip over the rest pose, and what plays below it after `elapsed_secs`; without a clip, the rest pose.
    pub(super) fn sample_clip(&self, time_secs: f64, elapsed_secs: f64, cursor: &mut SampleCursor, pose: &mut Pose) {
        let skeleton = &self.model.asset.skeleton;
        match self.clip {
            Some(clip) => clip.sample(skeleton, time_secs, elapsed_secs, cursor, pose),
            None => pose.copy_from(skeleton.rest()),
        }
    }
}

fn sample_properties(
    clip: Option<ClipOverLayers<'_>>,
    time_secs: f64,
    cursor: &mut SampleCursor,
    into: &mut PropertyValues,
) {
    into.clear();
    if let Some(over) = clip {
        over.clip.sample_properties(time_secs as f32, cursor, into);
    }
}
