//! Animations (§3.11). Each becomes a clip with the file's own keys.

use std::collections::BTreeMap;
use std::fmt::Display;

use glam::{Quat, Vec3};

use super::accessor::{Accessors, get};
use super::schema;
use crate::anim::{Clip, ClipBuilder, Interpolation, Keys, Skeleton};
use crate::asset::{Warning, Warnings};
use crate::formats::error::Problem;

pub fn clips(accessors: &Accessors, skeleton: &Skeleton, warnings: &mut Warnings) -> Result<Vec<Clip>, Problem> {
    let mut times = Times { accessors, read: BTreeMap::new() };
    let mut clips = Vec::with_capacity(accessors.root.animations.len());
    for (index, animation) in accessors.root.animations.iter().enumerate() {
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
            entry.insert(times.into_iter().map(|[time_secs]| time_secs).collect());
        }
        Ok(&self.read[&accessor])
    }
}

fn read_clip(
    accessors: &Accessors,
    skeleton: &Skeleton,
    index: usize,
    animation: &schema::Animation,
    times: &mut Times,
    warnings: &mut Warnings,
) -> Result<Clip, Problem> {
    let mut builder = ClipBuilder::new(animation.name.as_str(), skeleton);
    for (at, channel) in animation.channels.iter().enumerate() {
        // Written out only where there is something to say: a file may have thousands of channels.
        let place = format_args!("animations[{index}].channels[{at}]");
        let mut ignore = |problem: String| {
            warnings.push(Warning::ChannelIgnored { clip: animation.name.clone(), place: place.to_string(), problem });
        };
        let sampler = get(&animation.samplers, channel.sampler, &format_args!("{place}.sampler"), "samplers")?;
        // A channel without a node belongs to an extension; none of those is supported.
        let Some(node) = channel.target.node else {
            ignore(format!("its target “{}” is not a node's property", channel.target.path));
            continue;
        };
        get(&accessors.root.nodes, node, &format_args!("{place}.target.node"), "nodes")?;
        let Some(joint) = skeleton.joint_of_source(node) else { continue };
        let here = format_args!("animations[{index}].samplers[{}]", channel.sampler);
        let interpolation = match sampler.interpolation.as_deref() {
            None | Some("LINEAR") => Interpolation::Linear,
            Some("STEP") => Interpolation::Step,
            Some("CUBICSPLINE") => Interpolation::CubicSpline,
            Some(other) => {
                let expected = "LINEAR, STEP or CUBICSPLINE";
                return Err(Problem::new(format!("{here}.interpolation"), expected, format!("“{other}”")));
            }
        };
        let output = format_args!("{here}.output");
        let keys = match channel.target.path.as_str() {
            "translation" => Keys::Translation(vec3(accessors, sampler.output, &output)?),
            "scale" => Keys::Scale(vec3(accessors, sampler.output, &output)?),
            "rotation" => {
                let read = accessors.finite::<4>(sampler.output, &output, "VEC4 of rotations")?;
                Keys::Rotation(read.into_iter().map(Quat::from_array).collect())
            }
            "weights" => match skeleton.morph_range(joint).len() {
                0 => {
                    ignore("the node has no morph targets".to_owned());
                    continue;
                }
                targets => {
                    Keys::MorphWeights { values: weights(accessors, sampler.output, &output, targets)?, targets }
                }
            },
            other => {
                ignore(format!("its path “{other}” is not known"));
                continue;
            }
        };
        let key_times = times.get(sampler.input, &format_args!("{here}.input"))?;
        builder
            .channel(joint, interpolation, key_times, keys)
            .map_err(|problem| Problem::new(here.to_string(), "usable keys", problem))?;
    }
    Ok(builder.build())
}

fn vec3(accessors: &Accessors, accessor: usize, place: &dyn Display) -> Result<Vec<Vec3>, Problem> {
    Ok(accessors.finite::<3>(accessor, place, "VEC3")?.into_iter().map(Vec3::from).collect())
}

fn weights(accessors: &Accessors, accessor: usize, place: &dyn Display, targets: usize) -> Result<Vec<f32>, Problem> {
    let values: Vec<f32> =
        accessors.finite::<1>(accessor, place, "SCALAR of weights")?.into_iter().map(|[weight]| weight).collect();
    if !values.len().is_multiple_of(targets) {
        return Err(Problem::new(
            place.to_string(),
            format!("a multiple of {targets}, the number of targets"),
            values.len(),
        ));
    }
    Ok(values)
}
