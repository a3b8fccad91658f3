//! Links of views that call their clips as links do, so that no library is needed.

use gaitway_scene::library::Library;
use gaitway_scene::state::{LinkError, ViewerState, from_object, to_link, to_object};
use serde_json::Value;

/// The link of a view.
pub fn link_of(state: &ViewerState) -> String {
    to_link(state, &Library::default())
}

/// All keys of the link as JSON.
pub fn object_of(state: &ViewerState) -> Value {
    to_object(state, &Library::default())
}

/// The view with some keys of the link replaced.
pub fn with_keys(base: &ViewerState, partial: &Value) -> (ViewerState, Vec<LinkError>) {
    from_object(base, &Library::default(), partial)
}
