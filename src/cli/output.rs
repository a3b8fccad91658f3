//! What commands write: the file of `--out` and standard output. Everything that is written passes through here.

use std::borrow::Cow;
use std::ffi::OsStr;
use std::io::{ErrorKind, Write, stderr, stdout};
use std::path::{Path, PathBuf};

use super::failure::{Failure, Outcome};
use crate::files::{Disk, STANDARD_STREAM, is_stream, refuse_input, save_file};

/// Writes the file of `--out`, or to standard output for `-`. `extensions` are those that fit the content, in lower case.
pub(super) fn write_output(out: &Path, bytes: &[u8], extensions: &[&str], disk: &Disk) -> Outcome {
    if is_standard_output(out) {
        return print_bytes(bytes);
    }
    save_output(out, bytes, extensions, &disk.files_read())
}

/// Writes a file that is none of the `inputs`. `extensions` are those that fit the content, in lower case.
pub(super) fn save_output(out: &Path, bytes: &[u8], extensions: &[&str], inputs: &[PathBuf]) -> Outcome {
    check_extension(out, extensions)?;
    Ok(save_file(out, bytes, inputs)?)
}

pub(super) fn is_standard_output(out: &Path) -> bool {
    out == STANDARD_STREAM
}

/// Refuses an output that [`write_output`] would refuse, before the work.
pub(super) fn check_output(out: &Path, extensions: &[&str], disk: &Disk) -> Outcome {
    if is_standard_output(out) {
        return Ok(());
    }
    check_extension(out, extensions)?;
    Ok(refuse_input(out, &disk.files_read())?)
}

/// A name without an extension fits everything, and so do devices and pipes.
fn check_extension(out: &Path, extensions: &[&str]) -> Outcome {
    let Some(extension) = out.extension().and_then(OsStr::to_str).map(str::to_lowercase) else { return Ok(()) };
    if extensions.contains(&extension.as_str()) || is_stream(out) {
        return Ok(());
    }
    let expected: Vec<String> = extensions.iter().map(|extension| format!(".{extension}")).collect();
    let failure = Failure::expected(expected.join(" or "), format!(".{extension}"));
    Err(failure.at("file extension").in_file(out.display()))
}

/// Prints a document to standard output.
pub(super) fn print_json(document: &serde_json::Value) -> Outcome {
    print_bytes(format!("{document}\n").as_bytes())
}

/// Prints bytes to standard output. A closed pipe is not an error.
pub(super) fn print_bytes(bytes: &[u8]) -> Outcome {
    let mut stdout = stdout().lock();
    match stdout.write_all(bytes).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::new(crate::files::describe(&error)).in_file("standard output"))
        }
        _ => Ok(()),
    }
}

/// Prints lines for people to standard output.
pub(super) fn print_lines(lines: impl IntoIterator<Item: AsRef<str>>) -> Outcome {
    let lines = lines.into_iter().map(|line| format!("{}\n", shown(line.as_ref())));
    print_bytes(lines.collect::<String>().as_bytes())
}

/// Prints a line for people to standard error. If that fails, there is nowhere left to report it.
pub(super) fn print_error(line: &str) {
    let _ = writeln!(stderr(), "{}", shown(line));
}

pub(super) fn warn(message: &str) {
    print_error(&format!("warning: {message}"));
}

/// Returns a line as a terminal shows it. Names come from files that nobody has vetted: what a terminal would obey, such as escape
/// sequences, new lines and marks that reverse the text, is escaped. All text for people passes through here; JSON has its own
/// escapes.
pub(super) fn shown(line: &str) -> Cow<'_, str> {
    if !line.contains(is_obeyed) {
        return Cow::Borrowed(line);
    }
    let mut shown = String::with_capacity(2 * line.len());
    for character in line.chars() {
        match is_obeyed(character) {
            true => shown.extend(character.escape_default()),
            false => shown.push(character),
        }
    }
    Cow::Owned(shown)
}

/// Whether a terminal obeys a character instead of showing it: a control, a line separator or a bidirectional mark.
fn is_obeyed(character: char) -> bool {
    let is_mark =
        matches!(character, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    character.is_control() || is_mark
}
