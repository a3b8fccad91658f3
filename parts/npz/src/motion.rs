//! The motion: rotations of the joints and the path of the pelvis.

use gaitway_glb::{Animation, Glb, Warnings};
use glam::{DMat3, DQuat, DVec3};

use crate::archive::Archive;
use crate::array::Array;
use crate::body::{JOINT_COUNTS, PELVIS, bones};

/// Assumed where a file states no rate: that of most video, and of tools that fit SMPL bodies to it.
const DEFAULT_FRAMES_PER_SEC: f64 = 30.0;
/// That of AIST++, whose files state none.
const AIST_FRAMES_PER_SEC: f64 = 60.0;
/// AIST++'s units of the path per metre of the body.
const SCALING: &str = "smpl_scaling";

/// Maximum difference between a rotation matrix times its transpose and the identity. 16-bit floats and the models that predict
/// such matrices aren't exact.
const MATRIX_TOLERANCE: f64 = 0.1;
/// Maximum number of frames in which the body's height is looked up.
const MAX_LOOKS: usize = 64;
/// A body that is deeper in the ground than this, in metres, isn't upright along that axis.
const MAX_DEPTH: f64 = 0.35;
/// Minimum difference between Y and Z of the pelvis's mean direction that shows which axis is up.
const MIN_LEAN: f64 = 0.2;

/// How a rotation is stored; the discriminant is how many numbers that takes.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// Axis times angle.
    AxisAngle = 3,
    /// Rows of a matrix.
    Matrix = 9,
}

/// Rotations of some of the joints: frames × joints.
struct Group {
    name: String,
    frames: usize,
    joints: usize,
    kind: Kind,
    values: Vec<f64>,
}

impl Group {
    /// Finds the layout of an array. `counts` are the numbers of joints that one of its name may have.
    fn of(array: Array, counts: &[usize]) -> Result<Group, String> {
        let found = layouts(&array.shape);
        let is_expected = |layout: &&(usize, usize, Kind)| counts.contains(&layout.1);
        let Some(&(frames, joints, kind)) = found.iter().find(is_expected).or_else(|| found.first()) else {
            let expected = "frames × joints × 3 numbers (axis times angle), or × 3 × 3 (matrices)";
            return Err(unexpected(&array.name, expected, &format!("{:?}", array.shape)));
        };
        let group = Group { name: array.name, frames, joints, kind, values: array.values };
        group.check()?;
        Ok(group)
    }

    fn check(&self) -> Result<(), String> {
        let numbers = self.kind as usize;
        check_finite(&self.name, &self.values, numbers * self.joints)?;
        if self.kind == Kind::AxisAngle {
            return Ok(());
        }
        let bad = self.values.chunks_exact(numbers).position(|rows| {
            let matrix = DMat3::from_cols_slice(rows);
            let product = (matrix * matrix.transpose() - DMat3::IDENTITY).to_cols_array();
            matrix.determinant() <= 0.0 || product.iter().any(|difference| difference.abs() > MATRIX_TOLERANCE)
        });
        match bad {
            Some(at) => {
                let found = format!("another in frame {}", at / self.joints);
                Err(unexpected(&self.name, "matrices that are rotations", &found))
            }
            None => Ok(()),
        }
    }
}

/// Returns what the sides of an array may be: frames, joints, and what a rotation is. One side of 1 may be a batch's.
fn layouts(shape: &[usize]) -> Vec<(usize, usize, Kind)> {
    use Kind::{AxisAngle, Matrix};
    let of_sides = |sides: &[usize]| match *sides {
        [frames, joints, 3, 3] => vec![(frames, joints, Matrix)],
        [frames, 3, 3] => vec![(frames, 3, AxisAngle), (frames, 1, Matrix)],
        [frames, joints, 3] => vec![(frames, joints, AxisAngle)],
        [frames, joints, 9] => vec![(frames, joints, Matrix)],
        [frames, numbers] if numbers % 9 == 0 => vec![(frames, numbers / 3, AxisAngle), (frames, numbers / 9, Matrix)],
        [frames, numbers] if numbers % 3 == 0 => vec![(frames, numbers / 3, AxisAngle)],
        _ => Vec::new(),
    };
    let without_batch =
        (0..shape.len()).filter(|&at| shape[at] == 1).map(|at| [&shape[..at], &shape[at + 1..]].concat());
    let mut found = of_sides(shape);
    found.extend(without_batch.flat_map(|sides| of_sides(&sides)));
    found
}

pub struct Motion {
    /// In order of the body's joints.
    groups: Vec<Group>,
    frames: usize,
    /// Where each frame puts the body, if it moves.
    trans: Option<Vec<DVec3>>,
    frames_per_sec: f64,
}

impl Motion {
    pub fn read(archive: &Archive, warnings: &mut Warnings) -> Result<Motion, String> {
        let groups = groups(archive)?;
        let frames = groups[0].frames;
        if frames == 0 {
            return Err(unexpected(&groups[0].name, "at least one frame", "none"));
        }
        for group in &groups {
            if group.frames != frames {
                return Err(unexpected(&group.name, &format!("{frames} frames"), &group.frames.to_string()));
            }
        }
        let joints: usize = groups.iter().map(|group| group.joints).sum();
        if !JOINT_COUNTS.contains(&joints) {
            let expected = "22, 24, 52 or 55 joints (SMPL, SMPL+H, SMPL-X)";
            return Err(unexpected(&groups[0].name, expected, &joints.to_string()));
        }
        let trans = path(archive, frames)?;
        if trans.is_none() {
            warnings.add("The file has no path (\"trans\"), so the person stays in place.".to_owned());
        }
        let frames_per_sec = match archive.find(&["mocap_framerate", "mocap_frame_rate", "fps"])? {
            Some(rate) => match rate.values[..] {
                [rate] if (1e-3..=1e6).contains(&rate) => rate,
                _ => {
                    return Err(unexpected(&rate.name, "a number of frames per second", &format!("{:?}", rate.values)));
                }
            },
            None => {
                let rate = if archive.has(SCALING) { AIST_FRAMES_PER_SEC } else { DEFAULT_FRAMES_PER_SEC };
                warnings.add(format!(
                    "The file has no frame rate (\"mocap_framerate\"): {rate} frames per second are assumed."
                ));
                rate
            }
        };
        Ok(Motion { groups, frames, trans, frames_per_sec })
    }

    /// One of [`JOINT_COUNTS`].
    pub fn joints(&self) -> usize {
        self.groups.iter().map(|group| group.joints).sum()
    }

    /// Writes the clip. Joints that never turn have no keys.
    pub fn write(&self, glb: &mut Glb, warnings: &mut Warnings) -> Result<(), String> {
        let y_up =
            if self.is_z_up(warnings) { DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2) } else { DQuat::IDENTITY };
        let times: Vec<f32> = (0..self.frames).map(|frame| (frame as f64 / self.frames_per_sec) as f32).collect();
        let mut clip = Animation::default();
        let mut joint = 0;
        for group in &self.groups {
            for place in 0..group.joints {
                let world = if joint == 0 { y_up } else { DQuat::IDENTITY };
                let rotations = (0..self.frames).map(|frame| world * rotation(group, frame, place));
                if joint == 0 || rotations.clone().any(|rotation| rotation != DQuat::IDENTITY) {
                    let values: Vec<f32> = rotations.flat_map(|rotation| rotation.as_quat().to_array()).collect();
                    clip.add(glb, (joint, "rotation"), "LINEAR", &times, &values)?;
                }
                joint += 1;
            }
        }
        if let Some(trans) = &self.trans {
            let pelvis = trans.iter().flat_map(|&trans| (y_up * (trans + PELVIS)).as_vec3().to_array());
            clip.add(glb, (0, "translation"), "LINEAR", &times, &pelvis.collect::<Vec<f32>>())?;
        }
        clip.write("", glb);
        Ok(())
    }

    /// Returns whether Z is up: on average, the pelvis's own Y axis is closer to Z than to Y. A person may lie, however: if the
    /// body would be in the ground then, and wouldn't with the other axis, that one is up.
    fn is_z_up(&self, warnings: &mut Warnings) -> bool {
        let up: DVec3 = (0..self.frames).map(|frame| rotation(&self.groups[0], frame, 0) * DVec3::Y).sum();
        let is_z = up.z > up.y;
        let Some(trans) = &self.trans else { return is_z };
        let lowest = self.lowest(trans);
        let [own, other] = if is_z { [lowest.z, lowest.y] } else { [lowest.y, lowest.z] };
        let is_in_the_ground = own < -MAX_DEPTH;
        let is_other = is_in_the_ground && other.abs() < MAX_DEPTH;
        let is_z = is_z != is_other;
        if is_in_the_ground && !is_other || (up.z - up.y).abs() < MIN_LEAN * self.frames as f64 {
            let axis = if is_z { "Z" } else { "Y" };
            warnings.add(format!(
                "The file doesn't say which axis is up, and the body doesn't show it clearly: {axis} is assumed."
            ));
        }
        is_z
    }

    /// Returns the least coordinates of any joint in some of the frames. The ground is at 0 in nearly all files.
    fn lowest(&self, trans: &[DVec3]) -> DVec3 {
        let mut lowest = DVec3::INFINITY;
        for frame in (0..self.frames).step_by(self.frames.div_ceil(MAX_LOOKS).max(1)) {
            let rotations: Vec<DQuat> = self
                .groups
                .iter()
                .flat_map(|group| (0..group.joints).map(move |place| rotation(group, frame, place)))
                .collect();
            let mut placed: Vec<(DQuat, DVec3)> = Vec::new();
            for (joint, (parent, offset)) in bones().enumerate() {
                let (turn, at) = match placed.get(parent) {
                    Some(&(turn, at)) => (turn, at + turn * offset),
                    None => (DQuat::IDENTITY, trans[frame] + PELVIS),
                };
                lowest = lowest.min(at);
                placed.push((turn * rotations[joint], at));
            }
        }
        lowest
    }
}

/// Finds the rotations, which some tools divide into several arrays.
fn groups(archive: &Archive) -> Result<Vec<Group>, String> {
    if let Some(all) = archive.find(&["poses", "pose", "smpl_poses", "fullpose"])? {
        return Ok(vec![Group::of(all, &JOINT_COUNTS)?]);
    }
    let root = archive.find(&["root_orient", "global_orient"])?;
    let body = archive.find(&["pose_body", "body_pose"])?;
    let (Some(root), Some(body)) = (root, body) else {
        let found = archive.names();
        return Err(format!(
            "the .npz file holds no motion of a person that can be read: expected an array \"poses\", or \"root_orient\" and \
             \"pose_body\", found {found}. Save the joints' rotations under one of these names."
        ));
    };
    let root = Group::of(root, &[1])?;
    if root.joints != 1 {
        return Err(unexpected(&root.name, "one joint", &root.joints.to_string()));
    }
    let bodies = JOINT_COUNTS.map(|joints| joints - 1);
    let mut groups = vec![root, Group::of(body, &bodies)?];
    for (names, joints) in [(&["pose_hand"][..], 30), (&["left_hand_pose"], 15), (&["right_hand_pose"], 15)] {
        if let Some(hand) = archive.find(names)? {
            groups.push(Group::of(hand, &[joints])?);
        }
    }
    Ok(groups)
}

fn path(archive: &Archive, frames: usize) -> Result<Option<Vec<DVec3>>, String> {
    let Some(trans) = archive.find(&["trans", "transl", "smpl_trans"])? else { return Ok(None) };
    let sides: Vec<usize> = trans.shape.iter().copied().filter(|&side| side != 1).collect();
    let expected: Vec<usize> = [frames, 3].into_iter().filter(|&side| side != 1).collect();
    if sides != expected {
        return Err(unexpected(&trans.name, &format!("[{frames}, 3] numbers"), &format!("{:?}", trans.shape)));
    }
    check_finite(&trans.name, &trans.values, 3)?;
    let scaling = match archive.find(&[SCALING])? {
        Some(scaling) => match scaling.values[..] {
            [factor] if factor.is_finite() && factor > 0.0 => factor,
            _ => return Err(unexpected(&scaling.name, "a number above 0", &format!("{:?}", scaling.shape))),
        },
        None => 1.0,
    };
    Ok(Some(trans.values.chunks_exact(3).map(|at| DVec3::from_slice(at) / scaling).collect()))
}

fn rotation(group: &Group, frame: usize, joint: usize) -> DQuat {
    let numbers = group.kind as usize;
    let at = numbers * (frame * group.joints + joint);
    let values = &group.values[at..at + numbers];
    match group.kind {
        Kind::AxisAngle => DQuat::from_scaled_axis(DVec3::from_slice(values)),
        // Rows become columns.
        Kind::Matrix => DQuat::from_mat3(&DMat3::from_cols_slice(values).transpose()).normalize(),
    }
}

fn check_finite(name: &str, values: &[f64], per_frame: usize) -> Result<(), String> {
    match values.iter().position(|&value| !(value as f32).is_finite()) {
        Some(at) => Err(unexpected(name, "finite numbers", &format!("{} in frame {}", values[at], at / per_frame))),
        None => Ok(()),
    }
}

fn unexpected(name: &str, expected: &str, found: &str) -> String {
    format!("array \"{name}\": expected {expected}, found {found}. Save the motion again with the arrays of AMASS.")
}
