//! Evaluates the library and the state into a frame.

use std::collections::BTreeSet;

use gaitway_character::anim::{
    JointIndex, LoopMode, PropertyTarget, PropertyValues, model_from_joint, model_from_single_joint,
};
use gaitway_character::asset::{Asset, LightKind, MAX_LIGHTS, MeshInstance, SceneJoints};
use gaitway_character::mesh::{Bounds, Material, SkinningMode, palette_entry, write_palette};
use gaitway_retarget::ClipOverLayers;
use glam::Vec3;

use super::{Character, Draw, Frame, FrameLight, Look, overlays, view};
use crate::library::{Library, LookTarget, Model, ModelId, Moment, Take, TakeSampler};
use crate::state::{
    COMPARED_SKINNING, Comparison, EnvironmentChoice, LightSetup, SourceOnStage, ViewerState, active_clip, active_take,
    active_variant, camera_eye, compared_rests, comparison, moment, panes, resolved_bounds, source_on_stage,
};

/// Buffers and lookups reused between frames.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    pub sampler: TakeSampler,
    /// How far the camera has followed the character.
    pub travel: Vec3,
    /// Of the start of the clip.
    first: TakeSampler,
    /// By pane, while they compare rests. The first pane has the character itself.
    rests: Vec<TakeSampler>,
    source: TakeSampler,
    pub model_scene: Scene,
    pub source_scene: Scene,
}

/// Which joints of a model belong to the chosen scene, and which of them are visible.
#[derive(Debug, Default)]
pub(super) struct Scene {
    /// The model and scene the flags were computed for.
    key: Option<(ModelId, Option<usize>)>,
    pub joints: SceneJoints,
    /// Whether there are meshes, visible at rest.
    pub has_meshes: bool,
}

/// Fills `frame` for a viewport of the given aspect ratio (width over height).
pub fn evaluate(library: &Library, state: &ViewerState, aspect: f32, frame: &mut Frame) {
    let aspect = if aspect.is_finite() { aspect.clamp(1e-3, 1e3) } else { 1.0 };
    frame.lines.clear();
    frame.bones.clear();
    frame.lights.clear();
    let (light, panorama) = match &state.lighting.environment {
        EnvironmentChoice::Setup(setup) => (*setup, None),
        EnvironmentChoice::File(name) => (LightSetup::default(), library.environment(name)),
    };
    frame.panorama = panorama.map(|environment| environment.panorama.clone());
    frame.look = Look {
        exposure: state.display.exposure.exp2(),
        tone_map: state.display.tone_map,
        environment_radians: state.display.environment_degrees.to_radians(),
        light,
        key: state.lighting.key,
        background: state.display.background,
        channel: state.channel(),
        mesh: state.display.show.mesh,
        wireframe: state.display.show.wireframe,
        boxes: state.display.show.boxes,
        smooth: state.display.show.smooth,
        shadow: state.display.show.shadow,
        grid: None,
        ground_height: 0.0,
        time_secs: 0.0,
    };
    frame.comparison = comparison(library, state);
    frame.panes = panes(frame.comparison, aspect);
    // The only shadow map has the first pane's pose.
    frame.look.shadow &= !matches!(frame.comparison, Some(Comparison::Rests(_)));
    let Some(model) = library.active() else {
        frame.characters.clear();
        frame.clip = None;
        frame.scratch.sampler = TakeSampler::default();
        frame.bounds = Bounds::EMPTY;
        view::place_camera(library, state, aspect, Vec3::ZERO, frame);
        return;
    };
    let (take, moment) = (active_take(model, state), moment(model, state));
    frame.clip = active_clip(model, state).map(|clip| clip.id().clone());
    frame.look.time_secs = take.clip_secs(moment.elapsed_secs) as f32;
    frame.scratch.sampler.sample_motion(&take, moment);
    let travel = if state.camera_options.follow { travel(&take, &mut frame.scratch) } else { Vec3::ZERO };
    frame.scratch.travel = travel;
    let needs_eye = take.look_at == LookTarget::Camera || take.has_gaze_at_camera();
    let eye = needs_eye.then(|| camera_eye(library, state, aspect, travel, &frame.scratch.sampler.pose)).flatten();
    frame.scratch.sampler.apply_avatar(&take, moment.elapsed_secs, eye);
    let source = source_on_stage(library, state);
    write_characters(library, &take, moment, eye, state, source.as_ref(), frame);
    frame.bounds = translated(resolved_bounds(library, state), travel);
    write_lights(model, frame);
    overlays::write_ground(model, state, frame);
    view::place_camera(library, state, aspect, travel, frame);
    // They would show the first pane's pose in all panes.
    if !matches!(frame.comparison, Some(Comparison::Rests(_))) {
        overlays::write_overlays(model, state, source.as_ref(), frame);
    }
}

/// The model once per pane, then the source.
fn write_characters(
    library: &Library,
    take: &Take<'_>,
    moment: Moment<'_>,
    eye: Option<Vec3>,
    state: &ViewerState,
    source: Option<&SourceOnStage>,
    frame: &mut Frame,
) {
    let model = take.model;
    let Frame { characters, scratch, look, clip, comparison, panes, .. } = frame;
    let count = (panes[0] * panes[1]) as usize;
    characters.resize_with(count + usize::from(source.is_some()), Character::default);
    let properties = &scratch.sampler.properties;
    scratch.model_scene.update(model, state.character.sources.scene, properties, &state.character.edits.hidden.nodes);
    let skeleton = &model.asset.skeleton;
    let chosen =
        state.selection.joint.and_then(|joint| skeleton.joint_of_source(joint)).filter(|_| state.inspect.weights);
    let rests = if matches!(comparison, Some(Comparison::Rests(_))) { count } else { 0 };
    scratch.rests.resize_with(rests, TakeSampler::default);
    for (pane, character) in characters.iter_mut().take(count).enumerate() {
        character.model = model.id;
        character.pane = comparison.is_some().then_some(pane as u32);
        character.variant = active_variant(model, state);
        character.hidden_materials.clear();
        character.hidden_materials.extend(&state.character.edits.hidden.materials);
        character.skinning = match comparison {
            Some(Comparison::Skinning) => COMPARED_SKINNING[pane],
            _ => state.display.skinning,
        };
        let pose = match (*comparison, &*clip, take.clip) {
            (Some(Comparison::Rests(active_rest)), Some(clip), Some(over)) if pane > 0 => {
                let other = library.clip_from_rest(clip, compared_rests(active_rest)[pane]).unwrap_or(over.clip);
                let from_rest = Take { clip: Some(ClipOverLayers { clip: other, ..over }), ..*take };
                let sampler = &mut scratch.rests[pane];
                sampler.sample(&from_rest, moment, eye);
                &sampler.pose
            }
            _ => &scratch.sampler.pose,
        };
        character.morph_weights.clone_from(&pose.morph_weights);
        model_from_joint(skeleton, pose, take.world_from_model, &mut character.world_from_joint);
        write_materials(&model.asset, properties, &mut character.materials);
        write_draws(model, chosen, &scratch.model_scene.joints, character);
    }
    if let (Some(source), Some(character)) = (source, characters.last_mut()) {
        write_source(source, look.time_secs, scratch, character);
    }
}

/// The source plays its own clip at the same time, always with linear skinning.
fn write_source(source: &SourceOnStage, time_secs: f32, scratch: &mut Scratch, character: &mut Character) {
    // It doesn't start over where the model's clip was made longer.
    let take = Take { loop_mode: LoopMode::Once, ..source.take() };
    scratch.source.sample_motion(&take, Moment { elapsed_secs: f64::from(time_secs), from: None });
    let TakeSampler { pose, properties, .. } = &scratch.source;
    scratch.source_scene.update(source.model, None, properties, &BTreeSet::new());
    character.model = source.model.id;
    character.skinning = SkinningMode::Linear;
    character.pane = None;
    character.variant = None;
    character.hidden_materials.clear();
    character.morph_weights.clone_from(&pose.morph_weights);
    model_from_joint(&source.model.asset.skeleton, pose, take.world_from_model, &mut character.world_from_joint);
    write_materials(&source.model.asset, properties, &mut character.materials);
    write_draws(source.model, None, &scratch.source_scene.joints, character);
}

impl Scene {
    /// `hidden` are nodes by their index in the file.
    fn update(&mut self, model: &Model, scene: Option<usize>, properties: &PropertyValues, hidden: &BTreeSet<usize>) {
        let key = (model.id, model.scene(scene));
        if self.key != Some(key) || self.joints.visible.len() != model.asset.skeleton.len() {
            self.joints = SceneJoints::new(&model.asset, key.1);
            let at_rest = &self.joints.visible_at_rest;
            self.has_meshes = model.asset.instances.iter().any(|instance| at_rest[instance.joint.get()]);
            self.key = Some(key);
        }
        self.joints.hide(hidden.iter().filter_map(|&node| model.asset.skeleton.joint_of_source(node)));
        self.joints.show(&model.asset, properties);
    }
}

/// Fills `out` with the animated materials and their indices, in ascending order. Reuses the materials that it holds.
fn write_materials(asset: &Asset, properties: &PropertyValues, out: &mut Vec<(usize, Material)>) {
    let mut count = 0;
    for (target, value) in properties.iter() {
        let PropertyTarget::Material(index, property) = target else { continue };
        if count == 0 || out[count - 1].0 != index {
            let Some(material) = asset.materials.get(index) else { continue };
            if out.len() == count {
                out.push((index, Material::default()));
            }
            out[count].0 = index;
            out[count].1.copy_values(material);
            count += 1;
        }
        out[count - 1].1.set(property, value);
    }
    out.truncate(count);
}

/// If `chosen` is set, surfaces show that joint's influence.
fn write_draws(model: &Model, chosen: Option<JointIndex>, scene: &SceneJoints, character: &mut Character) {
    let asset = &model.asset;
    character.palette.clear();
    character.draws.clear();
    let mut last_joint = None;
    for (index, instance) in asset.instances.iter().enumerate() {
        if !scene.in_scene[instance.joint.get()] {
            continue;
        }
        let world_from_mesh = character.world_from_joint[instance.joint.get()] * instance.joint_from_mesh;
        let skin = instance.skin.map(|skin| &asset.skins[skin]);
        let start = character.palette.len() as u32;
        match skin {
            Some(skin) => write_palette(skin, &character.world_from_joint, character.skinning, &mut character.palette),
            None => character.palette.push(palette_entry(&world_from_mesh, character.skinning)),
        }
        let morphs = asset.skeleton.morph_range(instance.joint);
        character.draws.push(Draw {
            instance: index,
            mesh: instance.mesh,
            is_copy: last_joint.replace(instance.joint) == Some(instance.joint),
            visible: scene.visible[instance.joint.get()],
            palette: start..character.palette.len() as u32,
            morph_weights: morphs.start as u32..morphs.end as u32,
            mirrored: skin.is_none() && world_from_mesh.matrix3.determinant() < 0.0,
            heat_joint: chosen.map(|chosen| heat_joint(model, instance, chosen)),
            center: model.instance_center(index, &character.world_from_joint),
        });
    }
}

/// Index of the chosen joint in the instance's palette. An unskinned mesh has a single entry, its node.
fn heat_joint(model: &Model, instance: &MeshInstance, chosen: JointIndex) -> u32 {
    let position = match instance.skin {
        Some(skin) => model.asset.skins[skin].joints().iter().position(|&joint| joint == chosen),
        None => (instance.joint == chosen).then_some(0),
    };
    position.map_or(u32::MAX, |position| position as u32)
}

/// Returns the ground-plane travel of the active model's root since the start of its clip, which a following camera adds.
pub fn travelled(library: &Library, state: &ViewerState) -> Vec3 {
    let Some(model) = library.active() else { return Vec3::ZERO };
    let (take, mut scratch) = (active_take(model, state), Scratch::default());
    scratch.sampler.sample_motion(&take, moment(model, state));
    travel(&take, &mut scratch)
}

/// Returns [`travelled`] for the motion in the sampler.
fn travel(take: &Take<'_>, scratch: &mut Scratch) -> Vec3 {
    let Some(root) = take.root else { return Vec3::ZERO };
    scratch.first.sample_motion(&take.whole(), Moment::default());
    let position = |pose| {
        let model_from_root = model_from_single_joint(&take.model.asset.skeleton, pose, root);
        Vec3::from((take.world_from_model * model_from_root).translation)
    };
    let travel = (position(&scratch.sampler.pose) - position(&scratch.first.pose)) * Vec3::new(1.0, 0.0, 1.0);
    if travel.is_finite() { travel } else { Vec3::ZERO }
}

fn translated(bounds: Bounds, by: Vec3) -> Bounds {
    if bounds.is_empty() { bounds } else { Bounds { min: bounds.min + by, max: bounds.max + by } }
}

/// A light that the clip hides stays in the list, black: otherwise the key light would take over.
fn write_lights(model: &Model, frame: &mut Frame) {
    let world_from_joint = &frame.characters[0].world_from_joint;
    let Scratch { model_scene, sampler, .. } = &frame.scratch;
    for light in &model.asset.lights {
        let joint = light.joint.get();
        let visible = model_scene.joints.visible[joint];
        if !visible && !model_scene.joints.visible_at_rest[joint] {
            continue;
        }
        let light = light.animated(&sampler.properties);
        let world_from_light = &world_from_joint[joint];
        frame.lights.push(FrameLight {
            kind: light.kind,
            color: if visible { light.color * light.intensity } else { Vec3::ZERO },
            position: world_from_light.translation.into(),
            direction: (-world_from_light.matrix3.z_axis).normalize_or(-glam::Vec3A::Z).into(),
            range: light.range.unwrap_or(0.0),
        });
    }
    keep_strongest(&mut frame.lights, &frame.bounds);
}

/// Keeps the lights that contribute most, the strongest first.
fn keep_strongest(lights: &mut Vec<FrameLight>, bounds: &Bounds) {
    if lights.len() > MAX_LIGHTS {
        lights.sort_unstable_by(|a, b| contribution(b, bounds).total_cmp(&contribution(a, bounds)));
        lights.truncate(MAX_LIGHTS);
    }
}

/// Estimates a light's irradiance on the nearest part of the bounds.
fn contribution(light: &FrameLight, bounds: &Bounds) -> f32 {
    let strength = light.color.max_element();
    if light.kind == LightKind::Directional || bounds.is_empty() {
        return strength;
    }
    let nearest = light.position.clamp(bounds.min, bounds.max);
    // A light inside the bounds shines on what is around it.
    let distance = nearest.distance(light.position).max(0.1 * bounds.diagonal()).max(1e-3);
    let out_of_range = light.range > 0.0 && nearest.distance(light.position) >= light.range;
    if out_of_range { 0.0 } else { strength / (distance * distance) }
}
