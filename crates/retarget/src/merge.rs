//! Merges clips of several files for one rig: they keep their keys, bit for bit. Retargeting between such files gives the same motion
//! except for rounding.

use gaitway_character::anim::{Clip, ClipBuilder, JointIndex, Pose, SampleCursor, Skeleton, Transform};

use crate::keys::resample::union;
use crate::map::shared_names;

/// How far transforms of one rig may differ: a quaternion's components, factors of scale, and translations as a share of the
/// longest one in the model's rest.
const TOLERANCE: f32 = 1e-4;

/// Returns a clip of a motion for the model's joints, with its keys unchanged. `retargeted` is the same clip as it is shown.
/// `None` unless it is shown as the motion has it, and all joints that it moves, with those above them, have the names, the
/// parents and the rest that they have in the model.
pub fn merged_clip(model: &Skeleton, motion: &Skeleton, clip: &Clip, retargeted: &Clip) -> Option<Clip> {
    let lengths = model.rest().locals().map(|local| local.translation.length());
    let tolerance = Tolerance { metres: TOLERANCE * lengths.fold(0.0, f32::max) };
    let mut target_of: Vec<Option<JointIndex>> = vec![None; motion.len()];
    for (target, source) in shared_names(model, motion) {
        target_of[source.get()] = Some(target).filter(|_| model.name(target) == motion.name(source));
    }
    let is_same_joint = |source: JointIndex, target: JointIndex| {
        let parent = motion.parent(source).map(|parent| target_of[parent.get()]);
        let has_its_parent =
            parent.map_or(model.parent(target).is_none(), |parent| parent.is_some() && parent == model.parent(target));
        has_its_parent && tolerance.is_met(motion.rest().local(source), model.rest().local(target))
    };
    for channel in clip.channels() {
        let mut above = Some(channel.joint);
        while let Some(source) = above {
            target_of[source.get()].filter(|&target| is_same_joint(source, target))?;
            above = motion.parent(source);
        }
    }
    let merged = clip_for(model, clip, |source| target_of[source.get()])?.with_properties_of(retargeted, &Some);
    tolerance.are_alike(model, &merged, retargeted).then_some(merged)
}

/// Returns a clip with the same keys for the joints of another skeleton. `None` if it lacks one of them, or its morph targets.
pub fn clip_for(
    skeleton: &Skeleton,
    clip: &Clip,
    target_of: impl Fn(JointIndex) -> Option<JointIndex>,
) -> Option<Clip> {
    let mut builder = ClipBuilder::new(clip.name(), skeleton);
    for channel in clip.channels() {
        let times_secs = &clip.timelines()[channel.timeline as usize];
        builder.channel(target_of(channel.joint)?, channel.interpolation, times_secs, channel.keys.clone()).ok()?;
    }
    Some(builder.build())
}

struct Tolerance {
    metres: f32,
}

impl Tolerance {
    fn is_met(&self, one: Transform, other: Transform) -> bool {
        // Opposite quaternions are one rotation.
        let turn = (one.rotation - other.rotation).length().min((one.rotation + other.rotation).length());
        turn <= TOLERANCE
            && one.translation.distance(other.translation) <= self.metres
            && one.scale.distance(other.scale) <= TOLERANCE * one.scale.length()
    }

    /// Whether two clips have the same poses at their keys and halfway to the next ones.
    fn are_alike(&self, skeleton: &Skeleton, one: &Clip, other: &Clip) -> bool {
        let times = union(one.timelines().iter().chain(other.timelines()).map(Vec::as_slice));
        let halfway: Vec<f32> = times.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        let mut sampled = [one, other].map(|clip| (clip, SampleCursor::default(), skeleton.rest().clone()));
        times.iter().chain(&halfway).all(|&time_secs| {
            for (clip, cursor, pose) in &mut sampled {
                pose.copy_from(skeleton.rest());
                clip.sample(skeleton, time_secs, cursor, pose);
            }
            let [(_, _, one), (_, _, other)] = &sampled;
            self.are_same(one, other)
        })
    }

    fn are_same(&self, one: &Pose, other: &Pose) -> bool {
        one.locals().zip(other.locals()).all(|(one, other)| self.is_met(one, other))
            && one.morph_weights.iter().zip(&other.morph_weights).all(|(one, other)| (one - other).abs() <= TOLERANCE)
    }
}
