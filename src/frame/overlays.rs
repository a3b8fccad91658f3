//! What is drawn besides the model: ground, bones, boxes, the axes of the chosen joint.

use glam::{Affine3A, Vec3, Vec4};

use super::{Bone, Frame, Grid, Line};
use crate::anim::JointIndex;
use crate::library::Model;
use crate::state::{SourceOnStage, ViewerState};

const BONE: Vec4 = Vec4::new(0.2, 0.46, 0.95, 1.0);
/// Joints that follow nothing.
const NO_ERROR: Vec4 = Vec4::new(0.3, 0.3, 0.32, 1.0);
const MOST_ERROR_DEGREES: f32 = 15.0;
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
    let rest = model.rest_bounds().transformed(&crate::state::world_from_model(state.edits.up));
    let rest = if rest.is_empty() { frame.bounds } else { rest };
    // Soles are rarely exactly at zero; what stands near it stands on it.
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

/// Expects the joints and bounds. Without a mesh to look at the skeleton is drawn by itself.
pub(super) fn write_overlays(model: &Model, state: &ViewerState, source: Option<&SourceOnStage>, frame: &mut Frame) {
    let Frame { characters, scratch, lines, bones, look, .. } = frame;
    let Some(character) = characters.first() else { return };
    let world_from_joint = &character.world_from_joint;
    let size = model.rest_bounds().diagonal().max(1e-6);
    let chosen = state.selection.joint.and_then(|joint| model.asset.skeleton.joint_of_source(joint));
    // Beside its source the model shows its bones too, or there would be nothing to compare.
    look.skeleton |= character.draws.is_empty() || source.is_some();
    let boxes = state.display.show.boxes;
    let bone_look = BoneLook { plain: BONE, chosen, of_source: false, boxes, size };
    write_bones(model, world_from_joint, &scratch.shown.joints, bone_look, bones);
    if let (Some(source), Some(on_stage)) = (source.filter(|_| state.display.show.error), characters.last()) {
        for bone in bones.iter_mut() {
            let joint = model.asset.skeleton.joint_of_source(bone.joint as usize);
            let pair = source.borrowed.pairs.iter().find(|pair| Some(pair.target) == joint);
            let error = pair.and_then(|pair| {
                let source = on_stage.world_from_joint.get(pair.source.get())?;
                pair.error_radians(world_from_joint.get(pair.target.get())?, source)
            });
            bone.color = error.map_or(NO_ERROR, |radians| error_color(radians.to_degrees()));
        }
    }
    if let (Some(source), Some(on_stage)) = (source, characters.last()) {
        let partner = source.borrowed.pairs.iter().find(|pair| Some(pair.target) == chosen).map(|pair| pair.source);
        let size = source.model.rest_bounds().transformed(&source.world_from_source).diagonal().max(1e-6);
        let look = BoneLook { plain: SOURCE_BONE, chosen: partner, of_source: true, boxes, size };
        write_bones(source.model, &on_stage.world_from_joint, &scratch.source.joints, look, bones);
    }
    if let Some(joint) = chosen.filter(|joint| scratch.shown.joints[joint.get()]) {
        write_axes(&world_from_joint[joint.get()], 0.06 * size, lines);
    }
    if state.display.show.bounds {
        let bounds = model.pose_bounds(world_from_joint, &character.morph_weights, &scratch.shown.joints);
        if !bounds.is_empty() {
            write_box(bounds.corners(), lines);
        }
    }
}

/// Green where nothing is apart, through yellow to red at [`MOST_ERROR_DEGREES`] and more.
fn error_color(degrees: f32) -> Vec4 {
    let share = (degrees / MOST_ERROR_DEGREES).clamp(0.0, 1.0);
    let (green, yellow, red) =
        (Vec4::new(0.1, 0.6, 0.2, 1.0), Vec4::new(0.9, 0.75, 0.1, 1.0), Vec4::new(0.9, 0.05, 0.05, 1.0));
    if share < 0.5 { green.lerp(yellow, 2.0 * share) } else { yellow.lerp(red, 2.0 * share - 1.0) }
}

#[derive(Clone, Copy)]
struct BoneLook {
    plain: Vec4,
    chosen: Option<JointIndex>,
    of_source: bool,
    /// As thick everywhere.
    boxes: bool,
    /// Of the whole skeleton, metres.
    size: f32,
}

fn write_bones(model: &Model, world_from_joint: &[Affine3A], in_scene: &[bool], look: BoneLook, bones: &mut Vec<Bone>) {
    let size = look.size;
    let skeleton = &model.asset.skeleton;
    let place = |joint: usize| Vec3::from(world_from_joint[joint].translation);
    for bone in model.rig().bones() {
        if !in_scene[bone.head.get()] {
            continue;
        }
        let head = place(bone.head.get());
        let tail = match bone.tail {
            Some(tail) => place(tail.get()),
            None => {
                // The end of a chain has no length of its own: a stub that goes on the way the last bone went.
                let before = skeleton.parent(bone.head).filter(|&parent| model.rig().is_real(parent));
                let along = before.map_or(Vec3::ZERO, |parent| 0.35 * (head - place(parent.get())));
                head + if along.length() > 1e-4 * size { along } else { 0.03 * size * Vec3::Y }
            }
        };
        let length = (tail - head).length();
        if !length.is_finite() || length <= 1e-5 * size {
            continue;
        }
        let color = if look.chosen == Some(bone.head) { CHOSEN } else { look.plain };
        let radius = if look.boxes { 0.012 * size } else { (0.1 * length).clamp(0.002 * size, 0.02 * size) };
        bones.push(Bone {
            head,
            tail,
            radius,
            color,
            joint: skeleton.source_index(bone.head) as u32,
            of_source: look.of_source,
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
        // Bits of a corner's number are its sides along x, y and z: an edge changes one bit.
        for to in [from | 1, from | 2, from | 4].into_iter().filter(|&to| to != from) {
            lines.push(Line { from: corners[from], to: corners[to], color: BOX, width_pixels: 1.5, on_top: false });
        }
    }
}
