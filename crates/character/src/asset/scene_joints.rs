//! Visibility of a scene's joints: all are visible except those that the file, a clip or the user hides, and their
//! descendants.

use super::Asset;
use crate::anim::{JointIndex, PropertyTarget, PropertyValues};

/// Flags for all joints of an asset. Reused between frames.
#[derive(Debug, Clone, Default)]
pub struct SceneJoints {
    /// Whether the joint belongs to the scene.
    pub in_scene: Vec<bool>,
    /// Whether the joint is shown: it belongs to the scene and is not hidden.
    pub visible: Vec<bool>,
    /// [`Self::visible`] at rest.
    pub visible_at_rest: Vec<bool>,
    /// Hidden whatever the file and the clip say.
    hidden: Vec<JointIndex>,
    /// `visible` may differ from `visible_at_rest`.
    is_animated: bool,
}

impl SceneJoints {
    /// Returns the flags of a scene at rest; without a scene, of all scenes.
    pub fn new(asset: &Asset, scene: Option<usize>) -> Self {
        let in_scene = asset.joints_in_scene(scene);
        let mut joints = Self { in_scene, is_animated: true, ..Self::default() };
        joints.show(asset, &PropertyValues::default());
        joints.visible_at_rest.clone_from(&joints.visible);
        joints
    }

    /// Sets the joints that are hidden whatever the file and the clip say. Takes effect with [`Self::show`].
    pub fn hide(&mut self, joints: impl Iterator<Item = JointIndex> + Clone) {
        if !joints.clone().eq(self.hidden.iter().copied()) {
            self.hidden.clear();
            self.hidden.extend(joints);
            self.is_animated = true;
        }
    }

    /// Applies animated visibility; costs nothing if there is none.
    pub fn show(&mut self, asset: &Asset, values: &PropertyValues) {
        let was_animated = std::mem::replace(&mut self.is_animated, values.has_visibility());
        if !was_animated && !self.is_animated {
            return;
        }
        let Self { in_scene, visible, hidden, .. } = self;
        visible.clear();
        visible.resize(in_scene.len(), true);
        for joint in &asset.hidden {
            visible[joint.get()] = false;
        }
        for (target, value) in values.iter() {
            if let PropertyTarget::Visibility(joint) = target {
                visible[joint.get()] = value.x != 0.0;
            }
        }
        for joint in hidden {
            visible[joint.get()] = false;
        }
        for joint in asset.skeleton.joints() {
            visible[joint.get()] &= asset.skeleton.parent(joint).is_none_or(|parent| visible[parent.get()]);
        }
        // Last: a scene may contain a node without its parent, which still hides it.
        for (visible, in_scene) in visible.iter_mut().zip(in_scene) {
            *visible &= *in_scene;
        }
    }
}
