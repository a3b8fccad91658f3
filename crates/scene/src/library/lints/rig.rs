//! Lints for skins and skeletons. Weights that don't add up are corrected by the readers, with a warning.

use gaitway_character::anim::{JointIndex, Keys};
use gaitway_character::asset::{Asset, MeshInstance, Warning, Warnings};
use glam::Vec3;

use super::{at_node, key_values, name, names};

/// Relative differences below this are rounding.
const SCALE_TOLERANCE: f32 = 1e-3;

/// Reports meshes that have influences but are drawn without a skin: the influences only take memory.
pub(super) fn influences(asset: &Asset, lints: &mut Warnings) {
    for (index, mesh) in asset.meshes.iter().enumerate() {
        let mut uses = asset.instances.iter().filter(|instance| instance.mesh == index).peekable();
        let has_influences = mesh.primitives.iter().any(|geometry| !geometry.influences.is_empty());
        if has_influences && uses.peek().is_some() && uses.all(|instance| instance.skin.is_none()) {
            lints.push(Warning::Other {
                code: "influences-unused",
                place: format!("meshes[{index}]"),
                problem: "has joints and weights, but no node draws it with a skin".to_owned(),
            });
        }
    }
}

/// Reports joints of a skin that move no vertex, neither themselves nor through a descendant. Ends of chains are exempt:
/// exporters add them to give the last bone a length.
pub(super) fn joints(asset: &Asset, lints: &mut Warnings) {
    let skeleton = &asset.skeleton;
    let mut has_effect = vec![false; skeleton.len()];
    asset.instances.iter().for_each(|instance| mark_weighted(asset, instance, &mut has_effect));
    // Props, cameras and lights move with the joint that they are attached to.
    let attached = asset.instances.iter().filter(|instance| instance.skin.is_none()).map(|instance| instance.joint);
    let attached = attached.chain(asset.cameras.iter().map(|camera| camera.joint));
    for joint in attached.chain(asset.lights.iter().map(|light| light.joint)) {
        has_effect[joint.get()] = true;
    }
    let has_own_effect = has_effect.clone();
    for joint in skeleton.joints().rev() {
        if let Some(parent) = skeleton.parent(joint) {
            has_effect[parent.get()] |= has_effect[joint.get()];
        }
    }
    let mut has_child = vec![false; skeleton.len()];
    skeleton.parents().iter().flatten().for_each(|parent| has_child[parent.get()] = true);
    for (index, skin) in asset.skins.iter().enumerate() {
        if !asset.instances.iter().any(|instance| instance.skin == Some(index)) {
            continue;
        }
        let is_end = |joint: JointIndex| {
            !has_child[joint.get()] && skeleton.parent(joint).is_some_and(|parent| has_own_effect[parent.get()])
        };
        let idle = skin.joints().iter().copied().filter(|&joint| !has_effect[joint.get()] && !is_end(joint));
        let idle: Vec<JointIndex> = idle.collect();
        if let Some(&first) = idle.first() {
            let (idle_names, count) = (names(asset, &idle), skin.joints().len());
            let problem = match idle.len() {
                1 => format!("1 of the {count} joints of its skin moves no vertex: {idle_names}"),
                idle => format!("{idle} of the {count} joints of its skin move no vertex: {idle_names}"),
            };
            lints.push(at_node(asset, "joints-without-effect", first, problem));
        }
    }
}

fn mark_weighted(asset: &Asset, instance: &MeshInstance, weighted: &mut [bool]) {
    let Some(skin) = instance.skin.and_then(|skin| asset.skins.get(skin)) else { return };
    for geometry in &asset.meshes[instance.mesh].primitives {
        let influences = &geometry.influences;
        for (&joint, _) in influences.joints.iter().zip(&influences.weights).filter(|(_, weight)| **weight > 0.0) {
            weighted[skin.joints()[usize::from(joint)].get()] = true;
        }
    }
}

/// Reports joints with non-uniform scale above joints of a skin: the latter shear when they rotate, which engines that store
/// translation, rotation and scale can't represent.
pub(super) fn scale(asset: &Asset, lints: &mut Warnings) {
    let skeleton = &asset.skeleton;
    let mut is_in_skin = vec![false; skeleton.len()];
    asset.skins.iter().flat_map(|skin| skin.joints()).for_each(|joint| is_in_skin[joint.get()] = true);
    let mut is_above_skin = vec![false; skeleton.len()];
    for joint in skeleton.joints().rev() {
        if let Some(parent) = skeleton.parent(joint) {
            is_above_skin[parent.get()] |= is_in_skin[joint.get()] || is_above_skin[joint.get()];
        }
    }
    let at_rest = |joint: JointIndex| skeleton.rest().get(joint).is_some_and(|rest| is_non_uniform(&rest.scale));
    let mut is_stretched: Vec<bool> = skeleton.joints().map(at_rest).collect();
    for channel in asset.clips.iter().flat_map(|clip| clip.channels()) {
        if let Keys::Scale(values) = &channel.keys {
            is_stretched[channel.joint.get()] |= key_values(values, channel.interpolation).any(is_non_uniform);
        }
    }
    let found = skeleton.joints().filter(|joint| is_stretched[joint.get()] && is_above_skin[joint.get()]);
    let found: Vec<JointIndex> = found.collect();
    if let Some(&first) = found.first() {
        let problem = match found.len() {
            1 => {
                format!("{} has non-uniform scale, which shears the joints below it when they turn", name(asset, first))
            }
            count => format!(
                "{count} joints have non-uniform scale, which shears the joints below them when they turn: {}",
                names(asset, &found)
            ),
        };
        lints.push(at_node(asset, "scale-non-uniform", first, problem));
    }
}

fn is_non_uniform(scale: &Vec3) -> bool {
    let scale = scale.abs();
    scale.max_element() - scale.min_element() > SCALE_TOLERANCE * scale.max_element()
}
