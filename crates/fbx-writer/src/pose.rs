//! The bind pose: where the objects were when their meshes were skinned.

use std::collections::BTreeMap;

use glam::DMat4;

use crate::layout::{Attribute, Contents, Layout};
use crate::objects::{Id, Objects, ROOT};
use crate::record::Record;

/// Writes the bind pose of all skinned meshes, their joints and what is above those. Where two skins were bound in different poses,
/// the first counts here; each cluster has its own.
pub fn write(contents: Contents, layout: &Layout, objects: &mut Objects) {
    let Contents { asset, space, .. } = contents;
    let mut matrices: BTreeMap<Id, DMat4> = BTreeMap::new();
    for model in &layout.models {
        let Attribute::Mesh(index) = model.attribute else { continue };
        let instance = &asset.instances[index];
        let Some(skin) = instance.skin.map(|skin| &asset.skins[skin]) else { continue };
        let world = layout.of_instances.get(&index).copied().unwrap_or(DMat4::IDENTITY);
        matrices.insert(model.id, world);
        for (&joint, joint_from_bind) in skin.joints().iter().zip(skin.joint_from_bind()) {
            let bone_from_mesh = space.matrix(joint_from_bind, space.unit, space.of_joint(joint.get()));
            let link = world * bone_from_mesh.inverse();
            let rest = layout.worlds[joint.get()];
            matrices.entry(layout.models[joint.get()].id).or_insert(if link.is_finite() { link } else { rest });
        }
    }
    if matrices.is_empty() {
        return;
    }
    // Parents come before their children.
    for (index, model) in layout.models.iter().enumerate().take(asset.skeleton.len()).rev() {
        if model.parent != ROOT && matrices.contains_key(&model.id) {
            let parent = asset.skeleton.parents()[index];
            if let Some(parent) = parent {
                matrices.entry(model.parent).or_insert(layout.worlds[parent.get()]);
            }
        }
    }
    let nodes = matrices.iter().map(|(id, matrix)| {
        let node = Record::new("PoseNode").with(Record::new("Node").i64(*id));
        node.with(Record::new("Matrix").f64s(&matrix.to_cols_array()))
    });
    objects.add("Pose", ("bind", "Pose", "BindPose"), |record| {
        record
            .with(Record::new("Type").text("BindPose"))
            .with(Record::new("Version").i32(100))
            .with(Record::new("NbPoseNodes").i32(matrices.len() as i32))
            .with_all(nodes)
    });
}
