//! Overlays: ground, bones, bounds, the axes of the chosen joint.

use gaitway_character::anim::JointIndex;
use glam::{Affine3A, Vec3, Vec4};

use super::evaluate::Scene;
use super::{Bone, Character, Frame, Grid, Line};
use crate::library::Model;
use crate::state::{SourceOnStage, ViewerState};

const BONE: Vec4 = Vec4::new(0.2, 0.46, 0.95, 1.0);
/// Bones of unmapped joints in the error display.
const UNMAPPED: Vec4 = Vec4::new(0.3, 0.3, 0.32, 1.0);
const MAX_ERROR_DEGREES: f32 = 15.0;
const SOURCE_BONE: Vec4 = Vec4::new(0.5, 0.16, 0.72, 1.0);
const CHOSEN: Vec4 = Vec4::new(1.0, 0.42, 0.05, 1.0);
const BOX: Vec4 = Vec4::new(0.95, 0.75, 0.2, 0.9);
const AXES: [(Vec3, Vec4); 3] = [
    (Vec3::X, Vec4::new(0.9, 0.08, 0.1, 1.0)),
    (Vec3::Y, Vec4::new(0.2, 0.75, 0.1, 1.0)),
    (Vec3::Z, Vec4::new(0.08, 0.3, 0.95, 1.0)),
];

/// Expects the frame's bounds.
pub(super) fn write_ground(model: &Model, state: &ViewerState, frame: &mut Frame) {
    let rest = model.rest_bounds().transformed(&crate::state::world_from_model(state.character.edits.up));
    let rest = if rest.is_empty() { frame.bounds } else { rest };
    // Soles are rarely exactly at zero; a model that almost stands on zero is treated as if it did.
    let height = if rest.min.y.abs() <= 0.04 * rest.diagonal() { 0.0 } else { rest.min.y };
    frame.look.ground_height = height;
    if state.display.show.grid {
        let size = frame.bounds.diagonal().max(1e-6);
        let mut center = frame.bounds.center();
        center.y = height;
        let spacing = 10f32.powf((0.5 * size).log10().floor());
        frame.look.grid = Some(Grid { height, spacing, radius: 4.0 * size, center });
    }
}

/// Whether a character has no visible mesh, neither now nor at rest.
fn shows_no_mesh(scene: &Scene, character: &Character) -> bool {
    !scene.has_meshes && !character.draws.iter().any(|draw| draw.visible)
}

/// Expects the frame's characters and bounds.
pub(super) fn write_overlays(model: &Model, state: &ViewerState, source: Option<&SourceOnStage>, frame: &mut Frame) {
    let Frame { characters, scratch, lines, bones, .. } = frame;
    let Some(character) = characters.first() else { return };
    let world_from_joint = &character.world_from_joint;
    let size = model.rest_bounds().diagonal().max(1e-6);
    let chosen = state.selection.joint.and_then(|joint| model.asset.skeleton.joint_of_source(joint));
    // A character without a mesh is its skeleton, and errors are colours of bones.
    let show = state.display.show;
    let shows_all = show.skeleton || (show.error && source.is_some());
    let (boxes, controls) = (show.boxes, show.controls);
    let visible = shows_all || shows_no_mesh(&scratch.model_scene, character);
    let style = BoneStyle { plain: BONE, chosen, of_source: false, visible, boxes, controls, size };
    write_bones(model, world_from_joint, &scratch.model_scene.joints.in_scene, style, bones);
    if let (Some(source), Some(on_stage)) = (source, characters.last()) {
        if show.error {
            color_by_error(model, source, world_from_joint, &on_stage.world_from_joint, bones);
        }
        let partner = source.borrowed.pairs.iter().find(|pair| Some(pair.target) == chosen).map(|pair| pair.source);
        let size = source.model.rest_bounds().transformed(&source.world_from_source).diagonal().max(1e-6);
        let visible = shows_all || shows_no_mesh(&scratch.source_scene, on_stage);
        let style = BoneStyle { plain: SOURCE_BONE, chosen: partner, of_source: true, visible, boxes, controls, size };
        write_bones(source.model, &on_stage.world_from_joint, &scratch.source_scene.joints.in_scene, style, bones);
    }
    if let Some(joint) = chosen.filter(|joint| scratch.model_scene.joints.in_scene[joint.get()]) {
        write_axes(&world_from_joint[joint.get()], 0.06 * size, lines);
    }
    if state.display.show.bounds {
        let bounds = model.pose_bounds(world_from_joint, &character.morph_weights, &scratch.model_scene.joints);
        if !bounds.is_empty() {
            write_box(bounds.corners(), lines);
        }
    }
}

/// Colours the model's bones by their angle to the source's joints.
fn color_by_error(
    model: &Model,
    source: &SourceOnStage,
    world_from_joint: &[Affine3A],
    world_from_source_joint: &[Affine3A],
    bones: &mut [Bone],
) {
    for bone in bones {
        let joint = model.asset.skeleton.joint_of_source(bone.joint as usize);
        let pair = source.borrowed.pairs.iter().find(|pair| Some(pair.target) == joint);
        let error = pair.and_then(|pair| {
            let source = world_from_source_joint.get(pair.source.get())?;
            pair.error_radians(world_from_joint.get(pair.target.get())?, source)
        });
        bone.color = error.map_or(UNMAPPED, |radians| error_color(radians.to_degrees()));
    }
}

/// Maps an error of 0 to green and of [`MAX_ERROR_DEGREES`] or more to red, through yellow.
fn error_color(degrees: f32) -> Vec4 {
    let share = (degrees / MAX_ERROR_DEGREES).clamp(0.0, 1.0);
    let (green, yellow, red) =
        (Vec4::new(0.1, 0.6, 0.2, 1.0), Vec4::new(0.9, 0.75, 0.1, 1.0), Vec4::new(0.9, 0.05, 0.05, 1.0));
    if share < 0.5 { green.lerp(yellow, 2.0 * share) } else { yellow.lerp(red, 2.0 * share - 1.0) }
}

#[derive(Clone, Copy)]
struct BoneStyle {
    plain: Vec4,
    chosen: Option<JointIndex>,
    of_source: bool,
    visible: bool,
    /// Spheres and boxes, which look thicker than bones of the same radius.
    boxes: bool,
    /// Includes bones that move no mesh.
    controls: bool,
    /// Size of the model, metres.
    size: f32,
}

fn write_bones(
    model: &Model,
    world_from_joint: &[Affine3A],
    in_scene: &[bool],
    style: BoneStyle,
    bones: &mut Vec<Bone>,
) {
    let size = style.size;
    let skeleton = &model.asset.skeleton;
    let position = |joint: usize| Vec3::from(world_from_joint[joint].translation);
    for bone in model.rig().bones() {
        if !in_scene[bone.head.get()] || !(bone.deforms || style.controls) {
            continue;
        }
        let head = position(bone.head.get());
        let tail = match bone.tail {
            Some(tail) => position(tail.get()),
            None => {
                // The last joint of a chain gets a stub that continues the last bone.
                let before = skeleton.parent(bone.head).filter(|&parent| model.rig().is_real(parent));
                let along = before.map_or(Vec3::ZERO, |parent| 0.35 * (head - position(parent.get())));
                head + if along.length() > 1e-4 * size { along } else { 0.03 * size * Vec3::Y }
            }
        };
        let length = (tail - head).length();
        if !length.is_finite() || length <= 1e-5 * size {
            continue;
        }
        let color = if style.chosen == Some(bone.head) { CHOSEN } else { style.plain };
        let radius = (0.1 * length).clamp(0.002 * size, if style.boxes { 0.012 } else { 0.02 } * size);
        bones.push(Bone {
            head,
            tail,
            radius,
            color,
            joint: skeleton.source_index(bone.head) as u32,
            of_source: style.of_source,
            visible: style.visible,
        });
    }
}

fn write_axes(world_from_joint: &Affine3A, length: f32, lines: &mut Vec<Line>) {
    let from = Vec3::from(world_from_joint.translation);
    for (axis, color) in AXES {
        let to = from + length * world_from_joint.transform_vector3(axis).normalize_or_zero();
        lines.push(Line { from, to, color, width_pixels: 2.5, on_top: true });
    }
}

fn write_box(corners: [Vec3; 8], lines: &mut Vec<Line>) {
    for from in 0..8usize {
        // The bits of a corner's index are its sides along x, y and z; an edge flips one bit.
        for to in [from | 1, from | 2, from | 4].into_iter().filter(|&to| to != from) {
            lines.push(Line { from: corners[from], to: corners[to], color: BOX, width_pixels: 1.5, on_top: false });
        }
    }
}
