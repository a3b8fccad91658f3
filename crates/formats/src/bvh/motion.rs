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
    if lines.end_at_padding() {
        let problem = "a control character ends the text; what follows it is skipped".to_owned();
        warnings.push(Warning::Other { code: "bvh-motion", place: "the end".to_owned(), problem });
    }
    if lines.word().is_none() {
        warnings.push(other(lines.line, "there is no MOTION: the skeleton stands still".to_owned()));
        return Ok(None);
    }
    let Header { frame_secs, line, announced } =
        header(lines, &mut |line, problem| warnings.push(other(line, problem)))?;
    let numbers = frames(lines, hierarchy.channel_count, announced, budget, warnings)?;
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

fn other(line: usize, problem: String) -> Warning {
    Warning::Other { code: "bvh-motion", place: format!("line {line}"), problem }
}

fn missing(line: usize, problem: String) -> Warning {
    Warning::FramesMissing { line: format!("line {line}"), problem }
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

/// Reads all numbers of all frames. A frame starts on a new line and may span several, so that a missing number is reported
/// where it occurs. Three things are dropped with a warning: an incomplete last frame, a few surplus numbers at the end of a line
/// that holds a whole frame, and whatever follows the announced frames and isn't one.
fn frames(
    lines: &mut Lines,
    channels: usize,
    announced: Option<u64>,
    budget: &Budget,
    warnings: &mut Warnings,
) -> Result<Vec<f64>, Problem> {
    let mut frames = Numbers { all: Vec::new(), channels, in_frame: 0, began: lines.line };
    let mut surplus = None;
    while let Some((line, text)) = lines.next_full_line() {
        if channels == 0 {
            break;
        }
        if frames.in_frame == 0 {
            frames.began = line;
            budget.allocate(channels, size_of::<f64>(), &format_args!("line {line}"))?;
        }
        let whole = frames.all.len() - frames.in_frame;
        match frames.add(line, text) {
            Ok(0) => {}
            Ok(count) => surplus = surplus.or(Some((line, count))),
            Err(_) if announced.is_some_and(|announced| (whole / channels) as u64 >= announced) => {
                frames.all.truncate(whole);
                frames.in_frame = 0;
                let problem =
                    format!("{} after the last frame, and the rest of the file, is skipped", quoted(Some(text)));
                warnings.push(other(line, problem));
                break;
            }
            Err(problem) => return Err(problem),
        }
    }
    let Numbers { mut all, in_frame, began, .. } = frames;
    if in_frame > 0 {
        let problem = format!("the last frame has {in_frame} of {channels} numbers (cut short?) and is left out");
        warnings.push(missing(began, problem));
        all.truncate(all.len() - in_frame);
    }
    if let Some((line, count)) = surplus {
        // Too few frames: the file fills its lines regardless of where frames begin.
        if announced.is_some_and(|announced| ((all.len() / channels) as u64) < announced) {
            return Err(more(line, line, channels));
        }
        let problem = format!("{count} more than the {channels} numbers of a frame; what follows these is skipped");
        warnings.push(other(line, problem));
    }
    Ok(all)
}

/// The numbers of all frames so far.
struct Numbers {
    all: Vec<f64>,
    channels: usize,
    /// Numbers of the last frame; 0 once it is complete.
    in_frame: usize,
    /// The line on which the last frame begins.
    began: usize,
}

impl Numbers {
    /// Adds the numbers of a line. Returns how many it has beyond a whole frame, as long as they are fewer than another one.
    fn add(&mut self, line: usize, text: &[u8]) -> Result<usize, Problem> {
        let mut surplus = 0;
        for word in text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()) {
            if self.in_frame == self.channels {
                surplus += 1;
                if self.began != line || surplus == self.channels {
                    return Err(more(line, self.began, self.channels));
                }
                continue;
            }
            let value = number(word).ok_or_else(|| {
                let place = format!("line {line}, number {}", self.in_frame + 1);
                Problem::new(place, "a finite number", quoted(Some(word)))
            })?;
            self.all.push(value);
            self.in_frame += 1;
        }
        if self.in_frame == self.channels {
            self.in_frame = 0;
        }
        Ok(surplus)
    }
}

fn more(line: usize, began: usize, channels: usize) -> Problem {
    let expected = format!("{channels} numbers (one for each channel) in the frame that begins on line {began}");
    Problem::new(format!("line {line}"), expected, "more")
}

impl Frames {
    /// Returns the numbers of one frame.
    pub fn frame(&self, frame: usize) -> &[f64] {
        let channels = self.numbers.len() / self.frame_count;
        self.numbers.get(frame * channels..(frame + 1) * channels).unwrap_or_default()
    }
}
