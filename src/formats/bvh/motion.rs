//! MOTION: one key of every channel for each frame.

use glam::{DQuat, DVec3, Quat, Vec3};

use super::frame_of_reference::FrameOfReference;
use super::hierarchy::{Axis, BvhJoint, Channel, Hierarchy};
use crate::anim::{Clip, ClipBuilder, Interpolation, Keys, Skeleton};
use crate::asset::{Warning, Warnings};
use crate::formats::error::Problem;
use crate::formats::lines::{Lines, number, quoted, text};

/// Numbers in all frames together: a quarter of a gigabyte of them, some forty minutes of a body at 120 frames a second.
const MOST_NUMBERS: usize = 1 << 25;

pub struct Motion {
    pub frame_count: usize,
    frame_secs: f64,
    /// Frame after frame, each with all channels in file order.
    numbers: Vec<f64>,
    /// Where "Frame Time" stands.
    line: usize,
}

/// None when the file ends after its skeleton, or has no frame.
pub fn read(lines: &mut Lines, hierarchy: &Hierarchy, warnings: &mut Warnings) -> Result<Option<Motion>, Problem> {
    let mut warn = |line: usize, problem: String| {
        warnings.push(Warning::Other { code: "bvh-motion", place: format!("line {line}"), problem });
    };
    if lines.word().is_none() {
        warn(lines.line, "there is no MOTION: the skeleton stands still".to_owned());
        return Ok(None);
    }
    let mut announced = None;
    let (frame_secs, line) = loop {
        let (line, text) = lines.next_full_line().ok_or_else(|| missing_time(lines.line, "the end of the file"))?;
        if let Some(value) = value_of(text, "Frames") {
            let count = std::str::from_utf8(value).ok().and_then(|value| value.parse::<u64>().ok());
            match count {
                Some(count) => announced = Some(count),
                None => warn(line, format!("the number of frames is {}; the frames are counted", quoted(Some(value)))),
            }
        } else if let Some(value) = value_of(text, "Frame Time") {
            break (number(value).ok_or_else(|| missing_time(line, &quoted(Some(value))))?, line);
        } else {
            return Err(missing_time(line, &quoted(Some(text))));
        }
    };
    let numbers = frames(lines, hierarchy.channel_count, &mut warn)?;
    let frame_count = numbers.len().checked_div(hierarchy.channel_count).unwrap_or(0);
    match announced {
        Some(announced) if announced != frame_count as u64 && hierarchy.channel_count > 0 => {
            warn(line, format!("{announced} frames are announced, {frame_count} are there; those are used"));
        }
        _ => {}
    }
    if frame_count == 0 {
        return Ok(None);
    }
    if frame_count > 1 && frame_secs <= 0.0 {
        return Err(missing_time(line, &frame_secs.to_string()));
    }
    Ok(Some(Motion { frame_count, frame_secs, numbers, line }))
}

fn missing_time(line: usize, found: &str) -> Problem {
    Problem::new(format!("line {line}"), "“Frame Time:” and a number of seconds above 0", found)
}

/// What follows `key` and a colon, if the line is about that key.
fn value_of<'a>(line: &'a [u8], key: &str) -> Option<&'a [u8]> {
    let colon = line.iter().position(|&byte| byte == b':')?;
    let mut words = line[..colon].split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    let same =
        key.split(' ').all(|wanted| words.next().is_some_and(|word| word.eq_ignore_ascii_case(wanted.as_bytes())));
    (same && words.next().is_none()).then(|| line[colon + 1..].trim_ascii())
}

/// All numbers of all frames. A frame begins on a line of its own and may go on over several; so a number too many or too
/// few is noticed where it is. A last frame that is cut short is left out.
fn frames(lines: &mut Lines, channels: usize, warn: &mut impl FnMut(usize, String)) -> Result<Vec<f64>, Problem> {
    let mut numbers = Vec::new();
    let mut in_frame = 0;
    let mut began = lines.line;
    while let Some((line, words)) = lines.next_full_line() {
        if channels == 0 {
            break;
        }
        if in_frame == 0 {
            began = line;
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
            if numbers.len() == MOST_NUMBERS {
                return Err(Problem::new(format!("line {line}"), format!("at most {MOST_NUMBERS} numbers"), "more"));
            }
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

impl Motion {
    /// The numbers of one frame.
    pub fn frame(&self, frame: usize) -> &[f64] {
        let channels = self.numbers.len() / self.frame_count;
        self.numbers.get(frame * channels..(frame + 1) * channels).unwrap_or_default()
    }

    /// One rotation channel for each joint that has any, one translation channel likewise.
    pub fn into_clip(
        self,
        name: &str,
        hierarchy: &Hierarchy,
        reference: &FrameOfReference,
        skeleton: &Skeleton,
        warnings: &mut Warnings,
    ) -> Result<Option<Clip>, Problem> {
        let unusable = |problem: String| Problem::new(format!("line {}", self.line), "usable key times", problem);
        let times_secs: Vec<f32> = (0..self.frame_count).map(|frame| (frame as f64 * self.frame_secs) as f32).collect();
        let mut builder = ClipBuilder::new(name, skeleton);
        let mut first = 0;
        for (index, joint) in hierarchy.joints.iter().enumerate() {
            let channels = first..first + joint.channels.len();
            first = channels.end;
            let Some(target) = skeleton.joint_of_source(index) else { continue };
            let of_frame = |frame| self.frame(frame).get(channels.clone()).unwrap_or_default();
            if joint.channels.iter().any(|channel| matches!(channel, Channel::Rotation(_))) {
                let mut keys: Vec<Quat> = Vec::with_capacity(self.frame_count);
                for frame in 0..self.frame_count {
                    let key = reference.rotation(rotation(joint, of_frame(frame)));
                    // The sign that lies nearer to the key before: no reader has to turn it.
                    keys.push(if keys.last().is_some_and(|before| before.dot(key) < 0.0) { -key } else { key });
                }
                builder
                    .channel(target, Interpolation::Linear, &times_secs, Keys::Rotation(keys))
                    .map_err(|problem| unusable(problem.to_string()))?;
            }
            if joint.channels.iter().any(|channel| matches!(channel, Channel::Position(_))) {
                let positions = (0..self.frame_count).map(|frame| position(joint, of_frame(frame)));
                if joint.parent.is_some()
                    && joint.offset != DVec3::ZERO
                    && positions.clone().all(|at| at == DVec3::ZERO)
                {
                    let problem =
                        "its positions are all zero, which would fold it into its parent; its OFFSET holds".to_owned();
                    let place = format!("joint {index} “{}”", text(joint.name.as_bytes()));
                    warnings.push(Warning::ChannelIgnored { clip: name.to_owned(), place, problem });
                    continue;
                }
                let keys: Vec<Vec3> = positions.map(|at| reference.point(at)).collect();
                if let Some(frame) = keys.iter().position(|key| !key.is_finite()) {
                    let place = format!("frame {frame}, position of joint {index}");
                    return Err(Problem::new(place, "numbers that fit into 32 bits", keys[frame]));
                }
                builder
                    .channel(target, Interpolation::Linear, &times_secs, Keys::Translation(keys))
                    .map_err(|problem| unusable(problem.to_string()))?;
            }
        }
        Ok(Some(builder.build()))
    }
}

/// The product of a joint's rotation channels, the first listed outermost.
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

/// Where the joint is below its parent: its OFFSET, with the axes replaced that have a channel.
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
