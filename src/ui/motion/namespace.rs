//! What the names of all joints of a file begin with.

use std::collections::HashSet;

use gaitway_character::asset::Asset;

/// The namespace of all joints that have one, such as `mixamorig:`; omitted from rows to save room. Empty if names would be the
/// same without it.
pub(in crate::ui) fn namespace(asset: &Asset) -> &str {
    let names = || asset.skeleton.joints().map(|joint| asset.skeleton.name(joint));
    let Some(first) = names().find(|name| name.contains(':')) else { return "" };
    let all: HashSet<&str> = names().collect();
    let namespace = &first[..=first.rfind(':').unwrap_or(0)];
    let is_clear = |name: &str| match name.strip_prefix(namespace) {
        Some(rest) => !rest.contains(':') && !all.contains(rest),
        None => !name.contains(':'),
    };
    if names().all(is_clear) { namespace } else { "" }
}
