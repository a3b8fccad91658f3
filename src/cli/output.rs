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
    let Some(extension) = extension_of(out) else { return Ok(()) };
    if extensions.contains(&extension.as_str()) || is_stream(out) {
        return Ok(());
    }
    let expected: Vec<String> = extensions.iter().map(|extension| format!(".{extension}")).collect();
    let failure = Failure::expected(expected.join(" or "), format!(".{extension}"));
    Err(failure.at("file extension").in_file(out.display()))
}

/// Returns a path's extension in lower case.
pub(super) fn extension_of(path: &Path) -> Option<String> {
    path.extension().and_then(OsStr::to_str).map(str::to_lowercase)
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
    let lines = lines.into_iter().map(|line| format!("{}\n", printable(line.as_ref())));
    print_bytes(lines.collect::<String>().as_bytes())
}

/// Prints a line for people to standard error. If that fails, there is nowhere left to report it.
pub(super) fn print_error(line: &str) {
    let _ = writeln!(stderr(), "{}", printable(line));
}

pub(super) fn warn(message: &str) {
    print_error(&format!("warning: {message}"));
}

/// Escapes what a terminal would interpret instead of showing it: escape sequences, line breaks and marks that reverse the text.
/// Names come from untrusted files. All text for people passes through here; JSON has its own escapes.
pub(super) fn printable(line: &str) -> Cow<'_, str> {
    if !line.contains(is_interpreted) {
        return Cow::Borrowed(line);
    }
    let mut printable = String::with_capacity(2 * line.len());
    for character in line.chars() {
        match is_interpreted(character) {
            true => printable.extend(character.escape_default()),
            false => printable.push(character),
        }
    }
    Cow::Owned(printable)
}

/// Whether a character is a control character, a line separator or a bidirectional mark.
fn is_interpreted(character: char) -> bool {
    let is_mark =
        matches!(character, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    character.is_control() || is_mark
}
