//! Animations (§3.11). Each becomes a clip with the file's own keys.

use std::collections::BTreeMap;
use std::fmt::Display;

use glam::{Quat, Vec3};
use gltf::json;
use gltf::json::animation::{Interpolation as JsonInterpolation, Property};
use gltf::json::validation::Checked;

use super::accessor::{Accessors, get};
use super::document::{Document, present};
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
    let name = animation.name.as_deref().unwrap_or_default();
    let mut reader = ClipReader { accessors, skeleton, index, animation, builder: ClipBuilder::new(name, skeleton) };
    for at in 0..animation.channels.len() {
        let Err(ignored) = reader.channel(at, times, warnings) else { continue };
        let (place, problem) = match ignored {
            Ignored::Silently => continue,
            Ignored::Because(problem) => (format!("animations[{index}].channels[{at}]"), problem),
            Ignored::Broken(Problem::Invalid { place, expected, found }) => {
                (place, format!("expected {expected}, found {found}"))
            }
            // A limit on the whole model, or a file that is missing.
            Ignored::Broken(problem) => return Err(problem),
        };
        warnings.push(Warning::ChannelIgnored { clip: name.to_owned(), place, problem });
    }
    Ok(reader.builder.build())
}

/// Why a channel is left out.
enum Ignored {
    /// It was reported before.
    Silently,
    Because(String),
    Broken(Problem),
}

impl From<Problem> for Ignored {
    fn from(problem: Problem) -> Self {
        Self::Broken(problem)
    }
}

struct ClipReader<'a> {
    accessors: &'a Accessors<'a>,
    skeleton: &'a Skeleton,
    index: usize,
    animation: &'a json::Animation,
    builder: ClipBuilder<'a>,
}

impl ClipReader<'_> {
    fn channel(&mut self, at: usize, times: &mut Times, warnings: &mut Warnings) -> Result<(), Ignored> {
        let Self { accessors, skeleton, index, animation, .. } = *self;
        let document = accessors.document;
        let channel = &animation.channels[at];
        // Formatted only for a message: a file may have thousands of channels.
        let place = format_args!("animations[{index}].channels[{at}]");
        let sampler_index = present(channel.sampler).ok_or(Ignored::Silently)?;
        let sampler = get(&animation.samplers, sampler_index, &format_args!("{place}.sampler"), "samplers")?;
        let path = || document.quoted_at(&format!("{place}.target.path"));
        // A channel without a node belongs to an extension; none of those is supported.
        let Some(node) = present(channel.target.node) else {
            return Err(Ignored::Because(format!("its target {} is not a node's property", path())));
        };
        let target = get(&document.root.nodes, node, &format_args!("{place}.target.node"), "nodes")?;
        let joint = skeleton.joint_of_source(node).ok_or(Ignored::Silently)?;
        let here = format_args!("animations[{index}].samplers[{sampler_index}]");
        let (Some(input), Some(output)) = (present(sampler.input), present(sampler.output)) else {
            return Err(Ignored::Silently);
        };
        let Checked::Valid(property) = channel.target.path else {
            return Err(Ignored::Because(format!("its path {} is not known", path())));
        };
        let targets = skeleton.morph_range(joint).len();
        if property == Property::MorphTargetWeights && targets == 0 {
            return Err(Ignored::Because("the node has no morph targets".to_owned()));
        }
        let keys = keys(accessors, property, output, &format_args!("{here}.output"), targets)?;
        let key_times = times.get(input, &format_args!("{here}.input"))?;
        let interpolation = interpolation_mode(document, sampler, &here, warnings);
        self.builder
            .channel(joint, interpolation, key_times, keys)
            .map_err(|problem| Problem::new(here.to_string(), "usable keys", problem))?;
        if target.matrix.is_some() && property != Property::MorphTargetWeights {
            let problem = format!(
                "nodes[{node}] has a matrix, which must not be animated; its translation, rotation and scale are taken from it"
            );
            warnings.push(Warning::Other { code: "animated-matrix", place: place.to_string(), problem });
        }
        Ok(())
    }
}

fn interpolation_mode(
    document: &Document,
    sampler: &json::animation::Sampler,
    here: &dyn Display,
    warnings: &mut Warnings,
) -> Interpolation {
    match sampler.interpolation {
        Checked::Valid(JsonInterpolation::Linear) => Interpolation::Linear,
        Checked::Valid(JsonInterpolation::Step) => Interpolation::Step,
        Checked::Valid(JsonInterpolation::CubicSpline) => Interpolation::CubicSpline,
        Checked::Invalid => {
            let place = format!("{here}.interpolation");
            let problem = format!("{} is not known; LINEAR is used", document.quoted_at(&place));
            warnings.push(Warning::Other { code: "interpolation", place, problem });
            Interpolation::Linear
        }
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
