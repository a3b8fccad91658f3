//! Options that change the clip that is written, shared by `retarget` and `convert`.

use clap::Args;
use gaitway_character::anim::{Clip, TimeRange};
use gaitway_character::asset::Asset;
use gaitway_retarget::{ChangedClip, ClipChanges, Seam, Symmetry, change_clip};
use serde_json::{Value, json};

use super::failure::{Failure, Outcome};
use super::read_numbers;

/// Durations are printed in milliseconds, so a clip's end as typed may be up to half of one late.
const TRIM_TOLERANCE_SECS: f64 = 0.000_5;

#[derive(Debug, Default, Args)]
#[command(next_help_heading = "Changes to the clip, in this order")]
pub(super) struct ChangeOptions {
    /// Swaps left and right.
    #[arg(long)]
    mirror: bool,
    /// Keeps a part, in seconds.
    #[arg(long, value_name = "START,END", value_parser = read_trim)]
    trim: Option<TimeRange>,
    /// Plays backwards.
    #[arg(long)]
    reverse: bool,
    #[arg(
        long,
        value_name = "FACTOR",
        value_parser = read_speed,
        help = format!("A factor on the speed, {} to {}", ClipChanges::MIN_SPEED, ClipChanges::MAX_SPEED)
    )]
    speed: Option<f64>,
    /// Makes the end meet the start, blended over this many seconds at either side of the seam.
    #[arg(long, value_name = "SECS", value_parser = read_blend)]
    make_loop: Option<f64>,
    /// Moves the character over the ground, in metres.
    #[arg(long, value_name = "X,Z", allow_hyphen_values = true, value_parser = read_offset)]
    offset: Option<[f64; 2]>,
    /// Turns the character and its path about its start, in degrees, counter-clockwise from above.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = read_turn)]
    turn: Option<f64>,
}

impl ChangeOptions {
    pub(super) fn changes(&self) -> ClipChanges {
        ClipChanges {
            mirror: self.mirror,
            trim: self.trim,
            reverse: self.reverse,
            speed: self.speed.unwrap_or(ClipChanges::NONE.speed),
            loop_secs: self.make_loop,
            offset: self.offset.unwrap_or(ClipChanges::NONE.offset),
            turn_degrees: self.turn.unwrap_or(ClipChanges::NONE.turn_degrees),
        }
    }

    /// Changes a clip of an asset. `symmetry` is only called to mirror; if it pairs no joints, that is a warning.
    pub(super) fn change(
        &self,
        asset: &Asset,
        clip: Clip,
        symmetry: impl FnOnce() -> Symmetry,
        warnings: &mut Vec<(&'static str, String)>,
    ) -> Outcome<ChangedClip> {
        let changes = self.changes();
        if changes.is_none() {
            return Ok(ChangedClip { clip, seam: None });
        }
        let duration_secs = f64::from(clip.duration_secs());
        let is_beyond = |range: &TimeRange| range.end_secs > duration_secs + TRIM_TOLERANCE_SECS;
        if let Some(range) = changes.trim.filter(is_beyond) {
            let expected = format!("an end within the {duration_secs:.3} s of clip “{}”", clip.name());
            return Err(Failure::expected(expected, format!("{} s", range.end_secs)).at("--trim"));
        }
        let symmetry = || {
            let symmetry = symmetry();
            if symmetry.paired() == 0 {
                let message = "--mirror: no joint has a counterpart on the other side, by body part or by name; each is mirrored onto itself";
                warnings.push(("nothing-to-swap", message.to_owned()));
            }
            symmetry
        };
        Ok(change_clip(asset, &clip, &changes, symmetry))
    }
}

/// The changes for scripts; null if there are none.
pub(super) fn document(options: &ChangeOptions, seam: Option<&Seam>) -> Value {
    let changes = options.changes();
    if changes.is_none() { Value::Null } else { json!({ "changes": changes, "seam": seam }) }
}

fn read_trim(text: &str) -> Result<TimeRange, String> {
    let range = read_numbers(text).filter(|[start, end]| 0.0 <= *start && start < end);
    range
        .map(|[start_secs, end_secs]| TimeRange { start_secs, end_secs })
        .ok_or_else(|| "expected START,END in seconds, the end after the start".to_owned())
}

/// Reads one number in a range; `what` says what it is.
fn read_number(text: &str, what: &str, min: f64, max: f64) -> Result<f64, String> {
    let number = read_numbers(text).map(|[number]| number).filter(|number| (min..=max).contains(number));
    number.ok_or_else(|| format!("expected {what} from {min} to {max}"))
}

fn read_speed(text: &str) -> Result<f64, String> {
    read_number(text, "a factor", ClipChanges::MIN_SPEED, ClipChanges::MAX_SPEED)
}

fn read_blend(text: &str) -> Result<f64, String> {
    read_number(text, "seconds", 0.0, ClipChanges::MAX_LOOP_SECS)
}

fn read_turn(text: &str) -> Result<f64, String> {
    read_number(text, "degrees", -ClipChanges::MAX_TURN_DEGREES, ClipChanges::MAX_TURN_DEGREES)
}

fn read_offset(text: &str) -> Result<[f64; 2], String> {
    let max = ClipChanges::MAX_OFFSET_METRES;
    let offset = read_numbers(text).filter(|[x, z]: &[f64; 2]| x.abs().max(z.abs()) <= max);
    offset.ok_or_else(|| format!("expected X,Z in metres, at most {max}"))
}
