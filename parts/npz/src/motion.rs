//! The motion: rotations of the joints and the path of the pelvis.

use gaitway_glb::{Animation, Glb, Warnings};
use glam::{DQuat, DVec3};

use crate::archive::Archive;
use crate::array::Array;
use crate::body::{JOINT_COUNTS, PELVIS};

/// Assumed where a file states no rate: that of most video, and of tools that fit SMPL bodies to it.
const DEFAULT_FRAMES_PER_SEC: f64 = 30.0;

/// Rotations of some of the joints: frames × joints, each axis times angle.
struct Group {
    name: String,
    frames: usize,
    joints: usize,
    values: Vec<f64>,
}

impl Group {
    fn of(array: Array) -> Result<Group, String> {
        let (frames, joints) = match array.shape[..] {
            [frames, numbers] if numbers % 3 == 0 => (frames, numbers / 3),
            [frames, joints, 3] => (frames, joints),
            _ => {
                let expected = "frames × joints × 3 numbers (axis times angle)";
                return Err(unexpected(&array.name, expected, &format!("{:?}", array.shape)));
            }
        };
        Ok(Group { name: array.name, frames, joints, values: array.values })
    }
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
            check_finite(&group.name, &group.values, 3 * group.joints)?;
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
                warnings.add(format!(
                    "The file has no frame rate (\"mocap_framerate\"): {DEFAULT_FRAMES_PER_SEC} frames per second are assumed."
                ));
                DEFAULT_FRAMES_PER_SEC
            }
        };
        Ok(Motion { groups, frames, trans, frames_per_sec })
    }

    /// One of [`JOINT_COUNTS`].
    pub fn joints(&self) -> usize {
        self.groups.iter().map(|group| group.joints).sum()
    }

    /// Writes the clip. Joints that never turn have no keys.
    pub fn write(&self, glb: &mut Glb) -> Result<(), String> {
        let y_up = if self.is_z_up() { DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2) } else { DQuat::IDENTITY };
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

    /// Returns whether the pelvis's own Y axis is closer to Z than to Y on average.
    fn is_z_up(&self) -> bool {
        let up: DVec3 = (0..self.frames).map(|frame| rotation(&self.groups[0], frame, 0) * DVec3::Y).sum();
        up.z > up.y
    }
}

/// Finds the rotations, which some tools divide into several arrays.
fn groups(archive: &Archive) -> Result<Vec<Group>, String> {
    if let Some(all) = archive.find(&["poses", "pose"])? {
        return Ok(vec![Group::of(all)?]);
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
    let root = Group::of(root)?;
    if root.joints != 1 {
        return Err(unexpected(&root.name, "one joint", &root.joints.to_string()));
    }
    let mut groups = vec![root, Group::of(body)?];
    for names in [&["pose_hand"][..], &["left_hand_pose"], &["right_hand_pose"]] {
        if let Some(hand) = archive.find(names)? {
            groups.push(Group::of(hand)?);
        }
    }
    Ok(groups)
}

fn path(archive: &Archive, frames: usize) -> Result<Option<Vec<DVec3>>, String> {
    let Some(trans) = archive.find(&["trans", "transl"])? else { return Ok(None) };
    if trans.shape != [frames, 3] {
        return Err(unexpected(&trans.name, &format!("[{frames}, 3] numbers"), &format!("{:?}", trans.shape)));
    }
    check_finite(&trans.name, &trans.values, 3)?;
    Ok(Some(trans.values.chunks_exact(3).map(DVec3::from_slice).collect()))
}

fn rotation(group: &Group, frame: usize, joint: usize) -> DQuat {
    let at = 3 * (frame * group.joints + joint);
    DQuat::from_scaled_axis(DVec3::from_slice(&group.values[at..at + 3]))
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
