//! Lints: find what a model's author probably didn't intend, problems that load without an error but waste memory, look wrong in
//! other programs or confuse animators. Run on request; [`Model::findings`](super::Model::findings) caches the result.

mod clips;
mod places;
mod rig;

#[cfg(test)]
mod tests;

pub use places::joint_of_place;

use gaitway_character::anim::{Interpolation, JointIndex};
use gaitway_character::asset::{Asset, Warning, Warnings};
use gaitway_retarget::{Contradiction, Recognized};

/// Maximum number of names that a message lists.
const MAX_NAMES: usize = 3;

/// Checks an asset; `recognized` is what [`recognize`](gaitway_retarget::recognize) finds in it. A problem is reported once, at
/// the first node that has it, not for each joint or key.
pub(super) fn lint(asset: &Asset, recognized: &Recognized) -> Warnings {
    let mut lints = Warnings::default();
    rig::influences(asset, &mut lints);
    rig::joints(asset, &mut lints);
    rig::scale(asset, &mut lints);
    sides(asset, recognized, &mut lints);
    asset.clips.iter().for_each(|clip| clips::rotations(asset, clip, &mut lints));
    // Motion capture has a key per frame and seldom loops.
    if asset.format != "bvh" {
        clips::density(asset, &mut lints);
        asset.clips.iter().for_each(|clip| clips::closure(asset, clip, &mut lints));
    }
    lints
}

/// Reports joints that are named for one side but lie on the other. The feet tell which way is forward.
fn sides(asset: &Asset, recognized: &Recognized, lints: &mut Warnings) {
    let joints: Vec<JointIndex> = recognized
        .contradictions
        .iter()
        .map(|contradiction| match contradiction {
            Contradiction::Side { joint, .. } => *joint,
        })
        .collect();
    if let Some(&first) = joints.first() {
        let problem = match joints.len() {
            1 => format!("{} is named for one side of the body but lies on the other", name(asset, first)),
            count => format!(
                "{count} joints are named for one side of the body but lie on the other: {}",
                names(asset, &joints)
            ),
        };
        lints.push(at_node(asset, "side-names", first, problem));
    }
}

/// Returns the values of a channel's keys, without the tangents of splines.
fn key_values<T>(values: &[T], interpolation: Interpolation) -> impl Iterator<Item = &T> {
    let stride = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    values.iter().skip(stride / 2).step_by(stride)
}

fn at_node(asset: &Asset, code: &'static str, joint: JointIndex, problem: String) -> Warning {
    Warning::Other { code, place: format!("nodes[{}]", asset.skeleton.source_index(joint)), problem }
}

fn name(asset: &Asset, joint: JointIndex) -> String {
    match asset.skeleton.name(joint) {
        "" => format!("node {}", asset.skeleton.source_index(joint)),
        name => name.to_owned(),
    }
}

/// Lists the first names, and how many more there are.
fn names(asset: &Asset, joints: &[JointIndex]) -> String {
    let mut text: Vec<String> = joints.iter().take(MAX_NAMES).map(|&joint| name(asset, joint)).collect();
    if joints.len() > MAX_NAMES {
        text.push(format!("{} more", joints.len() - MAX_NAMES));
    }
    text.join(", ")
}
