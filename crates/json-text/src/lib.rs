//! What `serde_json` says in plain words, and where: joint maps and glTF files are written by people, too, who know neither Rust
//! nor its types.

#![forbid(unsafe_code)]
// Files are untrusted: whatever is wrong with them must be reported, never panic.
#![warn(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

/// Splits a message from the position that it ends with, as “line 3, column 4”.
pub fn split_position(message: &str) -> (&str, Option<String>) {
    match message.rsplit_once(" at line ") {
        Some((said, place)) => (said, Some(format!("line {}", place.replace(" column", ", column")))),
        None => (message, None),
    }
}

/// Returns what a value should have been and what it is; `None` if the text is not JSON at all. The message has no position.
pub fn expected_and_found(said: &str) -> Option<(String, String)> {
    if let Some(name) = said.strip_prefix("missing field ") {
        return Some((format!("a member {}", quoted(name)), "none".to_owned()));
    }
    // What follows the words, up to the comma, and what was expected.
    let parts = |words: &str| said.strip_prefix(words)?.split_once(", expected ");
    if let Some((length, expected)) = parts("invalid length ") {
        let is_object = expected.starts_with("struct ");
        let found = if is_object { "an array".to_owned() } else { format!("{length} elements") };
        return Some((expected_words(expected), found));
    }
    if let Some((name, known)) = parts("unknown variant ") {
        return Some((quoted(known), quoted(name)));
    }
    let (found, expected) = parts("invalid type: ").or_else(|| parts("invalid value: "))?;
    Some((expected_words(expected), found_words(found)))
}

/// The parser's message in plain words, without the position at its end.
pub fn message(problem: &serde_json::Error) -> String {
    plain(split_position(&problem.to_string()).0)
}

/// Rewrites a message without a position.
pub fn plain(said: &str) -> String {
    if said.starts_with("EOF while parsing") {
        return "it ends too soon (cut short?)".to_owned();
    }
    if let Some(name) = said.strip_prefix("missing field ") {
        return format!("the member {} is missing", quoted(name));
    }
    if let Some(name) = said.strip_prefix("duplicate field ") {
        return format!("{} appears twice; keep one of the two", quoted(name));
    }
    if let Some((name, known)) = said.strip_prefix("unknown field ").and_then(|rest| rest.split_once(", expected ")) {
        return format!("there is no member {} here; expected {}", quoted(name), quoted(known));
    }
    match expected_and_found(said) {
        Some((expected, found)) => format!("expected {expected}, found {found}"),
        None if said == "expected value" => "expected a JSON value".to_owned(),
        None if said == "key must be a string" => "expected the name of a member in quotation marks".to_owned(),
        None => quoted(said),
    }
}

fn expected_words(expected: &str) -> String {
    let words = match expected {
        "index into child of root" => "an index (0, 1, …)",
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number, 0 or more",
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number",
        "f32" | "f64" => "a number",
        "a boolean" => "true or false",
        "a sequence" => "an array",
        "a map" => "an object",
        "a sequence of 4 f32 values" => "an array of 4 numbers",
        _ if expected.starts_with("struct ") => "an object",
        _ => match expected.strip_prefix("any of: [").and_then(|list| list.strip_suffix(']')) {
            Some(list) => return format!("one of {}", curly(list, '"')),
            None => return quoted(expected),
        },
    };
    words.to_owned()
}

fn found_words(found: &str) -> String {
    let words = match found {
        "sequence" => "an array",
        "map" => "an object",
        "unit value" => "null",
        _ => {
            if let Some(text) = found.strip_prefix("string \"").and_then(|text| text.strip_suffix('"')) {
                return format!("“{text}”");
            }
            let number = ["integer ", "floating point ", "boolean "].iter().find_map(|kind| found.strip_prefix(kind));
            return number.map_or_else(|| quoted(found), |number| number.trim_matches('`').to_owned());
        }
    };
    words.to_owned()
}

/// Replaces backticks by quotation marks.
fn quoted(text: &str) -> String {
    curly(text, '`')
}

/// Replaces pairs of `mark` by quotation marks.
fn curly(text: &str, mark: char) -> String {
    let parts = text.split(mark).enumerate();
    parts.map(|(at, part)| if at % 2 == 1 { format!("“{part}”") } else { part.to_owned() }).collect()
}

/// The byte at a line and column, both from 1.
pub fn offset_of(text: &str, line: usize, column: usize) -> usize {
    let before: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    before + column
}

/// A step from a JSON value to one inside it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Step {
    /// By its name.
    Member(String),
    /// By its number.
    Element(usize),
}

/// The path to the value that a parser was reading when it stopped after `end` bytes.
pub fn path_at(text: &str, end: usize) -> Vec<Step> {
    let mut path = Vec::new();
    let mut at = 0;
    while at < end.min(text.len()) {
        let rest = &text[at..];
        let mut length = 1;
        match (rest.as_bytes()[0], path.last_mut()) {
            // Stopped at its beginning: what it is was the problem, not what is in it.
            (b'{' | b'[', _) if at + 1 >= end => {}
            (b'{', _) => path.push(Step::Member(String::new())),
            (b'[', _) => path.push(Step::Element(0)),
            (b'}' | b']', _) => drop(path.pop()),
            (b',', Some(Step::Member(key))) => key.clear(),
            (b',', Some(Step::Element(index))) => *index += 1,
            (b'"', last) => {
                length = string_length(rest);
                let string = &rest[..length];
                if let (Some(Step::Member(key)), true) = (last, rest[length..].trim_start().starts_with(':')) {
                    *key = serde_json::from_str(string).unwrap_or_default();
                }
            }
            _ => {}
        }
        at += length.max(rest.chars().next().map_or(1, char::len_utf8));
    }
    path
}

/// Bytes of the string that the text begins with, with its quotation marks.
fn string_length(text: &str) -> usize {
    let mut escaped = false;
    for (at, letter) in text.char_indices().skip(1) {
        match letter {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// A path as messages have it: `meshes[0].primitives[1].mode`.
pub fn place(path: &[Step]) -> String {
    let mut place = String::new();
    for step in path {
        match step {
            Step::Member(key) if key.is_empty() => {}
            Step::Member(key) if place.is_empty() => place.push_str(key),
            Step::Member(key) => place.extend([".", key]),
            Step::Element(index) => place.push_str(&format!("[{index}]")),
        }
    }
    place
}

#[cfg(test)]
mod tests {
    use crate::{plain, split_position};

    #[test]
    fn messages_have_no_types_of_rust() {
        for (message, expected) in [
            ("invalid length 0, expected struct Primitive with 7 elements", "expected an object, found an array"),
            ("invalid type: integer `3`, expected struct Primitive", "expected an object, found 3"),
            ("invalid value: integer `-3`, expected usize", "expected a whole number, 0 or more, found -3"),
            ("invalid type: string \"x\", expected f32", "expected a number, found “x”"),
            ("invalid length 2, expected an array of length 3", "expected an array of length 3, found 2 elements"),
            ("invalid type: map, expected a sequence", "expected an array, found an object"),
            ("invalid type: integer `0`, expected any of: [\"A\", \"B\"]", "expected one of “A”, “B”, found 0"),
            (
                "invalid type: string \"x\", expected \"rest\" or {\"clip\": NAME}",
                "expected \"rest\" or {\"clip\": NAME}, found “x”",
            ),
            ("missing field `count`", "the member “count” is missing"),
            ("duplicate field `count`", "“count” appears twice; keep one of the two"),
            ("EOF while parsing a list", "it ends too soon (cut short?)"),
            ("expected `,` or `}`", "expected “,” or “}”"),
        ] {
            assert_eq!(plain(message), expected);
        }
        assert_eq!(split_position("odd at line 3 column 4"), ("odd", Some("line 3, column 4".to_owned())));
    }
}
