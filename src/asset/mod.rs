//! What any loader makes of a file: immutable, validated, free of the file's own form.

mod humanoid;
mod warning;

use std::sync::Arc;

use glam::Vec3;

use crate::anim::{Clip, JointIndex, Skeleton};
use crate::mesh::{Material, Mesh, Skin, Texture};

pub use humanoid::{Humanoid, Slot};
pub use warning::{Warning, Warnings};

/// A model, its motion, or both. All indices are in range.
#[derive(Debug, Default)]
pub struct Asset {
    /// `glb`, `gltf`, …: the kind of file this came from.
    pub format: &'static str,
    pub generator: String,
    /// Every node of the file.
    pub skeleton: Skeleton,
    pub scenes: Vec<Scene>,
    /// The scene to show first; none when the file has no scenes (then all nodes are shown).
    pub default_scene: Option<usize>,
    pub clips: Vec<Clip>,
    pub skins: Vec<Skin>,
    pub meshes: Vec<Mesh>,
    /// Which mesh hangs on which joint.
    pub instances: Vec<MeshInstance>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub images: Vec<Image>,
    pub cameras: Vec<Camera>,
    pub lights: Vec<Light>,
    /// The file's own word on which joint is which part of a human body (VRM, VRMA).
    pub humanoid: Option<Humanoid>,
    pub extensions_used: Vec<String>,
    pub extensions_required: Vec<String>,
    pub warnings: Warnings,
}

#[derive(Debug, Clone, Default)]
pub struct Scene {
    pub name: String,
    pub roots: Vec<JointIndex>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeshInstance {
    pub joint: JointIndex,
    pub mesh: usize,
    pub skin: Option<usize>,
}

/// An image still encoded, its size already read from its header and within bounds.
#[derive(Debug, Clone)]
pub struct Image {
    pub name: String,
    pub mime: &'static str,
    pub bytes: Arc<[u8]>,
    pub width: u32,
    pub height: u32,
}

/// A camera of the file: looks along −Z of its joint.
#[derive(Debug, Clone)]
pub struct Camera {
    pub name: String,
    pub joint: JointIndex,
    pub projection: CameraProjection,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CameraProjection {
    Perspective { y_fov_radians: f32, aspect: Option<f32>, near: f32, far: Option<f32> },
    Orthographic { x_mag: f32, y_mag: f32, near: f32, far: f32 },
}

/// KHR_lights_punctual; shines along −Z of its joint. Intensity in lux (directional) or candela.
#[derive(Debug, Clone)]
pub struct Light {
    pub name: String,
    pub joint: JointIndex,
    pub color: Vec3,
    pub intensity: f32,
    pub range: Option<f32>,
    pub kind: LightKind,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    Directional,
    Point,
    Spot { inner_cone_radians: f32, outer_cone_radians: f32 },
}

impl Asset {
    /// Whether each joint belongs to a scene: one flag per joint. Without scenes, or with an index out of range, all do.
    pub fn joints_in_scene(&self, scene: Option<usize>) -> Vec<bool> {
        let Some(scene) = scene.and_then(|scene| self.scenes.get(scene)) else {
            return vec![true; self.skeleton.len()];
        };
        let mut inside = vec![false; self.skeleton.len()];
        for root in &scene.roots {
            inside[root.get()] = true;
        }
        for joint in self.skeleton.joints() {
            if let Some(parent) = self.skeleton.parent(joint)
                && inside[parent.get()]
            {
                inside[joint.get()] = true;
            }
        }
        inside
    }
}
