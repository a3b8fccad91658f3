//! Which arrays of a file are the motion: by their names, or by what they hold.

use gaitway_glb::Warnings;
use glam::{DQuat, DVec3};

use crate::archive::{Archive, LONE};
use crate::array::Array;
use crate::layout::{Grid, Wanted, unexpected};
use crate::motion::{Body, Motion};
use crate::rotations::{Form, Rotations};
use crate::skeleton::{PELVIS, SMPL, SOMA, Skeleton};
use crate::solve;

/// AIST++'s units of the path per metre of the body.
pub const SCALING: &str = "smpl_scaling";

/// Names of the rotations of all joints, in order of preference.
const ROTATIONS: [&str; 10] = [
    "poses",
    "pose",
    "smpl_poses",
    "fullpose",
    "local_rot_mats",
    "global_rot_mats",
    "rot6d",
    "thetas",
    "rotations",
    "quaternions",
];
/// Names of the positions of all joints.
const POSITIONS: [&str; 7] =
    ["posed_joints", "keypoints3d", "joints", "joints3d", "positions", "joint_positions", "motion"];
/// Numbers of joints, in the order that messages list them.
const JOINTS: [usize; 6] = [SMPL[0], SMPL[1], SOMA[0], SMPL[2], SMPL[3], SOMA[1]];
/// Numbers that a rotation may have.
const ROTATION_NUMBERS: [usize; 4] = [3, 4, 6, 9];
const WANTED_ROTATIONS: Wanted = Wanted { joints: &JOINTS, numbers: &ROTATION_NUMBERS };
const WANTED_POSITIONS: Wanted = Wanted { joints: &JOINTS, numbers: &[3] };

/// Positions whose bones change or differ by more than this share aren't those of a body.
const MAX_DEVIATION: f64 = 0.25;
/// Maximum deviation of a joint's position relative to its parent in the file, on average, in metres.
const MAX_BONE_ERROR: f64 = 0.005;
/// Minimum mean bend of knees and elbows, in radians, that shows which way they turn.
const MIN_BEND: f64 = 0.05;
/// Minimum sum of the lengths of all bones, in metres.
const MIN_BODY_LENGTH: f64 = 0.1;

/// What a file holds.
pub enum Found {
    Rotations(Motion),
    /// Positions alone.
    Positions(Grid),
}

/// Finds the motion. Adds a warning for each assumption.
pub fn find(archive: &Archive, warnings: &mut Warnings) -> Result<Found, String> {
    if let Some(groups) = named_rotations(archive)? {
        return rotations(archive, groups, warnings);
    }
    for name in POSITIONS {
        if let Some(array) = archive.find(&[name])? {
            let (label, shape) = (array.label.clone(), format!("{:?}", array.shape));
            let Some(grid) = positions(array)? else {
                return Err(unexpected(&label, &WANTED_POSITIONS.expected(), &shape));
            };
            grid.check()?;
            let deviation = body_deviation(&grid);
            if deviation > MAX_DEVIATION {
                let found = format!("bones that change or differ by {} %", (100.0 * deviation) as u32);
                let expected = "positions of a person's joints, in the order of SMPL or SOMA";
                return Err(unexpected(&label, expected, &found));
            }
            return Ok(Found::Positions(grid));
        }
    }
    by_contents(archive, warnings)
}

/// Finds an array of any name by its shape and its numbers.
fn by_contents(archive: &Archive, warnings: &mut Warnings) -> Result<Found, String> {
    enum Content {
        Rotations(Rotations),
        Positions(Grid),
    }
    let fits = |shape: &[usize]| !WANTED_ROTATIONS.layouts(shape).is_empty();
    let found = archive.find_fitting(&fits, &|array| {
        let is_body = |grid: &Grid| grid.check().is_ok() && body_deviation(grid) <= MAX_DEVIATION;
        let could_be_positions = !WANTED_POSITIONS.layouts(&array.shape).is_empty();
        let shape = array.shape.clone();
        let array = if could_be_positions {
            match positions(array)? {
                Some(grid) if is_body(&grid) => return Ok(Some(Content::Positions(grid))),
                Some(grid) => grid.into_array(shape),
                None => return Ok(None),
            }
        } else {
            array
        };
        // An archive may hold any other numbers as well.
        match Rotations::of(array, WANTED_ROTATIONS) {
            Err(_) if !archive.is_npy() => Ok(None),
            rotations => Ok(rotations?.map(Content::Rotations)),
        }
    })?;
    match found {
        Some(Content::Positions(grid)) => Ok(Found::Positions(grid)),
        Some(Content::Rotations(all)) => rotations(archive, vec![all], warnings),
        None if archive.is_npy() => {
            let expected =
                format!("{} or rotations (× {})", WANTED_POSITIONS.expected(), WANTED_ROTATIONS.expected_numbers());
            Err(unexpected(LONE, &expected, &format!("{:?}", archive.lone_shape())))
        }
        None => Err(format!(
            "the .npz file holds no motion of a person that can be read: expected an array \"poses\", or \"root_orient\" and \
             \"pose_body\", or \"posed_joints\", found {}. Save the joints' rotations or positions under one of these names.",
            archive.names()
        )),
    }
}

/// Returns how much positions differ from those of a body.
fn body_deviation(grid: &Grid) -> f64 {
    solve::deviation(grid, &Skeleton::of(grid.joints()))
}

fn positions(array: Array) -> Result<Option<Grid>, String> {
    Grid::of(array, WANTED_POSITIONS, &body_deviation)
}

/// Finds the rotations by name, which some tools divide into several arrays.
fn named_rotations(archive: &Archive) -> Result<Option<Vec<Rotations>>, String> {
    let read = |array: Array, joints: &[usize]| {
        let wanted = Wanted { joints, numbers: &ROTATION_NUMBERS };
        let (label, shape) = (array.label.clone(), format!("{:?}", array.shape));
        Rotations::of(array, wanted)?.ok_or_else(|| unexpected(&label, &wanted.expected(), &shape))
    };
    if let Some(all) = archive.find(&ROTATIONS)? {
        return Ok(Some(vec![read(all, &JOINTS)?]));
    }
    let root = archive.find(&["root_orient", "global_orient"])?;
    let body = archive.find(&["pose_body", "body_pose"])?;
    let (Some(root), Some(body)) = (root, body) else { return Ok(None) };
    let mut groups = vec![read(root, &[1])?, read(body, &SMPL.map(|joints| joints - 1))?];
    for (names, joints) in [(&["pose_hand"][..], 30), (&["left_hand_pose"], 15), (&["right_hand_pose"], 15)] {
        if let Some(hand) = archive.find(names)? {
            groups.push(read(hand, &[joints])?);
        }
    }
    Ok(Some(groups))
}

/// Joins groups of rotations, and finds the skeleton and the path that belong to them.
fn rotations(archive: &Archive, mut groups: Vec<Rotations>, warnings: &mut Warnings) -> Result<Found, String> {
    let (samples, frames) = (groups[0].grid.samples(), groups[0].grid.frames());
    for Rotations { grid, .. } in &groups {
        if (grid.samples(), grid.frames()) != (samples, frames) {
            let found = if grid.samples() == 1 {
                grid.frames().to_string()
            } else {
                format!("{} × {}", grid.samples(), grid.frames())
            };
            let expected =
                if samples == 1 { format!("{frames} frames") } else { format!("{samples} × {frames} frames") };
            return Err(unexpected(&grid.label, &expected, &found));
        }
    }
    let joints: usize = groups.iter().map(|group| group.grid.joints()).sum();
    if !JOINTS.contains(&joints) {
        let expected = "22, 24, 52 or 55 joints (SMPL, SMPL+H, SMPL-X)";
        return Err(unexpected(&groups[0].grid.label, expected, &joints.to_string()));
    }
    let mut skeleton = Skeleton::of(joints);
    let placed = placed(archive, joints, samples, frames)?;
    let is_global = groups[0].grid.label.contains("global_rot_mats");
    let (mut bodies, fit) = fitted(&mut groups, &skeleton, is_global, placed.as_ref(), warnings);
    let has_bones = fit.is_some();
    if let Some(Bones { offsets, .. }) = fit {
        for (joint, offset) in skeleton.joints.iter_mut().zip(offsets).skip(1) {
            joint.offset = offset;
        }
        skeleton.stand();
    } else if SOMA.contains(&joints) {
        let found = if placed.is_some() { "positions that other bones would have".to_owned() } else { archive.names() };
        return Err(format!(
            "{} holds rotations of the {joints} joints of SOMA, but not how long the bones are: expected an array \
             \"posed_joints\" with their positions, found {found}. Save the motion with all arrays that Kimodo writes.",
            groups[0].grid.label
        ));
    }
    add_paths(archive, placed.as_ref().filter(|_| has_bones), &mut bodies, frames)?;
    let source = if has_bones { "bones from the positions in the file" } else { "bones of an average adult" };
    let Rotations { grid, form } = &groups[0];
    let report = format!("{} of {joints} joints in {frames} frames{}; {source}", form.title(), grid.describe());
    Ok(Found::Rotations(Motion::new(skeleton, bodies, frames, report)))
}

/// Returns the rotations relative to the parents.
fn locals(groups: &[Rotations], skeleton: &Skeleton, is_global: bool) -> Vec<Body> {
    let (samples, frames) = (groups[0].grid.samples(), groups[0].grid.frames());
    let body = |sample: usize| {
        let mut rotations = Vec::with_capacity(skeleton.joints.len() * frames);
        for group in groups {
            for joint in 0..group.grid.joints() {
                rotations.extend((0..frames).map(|frame| group.at(sample, frame, joint)));
            }
        }
        if is_global {
            for (index, joint) in skeleton.joints.iter().enumerate().skip(1).rev() {
                for frame in 0..frames {
                    let parent = rotations[joint.parent * frames + frame];
                    rotations[index * frames + frame] = parent.inverse() * rotations[index * frames + frame];
                }
            }
        }
        Body { rotations, path: None }
    };
    (0..samples).map(body).collect()
}

/// Finds the positions that a file has besides rotations, if the numbers of joints agree.
fn placed(archive: &Archive, joints: usize, samples: usize, frames: usize) -> Result<Option<Grid>, String> {
    // HY-Motion has positions of the fingers, too, which follow the other joints.
    let counts: &[usize] = if joints == SMPL[0] { &[22, 52] } else { &[joints] };
    for name in POSITIONS {
        // These positions are optional.
        let Ok(Some(array)) = archive.find(&[name]) else { continue };
        let grid = Grid::of(array, Wanted { joints: counts, numbers: &[3] }, &|_| 0.0)?;
        let fits = |grid: &Grid| grid.samples() == samples && grid.frames() == frames && grid.check().is_ok();
        if let Some(grid) = grid.filter(fits) {
            return Ok(Some(grid));
        }
    }
    Ok(None)
}

/// Returns the rotations relative to the parents, and the bones that fit the positions, if there are any. These bones, or else the way
/// the body bends, show whether the axes of 6D rotations are rows or columns.
fn fitted(
    groups: &mut [Rotations],
    skeleton: &Skeleton,
    is_global: bool,
    placed: Option<&Grid>,
    warnings: &mut Warnings,
) -> (Vec<Body>, Option<Bones>) {
    let fit = |bodies: &[Body]| placed.and_then(|grid| bones(grid, skeleton, bodies));
    let bodies = locals(groups, skeleton, is_global);
    let bones = fit(&bodies);
    if groups.iter().all(|group| group.form != Form::Columns) {
        return (bodies, bones);
    }
    reinterpret(groups, Form::Columns, Form::Rows);
    let others = locals(groups, skeleton, is_global);
    let other_bones = fit(&others);
    let is_rows = match (&bones, &other_bones) {
        (Some(bones), Some(others)) => others.error < bones.error,
        (None, None) => {
            // Read the wrong way, all rotations are inverted, and knees and elbows bend backwards.
            let bend = bend(skeleton, &bodies, groups[0].grid.frames());
            if bend.abs() < MIN_BEND {
                warnings.add(
                    "The file doesn't say whether 6D rotations are rows or columns of matrices, and the body doesn't bend its \
                     knees or elbows, which would show it: rows are assumed."
                        .to_owned(),
                );
            }
            bend < MIN_BEND
        }
        (bones, _) => bones.is_none(),
    };
    if is_rows {
        return (others, other_bones);
    }
    reinterpret(groups, Form::Rows, Form::Columns);
    (bodies, bones)
}

/// Reads the rotations of one form as those of another.
fn reinterpret(groups: &mut [Rotations], form: Form, other: Form) {
    for group in groups.iter_mut().filter(|group| group.form == form) {
        group.form = other;
    }
}

/// Returns how much knees and elbows bend forwards, in radians, on average.
fn bend(skeleton: &Skeleton, bodies: &[Body], frames: usize) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for body in bodies {
        for &(joint, axis) in &skeleton.hinges {
            for frame in (0..frames).step_by(frames.div_ceil(solve::MAX_FRAMES)) {
                sum += body.rotations[joint * frames + frame].to_scaled_axis().dot(axis);
                count += 1;
            }
        }
    }
    sum / f64::from(count)
}

/// Bones that rotations and positions agree on.
struct Bones {
    /// The position of each joint relative to its parent at rest.
    offsets: Vec<DVec3>,
    /// How much the offsets vary on average, in metres.
    error: f64,
}

/// Finds the bones. `None` if rotations and positions don't agree on any.
fn bones(grid: &Grid, skeleton: &Skeleton, bodies: &[Body]) -> Option<Bones> {
    let frames = grid.frames();
    let count = skeleton.joints.len();
    let mut sums = vec![(DVec3::ZERO, 0.0); count];
    let mut looks = 0.0;
    for (sample, frame) in grid.moments(solve::MAX_FRAMES) {
        looks += 1.0;
        let mut worlds: Vec<DQuat> = Vec::with_capacity(count);
        for (index, joint) in skeleton.joints.iter().enumerate() {
            let parent = worlds.get(joint.parent).copied().unwrap_or(DQuat::IDENTITY);
            let [at, from] = [index, joint.parent].map(|joint| solve::position(grid, sample, frame, joint));
            let offset = parent.inverse() * (at - from);
            sums[index] = (sums[index].0 + offset, sums[index].1 + offset.length_squared());
            worlds.push(parent * bodies[sample].rotations[index * frames + frame]);
        }
    }
    let offsets: Vec<DVec3> = sums.iter().map(|(sum, _)| *sum / looks).collect();
    let variance =
        sums.iter().zip(&offsets).map(|((_, squares), mean)| (squares / looks - mean.length_squared()).max(0.0));
    let error = (variance.sum::<f64>() / count as f64).sqrt();
    // Some tools write zeros for positions that they don't have.
    let length: f64 = offsets.iter().map(|bone| bone.length()).sum();
    (error <= MAX_BONE_ERROR && length > MIN_BODY_LENGTH).then_some(Bones { offsets, error })
}

/// Adds the path of the pelvis: the file's own, that of its positions, or where the path of the body puts it.
fn add_paths(archive: &Archive, placed: Option<&Grid>, bodies: &mut [Body], frames: usize) -> Result<(), String> {
    let at_pelvis = path(archive, &["root_positions"], bodies.len(), frames)?;
    let is_pelvis = at_pelvis.is_some();
    let trans = match at_pelvis {
        Some(path) => Some(path),
        None => path(archive, &["trans", "transl", "smpl_trans", "root_translation"], bodies.len(), frames)?,
    };
    let scaling = match archive.find(&[SCALING])? {
        Some(scaling) => match scaling.values[..] {
            [factor] if factor.is_finite() && factor > 0.0 => factor,
            _ => return Err(unexpected(&scaling.label, "a number above 0", &format!("{:?}", scaling.shape))),
        },
        None => 1.0,
    };
    for (sample, body) in bodies.iter_mut().enumerate() {
        let pelvis = |frame: usize| placed.map(|grid| solve::position(grid, sample, frame, 0));
        // In some files the positions follow the path, in others they stay where the pelvis rests.
        let moves = (1..frames).any(|frame| pelvis(frame) != pelvis(0));
        let at = |frame: usize| -> Option<DVec3> {
            let Some(trans) = &trans else { return pelvis(frame) };
            let trans = DVec3::from(trans.at::<3>(sample, frame, 0)) / scaling;
            match pelvis(frame) {
                _ if is_pelvis => Some(trans),
                Some(pelvis) if moves => Some(pelvis),
                Some(pelvis) => Some(trans + pelvis),
                None => Some(trans + PELVIS),
            }
        };
        body.path = (0..frames).map(at).collect();
    }
    Ok(())
}

fn path(archive: &Archive, names: &[&str], samples: usize, frames: usize) -> Result<Option<Grid>, String> {
    let Some(trans) = archive.find(names)? else { return Ok(None) };
    let (label, shape) = (trans.label.clone(), format!("{:?}", trans.shape));
    let expected =
        if samples == 1 { format!("[{frames}, 3] numbers") } else { format!("[{samples}, {frames}, 3] numbers") };
    let fits = |grid: &Grid| if grid.samples() == samples && grid.frames() == frames { 0.0 } else { 1.0 };
    let grid = Grid::of(trans, Wanted { joints: &[1], numbers: &[3] }, &fits)?.filter(|grid| fits(grid) == 0.0);
    let grid = grid.ok_or_else(|| unexpected(&label, &expected, &shape))?;
    grid.check()?;
    Ok(Some(grid))
}
