//! `gaitway inspect`: summarizes a model.

use gaitway_scene::library::inspect;
use serde_json::Value;

use super::failure::Outcome;
use super::output::{print_json, print_lines, warn};
use super::{InspectArguments, open};
use crate::files::{Disk, Opened};

pub(super) fn run(arguments: &InspectArguments, disk: &Disk) -> Outcome {
    let opened = open(&arguments.input.files, disk)?;
    let document = inspect(&opened.model, &opened.files);
    // The reader's warnings have been printed.
    for finding in opened.model.findings().iter().skip(opened.model.asset.warnings.len()) {
        warn(&format!("{}: {}", opened.model.source, finding.warning));
    }
    if arguments.json {
        return print_json(&document);
    }
    print_lines(lines(&opened, &document))
}

/// Formats the summary for people; scripts read the JSON.
fn lines(opened: &Opened, document: &Value) -> Vec<String> {
    let asset = &opened.model.asset;
    let mut lines = Vec::new();
    let mut line = |name: &str, value: String| lines.push(format!("{name:<12}{value}"));
    let number = |key: &str| document[key].to_string();
    line("files", opened.files.join(", "));
    line("format", asset.format.to_owned());
    if !asset.generator.is_empty() {
        line("generator", asset.generator.clone());
    }
    line("nodes", number("nodes"));
    line("joints", format!("{} in {} skins", number("joints"), asset.skins.len()));
    line("meshes", format!("{} ({} primitives)", number("meshes"), number("primitives")));
    line("vertices", number("vertices"));
    line("triangles", number("triangles"));
    line("morphs", number("morph_targets"));
    line("cameras", number("cameras"));
    if !asset.variants.is_empty() {
        line("variants", asset.variants.join(", "));
    }
    let avatar = &asset.avatar;
    for (key, value) in &avatar.meta {
        line("avatar", format!("{key}: {value}"));
    }
    if !avatar.expressions.is_empty() {
        let names: Vec<&str> = avatar.expressions.iter().map(|expression| &*expression.name).collect();
        line("expressions", names.join(", "));
    }
    for (joint, flag) in &avatar.first_person {
        line("1st person", format!("{}: {flag}", asset.skeleton.label(*joint)));
    }
    if !asset.extensions_used.is_empty() {
        line("extensions", asset.extensions_used.join(", "));
    }
    let bounds = opened.model.rest_bounds();
    if !bounds.is_empty() {
        let size = bounds.size();
        line(
            "size",
            format!("{:.3} × {:.3} × {:.3} m, from {:.3} to {:.3}", size.x, size.y, size.z, bounds.min, bounds.max),
        );
    }
    for (index, title) in opened.model.clips().titles().enumerate() {
        let clip = &asset.clips[index];
        line(
            &format!("clip {index}"),
            format!(
                "{title}, {:.3} s, {} channels",
                clip.duration_secs(),
                clip.channels().len() + clip.properties().len()
            ),
        );
    }
    lines
}
