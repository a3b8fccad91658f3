//! Expressions of the motion on a model that doesn't have them: its morph targets of the same names. Expressions that the model has
//! are added by the library, which knows what else they change.

use std::collections::HashSet;

use gaitway_character::anim::{
    Interpolation, JointIndex, Keys, PropertyChannel, PropertyTarget, PropertyValues, SampleCursor,
};

use super::Transfer;
use crate::budget::held_poses;
use crate::keys::channel::NewChannel;
use crate::keys::resample::union;

/// Time between the keys that stand in for a CUBICSPLINE expression.
const SPLINE_STEP_SECS: f32 = 1.0 / 60.0;

/// Returns the weights of the model's morph targets that are named like animated expressions.
pub fn expression_channels(transfer: &Transfer) -> Vec<NewChannel> {
    let (model, clip) = (transfer.target, transfer.tracks.clip);
    let named = |channel: &PropertyChannel| {
        let PropertyTarget::Expression(index) = channel.target else { return None };
        let name = transfer.source.avatar.expressions.get(index)?.name.as_str();
        model.avatar.expression(name).is_none().then_some((name, channel.target))
    };
    let expressions: Vec<(&str, PropertyTarget)> = clip.properties().iter().filter_map(named).collect();
    let mut channels: Vec<NewChannel> = Vec::new();
    let mut moved_joints = HashSet::new();
    for instance in &model.instances {
        let weights = &model.skeleton.rest().morph_weights[model.skeleton.morph_range(instance.joint)];
        let targets = model.meshes[instance.mesh].target_names.iter().take(weights.len()).enumerate();
        let moved: Vec<(usize, PropertyTarget)> = targets
            .filter_map(|(at, target)| {
                let same = expressions.iter().find(|(name, _)| name.eq_ignore_ascii_case(target))?;
                Some((at, same.1))
            })
            .collect();
        if !moved.is_empty() && moved_joints.insert(instance.joint) {
            channels.push(weights_channel(transfer, instance.joint, weights, &moved));
        }
    }
    channels
}

/// The weights of all morph targets on a joint, `moved` as the expressions are.
fn weights_channel(
    transfer: &Transfer,
    joint: JointIndex,
    rest: &[f32],
    moved: &[(usize, PropertyTarget)],
) -> NewChannel {
    let clip = transfer.tracks.clip;
    let sources: Vec<&PropertyChannel> =
        clip.properties().iter().filter(|channel| moved.iter().any(|(_, target)| *target == channel.target)).collect();
    let mut times =
        union(sources.iter().map(|channel| clip.property_timelines()[channel.timeline as usize].as_slice()));
    let is_stepped = sources.iter().all(|channel| channel.interpolation == Interpolation::Step);
    if sources.iter().any(|channel| channel.interpolation == Interpolation::CubicSpline)
        && let (Some(&first), Some(&last)) = (times.first(), times.last())
    {
        let steps = (((last - first) / SPLINE_STEP_SECS) as usize).min(held_poses(rest.len()));
        let between: Vec<f32> = (0..=steps).map(|step| first + step as f32 * SPLINE_STEP_SECS).collect();
        times = union([times.as_slice(), &between]);
    }
    let (mut cursor, mut properties) = (SampleCursor::default(), PropertyValues::default());
    let mut values = Vec::with_capacity(times.len() * rest.len());
    for &time in &times {
        clip.sample_properties(time, &mut cursor, &mut properties);
        let start = values.len();
        values.extend_from_slice(rest);
        for &(at, target) in moved {
            values[start + at] = properties.get(target).map_or(rest[at], |value| value.x);
        }
    }
    NewChannel {
        joint,
        interpolation: if is_stepped { Interpolation::Step } else { Interpolation::Linear },
        times,
        keys: Keys::MorphWeights { values, targets: rest.len() },
        resampled: false,
    }
}
