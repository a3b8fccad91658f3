//! Animations (§3.11). Each becomes a clip with the file's own keys.

use std::collections::BTreeMap;
use std::fmt::Display;

use gaitway_character::anim::{ChannelError, Clip, ClipBuilder, Interpolation, Keys, PropertyTarget, Skeleton};
use gaitway_character::asset::{Warning, Warnings};
use gaitway_character::mesh::Material;
use glam::{Quat, Vec3};
use gltf::json;
use gltf::json::animation::{Interpolation as JsonInterpolation, Property};
use gltf::json::validation::Checked;
use serde::{Deserialize, Serialize};

use super::accessor::{Accessors, get};
use super::document::{Document, present};
use super::pointer::{Aim, POINTER, Pointers, Unresolved};
use super::vrm::AnimatedNodes;
use crate::error::Problem;

/// Further pointers to things that aren't shown are only counted in the warning.
const MAX_NAMED: usize = 30;
/// Characters of a pointer shown in a warning.
const MAX_POINTER: usize = 120;

pub fn clips(
    accessors: &Accessors,
    skeleton: &Skeleton,
    materials: &[Material],
    animated: &AnimatedNodes,
    warnings: &mut Warnings,
) -> Result<Vec<Clip>, Problem> {
    let root = &accessors.document.root;
    let pointers = Pointers { root, skeleton, materials, animated };
    let mut times = Times { accessors, read: BTreeMap::new() };
    let mut clips = Vec::with_capacity(root.animations.len());
    for (index, animation) in root.animations.iter().enumerate() {
        clips.push(read_clip(accessors, &pointers, index, animation, &mut times, warnings)?);
    }
    Ok(clips)
}

/// The extras of an animation.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct Extras {
    /// Gaitway has added it to a file that was there before.
    #[serde(default)]
    pub gaitway_added: bool,
}

/// Returns the last animation that Gaitway has added.
pub fn added(root: &json::Root) -> Option<usize> {
    root.animations.iter().rposition(|animation| {
        let extras = animation.extras.as_ref().and_then(|extras| serde_json::from_str::<Extras>(extras.get()).ok());
        extras.is_some_and(|extras| extras.gaitway_added)
    })
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
    pointers: &Pointers,
    index: usize,
    animation: &json::Animation,
    times: &mut Times,
    warnings: &mut Warnings,
) -> Result<Clip, Problem> {
    let name = animation.name.as_deref().unwrap_or_default();
    let builder = ClipBuilder::new(name, pointers.skeleton);
    let mut reader = ClipReader { accessors, pointers, index, animation, builder };
    let mut not_shown = Vec::new();
    for at in 0..animation.channels.len() {
        let Err(ignored) = reader.channel(at, times, warnings) else { continue };
        let (place, problem) = match ignored {
            Ignored::Silently => continue,
            Ignored::NotShown(pointer) => {
                not_shown.push(pointer);
                continue;
            }
            Ignored::Because(problem) => (format!("animations[{index}].channels[{at}]"), problem),
            Ignored::Broken(Problem::Invalid { place, expected, found }) => {
                (place, format!("expected {expected}, found {found}"))
            }
            // A limit on the whole model, or a file that is missing.
            Ignored::Broken(problem) => return Err(problem),
        };
        warnings.push(Warning::ChannelIgnored { clip: name.to_owned(), place, problem });
    }
    if !not_shown.is_empty() {
        warnings.push(not_shown_warning(index, &not_shown));
    }
    Ok(reader.builder.build())
}

/// One warning for all: a file that animates such properties often animates many.
fn not_shown_warning(index: usize, pointers: &[String]) -> Warning {
    let mut named = pointers[..pointers.len().min(MAX_NAMED)].join(", ");
    if pointers.len() > MAX_NAMED {
        named += &format!(" and {} more", pointers.len() - MAX_NAMED);
    }
    let problem = format!("properties that Gaitway doesn't show are animated and left out: {named}");
    Warning::Other { code: "animation-pointer", place: format!("animations[{index}]"), problem }
}

/// Why a channel is left out.
enum Ignored {
    /// Already reported.
    Silently,
    /// This pointer leads to nothing that is shown.
    NotShown(String),
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
    pointers: &'a Pointers<'a>,
    index: usize,
    animation: &'a json::Animation,
    builder: ClipBuilder<'a>,
}

/// Where a channel's keys are.
struct Source<'a> {
    sampler: &'a json::animation::Sampler,
    input: usize,
    output: usize,
    /// The sampler's place.
    here: &'a dyn Display,
}

impl ClipReader<'_> {
    fn channel(&mut self, at: usize, times: &mut Times, warnings: &mut Warnings) -> Result<(), Ignored> {
        let Self { index, animation, .. } = *self;
        let channel = &animation.channels[at];
        // Formatted only for a message: a file may have thousands of channels.
        let place = format_args!("animations[{index}].channels[{at}]");
        let sampler_index = present(channel.sampler).ok_or(Ignored::Silently)?;
        let sampler = get(&animation.samplers, sampler_index, &format_args!("{place}.sampler"), "samplers")?;
        let here = &format_args!("animations[{index}].samplers[{sampler_index}]");
        let (Some(input), Some(output)) = (present(sampler.input), present(sampler.output)) else {
            return Err(Ignored::Silently);
        };
        let source = Source { sampler, input, output, here };
        if let (Some(node), Checked::Valid(property)) = (present(channel.target.node), channel.target.path) {
            return self.node(node, property, &source, &place, times, warnings);
        }
        for aim in self.pointed_at(&channel.target, &place)? {
            match aim {
                Aim::Node(node, property) => self.node(node, property, &source, &place, times, warnings)?,
                Aim::Property(target) => self.property(target, &source, times, warnings)?,
            }
        }
        Ok(())
    }

    /// Returns what a channel without a node, or with an unknown path, animates.
    fn pointed_at(&self, target: &json::animation::Target, place: &dyn Display) -> Result<Vec<Aim>, Ignored> {
        let document = self.accessors.document;
        let pointer = document.text_at(&format!("{place}.target.extensions.{POINTER}.pointer"));
        if pointer.is_empty() {
            let path = document.quoted_at(&format!("{place}.target.path"));
            return Err(Ignored::Because(match present(target.node) {
                Some(_) => format!("its path {path} is not known"),
                None => format!("its target {path} is not a node's property"),
            }));
        }
        let resolved = self.pointers.resolve(&pointer);
        let pointer: String = pointer.chars().take(MAX_POINTER).collect();
        resolved.map_err(|problem| match problem {
            Unresolved::Unsupported => Ignored::NotShown(pointer),
            Unresolved::Bad(problem) => Ignored::Because(format!("its pointer “{pointer}” leads nowhere: {problem}")),
        })
    }

    fn node(
        &mut self,
        node: usize,
        property: Property,
        source: &Source,
        place: &dyn Display,
        times: &mut Times,
        warnings: &mut Warnings,
    ) -> Result<(), Ignored> {
        let (accessors, skeleton) = (self.accessors, self.pointers.skeleton);
        let target = get(&accessors.document.root.nodes, node, &format_args!("{place}.target.node"), "nodes")?;
        let joint = skeleton.joint_of_source(node).ok_or(Ignored::Silently)?;
        let targets = skeleton.morph_range(joint).len();
        if property == Property::MorphTargetWeights && targets == 0 {
            return Err(Ignored::Because("the node has no morph targets".to_owned()));
        }
        let here = source.here;
        let keys = keys(accessors, property, source.output, &format_args!("{here}.output"), targets)?;
        let key_times = times.get(source.input, &format_args!("{here}.input"))?;
        let interpolation = interpolation_mode(accessors.document, source, warnings);
        // The tangents of a rotation can't be converted to tangents of its angles.
        let is_rotation_spline = matches!(keys, Keys::Rotation(_)) && interpolation == Interpolation::CubicSpline;
        if let Some((target, values)) = self.pointers.animated.property(joint, &keys)
            && !is_rotation_spline
        {
            let added = self.builder.property(target, interpolation, key_times, values);
            added.map_err(|problem| unusable(source, problem))?;
        }
        self.builder.channel(joint, interpolation, key_times, keys).map_err(|problem| unusable(source, problem))?;
        if target.matrix.is_some() && property != Property::MorphTargetWeights {
            let problem = format!(
                "nodes[{node}] has a matrix, which must not be animated; its translation, rotation and scale are taken from it"
            );
            warnings.push(Warning::Other { code: "animated-matrix", place: place.to_string(), problem });
        }
        Ok(())
    }

    fn property(
        &mut self,
        target: PropertyTarget,
        source: &Source,
        times: &mut Times,
        warnings: &mut Warnings,
    ) -> Result<(), Ignored> {
        let (accessors, here) = (self.accessors, source.here);
        let place = format_args!("{here}.output");
        let values = match target.width() {
            4 => accessors.finite::<4>(source.output, &place, "VEC4")?.into_flattened(),
            3 => accessors.finite::<3>(source.output, &place, "VEC3")?.into_flattened(),
            2 => accessors.finite::<2>(source.output, &place, "VEC2")?.into_flattened(),
            _ => accessors.finite::<1>(source.output, &place, "SCALAR")?.into_flattened(),
        };
        let key_times = times.get(source.input, &format_args!("{here}.input"))?;
        let interpolation = interpolation_mode(accessors.document, source, warnings);
        if matches!(target, PropertyTarget::Visibility(_)) && interpolation != Interpolation::Step {
            let problem = "visibility can't be interpolated; STEP is used".to_owned();
            let place = format!("{here}.interpolation");
            warnings.push(Warning::Other { code: "interpolation", place, problem });
        }
        let added = self.builder.property(target, interpolation, key_times, values);
        added.map_err(|problem| unusable(source, problem).into())
    }
}

fn unusable(source: &Source, problem: ChannelError) -> Problem {
    Problem::new(source.here.to_string(), "usable keys", problem)
}

fn interpolation_mode(document: &Document, source: &Source, warnings: &mut Warnings) -> Interpolation {
    match source.sampler.interpolation {
        Checked::Valid(JsonInterpolation::Linear) => Interpolation::Linear,
        Checked::Valid(JsonInterpolation::Step) => Interpolation::Step,
        Checked::Valid(JsonInterpolation::CubicSpline) => Interpolation::CubicSpline,
        Checked::Invalid => {
            let place = format!("{}.interpolation", source.here);
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
