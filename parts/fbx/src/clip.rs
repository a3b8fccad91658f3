//! Animation stacks ("takes") as clips.
//!
//! ufbx evaluates the curves with everything that lies between them and a joint's transform: pivots, rotation orders, layers,
//! extrapolation. `curves` finds out which ones take part and where they have keys, `fit` does the rest.

use gaitway_glb::{Animation, Glb, Warnings};
use ufbx::{Anim, Node, Scene};

use crate::curves::{
    Curves, Drivers, Limits, PIVOT_PROPERTIES, ROTATION_PROPERTIES, SCALE_PROPERTIES, TRANSLATION_PROPERTIES,
};
use crate::fit::{self, Keys, Space, Track, fit};
use crate::inherit;
use crate::mesh::Morph;
use crate::node::{Nodes, finite};
use crate::tolerance::{Tolerance, Tolerances};

/// Maximum error of a blend shape's weight.
const WEIGHT_TOLERANCE: f64 = 1e-4;

/// Writes all stacks.
pub fn write(
    scene: &Scene,
    nodes: &Nodes,
    morphs: &[Morph],
    glb: &mut Glb,
    warnings: &mut Warnings,
) -> Result<(), String> {
    let tolerances = Tolerances::new(scene);
    let mut limits = Limits::default();
    for stack in &scene.anim_stacks {
        let curves = Curves::new(stack);
        // Mixamo's files, for one, have an empty take besides the clip.
        if !curves.have_keys() {
            continue;
        }
        let name = &*stack.element.name;
        let Some(range) = curves.range(stack) else {
            warnings.add(format!("Clip \"{name}\" left out: it is longer than a day."));
            continue;
        };
        curves.warn_of_length(stack, range, warnings);
        let mut clip =
            Clip { scene, anim: &stack.anim, curves, range, limits: &mut limits, glb, animation: Animation::default() };
        clip.add_nodes(nodes, &tolerances)?;
        clip.add_morphs(morphs)?;
        clip.warn(warnings, name);
        clip.animation.write(name, clip.glb);
    }
    if limits.are_reached() {
        warnings.add("The animation has too many keys to follow each one exactly: it was simplified.".to_owned());
    }
    Ok(())
}

/// A clip under construction.
struct Clip<'a, 'b> {
    scene: &'a Scene,
    anim: &'a Anim,
    curves: Curves<'a>,
    /// Start and end in the file's time.
    range: [f64; 2],
    limits: &'b mut Limits,
    glb: &'b mut Glb,
    animation: Animation,
}

/// A property of a node: name in glTF, ufbx's flag for that part of a transform, number of components.
const PARTS: [(&str, u32, usize); 3] = [("translation", 0x10, 3), ("rotation", 0x20, 4), ("scale", 0x40, 3)];
/// `UFBX_TRANSFORM_FLAG_EXPLICIT_INCLUDES`: only what the other flags name is evaluated. The bindings don't convert their
/// constants to the type that the function takes.
const EXPLICIT_INCLUDES: u32 = 0x4;

impl<'a> Clip<'a, '_> {
    fn add_nodes(&mut self, nodes: &Nodes, tolerances: &Tolerances) -> Result<(), String> {
        let scene = self.scene;
        let drivers: Vec<[Drivers; 3]> = scene.nodes.into_iter().map(|node| self.drivers(node)).collect();
        let animated: Vec<bool> = drivers.iter().map(|parts| parts.iter().any(Drivers::vary)).collect();
        let tolerances = tolerances.of_nodes(&animated);
        for ((node, drivers), tolerance) in scene.nodes.into_iter().zip(&drivers).zip(&tolerances) {
            let Some(index) = nodes.index(node) else { continue };
            for (part, drivers) in drivers.iter().enumerate().filter(|(_, drivers)| drivers.is_animated()) {
                self.add_part(node, index, part, drivers, tolerance)?;
            }
        }
        Ok(())
    }

    /// Returns what animates translation, rotation and scale of a node.
    fn drivers(&self, node: &'a Node) -> [Drivers<'a>; 3] {
        let id = node.element.element_id;
        let mut scale: Vec<_> = self.curves.of(id, &SCALE_PROPERTIES).collect();
        let rotation: Vec<_> = self.curves.of(id, &ROTATION_PROPERTIES).collect();
        let mut translation: Vec<_> = self.curves.of(id, &TRANSLATION_PROPERTIES).collect();
        if has_pivot(node) || self.curves.of(id, &PIVOT_PROPERTIES).next().is_some() {
            translation.extend(rotation.iter().chain(&scale));
        }
        // A scale that isn't inherited sits in a helper node beside the children, and moves them.
        if let Some(parent) = node.parent.as_deref() {
            let mut helpers = Vec::new();
            let mut ancestor = parent.inherit_scale_node.as_deref();
            while let Some(helper) = ancestor.and_then(|ancestor| ancestor.scale_helper.as_deref()) {
                helpers.extend(self.curves.of(helper.element.element_id, &SCALE_PROPERTIES));
                ancestor = ancestor.and_then(|ancestor| ancestor.inherit_scale_node.as_deref());
            }
            if let Some(helper) = parent.scale_helper.as_deref().filter(|_| !node.is_scale_helper) {
                translation.extend(self.curves.of(helper.element.element_id, &SCALE_PROPERTIES));
                translation.extend(&helpers);
            } else if node.is_scale_helper {
                scale.extend(&helpers);
            }
        }
        [translation, rotation, scale].map(|mut values| {
            if !values.is_empty() {
                values.extend(&self.curves.layer_weights);
            }
            Drivers { values }
        })
    }

    fn add_part(
        &mut self,
        node: &Node,
        index: usize,
        part: usize,
        drivers: &Drivers,
        tolerance: &Tolerance,
    ) -> Result<(), String> {
        let corners = drivers.corners(self.range, self.limits)?;
        let Some(&(path, flags, width)) = PARTS.get(part) else { return Ok(()) };
        let (anim, start, rest) = (self.anim, self.range[0], finite(node.local_transform));
        let mut sample = |time: f64, out: &mut [f64]| {
            let transform = finite(inherit::transform(anim, node, start + time, EXPLICIT_INCLUDES | flags));
            copy_part(&transform, part, out);
        };
        let mut track = Track {
            sample: &mut sample,
            width,
            space: if part == 1 { Space::Rotation } else { Space::Linear },
            tolerance: [tolerance.translation, tolerance.rotation, tolerance.scale][part],
            budget: &mut self.limits.evaluations,
        };
        let allowed = track.tolerance;
        let keys = fit(&mut track, &corners);
        let mut resting = vec![0.0; width];
        copy_part(&rest, part, &mut resting);
        // Exporters write all channels of all joints. Those that never leave the rest would only hide which ones matter;
        // a rotation stays, as a sign that the clip holds the joint.
        let rests = part != 1 && keys.values.chunks_exact(width).all(|value| near(value, &resting, allowed));
        if rests && keys.interpolation != fit::Interpolation::CubicSpline {
            return Ok(());
        }
        self.push(&keys, index, path)
    }

    fn add_morphs(&mut self, morphs: &[Morph]) -> Result<(), String> {
        for morph in morphs {
            let channels: Vec<_> =
                morph.mesh.blend_deformers.into_iter().flat_map(|deformer| &deformer.channels).collect();
            let values =
                channels.iter().flat_map(|channel| self.curves.of(channel.element.element_id, &["DeformPercent"]));
            let mut drivers = Drivers { values: values.collect() };
            if !drivers.is_animated() {
                continue;
            }
            drivers.values.extend(&self.curves.layer_weights);
            let corners = drivers.corners(self.range, self.limits)?;
            let (anim, start) = (self.anim, self.range[0]);
            let mut sample = |time: f64, out: &mut [f64]| {
                let mut rest = out;
                for channel in &channels {
                    let weight = ufbx::evaluate_blend_weight(anim, channel, start + time);
                    let (own, others) = rest.split_at_mut(channel.keyframes.count);
                    let weight = Some(weight).filter(|weight| weight.is_finite()).unwrap_or_default();
                    shape_weights(channel, weight, own);
                    rest = others;
                }
            };
            let width = channels.iter().map(|channel| channel.keyframes.count).sum();
            let mut track = Track {
                sample: &mut sample,
                width,
                space: Space::Linear,
                tolerance: WEIGHT_TOLERANCE,
                budget: &mut self.limits.evaluations,
            };
            let keys = fit(&mut track, &corners);
            self.push(&keys, morph.node, "weights")?;
        }
        Ok(())
    }

    fn push(&mut self, keys: &Keys, node: usize, path: &'static str) -> Result<(), String> {
        let interpolation = match keys.interpolation {
            fit::Interpolation::Linear => "LINEAR",
            fit::Interpolation::Step => "STEP",
            fit::Interpolation::CubicSpline => "CUBICSPLINE",
        };
        self.animation.add(self.glb, (node, path), interpolation, &keys.times, &keys.values)
    }

    /// Warns about animated properties that have no equivalent in glTF.
    fn warn(&self, warnings: &mut Warnings, clip: &str) {
        let mut others: Vec<&str> = Vec::new();
        for &(element, name, value) in &self.curves.properties {
            let carried = TRANSLATION_PROPERTIES.contains(&name)
                || ROTATION_PROPERTIES.contains(&name)
                || SCALE_PROPERTIES.contains(&name)
                || ["DeformPercent", "Weight"].contains(&name);
            let known = self.scene.elements.as_ref().get(element as usize).is_some_and(|element| {
                use ufbx::ElementType::{Camera, Light, Material, Node, Texture};
                matches!(element.type_, Camera | Light | Material | Node | Texture)
            });
            let changes = Drivers { values: vec![value] }.vary();
            if known && !carried && changes && !others.contains(&name) {
                others.push(name);
            }
        }
        if !others.is_empty() {
            others.sort_unstable();
            warnings.add(format!("Clip \"{clip}\": animated {} left out.", others.join(", ")));
        }
    }
}

fn copy_part(transform: &ufbx::Transform, part: usize, out: &mut [f64]) {
    let (t, r, s) = (transform.translation, transform.rotation, transform.scale);
    match part {
        0 => out.copy_from_slice(&[t.x, t.y, t.z]),
        1 => out.copy_from_slice(&[r.x, r.y, r.z, r.w]),
        _ => out.copy_from_slice(&[s.x, s.y, s.z]),
    }
}

fn near(value: &[f32], other: &[f64], tolerance: f64) -> bool {
    value.iter().zip(other).all(|(a, b)| (f64::from(*a) - b).abs() <= tolerance)
}

fn has_pivot(node: &Node) -> bool {
    PIVOT_PROPERTIES.iter().any(|name| {
        ufbx::find_prop(&node.element.props, name).is_some_and(|prop| {
            let pivot = prop.value_vec4;
            (pivot.x, pivot.y, pivot.z) != (0.0, 0.0, 0.0)
        })
    })
}

/// Divides a channel's weight among its shapes: between the two whose target weights enclose it, starting from 0.
///
/// The same rule as ufbx's for a scene at rest.
fn shape_weights(channel: &ufbx::BlendChannel, weight: f64, out: &mut [f64]) {
    out.fill(0.0);
    let keys = channel.keyframes.as_ref();
    let negative = keys.iter().rposition(|key| key.target_weight < 0.0).map_or(0, |last| last + 1);
    // Beyond 0 on the side without shapes, the nearest shape of the other side is extrapolated.
    let mut previous =
        if weight > 0.0 { negative.checked_sub(1) } else { Some(negative).filter(|&first| first < keys.len()) };
    let mut next = None;
    let mut visit = |index: usize| {
        (previous, next) = (next, Some(index));
        let target = keys[index].target_weight;
        if weight > 0.0 { target > weight } else { target < weight }
    };
    if weight > 0.0 {
        let _ = (negative..keys.len()).any(&mut visit);
    } else {
        let _ = (0..negative).rev().any(&mut visit);
    }
    let target = |index: Option<usize>| index.map_or(0.0, |index| keys[index].target_weight);
    let distance = target(next) - target(previous);
    if distance != 0.0 {
        let t = (weight - target(previous)) / distance;
        if let Some(index) = previous {
            out[index] = 1.0 - t;
        }
        if let Some(index) = next {
            out[index] = t;
        }
    }
}
