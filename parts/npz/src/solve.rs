//! Solves rotations from joint positions: MDM, MoMask, T2M-GPT and HumanML3D write nothing else.
//!
//! Bones keep their lengths, the medians of the file's; they point where the file has them. What the positions leave open is how
//! bones are twisted:
//!
//! - A joint with several children, such as the pelvis, turns as they do (Müller et al. 2016, “A Robust Method to Extract the
//!   Rotational Part of Deformations”).
//! - A thigh or an upper arm is twisted so that the knee or elbow bends like a hinge, the more so the more it is bent. While it is
//!   straight, the twist is interpolated between the moments before and after, or fades to none.
//! - Other bones are swung from where their parents leave them, by the shortest arc. Right above a joint whose rotation is known, such
//!   as in the forearm of a hand with fingers, they take half of its twist.

use glam::{DQuat, DVec2, DVec3};

use crate::layout::{Grid, MAX_LOOKS};
use crate::skeleton::Skeleton;

/// Maximum number of frames in which bones are measured.
pub const MAX_FRAMES: usize = 4096;
/// How often the bones at joints with several children are aligned to find their directions at rest.
const PASSES: usize = 4;
/// Maximum number of steps in which a rotation converges.
const STEPS: usize = 30;
/// Weight of no twist. A bend weighs the square of its sine.
const UNTWISTED: f64 = 0.02;
/// The time over which twists are smoothed.
const SMOOTH_SECS: f64 = 0.05;

/// The motion of a body.
pub struct Solved {
    /// Relative to the parent: joints × frames.
    pub rotations: Vec<DQuat>,
    /// How far joints are from the file's positions, in metres.
    pub error: Error,
}

/// Distances in metres.
#[derive(Clone, Copy, Default)]
pub struct Error {
    sum: f64,
    count: f64,
    max: f64,
}

impl Error {
    pub fn add(&mut self, distance: f64) {
        self.sum += distance;
        self.count += 1.0;
        self.max = self.max.max(distance);
    }

    pub fn join(&mut self, other: Error) {
        self.sum += other.sum;
        self.count += other.count;
        self.max = self.max.max(other.max);
    }

    pub fn mean(&self) -> f64 {
        self.sum / self.count.max(1.0)
    }

    /// `0.1 mm on average, 2.3 mm at most`
    pub fn text(&self) -> String {
        // The standard library's rounding to decimals takes kilobytes.
        let [mean, max] = [self.mean(), self.max].map(|metres| (10_000.0 * metres).round() as u64);
        format!("{}.{} mm on average, {}.{} mm at most", mean / 10, mean % 10, max / 10, max % 10)
    }
}

/// Returns where a joint is.
pub fn position(grid: &Grid, sample: usize, frame: usize, joint: usize) -> DVec3 {
    grid.at(sample, frame, joint).into()
}

fn bone(grid: &Grid, skeleton: &Skeleton, (sample, frame, joint): (usize, usize, usize)) -> DVec3 {
    position(grid, sample, frame, joint) - position(grid, sample, frame, skeleton.joints[joint].parent)
}

/// Returns how much positions differ from those of a body: the relative changes of the lengths of bones, and the relative
/// differences of left and right ones.
pub fn deviation(grid: &Grid, skeleton: &Skeleton) -> f64 {
    let count = skeleton.joints.len();
    let mut sums = vec![[0.0; 3]; count];
    for place in grid.places(MAX_LOOKS) {
        let length = bone(grid, skeleton, place).length();
        let sum = &mut sums[place.2];
        *sum = [sum[0] + 1.0, sum[1] + length, sum[2] + length * length];
    }
    let mean = |joint: usize| sums[joint][1] / sums[joint][0];
    let mut deviation = 0.0;
    for (joint, [count, _, squares]) in sums.iter().enumerate().skip(1) {
        let variance = squares / count - mean(joint) * mean(joint);
        let name = &skeleton.joints[joint].name;
        let other = name.replace("left", "right").replace("Left", "Right");
        let other = skeleton.joints.iter().position(|joint| joint.name == other).unwrap_or(joint);
        let [left, right] = [joint, other].map(mean);
        let change = if mean(joint) > 0.0 { variance.max(0.0).sqrt() / mean(joint) } else { 1.0 };
        deviation += change.min(1.0) + if left + right > 0.0 { (left - right).abs() / (left + right) } else { 0.0 };
    }
    deviation / (count - 1) as f64
}

/// Finds the lengths of bones, and their directions relative to each other at joints with several children.
pub fn measure(grid: &Grid, skeleton: &mut Skeleton) {
    let moments: Vec<(usize, usize)> = grid.moments(MAX_FRAMES).collect();
    for joint in 1..skeleton.joints.len() {
        let mut lengths: Vec<f64> =
            moments.iter().map(|&(sample, frame)| bone(grid, skeleton, (sample, frame, joint)).length()).collect();
        let middle = lengths.len() / 2;
        let length = *lengths.select_nth_unstable_by(middle, f64::total_cmp).1;
        skeleton.joints[joint].offset = length * skeleton.joints[joint].offset.normalize_or_zero();
    }
    for parent in 0..skeleton.joints.len() {
        let children = skeleton.children(parent);
        if children.len() < 2 {
            continue;
        }
        for _ in 0..PASSES {
            let mut sums = vec![DVec3::ZERO; children.len()];
            for &(sample, frame) in &moments {
                let pairs = pairs(grid, skeleton, &children, sample, frame);
                let Some(rotation) = aligned(&pairs) else { continue };
                for (sum, (_, now)) in sums.iter_mut().zip(&pairs) {
                    *sum += rotation.inverse() * *now;
                }
            }
            for (&child, sum) in children.iter().zip(sums) {
                let offset = &mut skeleton.joints[child].offset;
                if let Some(direction) = sum.try_normalize() {
                    *offset = offset.length() * direction;
                }
            }
        }
    }
    skeleton.stand();
}

/// Returns the bones to the children, at rest and in a frame.
fn pairs(grid: &Grid, skeleton: &Skeleton, children: &[usize], sample: usize, frame: usize) -> Vec<(DVec3, DVec3)> {
    children
        .iter()
        .map(|&child| (skeleton.joints[child].offset, bone(grid, skeleton, (sample, frame, child))))
        .collect()
}

/// Returns the rotation that best turns the first vector of each pair into the second. `None` if they don't determine one.
fn aligned(pairs: &[(DVec3, DVec3)]) -> Option<DQuat> {
    // The plane that the first and the last child span gives a first estimate.
    let frame = |first: DVec3, last: DVec3| {
        let x = first.try_normalize()?;
        let z = x.cross(last.try_normalize()?);
        let z = z.try_normalize().filter(|_| z.length() > 0.05)?;
        Some(DQuat::from_mat3(&glam::DMat3::from_cols(x, z.cross(x), z)))
    };
    let [(first_rest, first_now), (last_rest, last_now)] = [*pairs.first()?, *pairs.last()?];
    let mut rotation = frame(first_now, last_now)? * frame(first_rest, last_rest)?.inverse();
    for _ in 0..STEPS {
        let (mut torque, mut weight) = (DVec3::ZERO, 0.0);
        for &(rest, now) in pairs {
            let turned = rotation * rest;
            torque += turned.cross(now);
            weight += turned.dot(now);
        }
        let step = torque / (weight.abs() + 1e-12);
        rotation = (DQuat::from_scaled_axis(step) * rotation).normalize();
        if step.length() < 1e-12 {
            break;
        }
    }
    rotation.is_finite().then_some(rotation)
}

/// Returns the shortest rotation between two directions; none if there is no direction.
fn arc(from: DVec3, to: DVec3) -> DQuat {
    match (from.try_normalize(), to.try_normalize()) {
        (Some(from), Some(to)) => DQuat::from_rotation_arc(from, to),
        _ => DQuat::IDENTITY,
    }
}

/// Solves the rotations of one of the bodies, whose bones were measured.
pub fn solve(grid: &Grid, skeleton: &Skeleton, sample: usize, frames_per_sec: f64) -> Solved {
    let (frames, count) = (grid.frames(), skeleton.joints.len());
    let children: Vec<Vec<usize>> = (0..count).map(|joint| skeleton.children(joint)).collect();
    let mut worlds = vec![DQuat::IDENTITY; count * frames];
    // First what depends on nothing else.
    for joint in (0..count).filter(|&joint| children[joint].len() > 1) {
        let mut last = None;
        for frame in 0..frames {
            let found = aligned(&pairs(grid, skeleton, &children[joint], sample, frame)).or(last);
            worlds[joint * frames + frame] = found.unwrap_or(DQuat::IDENTITY);
            last = found;
        }
    }
    for joint in 0..count {
        let parent = skeleton.joints[joint].parent;
        match *children[joint] {
            [] => worlds.copy_within(parent * frames..(parent + 1) * frames, joint * frames),
            [child] => {
                let is_known = children[child].len() > 1;
                for frame in 0..frames {
                    let mut world = if joint == 0 { DQuat::IDENTITY } else { worlds[parent * frames + frame] };
                    if is_known {
                        world = world.slerp(worlds[child * frames + frame], 0.5);
                    }
                    let now = bone(grid, skeleton, (sample, frame, child));
                    worlds[joint * frames + frame] = arc(world * skeleton.joints[child].offset, now) * world;
                }
                if let Some(&(hinge, axis)) = skeleton.hinges.iter().find(|(hinge, _)| *hinge == child) {
                    let lower = children[hinge].first().copied().unwrap_or(hinge);
                    let worlds = &mut worlds[joint * frames..(joint + 1) * frames];
                    twist(worlds, axis, frames_per_sec, |frame| {
                        [hinge, lower].map(|end| bone(grid, skeleton, (sample, frame, end)).normalize_or_zero())
                    });
                }
            }
            _ => (),
        }
    }
    let error = error(grid, skeleton, sample, &worlds);
    // Children first: each needs its parent's rotation in the world, which is then replaced.
    for joint in (1..count).rev() {
        let parent = skeleton.joints[joint].parent;
        for frame in 0..frames {
            let local = worlds[parent * frames + frame].inverse() * worlds[joint * frames + frame];
            worlds[joint * frames + frame] = local.normalize();
        }
    }
    Solved { rotations: worlds, error }
}

/// Twists a limb's upper bone so that the lower one bends around `axis`. `limb` returns the directions of both in a frame.
///
/// The twists are angles of complex numbers: those that minimize the squared differences to what the bend shows, to no twist and to
/// their neighbours, with weights. Each depends on its neighbours alone, so elimination in both directions solves them.
fn twist(worlds: &mut [DQuat], axis: DVec3, frames_per_sec: f64, limb: impl Fn(usize) -> [DVec3; 2]) {
    let smooth = (SMOOTH_SECS * frames_per_sec).powi(2);
    let frames = worlds.len();
    // Weight and weighted value of each frame.
    let mut rows: Vec<(f64, DVec2)> = Vec::with_capacity(frames);
    for (frame, world) in worlds.iter().enumerate() {
        let [upper, lower] = limb(frame);
        let hinge = (*world * axis).reject_from(upper).normalize_or_zero();
        let bend = upper.cross(lower);
        // Thighs twist by less than a quarter turn, so a bend that shows more is that of an overstretched knee.
        let bend = if axis == DVec3::X && hinge.dot(bend) < 0.0 { -bend } else { bend };
        let value = bend.length() * DVec2::new(hinge.dot(bend), upper.dot(hinge.cross(bend)));
        let is_known = upper != DVec3::ZERO && value.is_finite();
        let (weight, value) = if is_known { (bend.length_squared(), value) } else { (0.0, DVec2::ZERO) };
        rows.push((weight + UNTWISTED, value + DVec2::new(UNTWISTED, 0.0)));
    }
    // Each becomes a multiple of the next one's value plus a constant.
    let mut before = (0.0, DVec2::ZERO);
    for (frame, row) in rows.iter_mut().enumerate() {
        let neighbours = usize::from(frame > 0) + usize::from(frame + 1 < frames);
        let pivot = row.0 + smooth * (neighbours as f64 - before.0);
        *row = (smooth / pivot, (row.1 + smooth * before.1) / pivot);
        before = *row;
    }
    let mut after = DVec2::ZERO;
    for (frame, (factor, value)) in rows.into_iter().enumerate().rev() {
        after = value + factor * after;
        let [upper, _] = limb(frame);
        worlds[frame] = DQuat::from_scaled_axis(upper * after.y.atan2(after.x)) * worlds[frame];
    }
}

/// Compares where the skeleton has its joints with where the file has them.
fn error(grid: &Grid, skeleton: &Skeleton, sample: usize, worlds: &[DQuat]) -> Error {
    let frames = grid.frames();
    let mut error = Error::default();
    let mut placed = Vec::with_capacity(skeleton.joints.len());
    for frame in 0..frames {
        placed.clear();
        placed.push(position(grid, sample, frame, 0));
        for (index, joint) in skeleton.joints.iter().enumerate().skip(1) {
            let at = placed[joint.parent] + worlds[joint.parent * frames + frame] * joint.offset;
            error.add(at.distance(position(grid, sample, frame, index)));
            placed.push(at);
        }
    }
    error
}
