//! The GLB container: a header of 12 bytes ("glTF", version, length), then chunks of (length, type, data). The first is JSON,
//! an optional second is the binary buffer (glTF 2.0 §4.4).

use gaitway_character::asset::{Warning, Warnings};

use crate::LoadError;

/// JSON text and binary chunk of a file, which is a GLB or plain JSON.
pub struct Container<'a> {
    pub json: &'a [u8],
    pub binary: Option<&'a [u8]>,
    pub is_glb: bool,
    /// The images have not arrived yet; see [`LoadOptions`](crate::LoadOptions).
    pub awaits_images: bool,
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

/// The beginning of a GLB, up to its binary chunk.
pub struct Beginning<'a> {
    /// Without the binary chunk.
    pub container: Container<'a>,
    /// Byte offset of the binary chunk's data.
    pub binary_at: usize,
    /// Of the whole file, as its header says.
    pub length: usize,
}

/// Reads the JSON of a file of which only the `start` is there, or returns how many bytes that takes. `None` if it is no GLB, or
/// has no binary chunk after its JSON.
pub fn begin(start: &[u8]) -> Option<Result<Beginning<'_>, usize>> {
    if !start.starts_with(&b"glTF"[..start.len().min(4)]) {
        return None;
    }
    let header = |at: usize| word(start, at).zip(word(start, at + 4));
    let Some(((_, length), (size, kind))) = header(4).zip(header(12)) else { return Some(Err(20)) };
    let end = (size as usize).checked_add(20)?;
    let binary_at = end.checked_add(8).filter(|&at| kind == JSON_CHUNK && at <= length as usize)?;
    let Some((_, kind)) = header(end) else { return Some(Err(binary_at)) };
    let container = Container {
        json: without_bom(&start[20..end]),
        binary: None,
        is_glb: true,
        awaits_images: true,
        repeated_chunk: None,
    };
    (kind == BINARY_CHUNK).then_some(Ok(Beginning { container, binary_at, length: length as usize }))
}

/// Returns a GLB that ends inside its binary chunk, whose data is at `binary_at`, with the lengths corrected.
pub fn shortened(start: &[u8], binary_at: usize) -> Vec<u8> {
    let mut bytes = start.to_vec();
    for (at, length) in [(8, start.len()), (binary_at - 8, start.len() - binary_at)] {
        bytes[at..at + 4].copy_from_slice(&(length as u32).to_le_bytes());
    }
    bytes
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..at.checked_add(4)?)?.try_into().ok().map(u32::from_le_bytes)
}

pub fn open<'a>(file: &str, bytes: &'a [u8]) -> Result<Container<'a>, LoadError> {
    let invalid = |place: &str, expected: &str, found: String| LoadError::Invalid {
        file: file.to_owned(),
        place: place.to_owned(),
        expected: expected.to_owned(),
        found,
    };
    if !bytes.starts_with(b"glTF") {
        return match other_content(bytes) {
            Some(found) => Err(invalid("", "a GLB, which begins with “glTF”, or JSON, which begins with “{”", found)),
            None => Ok(Container {
                json: without_bom(bytes),
                binary: None,
                is_glb: false,
                awaits_images: false,
                repeated_chunk: None,
            }),
        };
    }
    let word = |at| word(bytes, at);
    let header = || invalid("GLB header", "12 bytes", format!("{}", bytes.len()));
    let (version, length) = word(4).zip(word(8)).ok_or_else(header)?;
    match version {
        2 => {}
        0 | 1 => return Err(LoadError::UnsupportedVersion { file: file.to_owned(), found: format!("{version}.0") }),
        _ => return Err(invalid("GLB header", "version 2", format!("version {version} (not a GLB, or damaged?)"))),
    }
    let length = length as usize;
    if length > bytes.len() {
        return Err(invalid(
            "GLB header",
            &format!("{length} bytes in all"),
            format!("{} (cut short?); download or save it again", bytes.len()),
        ));
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
    Ok(Container { json: without_bom(json), binary, is_glb: true, awaits_images: false, repeated_chunk })
}

/// Returns what a file without the header of a GLB contains; `None` for anything that may be JSON. Truncated or misspelt
/// JSON is left to its parser, which knows the place.
fn other_content(bytes: &[u8]) -> Option<String> {
    const KNOWN: [(&[u8], &str); 11] = [
        (b"\x89PNG", "a PNG image"),
        (b"\xff\xd8\xff", "a JPEG image"),
        (b"GIF8", "a GIF image"),
        (b"RIFF", "a RIFF file, such as a WebP image"),
        (b"PK", "a .zip archive; name it .zip"),
        (b"\x1f\x8b", "a gzip archive; unpack it first"),
        (b"7z\xbc\xaf", "a 7-Zip archive; unpack it first"),
        (b"Rar!", "a RAR archive; unpack it first"),
        (b"BLENDER", "a Blender file; export glTF 2.0 (.glb) from Blender"),
        (b"%PDF", "a PDF document"),
        (b"version https://git-lfs", "a Git LFS pointer; fetch the file itself with “git lfs pull”"),
    ];
    if let Some((_, kind)) = KNOWN.iter().find(|(start, _)| bytes.starts_with(start)) {
        return Some((*kind).to_owned());
    }
    match without_bom(bytes).trim_ascii_start() {
        [] => Some("nothing: the file is empty".to_owned()),
        [b'<', ..] => Some("a web page or XML; the address may lead to a page about the file".to_owned()),
        [first, ..] if first.is_ascii_alphabetic() => Some(format!("text that begins with “{}”", char::from(*first))),
        [first, ..] if !first.is_ascii_graphic() => Some(format!("binary data that begins with byte 0x{first:02x}")),
        _ => None,
    }
}

fn without_bom(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)
}
