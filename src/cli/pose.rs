//! `gaitway pose`: prints a pose as numbers.

use std::fmt::Write;

use super::failure::Outcome;
use super::motion::{apply_link, open_editor};
use super::output::{print_bytes, print_json};
use super::{PoseArguments, apply_moment, open};
use crate::files::Disk;
use crate::frame::pose_document;

pub(super) fn run(arguments: &PoseArguments, disk: &Disk) -> Outcome {
    let mut editor = open_editor(open(&arguments.input.files, disk)?, &arguments.motion, disk)?;
    if let Some(link) = &arguments.view {
        apply_link(&mut editor, link, &arguments.motion, arguments.moment.clip.is_some(), disk)?;
    }
    apply_moment(&mut editor, &arguments.moment, arguments.motion.motion.is_some())?;
    let document = pose_document(editor.library(), editor.state());
    if arguments.json {
        return print_json(&document);
    }
    let mut text = String::new();
    let clip = document["clip"].as_str().unwrap_or("rest pose");
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{clip} at {} s; world positions of the nodes in metres:", document["time_secs"]);
    for node in document["nodes"].as_array().into_iter().flatten() {
        let name = node["name"].as_str().unwrap_or_default();
        let at = |index: usize| node["world"][index].as_f64().unwrap_or(f64::NAN);
        let _ = writeln!(text, "{:>5} {name:<32} {:>10.4} {:>10.4} {:>10.4}", node["node"], at(12), at(13), at(14));
    }
    print_bytes(text.as_bytes())
}
