//! What can be wrong with a joint map.

/// Why a joint map cannot be read or does not fit a model and a motion. `path` is the place in the map's JSON.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MapError {
    #[error("not JSON: {message}")]
    NotJson { message: String },
    #[error("not a joint map: it has no “gaitway_map”")]
    NotAMap,
    #[error("gaitway_map is {found}; this program reads version 1")]
    Version { found: String },
    #[error("{path}: {message}")]
    Json { path: String, message: String },
    #[error("{path}: the model has no joint “{name}”{}", nearest_text(.nearest))]
    NoTarget { path: String, name: String, nearest: Vec<String> },
    #[error("{path}: the motion has no joint “{name}”{}", nearest_text(.nearest))]
    NoSource { path: String, name: String, nearest: Vec<String> },
    #[error("{path}: the model has no node {number}: it has {count}, numbered from 0")]
    TargetOutOfRange { path: String, number: String, count: usize },
    #[error("{path}: the motion has no channel {number}: it has {count} joints, 0 to {}", .count.saturating_sub(1))]
    SourceOutOfRange { path: String, number: usize, count: usize },
    #[error("{path}: {} joints of the model are called “{name}”: write one of {}", .numbers.len(), numbers_text(.numbers, "#"))]
    AmbiguousTarget { path: String, name: String, numbers: Vec<usize> },
    #[error("{path}: {} joints of the motion are called “{name}”: write one of their numbers, {}", .numbers.len(), numbers_text(.numbers, ""))]
    AmbiguousSource { path: String, name: String, numbers: Vec<usize> },
    #[error("{path}: “{first}” and “{second}” are the same joint of the model; keep one of them")]
    SameTarget { path: String, first: String, second: String },
    #[error("{path}: the model has no clip {clip}; it has {}", clips_text(.clips))]
    NoClip { path: String, clip: String, clips: Vec<String> },
    #[error(
        "{path}: expected four finite numbers, not all zero; found [{}, {}, {}, {}]",
        .found[0], .found[1], .found[2], .found[3]
    )]
    Correction { path: String, found: [f32; 4] },
    #[error("crossfade_secs is {found}; it must be 0 or more")]
    Crossfade { found: f64 },
    #[error("no joint of the model follows the motion: the map names no source")]
    NothingMapped,
    #[error(
        "the model and the motion have no joint in common: neither names nor body parts agree. Write a map by hand, as docs/joint-maps.md says"
    )]
    NothingInCommon,
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
