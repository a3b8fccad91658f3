//! Writes a skeleton and a clip as BVH, in metres and Y up.
//!
//! BVH has no rest rotations, so a joint's OFFSET is its position in the reference pose relative to its parent in the axes of the
//! model, and its rotation is relative to that pose in the same axes. That works for any skeleton, whatever its rest rotations and
//! scales. Joints that move relative to their parents have position channels as well.

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;

use gaitway_character::anim::{Clip, JointIndex, Pose, SampleCursor, Skeleton, model_from_joint};
use glam::{Affine3A, DQuat, DVec3, EulerRot};

use crate::WriteError;
use crate::gltf::check_frames;

/// A position that strays less from the OFFSET, relative to the size of the skeleton, is not written.
const POSITION_TOLERANCE: f64 = 1e-5;
/// Keys farther apart aren't frames: other programs interpolate Euler angles, which strays from the shortest arc.
const MAX_FRAME_SECS: f64 = 0.1;
/// By how much key times may deviate from frames, relative to the duration of a frame.
const FRAME_TOLERANCE: f64 = 0.02;
const POSITIONS: &str = "Xposition Yposition Zposition ";

/// A joint of the file. Parents come first.
struct Bone {
    name: String,
    /// `None` for a root at the origin that is added above several others.
    joint: Option<JointIndex>,
    parent: Option<usize>,
    offset: DVec3,
    /// Rotation in the reference pose.
    reference: DQuat,
    has_positions: bool,
    /// Position relative to the parent and angles about Z, X and Y in the current frame.
    at: DVec3,
    angles: [f64; 3],
}

/// Writes `joints` of `skeleton`, in ascending order, as `clip` moves them away from `reference`. Joints in between that are left
/// out still move those below. `frames_per_sec` applies if the keys of the clip aren't frames themselves.
pub fn write(
    skeleton: &Skeleton,
    reference: &Pose,
    joints: &[JointIndex],
    clip: &Clip,
    frames_per_sec: f64,
) -> Result<Vec<u8>, WriteError> {
    let mut bones = bones(skeleton, reference, joints);
    if bones.is_empty() {
        return Err(WriteError::EmptyClip { clip: clip.name().to_owned() });
    }
    let (count, frame_secs) = frames_of(clip, frames_per_sec);
    check_frames(clip, count, bones.len())?;
    let (mut pose, mut cursor, mut world) = (skeleton.rest().clone(), SampleCursor::default(), Vec::new());
    let mut move_to = |bones: &mut [Bone], frame: usize| {
        let time_secs = (frame as f64 * frame_secs) as f32;
        pose.copy_from(skeleton.rest());
        clip.sample(skeleton, time_secs.min(clip.duration_secs()), &mut cursor, &mut pose);
        model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut world);
        pose_bones(bones, &world);
    };
    // The header says which joints have positions. Frames are sampled twice, since keeping them all would take more memory than the
    // file.
    let size = bones.iter().map(|bone| bone.offset.length()).sum::<f64>();
    for frame in 0..count {
        move_to(&mut bones, frame);
        for bone in &mut bones {
            if !(bone.at.is_finite() && bone.angles.iter().all(|angle| angle.is_finite())) {
                return Err(WriteError::NotFinite { clip: clip.name().to_owned(), joint: bone.name.clone() });
            }
            bone.has_positions |= bone.parent.is_none() || bone.at.distance(bone.offset) > POSITION_TOLERANCE * size;
        }
    }
    bones.iter_mut().for_each(|bone| bone.angles = [0.0; 3]);
    let mut out = hierarchy(&bones);
    // Writing to a string cannot fail.
    let _ = write!(out, "MOTION\nFrames: {count}\nFrame Time: {frame_secs}\n");
    for frame in 0..count {
        move_to(&mut bones, frame);
        add_line(&mut out, &bones);
    }
    Ok(out.into_bytes())
}

/// Returns the number of frames and the time between two of them.
fn frames_of(clip: &Clip, frames_per_sec: f64) -> (usize, f64) {
    let duration_secs = f64::from(clip.duration_secs());
    let densest = clip.timelines().iter().max_by_key(|times| times.len());
    let intervals = densest.map_or(0, |times| times.len() - 1);
    let own_secs = duration_secs / intervals.max(1) as f64;
    let is_frame =
        |(key, &time): (usize, &f32)| (f64::from(time) - key as f64 * own_secs).abs() <= FRAME_TOLERANCE * own_secs;
    if intervals > 0
        && own_secs <= MAX_FRAME_SECS
        && densest.is_some_and(|times| times.iter().enumerate().all(is_frame))
    {
        return (intervals + 1, own_secs);
    }
    let intervals = (duration_secs * frames_per_sec).round().max(1.0);
    let frame_secs = if duration_secs > 0.0 { duration_secs / intervals } else { 1.0 / frames_per_sec };
    (if duration_secs > 0.0 { (intervals as usize).saturating_add(1) } else { 1 }, frame_secs)
}

fn bones(skeleton: &Skeleton, reference: &Pose, joints: &[JointIndex]) -> Vec<Bone> {
    let mut world = Vec::new();
    model_from_joint(skeleton, reference, Affine3A::IDENTITY, &mut world);
    let mut place = vec![None; skeleton.len()];
    let is_written = |joint: JointIndex| joints.binary_search(&joint).is_ok();
    let parent_of = |joint: JointIndex| {
        std::iter::successors(skeleton.parent(joint), |&parent| skeleton.parent(parent)).find(|&up| is_written(up))
    };
    let mut bones: Vec<Bone> = Vec::with_capacity(joints.len() + 1);
    let mut names = BTreeSet::new();
    if joints.iter().filter(|&&joint| parent_of(joint).is_none()).count() > 1 {
        // Most programs read only one ROOT.
        let name = unique("root", &mut names);
        bones.push(Bone::new(name, None, None, DVec3::ZERO, DQuat::IDENTITY));
    }
    let root = bones.first().map(|_| 0);
    for &joint in joints {
        let parent = parent_of(joint).map_or(root, |parent| place[parent.get()]);
        let (at, turn) = position_and_turn(&world[joint.get()]);
        let origin = parent
            .and_then(|parent| bones[parent].joint)
            .map_or(DVec3::ZERO, |parent| position_and_turn(&world[parent.get()]).0);
        place[joint.get()] = Some(bones.len());
        let name = match skeleton.name(joint) {
            "" => format!("joint_{}", skeleton.source_index(joint)),
            name => name.to_owned(),
        };
        bones.push(Bone::new(unique(&name, &mut names), Some(joint), parent, at - origin, turn));
    }
    bones
}

/// Returns a name that is unique and has no white space: programs split at white space and look joints up by name.
fn unique(name: &str, names: &mut BTreeSet<String>) -> String {
    let is_reserved = |letter: char| letter.is_whitespace() || letter.is_control() || "{}".contains(letter);
    let name: String = name.chars().map(|letter| if is_reserved(letter) { '_' } else { letter }).collect();
    let mut candidate = name.clone();
    let mut number = 1;
    while !names.insert(candidate.clone()) {
        number += 1;
        candidate = format!("{name}_{number}");
    }
    candidate
}

/// Returns position and rotation; the identity for a joint that is scaled to 0, which hides it.
fn position_and_turn(world: &Affine3A) -> (DVec3, DQuat) {
    let (_, turn, at) = world.to_scale_rotation_translation();
    (at.as_dvec3(), if turn.is_finite() { turn.as_dquat().normalize() } else { DQuat::IDENTITY })
}

impl Bone {
    fn new(name: String, joint: Option<JointIndex>, parent: Option<usize>, offset: DVec3, reference: DQuat) -> Self {
        Self { name, joint, parent, offset, reference, has_positions: false, at: DVec3::ZERO, angles: [0.0; 3] }
    }
}

fn pose_bones(bones: &mut [Bone], world: &[Affine3A]) {
    let mut placed: Vec<(DVec3, DQuat)> = Vec::with_capacity(bones.len());
    for bone in bones {
        let (at, turn) = match bone.joint {
            Some(joint) => {
                let (at, turn) = position_and_turn(&world[joint.get()]);
                (at, turn * bone.reference.inverse())
            }
            None => (DVec3::ZERO, DQuat::IDENTITY),
        };
        let (origin, parent_turn) = bone.parent.map_or((DVec3::ZERO, DQuat::IDENTITY), |parent| placed[parent]);
        let local = parent_turn.inverse() * turn;
        bone.at = parent_turn.inverse() * (at - origin);
        bone.angles = nearest_angles(local, bone.angles);
        placed.push((at, turn));
    }
}

/// Returns the angles about Z, X and Y that are closest to those of the frame before. Every rotation has two such triples, and
/// each angle any number of full turns.
fn nearest_angles(rotation: DQuat, before: [f64; 3]) -> [f64; 3] {
    let (z, x, y) = rotation.to_euler(EulerRot::ZXY);
    let unwound =
        |angles: [f64; 3]| [0, 1, 2].map(|axis| angles[axis] + TAU * ((before[axis] - angles[axis]) / TAU).round());
    let turn = |angles: &[f64; 3]| (0..3).map(|axis| (angles[axis] - before[axis]).abs()).sum::<f64>();
    let (one, other) = (unwound([z, x, y]), unwound([z + PI, PI - x, y + PI]));
    if turn(&other) < turn(&one) { other } else { one }
}

fn hierarchy(bones: &[Bone]) -> String {
    let mut out = String::from("HIERARCHY\n");
    // Open braces.
    let mut path: Vec<usize> = Vec::new();
    for (index, bone) in bones.iter().enumerate() {
        while path.last().copied() != bone.parent {
            path.pop();
            close(&mut out, path.len());
        }
        let indent = indentation(path.len());
        let keyword = if path.is_empty() { "ROOT" } else { "JOINT" };
        let positions = if bone.has_positions { POSITIONS } else { "" };
        let channels = if bone.has_positions { 6 } else { 3 };
        // Writing to a string cannot fail.
        let _ = write!(out, "{indent}{keyword} {}\n{indent}{{\n{indent}\tOFFSET", bone.name);
        add_numbers(&mut out, bone.offset.to_array());
        let _ = write!(out, "\n{indent}\tCHANNELS {channels} {positions}Zrotation Xrotation Yrotation\n");
        path.push(index);
        // Parents come right before their first child.
        if bones.get(index + 1).is_none_or(|next| next.parent != Some(index)) {
            // Gives the last bone of a limb a length; the skeleton doesn't say which.
            let end = if bone.offset == DVec3::ZERO { DVec3::Y * 0.01 } else { bone.offset * 0.5 };
            let _ = write!(out, "{indent}\tEnd Site\n{indent}\t{{\n{indent}\t\tOFFSET");
            add_numbers(&mut out, end.to_array());
            let _ = write!(out, "\n{indent}\t}}\n");
        }
    }
    while path.pop().is_some() {
        close(&mut out, path.len());
    }
    out
}

/// Adds the line of the current frame.
fn add_line(out: &mut String, bones: &[Bone]) {
    for (index, bone) in bones.iter().enumerate() {
        let start = out.len();
        if bone.has_positions {
            add_numbers(out, bone.at.to_array());
        }
        add_numbers(out, bone.angles.map(f64::to_degrees));
        if index == 0 {
            // Without the space before the first number.
            out.remove(start);
        }
    }
    out.push('\n');
}

fn close(out: &mut String, depth: usize) {
    out.push_str(&indentation(depth));
    out.push_str("}\n");
}

/// Deeper joints aren't indented further, or a file of 100,000 nested ones would have gigabytes of tabs.
fn indentation(depth: usize) -> String {
    const MAX_LEVELS: usize = 64;
    "\t".repeat(depth.min(MAX_LEVELS))
}

/// Adds three numbers, each after a space.
fn add_numbers(out: &mut String, values: [f64; 3]) {
    // Adding 0 makes a rounded −0 a 0.
    let [x, y, z] = values.map(|value| (value * 1e6).round() / 1e6 + 0.0);
    // Writing to a string cannot fail.
    let _ = write!(out, " {x:.6} {y:.6} {z:.6}");
}
