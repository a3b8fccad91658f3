//! `gaitway pose`: prints a pose as numbers.

use gaitway_scene::frame::{NodePose, PoseDocument};

use super::failure::Outcome;
use super::moment::apply_moment;
use super::motion::{apply_link, open_editor};
use super::output::{print_bytes, print_lines};
use super::{PoseArguments, open};
use crate::files::Disk;

pub(super) fn run(arguments: &PoseArguments, disk: &Disk) -> Outcome {
    let mut editor = open_editor(open(&arguments.input.files, disk)?, &arguments.motion, disk)?;
    if let Some(link) = &arguments.view {
        apply_link(&mut editor, link, &arguments.motion, arguments.moment.overrides(), disk)?;
    }
    apply_moment(&mut editor, &arguments.moment, arguments.motion.motion.is_some())?;
    let document = PoseDocument::new(editor.library(), editor.state());
    if arguments.json {
        return print_bytes(format!("{document}\n").as_bytes());
    }
    let clip = document.clip.as_deref().unwrap_or("rest pose");
    let title = format!("{clip} at {} s; world positions of the nodes in metres:", document.time_secs);
    let line = |NodePose { node, name, world }: &NodePose| {
        format!("{node:>5} {name:<32} {:>10.4} {:>10.4} {:>10.4}", world[12], world[13], world[14])
    };
    print_lines([title].into_iter().chain(document.nodes.iter().map(line)))
}
