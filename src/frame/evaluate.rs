//! From what is loaded and set to what is drawn.

use glam::{Affine3A, Vec3};

use super::{Character, Draw, Frame, FrameLight, Look, overlays, view};
use crate::anim::{JointIndex, Pose, SampleCursor, model_from_joint};
use crate::asset::MeshInstance;
use crate::library::{Library, Model, ModelId};
use crate::mesh::{Bounds, palette_entry, write_palette};
use crate::state::{PoseSampler, ViewerState, active_clip, resolved_bounds, world_from_model};

/// What one evaluation leaves for the next, so that nothing is allocated or looked for again.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    sampler: PoseSampler,
    first_pose: Pose,
    first_cursor: SampleCursor,
    pub world_from_first: Vec<Affine3A>,
    /// The model and scene that `in_scene` is for.
    scene_of: Option<(ModelId, Option<usize>)>,
    pub in_scene: Vec<bool>,
}

/// Fills `frame` for a picture of the given aspect ratio (width over height).
pub fn evaluate(library: &Library, state: &ViewerState, aspect: f32, frame: &mut Frame) {
    let aspect = if aspect.is_finite() { aspect.clamp(1e-3, 1e3) } else { 1.0 };
    frame.lines.clear();
    frame.bones.clear();
    frame.lights.clear();
    frame.look = Look {
        skinning: state.skinning,
        exposure: state.exposure.exp2(),
        environment_radians: state.environment_degrees.to_radians(),
        background: state.background,
        mesh: state.show.mesh,
        wireframe: state.show.wireframe,
        shadow: state.show.shadow,
        grid: None,
        ground_height: 0.0,
    };
    let Some(model) = library.active() else {
        frame.characters.clear();
        frame.bounds = Bounds::EMPTY;
        view::place_camera(library, state, aspect, Vec3::ZERO, frame);
        return;
    };
    frame.characters.truncate(1);
    if frame.characters.is_empty() {
        frame.characters.push(Character::default());
    }
    frame.scratch.choose_scene(model, state.scene);
    let Frame { characters, scratch, .. } = frame;
    let character = &mut characters[0];
    character.model = model.id;
    scratch.sampler.sample(model, state);
    character.morph_weights.clone_from(&scratch.sampler.pose.morph_weights);
    let world_from_model = world_from_model(state.up);
    model_from_joint(
        &model.asset.skeleton,
        &scratch.sampler.pose.locals,
        world_from_model,
        &mut character.world_from_joint,
    );
    write_draws(model, state, &scratch.in_scene, character);

    let travel = travel(model, state, scratch, &character.world_from_joint);
    frame.bounds = moved(resolved_bounds(model, state), travel);
    write_lights(model, frame);
    overlays::write_ground(model, state, frame);
    view::place_camera(library, state, aspect, travel, frame);
    overlays::write_overlays(model, state, frame);
}

impl Scratch {
    fn choose_scene(&mut self, model: &Model, scene: Option<usize>) {
        let key = (model.id, model.scene(scene));
        if self.scene_of != Some(key) || self.in_scene.len() != model.asset.skeleton.len() {
            self.in_scene = model.asset.joints_in_scene(key.1);
            self.scene_of = Some(key);
        }
    }
}

fn write_draws(model: &Model, state: &ViewerState, in_scene: &[bool], character: &mut Character) {
    let asset = &model.asset;
    let chosen = state.joint.and_then(|joint| asset.skeleton.joint_of_source(joint));
    character.palette.clear();
    character.draws.clear();
    for (index, instance) in asset.instances.iter().enumerate() {
        if !in_scene[instance.joint.get()] {
            continue;
        }
        let world_from_node = character.world_from_joint[instance.joint.get()];
        let skin = instance.skin.map(|skin| &asset.skins[skin]);
        let start = character.palette.len() as u32;
        match skin {
            Some(skin) => write_palette(skin, &character.world_from_joint, state.skinning, &mut character.palette),
            None => character.palette.push(palette_entry(&world_from_node, state.skinning)),
        }
        let morphs = asset.skeleton.morph_range(instance.joint);
        character.draws.push(Draw {
            instance: index,
            mesh: instance.mesh,
            palette: start..character.palette.len() as u32,
            morph_weights: morphs.start as u32..morphs.end as u32,
            mirrored: skin.is_none() && world_from_node.matrix3.determinant() < 0.0,
            heat_joint: chosen.filter(|_| state.show.weights).map(|chosen| heat_joint(model, instance, chosen)),
            center: model.instance_center(index, &character.world_from_joint),
        });
    }
}

/// Where the chosen joint is in the palette of an instance. A mesh without skin follows its node alone.
fn heat_joint(model: &Model, instance: &MeshInstance, chosen: JointIndex) -> u32 {
    let position = match instance.skin {
        Some(skin) => model.asset.skins[skin].joints().iter().position(|&joint| joint == chosen),
        None => (instance.joint == chosen).then_some(0),
    };
    position.map_or(u32::MAX, |position| position as u32)
}

/// How far over the ground the root has gone since the start of the clip; zero when the camera does not follow.
fn travel(model: &Model, state: &ViewerState, scratch: &mut Scratch, world_from_joint: &[Affine3A]) -> Vec3 {
    let clip = active_clip(model, state).filter(|_| state.follow);
    let Some((clip, root)) = clip.and_then(|clip| Some((clip, model.root_of_clip(clip)?))) else { return Vec3::ZERO };
    let skeleton = &model.asset.skeleton;
    scratch.first_pose.copy_from(skeleton.rest());
    if let Some(clip) = model.clip(clip) {
        clip.sample(skeleton, 0.0, &mut scratch.first_cursor, &mut scratch.first_pose);
    }
    let world_from_model = world_from_model(state.up);
    model_from_joint(skeleton, &scratch.first_pose.locals, world_from_model, &mut scratch.world_from_first);
    let at = |world: &[Affine3A]| Vec3::from(world[root.get()].translation);
    let travel = (at(world_from_joint) - at(&scratch.world_from_first)) * Vec3::new(1.0, 0.0, 1.0);
    if travel.is_finite() { travel } else { Vec3::ZERO }
}

fn moved(bounds: Bounds, by: Vec3) -> Bounds {
    if bounds.is_empty() { bounds } else { Bounds { min: bounds.min + by, max: bounds.max + by } }
}

fn write_lights(model: &Model, frame: &mut Frame) {
    let world_from_joint = &frame.characters[0].world_from_joint;
    for light in &model.asset.lights {
        if !frame.scratch.in_scene[light.joint.get()] {
            continue;
        }
        let world_from_light = &world_from_joint[light.joint.get()];
        frame.lights.push(FrameLight {
            kind: light.kind,
            color: light.color * light.intensity,
            position: world_from_light.translation.into(),
            direction: (-world_from_light.matrix3.z_axis).normalize_or(-glam::Vec3A::Z).into(),
            range: light.range.unwrap_or(0.0),
        });
    }
}
