//! Animations (§3.11). Each becomes a clip with the file's own keys.

use std::collections::BTreeMap;
use std::fmt::Display;

use glam::{Quat, Vec3};
use gltf::json;
use gltf::json::animation::{Interpolation as JsonInterpolation, Property};
use gltf::json::validation::Checked;

use super::accessor::{Accessors, get};
use super::document::target_node;
use crate::anim::{Clip, ClipBuilder, Interpolation, Keys, Skeleton};
use crate::asset::{Warning, Warnings};
use crate::formats::error::Problem;

pub fn clips(accessors: &Accessors, skeleton: &Skeleton, warnings: &mut Warnings) -> Result<Vec<Clip>, Problem> {
    let animations = &accessors.document.root.animations;
    let mut times = Times { accessors, read: BTreeMap::new() };
    let mut clips = Vec::with_capacity(animations.len());
    for (index, animation) in animations.iter().enumerate() {
        clips.push(read_clip(accessors, skeleton, index, animation, &mut times, warnings)?);
    }
    Ok(clips)
}

/// Key times, decoded once per accessor: many channels share them.
struct Times<'a> {
    accessors: &'a Accessors<'a>,
    read: BTreeMap<usize, Vec<f32>>,
}

impl Times<'_> {
    fn get(&mut self, accessor: usize, place: &dyn Display) -> Result<&[f32], Problem> {
        if let std::collections::btree_map::Entry::Vacant(entry) = self.read.entry(accessor) {
            let times = self.accessors.finite::<1>(accessor, place, "SCALAR of key times")?;
            entry.insert(times.into_flattened());
        }
        Ok(&self.read[&accessor])
    }
}

fn read_clip(
    accessors: &Accessors,
    skeleton: &Skeleton,
    index: usize,
    animation: &json::Animation,
    times: &mut Times,
    warnings: &mut Warnings,
) -> Result<Clip, Problem> {
    let document = accessors.document;
    let name = animation.name.as_deref().unwrap_or_default();
    let mut builder = ClipBuilder::new(name, skeleton);
    for (at, channel) in animation.channels.iter().enumerate() {
        // Formatted only for a message: a file may have thousands of channels.
        let place = format_args!("animations[{index}].channels[{at}]");
        let mut ignore = |problem: String| {
            warnings.push(Warning::ChannelIgnored { clip: name.to_owned(), place: place.to_string(), problem });
        };
        let sampler_index = channel.sampler.value();
        let sampler = get(&animation.samplers, sampler_index, &format_args!("{place}.sampler"), "samplers")?;
        let path = || document.quoted_at(&format!("{place}.target.path"));
        // A channel without a node belongs to an extension; none of those is supported.
        let Some(node) = target_node(channel.target.node) else {
            ignore(format!("its target {} is not a node's property", path()));
            continue;
        };
        get(&document.root.nodes, node, &format_args!("{place}.target.node"), "nodes")?;
        let Some(joint) = skeleton.joint_of_source(node) else { continue };
        let here = format_args!("animations[{index}].samplers[{sampler_index}]");
        let Checked::Valid(interpolation) = sampler.interpolation else {
            let here = format!("{here}.interpolation");
            let found = document.quoted_at(&here);
            return Err(Problem::new(here, "LINEAR, STEP or CUBICSPLINE", found));
        };
        let Checked::Valid(property) = channel.target.path else {
            ignore(format!("its path {} is not known", path()));
            continue;
        };
        let targets = skeleton.morph_range(joint).len();
        if property == Property::MorphTargetWeights && targets == 0 {
            ignore("the node has no morph targets".to_owned());
            continue;
        }
        let keys = keys(accessors, property, sampler.output.value(), &format_args!("{here}.output"), targets)?;
        let key_times = times.get(sampler.input.value(), &format_args!("{here}.input"))?;
        builder
            .channel(joint, interpolation_mode(interpolation), key_times, keys)
            .map_err(|problem| Problem::new(here.to_string(), "usable keys", problem))?;
    }
    Ok(builder.build())
}

fn interpolation_mode(interpolation: JsonInterpolation) -> Interpolation {
    match interpolation {
        JsonInterpolation::Linear => Interpolation::Linear,
        JsonInterpolation::Step => Interpolation::Step,
        JsonInterpolation::CubicSpline => Interpolation::CubicSpline,
    }
}

/// `targets`: the number of morph targets of the node's mesh.
fn keys(
    accessors: &Accessors,
    property: Property,
    accessor: usize,
    place: &dyn Display,
    targets: usize,
) -> Result<Keys, Problem> {
    Ok(match property {
        Property::Translation => Keys::Translation(vec3(accessors, accessor, place)?),
        Property::Scale => Keys::Scale(vec3(accessors, accessor, place)?),
        Property::Rotation => {
            let read = accessors.finite::<4>(accessor, place, "VEC4 of rotations")?;
            Keys::Rotation(read.into_iter().map(Quat::from_array).collect())
        }
        Property::MorphTargetWeights => {
            Keys::MorphWeights { values: weights(accessors, accessor, place, targets)?, targets }
        }
    })
}

fn vec3(accessors: &Accessors, accessor: usize, place: &dyn Display) -> Result<Vec<Vec3>, Problem> {
    Ok(accessors.finite::<3>(accessor, place, "VEC3")?.into_iter().map(Vec3::from).collect())
}

fn weights(accessors: &Accessors, accessor: usize, place: &dyn Display, targets: usize) -> Result<Vec<f32>, Problem> {
    let values = accessors.finite::<1>(accessor, place, "SCALAR of weights")?.into_flattened();
    if !values.len().is_multiple_of(targets) {
        return Err(Problem::new(
            place.to_string(),
            format!("a multiple of {targets}, the number of targets"),
            values.len(),
        ));
    }
    Ok(values)
}
