//! MOTION: one key per channel and frame.

use std::ops::Range;

use glam::{DQuat, DVec3, Quat, Vec3};

use super::frame_of_reference::FrameOfReference;
use super::hierarchy::{Axis, BvhJoint, Channel, Hierarchy};
use crate::anim::{Clip, ClipBuilder, Interpolation, Keys, Skeleton};
use crate::asset::{Warning, Warnings};
use crate::formats::error::Problem;
use crate::formats::limits::Budget;
use crate::formats::lines::{Lines, number, quoted, text};

pub struct Frames {
    pub frame_count: usize,
    frame_secs: f64,
    /// Frame by frame, all channels in file order.
    numbers: Vec<f64>,
    /// Line of "Frame Time".
    line: usize,
}

/// Returns `None` if the file ends after its skeleton, or has no frame.
pub fn read(
    lines: &mut Lines,
    hierarchy: &Hierarchy,
    budget: &Budget,
    warnings: &mut Warnings,
) -> Result<Option<Frames>, Problem> {
    let other =
        |line: usize, problem: String| Warning::Other { code: "bvh-motion", place: format!("line {line}"), problem };
    let missing = |line: usize, problem: String| Warning::FramesMissing { line: format!("line {line}"), problem };
    if lines.word().is_none() {
        warnings.push(other(lines.line, "there is no MOTION: the skeleton stands still".to_owned()));
        return Ok(None);
    }
    let Header { frame_secs, line, announced } =
        header(lines, &mut |line, problem| warnings.push(other(line, problem)))?;
    let numbers =
        frames(lines, hierarchy.channel_count, budget, &mut |line, problem| warnings.push(missing(line, problem)))?;
    let frame_count = numbers.len().checked_div(hierarchy.channel_count).unwrap_or(0);
    match announced {
        Some(announced) if announced != frame_count as u64 && hierarchy.channel_count > 0 => {
            let problem = format!("{announced} frames are announced, {frame_count} are there; those are used");
            let is_more = frame_count as u64 > announced;
            warnings.push(if is_more { other(line, problem) } else { missing(line, problem) });
        }
        _ => {}
    }
    if frame_count == 0 {
        return Ok(None);
    }
    if frame_count > 1 && frame_secs <= 0.0 {
        return Err(missing_time(line, &frame_secs.to_string()));
    }
    Ok(Some(Frames { frame_count, frame_secs, numbers, line }))
}

struct Header {
    frame_secs: f64,
    /// Line of "Frame Time".
    line: usize,
    /// Value of "Frames".
    announced: Option<u64>,
}

fn header(lines: &mut Lines, warn: &mut impl FnMut(usize, String)) -> Result<Header, Problem> {
    let mut announced = None;
    loop {
        let (line, text) = lines.next_full_line().ok_or_else(|| missing_time(lines.line, "the end of the file"))?;
        if let Some(value) = value_of(text, "Frame Time") {
            let frame_secs = number(value).ok_or_else(|| missing_time(line, &quoted(Some(value))))?;
            return Ok(Header { frame_secs, line, announced });
        }
        let Some(value) = value_of(text, "Frames") else { return Err(missing_time(line, &quoted(Some(text)))) };
        match std::str::from_utf8(value).ok().and_then(|value| value.parse::<u64>().ok()) {
            Some(count) => announced = Some(count),
            None => warn(line, format!("the number of frames is {}; the frames are counted", quoted(Some(value)))),
        }
    }
}

fn missing_time(line: usize, found: &str) -> Problem {
    Problem::new(format!("line {line}"), "“Frame Time:” and a number of seconds above 0", found)
}

/// Returns the value of a line `key: value`.
fn value_of<'a>(line: &'a [u8], key: &str) -> Option<&'a [u8]> {
    let colon = line.iter().position(|&byte| byte == b':')?;
    let mut words = line[..colon].split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    let same =
        key.split(' ').all(|wanted| words.next().is_some_and(|word| word.eq_ignore_ascii_case(wanted.as_bytes())));
    (same && words.next().is_none()).then(|| line[colon + 1..].trim_ascii())
}

/// Reads all numbers of all frames. A frame starts on a new line and may span several, so that a missing or surplus
/// number is reported where it occurs. An incomplete last frame is dropped.
fn frames(
    lines: &mut Lines,
    channels: usize,
    budget: &Budget,
    warn: &mut impl FnMut(usize, String),
) -> Result<Vec<f64>, Problem> {
    let mut numbers = Vec::new();
    let mut in_frame = 0;
    let mut began = lines.line;
    while let Some((line, words)) = lines.next_full_line() {
        if channels == 0 {
            break;
        }
        if in_frame == 0 {
            began = line;
            budget.allocate(channels, size_of::<f64>(), &format_args!("line {line}"))?;
        }
        for word in words.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()) {
            if in_frame == channels {
                let expected =
                    format!("{channels} numbers (one for each channel) in the frame that begins on line {began}");
                return Err(Problem::new(format!("line {line}"), expected, "more"));
            }
            let value = number(word).ok_or_else(|| {
                let place = format!("line {line}, number {}", in_frame + 1);
                Problem::new(place, "a finite number", quoted(Some(word)))
            })?;
            numbers.push(value);
            in_frame += 1;
        }
        if in_frame == channels {
            in_frame = 0;
        }
    }
    if in_frame > 0 {
        warn(began, format!("the last frame has {in_frame} of {channels} numbers (cut short?) and is left out"));
        numbers.truncate(numbers.len() - in_frame);
    }
    Ok(numbers)
}

impl Frames {
    /// Returns the numbers of one frame.
    pub fn frame(&self, frame: usize) -> &[f64] {
        let channels = self.numbers.len() / self.frame_count;
        self.numbers.get(frame * channels..(frame + 1) * channels).unwrap_or_default()
    }

    /// Builds a clip with at most one rotation channel and one translation channel per joint.
    pub fn into_clip(
        self,
        name: &str,
        hierarchy: &Hierarchy,
        reference: &FrameOfReference,
        skeleton: &Skeleton,
        budget: &Budget,
        warnings: &mut Warnings,
    ) -> Result<Option<Clip>, Problem> {
        let times_secs: Vec<f32> = (0..self.frame_count).map(|frame| (frame as f64 * self.frame_secs) as f32).collect();
        let mut builder = ClipBuilder::new(name, skeleton);
        let mut first = 0;
        for (index, joint) in hierarchy.joints.iter().enumerate() {
            let channels = first..first + joint.channels.len();
            first = channels.end;
            let Some(target) = skeleton.joint_of_source(index) else { continue };
            let has = |kind: fn(&Channel) -> bool| joint.channels.iter().any(kind);
            let mut add = |keys: Keys| {
                builder.channel(target, Interpolation::Linear, &times_secs, keys).map_err(|problem| {
                    Problem::new(format!("line {}", self.line), "usable key times", problem.to_string())
                })
            };
            let place = format_args!("line {}", self.line);
            if has(|channel| matches!(channel, Channel::Rotation(_))) {
                budget.allocate(self.frame_count, size_of::<Quat>(), &place)?;
                add(Keys::Rotation(self.rotations(joint, &channels, reference)))?;
            }
            if has(|channel| matches!(channel, Channel::Position(_))) {
                budget.allocate(self.frame_count, size_of::<Vec3>(), &place)?;
                match self.translations(index, joint, &channels, reference)? {
                    Some(keys) => add(Keys::Translation(keys))?,
                    None => {
                        let problem =
                            "its positions are all zero, which would collapse it onto its parent; its OFFSET is used"
                                .to_owned();
                        let place = format!("joint {index} “{}”", text(joint.name.as_bytes()));
                        warnings.push(Warning::ChannelIgnored { clip: name.to_owned(), place, problem });
                    }
                }
            }
        }
        Ok(Some(builder.build()))
    }

    /// The numbers of some channels, frame by frame.
    fn values(&self, channels: &Range<usize>) -> impl Iterator<Item = &[f64]> + Clone {
        (0..self.frame_count).map(|frame| self.frame(frame).get(channels.clone()).unwrap_or_default())
    }

    /// Rotation keys, each with the sign that is closer to the previous key.
    fn rotations(&self, joint: &BvhJoint, channels: &Range<usize>, reference: &FrameOfReference) -> Vec<Quat> {
        let mut keys: Vec<Quat> = Vec::with_capacity(self.frame_count);
        for values in self.values(channels) {
            let key = reference.rotation(rotation(joint, values));
            keys.push(if keys.last().is_some_and(|before| before.dot(key) < 0.0) { -key } else { key });
        }
        keys
    }

    /// Translation keys. `None` if all are zero although the joint has an OFFSET.
    fn translations(
        &self,
        index: usize,
        joint: &BvhJoint,
        channels: &Range<usize>,
        reference: &FrameOfReference,
    ) -> Result<Option<Vec<Vec3>>, Problem> {
        let positions = self.values(channels).map(|values| position(joint, values));
        if joint.parent.is_some() && joint.offset != DVec3::ZERO && positions.clone().all(|at| at == DVec3::ZERO) {
            return Ok(None);
        }
        let keys: Vec<Vec3> = positions.map(|at| reference.point(at)).collect();
        match keys.iter().position(|key| !key.is_finite()) {
            None => Ok(Some(keys)),
            Some(frame) => {
                let place = format!("frame {frame}, position of joint {index}");
                Err(Problem::new(place, "numbers that fit into 32 bits", keys[frame]))
            }
        }
    }
}

/// Multiplies a joint's rotation channels, the first listed being the outermost.
pub fn rotation(joint: &BvhJoint, numbers: &[f64]) -> DQuat {
    joint.channels.iter().zip(numbers).fold(DQuat::IDENTITY, |product, (channel, degrees)| match channel {
        // The remainder is exact and keeps large angles precise.
        Channel::Rotation(axis) => product * about(*axis, (degrees % 360.0).to_radians()),
        _ => product,
    })
}

fn about(axis: Axis, radians: f64) -> DQuat {
    match axis {
        Axis::X => DQuat::from_rotation_x(radians),
        Axis::Y => DQuat::from_rotation_y(radians),
        Axis::Z => DQuat::from_rotation_z(radians),
    }
}

/// Returns the joint's position relative to its parent: its OFFSET, except on axes that have a channel.
pub fn position(joint: &BvhJoint, numbers: &[f64]) -> DVec3 {
    let mut at = joint.offset;
    for (channel, &number) in joint.channels.iter().zip(numbers) {
        match channel {
            Channel::Position(Axis::X) => at.x = number,
            Channel::Position(Axis::Y) => at.y = number,
            Channel::Position(Axis::Z) => at.z = number,
            _ => {}
        }
    }
    at
}
