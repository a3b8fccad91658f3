//! What can be wrong with a joint map.

/// Why a joint map cannot be read or does not fit a model and a motion.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MapError {
    /// The text is not JSON.
    #[error("not JSON: {}", plain(.message))]
    NotJson {
        /// `serde_json`'s message, with line and column.
        message: String,
    },
    /// JSON without a `gaitway_map` member.
    #[error("not a joint map: expected a JSON object with “gaitway_map” (1) and “joints”")]
    NotAMap,
    /// A version of the format other than 1.
    #[error("gaitway_map is {found}; this program reads version 1")]
    Version {
        /// The value of `gaitway_map`, as JSON text.
        found: String,
    },
    /// A member has the wrong type or value, is unknown, or appears twice.
    #[error("{path}: {}", plain(.message))]
    Json {
        /// JSON path, such as `joints.head.source`.
        path: String,
        /// `serde_json`'s message: what it expected and found.
        message: String,
    },
    /// A key of `joints` is not the name of a joint of the model.
    #[error("{path}: the model has no joint “{name}”{}", nearest_text(.nearest))]
    NoTarget {
        /// JSON path of the entry, such as `joints.head`.
        path: String,
        /// The name as written.
        name: String,
        /// The most similar joint names, best first, at most three; empty if none is similar.
        nearest: Vec<String>,
    },
    /// A source is not the name of a joint of the motion.
    #[error("{path}: the motion has no joint “{name}”{}", nearest_text(.nearest))]
    NoSource {
        /// JSON path of the reference, such as `joints.head.source` or `muted_channels[0].source`.
        path: String,
        /// The name as written.
        name: String,
        /// The most similar joint names, best first, at most three; empty if none is similar.
        nearest: Vec<String>,
    },
    /// A `#NODE` key is not the number of a joint of the model.
    #[error("{path}: the model has no node {number}: it has {count}, numbered from 0")]
    TargetOutOfRange {
        /// JSON path of the entry, such as `joints.#3`.
        path: String,
        /// The text after `#`, which need not be a number.
        number: String,
        /// Number of the model's joints.
        count: usize,
    },
    /// A source number is not that of a joint of the motion.
    #[error("{path}: the motion has no joint {number}: it has {count}, 0 to {}", .count.saturating_sub(1))]
    SourceOutOfRange {
        /// JSON path of the reference, such as `joints.head.source` or `muted_channels[0].source`.
        path: String,
        /// The number as written.
        number: usize,
        /// Number of the motion's joints.
        count: usize,
    },
    /// Several joints of the model share this name.
    #[error("{path}: {} joints of the model are called “{name}”: write one of {}", .numbers.len(), numbers_text(.numbers, "#"))]
    AmbiguousTarget {
        /// JSON path of the entry, such as `joints.head`.
        path: String,
        /// The name as written.
        name: String,
        /// Their numbers in the file, ascending.
        numbers: Vec<usize>,
    },
    /// Several joints of the motion share this name.
    #[error("{path}: {} joints of the motion are called “{name}”: write one of their numbers, {}", .numbers.len(), numbers_text(.numbers, ""))]
    AmbiguousSource {
        /// JSON path of the reference, such as `joints.head.source` or `muted_channels[0].source`.
        path: String,
        /// The name as written.
        name: String,
        /// Their numbers in the file, ascending.
        numbers: Vec<usize>,
    },
    /// Two keys of `joints` name the same joint, for example one by its name and one by `#NODE`.
    #[error("{path}: “{first}” and “{second}” are the same joint of the model; keep one of them")]
    SameTarget {
        /// JSON path of the second entry.
        path: String,
        /// Key of the first entry.
        first: String,
        /// Key of the second entry.
        second: String,
    },
    /// An `unmapped` option names a clip that the model does not have.
    #[error("{path}: the model has no clip {clip}; it has {}", clips_text(.clips))]
    NoClip {
        /// JSON path, such as `unmapped.clip` or `joints.head.unmapped.clip`.
        path: String,
        /// The index as written, or the name in quotation marks.
        clip: String,
        /// Names of the model's clips, by index.
        clips: Vec<String>,
    },
    /// A rotation offset is not finite or too short to normalize.
    #[error(
        "{path}: expected four finite numbers, not all zero; found [{}, {}, {}, {}]",
        .found[0], .found[1], .found[2], .found[3]
    )]
    Correction {
        /// JSON path, such as `joints.head.correction`.
        path: String,
        /// The quaternion as written: x, y, z, w.
        found: [f32; 4],
    },
    /// The crossfade is negative or not finite.
    #[error("crossfade_secs is {found}; it must be 0 or more")]
    Crossfade {
        /// The value as written, in seconds.
        found: f64,
    },
    /// No entry of the map has a source.
    #[error("no joint of the model follows the motion: the map names no source")]
    NothingMapped,
    /// The proposed map has no pairs.
    #[error(
        "the model and the motion have no joint in common: neither names nor body parts agree. Write a map by hand, as docs/joint-maps.md says"
    )]
    NothingInCommon,
}

/// Rewrites `serde_json`'s message without its technical terms: “unknown field `sorce`, expected one of …”.
fn plain(message: &str) -> String {
    let (said, place) = match message.rsplit_once(" at line ") {
        Some((said, place)) => (said, format!(" (line {})", place.replace(" column", ", column"))),
        None => (message, String::new()),
    };
    // What follows the words, up to the comma, and what was expected.
    let parts = |words: &str| said.strip_prefix(words)?.split_once(", expected ");
    let text = if said.starts_with("EOF while parsing") {
        "it ends too soon (cut short?)".to_owned()
    } else if let Some((name, known)) = parts("unknown field ") {
        format!("there is no member {name} here; expected {known}")
    } else if let Some((value, known)) = parts("unknown variant ") {
        format!("expected {known}, found {value}")
    } else if let Some((found, expected)) = parts("invalid type: ").or_else(|| parts("invalid value: ")) {
        format!("expected {expected}, found {found}")
    } else if let Some(name) = said.strip_prefix("missing field ") {
        format!("the member {name} is missing")
    } else {
        said.to_owned()
    };
    format!("{}{place}", quoted(&text))
}

/// Replaces backticks by quotation marks.
fn quoted(text: &str) -> String {
    let parts = text.split('`').enumerate();
    parts.map(|(at, part)| if at % 2 == 1 { format!("“{part}”") } else { part.to_owned() }).collect()
}

fn nearest_text(nearest: &[String]) -> String {
    if nearest.is_empty() { String::new() } else { format!("; nearest: {}", nearest.join(", ")) }
}

fn numbers_text(numbers: &[usize], mark: &str) -> String {
    numbers.iter().map(|number| format!("{mark}{number}")).collect::<Vec<_>>().join(", ")
}

fn clips_text(clips: &[String]) -> String {
    if clips.is_empty() {
        return "none".to_owned();
    }
    let named = clips.iter().enumerate().map(|(index, name)| format!("{index} “{name}”"));
    named.collect::<Vec<_>>().join(", ")
}
