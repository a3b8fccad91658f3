//! Joints that have the same name in two skeletons.

use std::collections::{BTreeMap, BTreeSet};

use gaitway_character::anim::{JointIndex, Skeleton};
use gaitway_character::sort::collect_map;

use crate::recognize::Name;

/// Returns the joints with the same name in both skeletons, target to source. Names that several joints share count if
/// their parents match; what exporters do to names is ignored where the result is unambiguous.
pub fn shared_names(model: &Skeleton, motion: &Skeleton) -> BTreeMap<JointIndex, JointIndex> {
    let is_same = |joint: JointIndex| model.name(joint) == motion.name(joint);
    if model.parents() == motion.parents() && model.joints().all(is_same) {
        return collect_map(model.joints().map(|joint| (joint, joint)));
    }
    let mut found = BTreeMap::new();
    let mut taken = BTreeSet::new();
    let readings: [fn(&str) -> String; 2] = [str::to_owned, normalized];
    for read in readings {
        let (targets, sources) = (joints_by_name(model, read), joints_by_name(motion, read));
        for (name, targets) in &targets {
            if let ([target], Some([source])) = (targets.as_slice(), sources.get(name).map(Vec::as_slice))
                && !found.contains_key(target)
                && !taken.contains(source)
            {
                found.insert(*target, *source);
                taken.insert(*source);
            }
        }
    }
    add_children_of_matches(model, motion, &taken, &mut found);
    found
}

/// Matches joints that share their name with others but whose parents match.
fn add_children_of_matches(
    model: &Skeleton,
    motion: &Skeleton,
    taken: &BTreeSet<JointIndex>,
    found: &mut BTreeMap<JointIndex, JointIndex>,
) {
    // Reversed, so that `pop` takes the first of a name.
    let mut children: Vec<BTreeMap<&str, Vec<JointIndex>>> = vec![BTreeMap::new(); motion.len()];
    for source in motion.joints().filter(|source| !taken.contains(source)).rev() {
        if let Some(parent) = motion.parent(source) {
            children[parent.get()].entry(motion.name(source)).or_default().push(source);
        }
    }
    // Parents come first, so children of joints matched here are matched as well.
    for target in model.joints() {
        let Some(&source_parent) = model.parent(target).and_then(|parent| found.get(&parent)) else { continue };
        if found.contains_key(&target) || model.name(target).is_empty() {
            continue;
        }
        if let Some(source) = children[source_parent.get()].get_mut(model.name(target)).and_then(Vec::pop) {
            found.insert(target, source);
        }
    }
}

/// Named joints by what `read` returns for their names.
fn joints_by_name(skeleton: &Skeleton, read: fn(&str) -> String) -> BTreeMap<String, Vec<JointIndex>> {
    let mut joints: BTreeMap<String, Vec<JointIndex>> = BTreeMap::new();
    for joint in skeleton.joints().filter(|&joint| !skeleton.name(joint).is_empty()) {
        joints.entry(read(skeleton.name(joint))).or_default().push(joint);
    }
    joints
}

/// Side and words of a name, without what exporters and rigs add.
fn normalized(name: &str) -> String {
    let name = Name::read(name);
    format!("{:?} {}", name.side, name.words.join(" "))
}
