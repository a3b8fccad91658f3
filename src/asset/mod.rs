//! The result of any loader: immutable, validated, independent of the file format.

mod error;
mod humanoid;
mod warning;

use std::ops::Deref;
use std::sync::Arc;

use glam::Vec3;

use crate::anim::{Clip, JointIndex, Skeleton};
use crate::mesh::{Material, Mesh, Skin, Texture};

pub use error::AssetError;
pub use humanoid::{Humanoid, Slot};
pub use warning::{Warning, Warnings};

/// A model, its motion, or both. [`Self::new`] has checked that all indices are in range; the parts can be read but not
/// changed.
#[derive(Debug, Default)]
pub struct Asset {
    parts: AssetParts,
    pub warnings: Warnings,
}

/// The parts that an [`Asset`] is built from.
#[derive(Debug, Default)]
pub struct AssetParts {
    /// The kind of file: `glb`, `gltf`, ….
    pub format: &'static str,
    pub generator: String,
    /// Every node of the file.
    pub skeleton: Skeleton,
    pub scenes: Vec<Scene>,
    /// The scene to show first; none if the file has no scenes (then all nodes are shown).
    pub default_scene: Option<usize>,
    pub clips: Vec<Clip>,
    pub skins: Vec<Skin>,
    pub meshes: Vec<Mesh>,
    /// Which joint draws which mesh.
    pub instances: Vec<MeshInstance>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub images: Vec<Image>,
    pub cameras: Vec<Camera>,
    pub lights: Vec<Light>,
    /// The humanoid bones that the file declares (VRM, VRMA).
    pub humanoid: Option<Humanoid>,
    pub extensions_used: Vec<String>,
    pub extensions_required: Vec<String>,
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

/// An encoded image, its size already read from the header and within bounds.
#[derive(Debug, Clone)]
pub struct Image {
    pub name: String,
    pub mime: &'static str,
    pub bytes: Arc<[u8]>,
    pub width: u32,
    pub height: u32,
}

/// A camera of the file, looking along −Z of its joint.
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

/// A light (KHR_lights_punctual), shining along −Z of its joint. Intensity in lux (directional) or candela.
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
    /// Checks every index once.
    pub fn new(parts: AssetParts) -> Result<Self, AssetError> {
        parts.check()?;
        Ok(Self { parts, warnings: Warnings::default() })
    }

    /// Takes the asset apart, for instance to build another one. Drops the warnings.
    pub fn into_parts(self) -> AssetParts {
        self.parts
    }

    /// Returns one flag per joint: whether it belongs to the scene. Without scenes, or if there is no such scene, all do.
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

impl Deref for Asset {
    type Target = AssetParts;

    fn deref(&self) -> &AssetParts {
        &self.parts
    }
}

/// A skeleton and nothing else.
impl From<Skeleton> for Asset {
    fn from(skeleton: Skeleton) -> Self {
        Self { parts: AssetParts { skeleton, ..AssetParts::default() }, warnings: Warnings::default() }
    }
}

impl AssetParts {
    fn check(&self) -> Result<(), AssetError> {
        self.check_nodes()?;
        self.check_surfaces()?;
        self.check_geometry()
    }

    fn check_nodes(&self) -> Result<(), AssetError> {
        let joints = self.skeleton.len();
        let check_all = |list: &'static str, indices: &mut dyn Iterator<Item = JointIndex>| {
            for joint in indices {
                check(list, joint.get(), joints)?;
            }
            Ok(())
        };
        check_all("scenes", &mut self.scenes.iter().flat_map(|scene| scene.roots.iter().copied()))?;
        check_all("skins", &mut self.skins.iter().flat_map(|skin| skin.joints().iter().copied()))?;
        check_all(
            "clips",
            &mut self.clips.iter().flat_map(|clip| clip.channels().iter().map(|channel| channel.joint)),
        )?;
        check_all("cameras", &mut self.cameras.iter().map(|camera| camera.joint))?;
        check_all("lights", &mut self.lights.iter().map(|light| light.joint))?;
        check_all("humanoid", &mut self.humanoid.iter().flat_map(|humanoid| humanoid.0.values().copied()))?;
        check_all("instances", &mut self.instances.iter().map(|instance| instance.joint))?;
        for instance in &self.instances {
            check("instances", instance.mesh, self.meshes.len())?;
            instance.skin.map_or(Ok(()), |skin| check("instances", skin, self.skins.len()))?;
        }
        self.default_scene.map_or(Ok(()), |scene| check("default_scene", scene, self.scenes.len()))
    }

    fn check_surfaces(&self) -> Result<(), AssetError> {
        for material in &self.materials {
            let textures = [
                material.base_color_texture,
                material.metallic_roughness_texture,
                material.normal_texture,
                material.occlusion_texture,
                material.emissive_texture,
            ];
            for texture in textures.into_iter().flatten() {
                check("materials", texture.texture, self.textures.len())?;
            }
        }
        let images = self.textures.iter().filter_map(|texture| texture.image);
        images.into_iter().try_for_each(|image| check("textures", image, self.images.len()))
    }

    fn check_geometry(&self) -> Result<(), AssetError> {
        // A mesh may be used with several skins; its influences have to fit the smallest.
        let mut smallest_skin = vec![None; self.meshes.len()];
        for instance in &self.instances {
            if let Some(skin) = instance.skin {
                let joints = self.skins[skin].joints().len();
                let smallest = &mut smallest_skin[instance.mesh];
                *smallest = Some(smallest.map_or(joints, |smallest: usize| smallest.min(joints)));
            }
        }
        for (mesh, skin_joints) in smallest_skin.into_iter().enumerate() {
            for (primitive, geometry) in self.meshes[mesh].primitives.iter().enumerate() {
                geometry.validate(skin_joints).map_err(|problem| AssetError::Geometry { mesh, primitive, problem })?;
                geometry.material.map_or(Ok(()), |material| check("meshes", material, self.materials.len()))?;
            }
        }
        Ok(())
    }
}

fn check(list: &'static str, index: usize, count: usize) -> Result<(), AssetError> {
    if index < count { Ok(()) } else { Err(AssetError::Index { list, index, count }) }
}
