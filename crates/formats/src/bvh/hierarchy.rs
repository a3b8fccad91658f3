//! HIERARCHY: joints with their offsets and channels, in file order. Read without recursion, so that files may nest to any
//! depth.

use gaitway_character::asset::{Warning, Warnings};
use glam::{DQuat, DVec3};

use crate::error::Problem;
use crate::limits::{Budget, Limit};
use crate::lines::{Lines, number, quoted, text};

/// Generous: six are usual, and some programs also write scales.
const MAX_CHANNELS_PER_JOINT: usize = 16;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    X,
    Y,
    Z,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    Position(Axis),
    Rotation(Axis),
    /// A kind that isn't supported; its numbers are skipped.
    Unknown,
}

#[derive(Debug)]
pub struct BvhJoint {
    pub name: String,
    pub parent: Option<usize>,
    pub offset: DVec3,
    pub channels: Vec<Channel>,
}

impl BvhJoint {
    /// Multiplies the joint's rotation channels, the first listed being the outermost. `numbers` are those of its channels.
    pub fn rotation(&self, numbers: &[f64]) -> DQuat {
        self.channels.iter().zip(numbers).fold(DQuat::IDENTITY, |product, (channel, degrees)| match channel {
            // The remainder is exact and keeps large angles precise.
            Channel::Rotation(axis) => product * about(*axis, (degrees % 360.0).to_radians()),
            _ => product,
        })
    }

    /// Returns the joint's position relative to its parent: its OFFSET, except on axes that have a channel.
    pub fn position(&self, numbers: &[f64]) -> DVec3 {
        let mut at = self.offset;
        for (channel, &number) in self.channels.iter().zip(numbers) {
            match channel {
                Channel::Position(Axis::X) => at.x = number,
                Channel::Position(Axis::Y) => at.y = number,
                Channel::Position(Axis::Z) => at.z = number,
                _ => {}
            }
        }
        at
    }
}

fn about(axis: Axis, radians: f64) -> DQuat {
    match axis {
        Axis::X => DQuat::from_rotation_x(radians),
        Axis::Y => DQuat::from_rotation_y(radians),
        Axis::Z => DQuat::from_rotation_z(radians),
    }
}

#[derive(Debug, Default)]
pub struct Hierarchy {
    pub joints: Vec<BvhJoint>,
    /// End Sites: the joint, and the offset from it.
    pub ends: Vec<(usize, DVec3)>,
    /// Channels of all joints, and thus numbers per frame.
    pub channel_count: usize,
}

/// An open brace.
#[derive(Clone, Copy)]
enum Open {
    Joint(usize),
    End(usize),
}

impl Hierarchy {
    /// Reads up to the word MOTION, which is left for the next reader, or to the end of the file.
    pub fn read(lines: &mut Lines, budget: &Budget, warnings: &mut Warnings) -> Result<Self, Problem> {
        let first = lines.word();
        if !first.is_some_and(|word| is(word, "HIERARCHY")) {
            return Err(Problem::new(lines.place(), "HIERARCHY, the first word of a BVH file", quoted(first)));
        }
        let mut hierarchy = Self::default();
        let mut open: Vec<Open> = Vec::new();
        let mut nodes = 0;
        while lines.peek().is_some_and(|word| !is(word, "MOTION")) {
            hierarchy.statement(lines, &mut open, warnings)?;
            let found = hierarchy.joints.len() + hierarchy.ends.len();
            budget.spend(Limit::Nodes, found - nodes, &format_args!("line {}", lines.line))?;
            nodes = found;
        }
        if let Some(open) = open.last() {
            let joint = match *open {
                Open::Joint(joint) => joint,
                Open::End(end) => hierarchy.ends[end].0,
            };
            let expected = format!("}} after joint “{}”", hierarchy.joints[joint].name);
            return Err(Problem::new(lines.next_place(), expected, quoted(lines.peek())));
        }
        if hierarchy.joints.is_empty() {
            return Err(Problem::new(lines.next_place(), "ROOT and at least one joint", quoted(lines.peek())));
        }
        Ok(hierarchy)
    }

    /// Reads one statement inside the innermost open brace.
    fn statement(&mut self, lines: &mut Lines, open: &mut Vec<Open>, warnings: &mut Warnings) -> Result<(), Problem> {
        let word = lines.word().unwrap_or_default();
        let place = lines.place();
        let unexpected = |expected: &str| Err(Problem::new(place.as_str(), expected, quoted(Some(word))));
        match open.last().copied() {
            Some(_) if word == b"}" => drop(open.pop()),
            None if is(word, "ROOT") => open.push(Open::Joint(self.joint(lines, None)?)),
            None => return unexpected("ROOT or MOTION"),
            Some(Open::Joint(joint)) if is(word, "OFFSET") => self.joints[joint].offset = offset(lines)?,
            Some(Open::Joint(joint)) if is(word, "CHANNELS") => self.channels(lines, joint, warnings)?,
            Some(Open::Joint(joint)) if is(word, "JOINT") => open.push(Open::Joint(self.joint(lines, Some(joint))?)),
            Some(Open::Joint(joint)) if is(word, "End") || is(word, "EndSite") => {
                lines.rest_of_line();
                open_brace(lines)?;
                self.ends.push((joint, DVec3::ZERO));
                open.push(Open::End(self.ends.len() - 1));
            }
            Some(Open::Joint(_)) => return unexpected("OFFSET, CHANNELS, JOINT, End Site or }"),
            Some(Open::End(end)) if is(word, "OFFSET") => self.ends[end].1 = offset(lines)?,
            Some(Open::End(_)) if is(word, "CHANNELS") && lines.peek() == Some(b"0") => {
                lines.word();
                let problem = "an End Site has no CHANNELS; “CHANNELS 0” is skipped".to_owned();
                warnings.push(Warning::Other { code: "bvh-end-site", place, problem });
            }
            Some(Open::End(_)) => return unexpected("OFFSET or } of an End Site"),
        }
        Ok(())
    }

    /// Reads what follows ROOT or JOINT. Names may contain spaces, or be missing.
    fn joint(&mut self, lines: &mut Lines, parent: Option<usize>) -> Result<usize, Problem> {
        let name = text(lines.rest_of_line()).into_owned();
        open_brace(lines)?;
        self.joints.push(BvhJoint { name, parent, offset: DVec3::ZERO, channels: Vec::new() });
        Ok(self.joints.len() - 1)
    }

    fn channels(&mut self, lines: &mut Lines, joint: usize, warnings: &mut Warnings) -> Result<(), Problem> {
        let place = lines.place();
        if !self.joints[joint].channels.is_empty() {
            return Err(Problem::new(place, "one list of CHANNELS for each joint", "a second one"));
        }
        let word = lines.word();
        let count = word
            .and_then(|word| std::str::from_utf8(word).ok()?.parse::<usize>().ok())
            .filter(|&count| count <= MAX_CHANNELS_PER_JOINT)
            .ok_or_else(|| {
                let expected = format!("a number of channels, at most {MAX_CHANNELS_PER_JOINT}");
                Problem::new(place.as_str(), expected, quoted(word))
            })?;
        for _ in 0..count {
            let word = lines.word();
            let Some(channel) = word.and_then(channel) else {
                let expected = "a channel such as Xposition or Zrotation";
                return Err(Problem::new(lines.place(), expected, quoted(word)));
            };
            if channel == Channel::Unknown {
                let problem = format!("channel {} is not read", quoted(word));
                warnings.push(Warning::Other { code: "bvh-channel-ignored", place: lines.place(), problem });
            }
            self.joints[joint].channels.push(channel);
        }
        self.channel_count += count;
        Ok(())
    }

    /// Returns the longest path along the bones from one end of the skeleton to another, in the file's units.
    pub fn longest_path(&self) -> f64 {
        let mut below = vec![0.0_f64; self.joints.len()];
        let mut longest = 0.0_f64;
        let mut reach = |below: &mut [f64], joint: usize, length: f64| {
            longest = longest.max(below[joint] + length);
            below[joint] = below[joint].max(length);
        };
        for &(joint, offset) in &self.ends {
            reach(&mut below, joint, offset.length());
        }
        // Children come after their parents in the file.
        for (index, joint) in self.joints.iter().enumerate().rev() {
            if let Some(parent) = joint.parent {
                let length = below[index] + joint.offset.length();
                reach(&mut below, parent, length);
            }
        }
        longest
    }
}

fn is(word: &[u8], keyword: &str) -> bool {
    word.eq_ignore_ascii_case(keyword.as_bytes())
}

fn open_brace(lines: &mut Lines) -> Result<(), Problem> {
    match lines.word() {
        Some(b"{") => Ok(()),
        other => Err(Problem::new(lines.place(), "{", quoted(other))),
    }
}

fn offset(lines: &mut Lines) -> Result<DVec3, Problem> {
    let mut numbers = [0.0; 3];
    for slot in &mut numbers {
        let word = lines.word();
        *slot = word
            .and_then(number)
            .ok_or_else(|| Problem::new(lines.place(), "three finite numbers after OFFSET", quoted(word)))?;
    }
    Ok(DVec3::from_array(numbers))
}

/// Parses the name of a channel.
fn channel(word: &[u8]) -> Option<Channel> {
    let (&first, kind) = word.split_first()?;
    let axis = match first.to_ascii_uppercase() {
        b'X' => Axis::X,
        b'Y' => Axis::Y,
        b'Z' => Axis::Z,
        _ => return None,
    };
    match kind.to_ascii_lowercase().as_slice() {
        b"position" | b"translation" => Some(Channel::Position(axis)),
        b"rotation" => Some(Channel::Rotation(axis)),
        b"scale" | b"scaling" => Some(Channel::Unknown),
        _ => None,
    }
}
