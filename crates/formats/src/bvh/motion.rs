//! MOTION: one number per channel and frame.

use gaitway_character::asset::{Warning, Warnings};

use super::hierarchy::Hierarchy;
use crate::error::Problem;
use crate::limits::Budget;
use crate::lines::{Lines, number, quoted};

pub struct Frames {
    pub frame_count: usize,
    pub frame_secs: f64,
    /// Frame by frame, all channels in file order.
    numbers: Vec<f64>,
    /// Line of "Frame Time".
    pub line: usize,
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
}
