//! Files that end before their content does, as interrupted downloads leave them. ufbx says only that it failed, at whatever
//! part it was reading; where a file is cut off follows from its outermost structure.
//!
//! Binary: after 27 bytes, records, each of which begins with the offset of its end: 4 bytes, from version 7500 on 8. A
//! record of zeros ends the list. Text: sections in braces; strings in quotes and comments, which begin with a
//! semicolon, may contain others.

const HEAD: &[u8] = b"Kaydara FBX Binary  \0\x1a\0";
const FIRST_RECORD: usize = 27;
/// The first version with offsets of 8 bytes.
const WIDE_VERSION: u32 = 7500;

/// Says where the file is cut off; `None` if its outermost structure is whole.
pub fn problem(bytes: &[u8]) -> Option<String> {
    let problem = if bytes.starts_with(HEAD) { in_records(bytes) } else { in_sections(bytes) }?;
    Some(format!("the FBX file is cut off {problem}. Copy or download it again, or export it again."))
}

fn in_records(bytes: &[u8]) -> Option<String> {
    let version = u32::from_le_bytes(bytes.get(23..FIRST_RECORD)?.try_into().ok()?);
    let width = if version >= WIDE_VERSION { 8 } else { 4 };
    let mut at = FIRST_RECORD;
    while let Some(head) = bytes.get(at..at + 3 * width + 1) {
        let mut place = [0; 8];
        place[..width].copy_from_slice(&head[..width]);
        let end = usize::try_from(u64::from_le_bytes(place)).ok()?;
        // The end of the list, or damage of another kind.
        if end <= at {
            return None;
        }
        if end > bytes.len() {
            let name = at + head.len()..at + head.len() + usize::from(head[3 * width]);
            let name = bytes.get(name).map(String::from_utf8_lossy).unwrap_or_default();
            return Some(format!("in its part \"{name}\": expected at least {end} bytes, found {}", bytes.len()));
        }
        at = end;
    }
    Some(format!("after {} bytes: expected another part or the end of the list, found neither", bytes.len()))
}

fn in_sections(bytes: &[u8]) -> Option<String> {
    let (mut depth, mut line, mut is_string, mut is_comment) = (0_usize, 1, false, false);
    for byte in bytes {
        match byte {
            b'\n' => {
                line += 1;
                is_comment = false;
            }
            _ if is_comment => {}
            b'"' => is_string = !is_string,
            _ if is_string => {}
            b';' => is_comment = true,
            b'{' => depth += 1,
            b'}' => depth = depth.checked_sub(1)?,
            _ => {}
        }
    }
    let what = if depth == 1 { "brace" } else { "braces" };
    let found = "found the end of the file";
    (depth > 0).then(|| format!("in line {line}: expected {depth} more closing {what}, {found}"))
}
