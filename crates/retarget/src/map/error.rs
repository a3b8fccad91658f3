//! What can be wrong with a joint map.

use gaitway_json_text as json_text;

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
    #[error("{}{}", prefix(.path), plain(.message))]
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
        "the model and the motion have no joint in common: neither names nor body parts agree. Map joints manually, in the Motion tab or in a map (docs/joint-maps.md)"
    )]
    NothingInCommon,
}

impl MapError {
    /// The JSON path of the error; `None` if it concerns the whole map.
    pub fn path(&self) -> Option<&str> {
        match self {
            Self::Json { path, .. } => Some(path.as_str()).filter(|path| *path != "."),
            Self::NoTarget { path, .. }
            | Self::NoSource { path, .. }
            | Self::TargetOutOfRange { path, .. }
            | Self::SourceOutOfRange { path, .. }
            | Self::AmbiguousTarget { path, .. }
            | Self::AmbiguousSource { path, .. }
            | Self::SameTarget { path, .. }
            | Self::NoClip { path, .. }
            | Self::Correction { path, .. } => Some(path),
            Self::Version { .. } => Some("gaitway_map"),
            Self::Crossfade { .. } => Some("crossfade_secs"),
            Self::NotJson { .. } | Self::NotAMap | Self::NothingMapped | Self::NothingInCommon => None,
        }
    }

    /// Returns what was expected and what was found, if a member has the wrong type or value.
    pub fn expected_and_found(&self) -> Option<(String, String)> {
        match self {
            Self::Json { message, .. } => json_text::expected_and_found(json_text::split_position(message).0),
            Self::Version { found } => Some(("1".to_owned(), found.clone())),
            Self::Crossfade { found } => Some(("0 or more".to_owned(), found.to_string())),
            _ => None,
        }
    }
}

/// `serde_json`'s message in plain words.
fn plain(message: &str) -> String {
    let (said, place) = json_text::split_position(message);
    let place = place.map_or_else(String::new, |place| format!(" ({place})"));
    json_text::plain(said) + &place
}

/// The path and a colon; nothing for the map itself.
fn prefix(path: &str) -> String {
    if path == "." { String::new() } else { format!("{path}: ") }
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
