//! Parts of the model that the user hides. They stay in exported models. Hidden nodes take the path of those that a file or
//! a clip hides: they keep their draws, marked as such, so that `gaitway pose` lists their vertices. Materials are skipped
//! when draws are listed.

use std::collections::BTreeSet;

use gaitway_character::anim::JointIndex;
use gaitway_character::asset::Asset;
use gaitway_character::sort::collect_set;
use serde::{Deserialize, Serialize};

/// Nodes and materials that the user hides, in addition to those that the file or the clip hides.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Hidden {
    /// Nodes by index in the file: their meshes and lights, and those of all nodes below.
    pub nodes: BTreeSet<usize>,
    /// Surfaces with these materials, by index in the asset; `None` is the default material.
    pub materials: BTreeSet<Option<usize>>,
}

impl Hidden {
    /// Whether nothing is hidden.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty() && self.materials.is_empty()
    }

    /// Hides a node by its index in the file, or shows it again.
    #[must_use]
    pub fn with_node_toggled(mut self, node: usize) -> Self {
        if !self.nodes.remove(&node) {
            self.nodes.insert(node);
        }
        self
    }

    /// Hides a material, or shows it again.
    #[must_use]
    pub fn with_material_toggled(mut self, material: Option<usize>) -> Self {
        if !self.materials.remove(&material) {
            self.materials.insert(material);
        }
        self
    }

    /// Hides all meshes except those on a joint and its descendants; if they already are, shows all.
    #[must_use]
    pub fn with_node_soloed(self, asset: &Asset, joint: JointIndex) -> Self {
        let others = nodes_beside(asset, joint);
        let nodes = if self.nodes == others { BTreeSet::new() } else { others };
        Self { nodes, ..self }
    }

    /// Hides all surfaces except those with a material; if they already are, shows all.
    #[must_use]
    pub fn with_material_soloed(self, asset: &Asset, material: Option<usize>) -> Self {
        let mut others = used_materials(asset);
        others.remove(&material);
        let materials = if self.materials == others { BTreeSet::new() } else { others };
        Self { materials, ..self }
    }

    /// Drops nodes and materials that the asset doesn't have.
    pub(super) fn retain_known(&mut self, asset: &Asset) {
        self.nodes.retain(|&node| asset.skeleton.joint_of_source(node).is_some());
        self.materials.retain(|material| material.is_none_or(|material| material < asset.materials.len()));
    }
}

/// Returns one flag per joint: whether it or a descendant has a mesh or, with `lights`, a light.
pub fn joints_with_content(asset: &Asset, lights: bool) -> Vec<bool> {
    let mut has_content = vec![false; asset.skeleton.len()];
    for instance in &asset.instances {
        has_content[instance.joint.get()] = true;
    }
    for light in asset.lights.iter().filter(|_| lights) {
        has_content[light.joint.get()] = true;
    }
    for joint in asset.skeleton.joints().rev() {
        if has_content[joint.get()]
            && let Some(parent) = asset.skeleton.parent(joint)
        {
            has_content[parent.get()] = true;
        }
    }
    has_content
}

/// Returns the topmost nodes with meshes that are neither ancestors nor descendants of a joint. Meshes on ancestors stay shown:
/// hiding those would hide the joint as well.
fn nodes_beside(asset: &Asset, joint: JointIndex) -> BTreeSet<usize> {
    let skeleton = &asset.skeleton;
    let has_meshes = joints_with_content(asset, false);
    let mut is_kept = vec![false; skeleton.len()];
    let mut above = Some(joint);
    while let Some(joint) = above {
        is_kept[joint.get()] = true;
        above = skeleton.parent(joint);
    }
    let mut is_below = vec![false; skeleton.len()];
    let mut is_hidden = vec![false; skeleton.len()];
    let mut nodes = BTreeSet::new();
    for other in skeleton.joints() {
        let parent = skeleton.parent(other).map(JointIndex::get);
        is_below[other.get()] = other == joint || parent.is_some_and(|parent| is_below[parent]);
        is_hidden[other.get()] = parent.is_some_and(|parent| is_hidden[parent]);
        let is_beside = !is_kept[other.get()] && !is_below[other.get()] && !is_hidden[other.get()];
        if is_beside && has_meshes[other.get()] {
            is_hidden[other.get()] = true;
            nodes.insert(skeleton.source_index(other));
        }
    }
    nodes
}

/// Returns the materials of all primitives, in all variants; `None` is the default material.
pub fn used_materials(asset: &Asset) -> BTreeSet<Option<usize>> {
    let primitives = || asset.meshes.iter().flat_map(|mesh| &mesh.primitives);
    collect_set(primitives().flat_map(|geometry| {
        let variants = geometry.variants.iter().map(|&(_, material)| Some(material));
        std::iter::once(geometry.material).chain(variants)
    }))
}
