//! The GLB container: a header of 12 bytes ("glTF", version, length), then chunks of (length, type, data). The first is JSON,
//! an optional second is the binary buffer (glTF 2.0 §4.4).

use crate::asset::{Warning, Warnings};
use crate::formats::LoadError;

/// JSON text and binary chunk of a file, which is a GLB or plain JSON.
pub struct Container<'a> {
    pub json: &'a [u8],
    pub binary: Option<&'a [u8]>,
    pub is_glb: bool,
    /// Byte offset of the first chunk whose kind occurred before.
    repeated_chunk: Option<usize>,
}

impl Container<'_> {
    /// Reports chunks that are ignored.
    pub fn warn(&self, warnings: &mut Warnings) {
        if let Some(at) = self.repeated_chunk {
            let (place, problem) =
                (format!("GLB chunk at byte {at}"), "a second one of its kind; only the first is read");
            warnings.push(Warning::Other { code: "repeated-chunk", place, problem: problem.to_owned() });
        }
    }
}

const JSON_CHUNK: u32 = 0x4E4F_534A;
const BINARY_CHUNK: u32 = 0x004E_4942;

pub fn open<'a>(file: &str, bytes: &'a [u8]) -> Result<Container<'a>, LoadError> {
    let invalid = |place: &str, expected: &str, found: String| LoadError::Invalid {
        file: file.to_owned(),
        place: place.to_owned(),
        expected: expected.to_owned(),
        found,
    };
    if bytes.is_empty() {
        return Err(invalid("the whole file", "a glTF", "nothing: it is empty".to_owned()));
    }
    if !bytes.starts_with(b"glTF") {
        // Truncated or misspelt text is left to the JSON parser, which knows the place.
        if let Some(first) = bytes.trim_ascii_start().first().filter(|byte| byte.is_ascii_alphabetic()) {
            let found = format!("text that begins with “{}”", char::from(*first));
            return Err(invalid(
                "the whole file",
                "a GLB, which begins with “glTF”, or JSON, which begins with “{”",
                found,
            ));
        }
        return Ok(Container { json: without_bom(bytes), binary: None, is_glb: false, repeated_chunk: None });
    }
    let word = |at: usize| {
        let four = bytes.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes([four[0], four[1], four[2], four[3]]))
    };
    let header = || invalid("GLB header", "12 bytes", format!("{}", bytes.len()));
    let (version, length) = word(4).zip(word(8)).ok_or_else(header)?;
    match version {
        2 => {}
        0 | 1 => return Err(LoadError::UnsupportedVersion { file: file.to_owned(), found: format!("{version}.0") }),
        _ => return Err(invalid("GLB header", "version 2", format!("version {version} (not a GLB, or damaged?)"))),
    }
    let length = length as usize;
    if length > bytes.len() {
        return Err(invalid("GLB header", &format!("{length} bytes in all"), format!("{} (cut short?)", bytes.len())));
    }
    let (mut at, mut json, mut binary, mut repeated_chunk) = (12, None, None, None);
    while at + 8 <= length {
        let (size, kind) = (word(at).unwrap_or(0) as usize, word(at + 4).unwrap_or(0));
        let data = (at + 8).checked_add(size).and_then(|end| bytes[..length].get(at + 8..end)).ok_or_else(|| {
            invalid(&format!("GLB chunk at byte {at}"), &format!("{size} bytes"), format!("{}", length - at - 8))
        })?;
        match kind {
            JSON_CHUNK if json.is_none() => json = Some(data),
            BINARY_CHUNK if binary.is_none() => binary = Some(data),
            JSON_CHUNK | BINARY_CHUNK => repeated_chunk = repeated_chunk.or(Some(at)),
            _ => {}
        }
        at += 8 + size;
    }
    let json = json.ok_or_else(|| invalid("GLB", "a JSON chunk", "none".to_owned()))?;
    Ok(Container { json: without_bom(json), binary, is_glb: true, repeated_chunk })
}

fn without_bom(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)
}
