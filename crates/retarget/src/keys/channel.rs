//! A channel of the retargeted clip before it is built.

use gaitway_character::anim::{Clip, Interpolation, JointIndex, Keys, Property, Reflection};
use glam::{DQuat, DVec3, Quat, Vec3};

use super::resample::Resampled;

/// Keys for one property of a target joint.
#[derive(Debug, Clone)]
pub struct NewChannel {
    pub joint: JointIndex,
    pub interpolation: Interpolation,
    pub times: Vec<f32>,
    pub keys: Keys,
    /// Whether the keys were resampled instead of taken from the source.
    pub resampled: bool,
}

impl NewChannel {
    /// Creates a channel with a single value.
    pub fn constant(joint: JointIndex, keys: Keys) -> Self {
        Self { joint, interpolation: Interpolation::Step, times: vec![0.0], keys, resampled: false }
    }

    /// Creates a channel of resampled, linear keys.
    pub fn resampled(joint: JointIndex, times: Vec<f32>, keys: Keys) -> Self {
        Self { joint, interpolation: Interpolation::Linear, times, keys, resampled: true }
    }

    pub fn resampled_translation(joint: JointIndex, positions: Resampled<DVec3>) -> Self {
        let values = positions.values.into_iter().map(DVec3::as_vec3).collect();
        Self::resampled(joint, positions.times, Keys::Translation(values))
    }

    /// Returns the channel of a mirrored skeleton, from the one in the mirror.
    pub fn in_mirror(mut self, reflection: &Reflection) -> Self {
        reflection.change_keys(self.joint, &mut self.keys);
        self
    }

    /// Copies the channels of a clip, with one joint's translation and the rotations of others replaced by keys at the given times.
    /// `resampled` lists the joints, ascending, whose keys in `clip` are not the source's own.
    pub fn corrected(
        clip: &Clip,
        resampled: &[JointIndex],
        times: &[f32],
        translation: Option<(JointIndex, Vec<Vec3>)>,
        rotations: Vec<(JointIndex, Vec<DQuat>)>,
    ) -> Vec<Self> {
        let is_replaced = |joint: JointIndex, property: Property| match property {
            Property::Rotation => rotations.iter().any(|(other, _)| *other == joint),
            Property::Translation => translation.as_ref().is_some_and(|(other, _)| *other == joint),
            Property::Scale | Property::MorphWeights => false,
        };
        let kept = clip.channels().iter().filter(|channel| !is_replaced(channel.joint, channel.keys.property()));
        let mut channels: Vec<Self> = Vec::with_capacity(clip.channels().len());
        channels.extend(kept.map(|channel| Self {
            joint: channel.joint,
            interpolation: channel.interpolation,
            times: clip.timelines()[channel.timeline as usize].clone(),
            keys: channel.keys.clone(),
            resampled: resampled.binary_search(&channel.joint).is_ok(),
        }));
        let new = |joint, keys| Self::resampled(joint, times.to_vec(), keys);
        channels.extend(translation.map(|(joint, keys)| new(joint, Keys::Translation(keys))));
        for (joint, keys) in rotations {
            channels.push(new(joint, Keys::Rotation(keys.into_iter().map(DQuat::as_quat).collect())));
        }
        channels
    }

    /// Repeats the last value at a later time.
    pub fn hold_until(&mut self, time_secs: f32) {
        let is_spline = self.interpolation == Interpolation::CubicSpline;
        match &mut self.keys {
            Keys::Translation(values) | Keys::Scale(values) => hold(values, is_spline, Vec3::ZERO),
            Keys::Rotation(values) => hold(values, is_spline, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
            Keys::MorphWeights { .. } => return,
        }
        self.times.push(time_secs);
    }
}

fn hold<T: Copy>(values: &mut Vec<T>, is_spline: bool, zero: T) {
    let Some(&value) = (if is_spline { values.iter().nth_back(1) } else { values.last() }) else { return };
    if let Some(out_tangent) = values.last_mut().filter(|_| is_spline) {
        *out_tangent = zero;
        values.extend([zero, value, zero]);
    } else {
        values.push(value);
    }
}

/// Returns rotation keys, each on the same side of the sphere as the one before, as interpolation between keys needs them.
pub fn continuous(rotations: impl IntoIterator<Item = DQuat>) -> Keys {
    let mut values: Vec<Quat> = rotations.into_iter().map(DQuat::as_quat).collect();
    for key in 1..values.len() {
        if values[key - 1].dot(values[key]) < 0.0 {
            values[key] = -values[key];
        }
    }
    Keys::Rotation(values)
}
