//! What the page says it opens, to people and to systems, is what it opens.

use std::collections::BTreeSet;
use std::fs;

use gaitway::files::extensions;
use serde_json::Value;

fn read(path: &str) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn all() -> BTreeSet<String> {
    extensions().map(|extension| format!(".{extension}")).collect()
}

/// The texts in a list that are extensions.
fn listed(values: &Value) -> impl Iterator<Item = String> + '_ {
    let texts = values.as_array().expect("a list").iter().map(|text| text.as_str().expect("a text").to_owned());
    texts.filter(|text| text.starts_with('.'))
}

#[test]
fn systems_are_told_of_everything_that_opens() {
    let manifest: Value = serde_json::from_str(&read("web/manifest.webmanifest")).expect("JSON");
    let handled = manifest["file_handlers"][0]["accept"].as_object().expect("types").values();
    assert_eq!(handled.flat_map(listed).collect::<BTreeSet<_>>(), all(), "file_handlers");
    let shared = &manifest["share_target"]["params"]["files"][0]["accept"];
    assert_eq!(listed(shared).collect::<BTreeSet<_>>(), all(), "share_target");
}

/// Joint maps are only mentioned where motions are chosen.
#[test]
fn people_are_told_of_everything_that_opens() {
    let missing = |path: &str| {
        let text = read(path);
        all().into_iter().filter(|extension| !text.contains(extension.as_str())).collect::<Vec<_>>()
    };
    for path in ["web/shell/open-dialog.js", "docs/hosting.md"] {
        assert_eq!(missing(path), [""; 0], "{path}");
    }
}
