//! Finds tails and ears, which have no slots: by their names and by the slot that they hang on.

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::Slot;

use super::{ChainPart, Form};
use crate::pose::ancestry;
use crate::recognize::Name;

/// Maximum number of joints: tails have a dozen, damaged files may have thousands.
const MAX_JOINTS: usize = 64;

/// Returns the joints of each appendage, from root to tip. A body with several tails has none here: nothing says which one follows
/// which.
pub fn find(form: &Form) -> Vec<(ChainPart, Vec<JointIndex>)> {
    let mut roots: Vec<(ChainPart, JointIndex)> = Vec::new();
    let mut several: Vec<ChainPart> = Vec::new();
    for joint in form.skeleton.joints() {
        let Some(part) = part_of(form, joint) else { continue };
        let is_below_another = || {
            let parent = form.skeleton.parent(joint);
            parent.and_then(|parent| part_of(form, parent)) == Some(part)
        };
        if is_below_another() {
            continue;
        }
        if roots.iter().any(|(other, _)| *other == part) {
            several.push(part);
        } else {
            roots.push((part, joint));
        }
    }
    roots.retain(|(part, _)| !several.contains(part));
    roots.into_iter().map(|(part, root)| (part, chain(form, root))).collect()
}

/// The appendage that a joint belongs to by its name.
fn part_of(form: &Form, joint: JointIndex) -> Option<ChainPart> {
    if !form.moves_skin[joint.get()] || form.carries_slot[joint.get()] {
        return None;
    }
    let name = Name::read(form.skeleton.name(joint));
    let part = match name.side {
        // Coats have two tails, one on each side.
        None if name.has("tail") => ChainPart::Tail,
        Some(side) if name.has("ear") => ChainPart::Ear(side),
        _ => return None,
    };
    // The tail of a pony hangs on its hips, a ponytail on a head.
    let above = ancestry(form.skeleton, joint).take(MAX_JOINTS).find_map(|above| form.slots.slot(above))?;
    let is_there = match part {
        ChainPart::Tail => matches!(above, Slot::Hips | Slot::Spine),
        _ => above == Slot::Head,
    };
    is_there.then_some(part)
}

/// The joints from a root to where the appendage ends or forks.
fn chain(form: &Form, root: JointIndex) -> Vec<JointIndex> {
    let mut joints = vec![root];
    let mut last = root;
    while joints.len() < MAX_JOINTS {
        let is_next = |joint: &JointIndex| form.skeleton.parent(*joint) == Some(last) && form.moves_skin[joint.get()];
        let mut below = form.skeleton.joints().filter(is_next);
        let (Some(next), None) = (below.next(), below.next()) else { break };
        joints.push(next);
        last = next;
    }
    joints
}
