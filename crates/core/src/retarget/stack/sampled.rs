//! Bakes poses into a clip: samples them densely enough, then keeps as few keys as hold every joint close to them.

use glam::{DQuat, DVec3};

use crate::anim::{Clip, Interpolation, JointIndex, Pose, PropertyTarget, SampleCursor, Skeleton};
use crate::retarget::change::track::{Target, Track, Tracks};
use crate::retarget::math::{angle_between, slerp};
use crate::retarget::pose::{WorldPose, ancestry, locals_of};

/// How far any joint may turn away, in radians.
const MAX_TURN: f64 = 0.05 * std::f64::consts::PI / 180.0;
/// How far any joint may move away, per metre of height.
const MAX_OFFSET_PER_METRE: f64 = 1e-4;
/// Likewise morph weights, and scales that move no joint.
const MAX_WEIGHT_ERROR: f64 = 1e-3;
/// The samples follow the poses this much more closely than the keys have to.
const SAMPLE_SHARE: f64 = 0.25;
const MAX_HALVINGS: u32 = 8;

/// Poses over time.
pub struct Poses<'a> {
    pub skeleton: &'a Skeleton,
    /// The joints that get new channels, one flag per joint.
    pub included: &'a [bool],
    /// Times to sample at, ascending; more are added where they don't suffice.
    pub times: Vec<f32>,
    /// Those of `times` right after which the pose jumps, ascending. Nothing is sampled before the next time.
    pub jumps: Vec<f32>,
    pub pose_at: &'a mut dyn FnMut(f32, &mut Pose),
}

/// The numbers of one new channel within a row.
struct Column {
    target: Target,
    start: usize,
    width: usize,
    /// The error allowed, if joints don't add up theirs.
    limit: f64,
}

/// All new channels at one time.
struct Row {
    time: f32,
    numbers: Vec<f32>,
}

/// Returns the clip with the channels of the included joints replaced by the poses.
pub fn bake(clip: &Clip, mut poses: Poses<'_>) -> Clip {
    let skeleton = poses.skeleton;
    let height = height(skeleton);
    let columns = columns(skeleton, poses.included, MAX_OFFSET_PER_METRE * height);
    let rows = rows(&mut poses, &columns);
    let mut kept = Tracks::of(clip);
    kept.tracks.retain(|track| !joint_of(track.target).is_some_and(|joint| poses.included[joint.get()]));
    let mut share = 1.0;
    loop {
        let mut tracks = kept.clone();
        tracks.tracks.extend(columns.iter().filter_map(|column| track(skeleton, column, &rows, share * column.limit)));
        if tracks.tracks.is_empty() {
            // All joints rest. A clip is as long as its tracks, so it needs one.
            tracks.tracks.extend(columns.first().map(|column| column.track(&rows, &[0])));
        }
        let baked = tracks.build(clip.name(), skeleton);
        // The errors of a chain of joints add up, though seldom all in one direction.
        if share < 1e-3 || is_close(&baked, &mut poses, &rows, MAX_OFFSET_PER_METRE * height) {
            return baked;
        }
        share *= 0.6;
    }
}

fn joint_of(target: Target) -> Option<JointIndex> {
    match target {
        Target::Translation(joint) | Target::Rotation(joint) | Target::Scale(joint) | Target::Weights(joint) => {
            Some(joint)
        }
        Target::Property(PropertyTarget::MorphWeight(joint, _)) => Some(joint),
        Target::Property(_) => None,
    }
}

fn world(skeleton: &Skeleton, pose: &Pose) -> WorldPose {
    WorldPose::new(skeleton, locals_of(pose), DQuat::IDENTITY)
}

/// The largest extent of the joints at rest, in metres.
fn height(skeleton: &Skeleton) -> f64 {
    let positions = world(skeleton, skeleton.rest()).positions;
    let least = positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let extent = positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max) - least;
    Some(extent.max_element()).filter(|&height| height > 0.0 && height.is_finite()).unwrap_or(1.0)
}

fn columns(skeleton: &Skeleton, included: &[bool], offset: f64) -> Vec<Column> {
    let rest = world(skeleton, skeleton.rest());
    // Distance to the farthest joint below each.
    let mut reach = vec![0.0_f64; skeleton.len()];
    for joint in skeleton.joints() {
        for ancestor in ancestry(skeleton, joint).skip(1) {
            let far = &mut reach[ancestor.get()];
            *far = far.max(rest.position(ancestor).distance(rest.position(joint)));
        }
    }
    let mut columns = Vec::new();
    let mut start = 0;
    let mut push = |target, width, limit| {
        columns.push(Column { target, start, width, limit });
        start += width;
    };
    for joint in skeleton.joints().filter(|joint| included[joint.get()]) {
        let scale = rest.parent_frame(skeleton, joint).matrix3.determinant().abs().cbrt();
        let per_reach = offset / reach[joint.get()];
        push(Target::Translation(joint), 3, if scale > 0.0 { offset / scale } else { offset });
        push(Target::Rotation(joint), 4, MAX_TURN.min(per_reach));
        push(Target::Scale(joint), 3, MAX_WEIGHT_ERROR.min(per_reach));
        let weights = skeleton.morph_range(joint).len();
        if weights > 0 {
            push(Target::Weights(joint), weights, MAX_WEIGHT_ERROR);
        }
    }
    columns
}

fn numbers(skeleton: &Skeleton, columns: &[Column], pose: &Pose) -> Vec<f32> {
    let mut numbers = Vec::with_capacity(columns.last().map_or(0, |last| last.start + last.width));
    for column in columns {
        match column.target {
            Target::Translation(joint) => numbers.extend(pose.local(joint).translation.to_array()),
            Target::Rotation(joint) => numbers.extend(pose.local(joint).rotation.to_array()),
            Target::Scale(joint) => numbers.extend(pose.local(joint).scale.to_array()),
            Target::Weights(joint) => numbers.extend(&pose.morph_weights[skeleton.morph_range(joint)]),
            Target::Property(_) => {}
        }
    }
    numbers
}

/// Samples the poses until linear interpolation follows them closely.
fn rows(poses: &mut Poses<'_>, columns: &[Column]) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::with_capacity(poses.times.len());
    let times = std::mem::take(&mut poses.times);
    let mut pose = poses.skeleton.rest().clone();
    for time in times {
        let end = row(poses, columns, time, &mut pose);
        if let Some(start) = rows.pop() {
            let is_jump = poses.jumps.binary_search_by(|jump| jump.total_cmp(&start.time)).is_ok();
            let halvings = if is_jump { 0 } else { MAX_HALVINGS };
            refine(poses, columns, start, &end, halvings, (&mut rows, &mut pose));
        }
        rows.push(end);
    }
    rows
}

fn row(poses: &mut Poses<'_>, columns: &[Column], time: f32, pose: &mut Pose) -> Row {
    (poses.pose_at)(time, pose);
    Row { time, numbers: numbers(poses.skeleton, columns, pose) }
}

/// Adds `start` and what is needed between it and `end`.
fn refine(
    poses: &mut Poses<'_>,
    columns: &[Column],
    start: Row,
    end: &Row,
    halvings: u32,
    (rows, pose): (&mut Vec<Row>, &mut Pose),
) {
    let length = end.time - start.time;
    let middle_secs = start.time + 0.5 * length;
    if halvings > 0 && middle_secs > start.time && middle_secs < end.time {
        let probes = [0.25, 0.5, 0.75].map(|part| row(poses, columns, start.time + part * length, pose));
        let is_close = |probe: &Row| {
            let fits = |column: &Column| column.error(&start, end, probe) <= SAMPLE_SHARE * column.limit;
            columns.iter().all(fits)
        };
        if !probes.iter().all(is_close) {
            let [_, middle, _] = probes;
            refine(poses, columns, start, &middle, halvings - 1, (rows, pose));
            refine(poses, columns, middle, end, halvings - 1, (rows, pose));
            return;
        }
    }
    rows.push(start);
}

impl Column {
    fn of<'a>(&self, row: &'a Row) -> &'a [f32] {
        &row.numbers[self.start..self.start + self.width]
    }

    /// Returns the channel with the values of these rows.
    fn track(&self, rows: &[Row], keys: &[usize]) -> Track {
        Track {
            target: self.target,
            interpolation: Interpolation::Linear,
            times: keys.iter().map(|&key| rows[key].time).collect(),
            width: self.width,
            values: keys.iter().flat_map(|&key| self.of(&rows[key])).copied().collect(),
        }
    }

    /// How far the value at a time is from the one between two others, in radians for rotations.
    fn error(&self, from: &Row, to: &Row, at: &Row) -> f64 {
        let factor = f64::from(at.time - from.time) / f64::from(to.time - from.time);
        let [from, to, value] = [from, to, at].map(|row| self.of(row));
        let quat = |numbers: &[f32]| DQuat::from_array(std::array::from_fn(|part| f64::from(numbers[part])));
        if let Target::Rotation(_) = self.target {
            return angle_between(slerp(quat(from), quat(to), factor), quat(value));
        }
        let parts = from.iter().zip(to).zip(value).map(|((&from, &to), &value)| {
            let (from, to) = (f64::from(from), f64::from(to));
            from + (to - from) * factor - f64::from(value)
        });
        parts.map(|part| part * part).sum::<f64>().sqrt()
    }
}

/// Returns the channel with as few keys as stay within the limit, each as far from the one before as it can be. `None` if it
/// would only hold the rest.
fn track(skeleton: &Skeleton, column: &Column, rows: &[Row], limit: f64) -> Option<Track> {
    let first = rows.first()?;
    let is_constant = rows.iter().all(|row| column.of(row) == column.of(first));
    let mut keys = vec![0];
    if is_constant {
        if numbers(skeleton, std::slice::from_ref(column), skeleton.rest()) == column.of(first) {
            return None;
        }
    } else {
        let fits =
            |from: usize, to: usize| (from + 1..to).all(|at| column.error(&rows[from], &rows[to], &rows[at]) <= limit);
        let last = rows.len() - 1;
        let mut from = 0;
        while from < last {
            let (mut good, mut step) = (from + 1, 1);
            while step > 0 {
                let next = (good + step).min(last);
                if next > good && fits(from, next) {
                    (good, step) = (next, 2 * step);
                } else {
                    step /= 2;
                }
            }
            keys.push(good);
            from = good;
        }
    }
    Some(column.track(rows, &keys))
}

/// Whether the clip has every joint where the poses have it.
fn is_close(clip: &Clip, poses: &mut Poses<'_>, rows: &[Row], offset: f64) -> bool {
    let skeleton = poses.skeleton;
    let (mut expected, mut found) = (skeleton.rest().clone(), skeleton.rest().clone());
    let mut cursor = SampleCursor::default();
    rows.iter().all(|row| {
        (poses.pose_at)(row.time, &mut expected);
        found.copy_from(skeleton.rest());
        clip.sample(skeleton, row.time, &mut cursor, &mut found);
        let (expected, found) = (world(skeleton, &expected), world(skeleton, &found));
        let is_near = |joint: JointIndex| {
            // The samples have a share of their own.
            let part = 1.0 - SAMPLE_SHARE;
            expected.position(joint).distance(found.position(joint)) <= part * offset
                && angle_between(expected.rotation(joint), found.rotation(joint)) <= part * MAX_TURN
        };
        skeleton.joints().all(is_near)
    })
}
