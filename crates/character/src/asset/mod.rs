//! The result of any loader: immutable, validated, independent of the file format. Nothing after the loaders checks ranges.
//! To change an asset, take it apart ([`Asset::into_parts`]) and build another.

mod error;
mod humanoid;
mod panorama;
mod reference_pose;
mod scene_joints;
mod warning;

use std::ops::Deref;
use std::sync::Arc;

use glam::{Affine3A, Vec3, Vec4Swizzles};

use crate::anim::{
    CameraProperty, Clip, JointIndex, LightProperty, PropertyTarget, PropertyValues, Skeleton, TextureSlot,
};
use crate::avatar::{Avatar, LookAtKind};
use crate::mesh::{Material, Mesh, Skin, Texture};

pub use error::AssetError;
pub use humanoid::{Humanoid, Side, Slot};
pub use panorama::Panorama;
pub use reference_pose::BoundTransform;
pub use scene_joints::SceneJoints;
pub use warning::{Warning, Warnings};

/// A model, its motion, or both. [`Self::new`] has checked that all indices are in range; the parts can be read but not
/// changed.
#[derive(Debug, Default)]
pub struct Asset {
    parts: AssetParts,
    /// Problems found while loading the file and decoding its images.
    pub warnings: Warnings,
}

/// The parts that an [`Asset`] is built from.
#[derive(Debug, Default)]
pub struct AssetParts {
    /// The kind of file: `glb`, `gltf`, ….
    pub format: &'static str,
    /// The tool that wrote the file (glTF's `asset.generator`); empty if unknown.
    pub generator: String,
    /// Every node of the file.
    pub skeleton: Skeleton,
    /// Empty if the file has none.
    pub scenes: Vec<Scene>,
    /// The scene to show first; none if the file has no scenes (then all nodes are shown).
    pub default_scene: Option<usize>,
    /// The file's animations.
    pub clips: Vec<Clip>,
    /// The last clip that `write_model` added: what the file was written for.
    pub added_clip: Option<usize>,
    /// Indexed by [`MeshInstance::skin`].
    pub skins: Vec<Skin>,
    /// Indexed by [`MeshInstance::mesh`].
    pub meshes: Vec<Mesh>,
    /// Which joint draws which mesh.
    pub instances: Vec<MeshInstance>,
    /// Joints that the file hides (KHR_node_visibility), with everything below them.
    pub hidden: Vec<JointIndex>,
    /// Indexed by [`crate::mesh::Geometry::material`].
    pub materials: Vec<Material>,
    /// Names of the material variants (KHR_materials_variants): unique and never empty.
    pub variants: Vec<String>,
    /// Indexed by [`crate::mesh::TextureRef::texture`].
    pub textures: Vec<Texture>,
    /// Indexed by [`Texture::image`].
    pub images: Vec<Image>,
    /// One per node with a camera, in node order.
    pub cameras: Vec<Camera>,
    /// One per node with a light, in node order.
    pub lights: Vec<Light>,
    /// The humanoid bones that the file declares (VRM, VRMA).
    pub humanoid: Option<Humanoid>,
    /// Expressions, node constraints, gaze and spring bones that the file declares (VRM, VRMA).
    pub avatar: Avatar,
    /// glTF's `extensionsUsed`.
    pub extensions_used: Vec<String>,
    /// glTF's `extensionsRequired`. Loading fails if any of them is unsupported.
    pub extensions_required: Vec<String>,
}

/// The nodes that are shown together.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// Empty if the file doesn't name it.
    pub name: String,
    /// Joints that belong to the scene, with all their descendants.
    pub roots: Vec<JointIndex>,
}

/// A mesh drawn at a node. The copies that EXT_mesh_gpu_instancing makes of a node's mesh are adjacent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshInstance {
    /// The node. Its transform places the mesh only if there is no skin.
    pub joint: JointIndex,
    /// Index into [`AssetParts::meshes`].
    pub mesh: usize,
    /// Index into [`AssetParts::skins`]; `None` if the mesh is rigid, even if it has influences.
    pub skin: Option<usize>,
    /// Transform of an EXT_mesh_gpu_instancing copy relative to the node, otherwise the identity. Unused with a skin.
    pub joint_from_mesh: Affine3A,
}

impl MeshInstance {
    /// Returns an instance placed by its node alone.
    pub fn new(joint: JointIndex, mesh: usize, skin: Option<usize>) -> Self {
        Self { joint, mesh, skin, joint_from_mesh: Affine3A::IDENTITY }
    }
}

/// The content of a file, shared by those who hold it. Not an `Arc<[u8]>`, which would copy what was read.
pub type SharedBytes = Arc<Vec<u8>>;

/// An encoded image, its size already read from the header and within bounds.
#[derive(Debug, Clone, Default)]
pub struct Image {
    /// Its name in the file, else its URI; may be empty.
    pub name: String,
    /// By content: `image/png`, `image/jpeg`, `image/webp`, `image/avif` or `image/ktx2`. Empty if the image is unavailable.
    pub mime: &'static str,
    /// As encoded. Empty if the image is unavailable.
    pub bytes: SharedBytes,
    /// In pixels. 0 if the image is unavailable.
    pub width: u32,
    /// In pixels. 0 if the image is unavailable.
    pub height: u32,
}

/// A camera of the file, looking along −Z of its joint.
#[derive(Debug, Clone)]
pub struct Camera {
    /// The camera's own name, else its node's; may be empty.
    pub name: String,
    /// The node that has the camera.
    pub joint: JointIndex,
    /// Its index in the file; several nodes can have the same camera.
    pub number: usize,
    /// Lens and clip planes.
    pub projection: CameraProjection,
}

/// A camera's lens and clip planes, as in glTF; distances in metres. The viewport decides the aspect ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CameraProjection {
    /// glTF's `camera.perspective`.
    Perspective {
        /// Vertical field of view.
        y_fov_radians: f32,
        /// Distance of the near plane.
        near: f32,
        /// Distance of the far plane; `None` is an infinite projection.
        far: Option<f32>,
    },
    /// glTF's `camera.orthographic`.
    Orthographic {
        /// Half the height of the view.
        y_mag: f32,
        /// Distance of the near plane.
        near: f32,
        /// Distance of the far plane.
        far: f32,
    },
}

/// Maximum number of lights drawn; the strongest are kept.
pub const MAX_LIGHTS: usize = 8;

/// A light (KHR_lights_punctual), shining along −Z of its joint. Intensity in lux (directional) or candela.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// The node that has the light.
    pub joint: JointIndex,
    /// Its index in the file; several nodes can have the same light.
    pub number: usize,
    /// Linear RGB.
    pub color: Vec3,
    /// Lux for a directional light, otherwise candela.
    pub intensity: f32,
    /// Distance in metres at which the light has faded out; `None` is unlimited.
    pub range: Option<f32>,
    /// Directional, point or spot.
    pub kind: LightKind,
}

/// How a light spreads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// Parallel rays.
    Directional,
    /// Equally in all directions.
    Point,
    /// A cone.
    Spot {
        /// Angle from the axis at which the light starts to fall off.
        inner_cone_radians: f32,
        /// Angle from the axis at which the light has fallen to zero.
        outer_cone_radians: f32,
    },
}

impl Camera {
    /// Returns the projection with animated properties applied.
    pub fn animated(&self, values: &PropertyValues) -> CameraProjection {
        let mut projection = self.projection;
        for (target, value) in values.iter() {
            if let PropertyTarget::Camera(number, property) = target
                && number == self.number
            {
                projection.set(property, value.x);
            }
        }
        projection
    }
}

impl CameraProjection {
    /// Sets an animated property; ignored if only the other kind of camera has it.
    fn set(&mut self, property: CameraProperty, value: f32) {
        match (self, property) {
            (Self::Perspective { y_fov_radians, .. }, CameraProperty::YFov) => *y_fov_radians = value,
            (Self::Perspective { near, .. } | Self::Orthographic { near, .. }, CameraProperty::Near) => *near = value,
            (Self::Perspective { far, .. }, CameraProperty::Far) => *far = Some(value),
            (Self::Orthographic { far, .. }, CameraProperty::Far) => *far = value,
            (Self::Orthographic { y_mag, .. }, CameraProperty::YMag) => *y_mag = value,
            (Self::Perspective { .. }, CameraProperty::YMag) | (Self::Orthographic { .. }, CameraProperty::YFov) => {}
        }
    }
}

impl Light {
    /// Returns the light with animated properties applied.
    pub fn animated(&self, values: &PropertyValues) -> Self {
        let mut light = *self;
        for (target, value) in values.iter() {
            let PropertyTarget::Light(number, property) = target else { continue };
            if number != self.number {
                continue;
            }
            match (property, &mut light.kind) {
                (LightProperty::Color, _) => light.color = value.xyz(),
                (LightProperty::Intensity, _) => light.intensity = value.x,
                (LightProperty::Range, _) => light.range = Some(value.x),
                (LightProperty::InnerCone, LightKind::Spot { inner_cone_radians, .. }) => *inner_cone_radians = value.x,
                (LightProperty::OuterCone, LightKind::Spot { outer_cone_radians, .. }) => *outer_cone_radians = value.x,
                (LightProperty::InnerCone | LightProperty::OuterCone, _) => {}
            }
        }
        light
    }
}

impl Asset {
    /// Validates all indices.
    pub fn new(parts: AssetParts) -> Result<Self, AssetError> {
        parts.check()?;
        Ok(Self { parts, warnings: Warnings::default() })
    }

    /// Whether any material uses an image for sRGB colours, or else for linear data.
    pub fn uses_image(&self, image: usize, for_color: bool) -> bool {
        let slots = || TextureSlot::ALL.into_iter().filter(|slot| slot.is_color() == for_color);
        let texture = |material: &Material, slot| self.textures.get(material.texture(slot)?.texture);
        self.materials.iter().any(|material| {
            slots().filter_map(|slot| texture(material, slot)).any(|texture| texture.image == Some(image))
        })
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

/// An asset with nothing but a skeleton.
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
        for channel in self.clips.iter().flat_map(|clip| clip.properties()) {
            match channel.target {
                PropertyTarget::Material(material, _) => check("clips", material, self.materials.len())?,
                PropertyTarget::Visibility(joint) | PropertyTarget::MorphWeight(joint, _) => {
                    check("clips", joint.get(), joints)?;
                }
                PropertyTarget::Expression(index) => check("clips", index, self.avatar.expressions.len())?,
                PropertyTarget::Light(..) | PropertyTarget::Camera(..) | PropertyTarget::LookAt => {}
            }
        }
        self.added_clip.map_or(Ok(()), |clip| check("added_clip", clip, self.clips.len()))?;
        check_all("hidden", &mut self.hidden.iter().copied())?;
        check_all("cameras", &mut self.cameras.iter().map(|camera| camera.joint))?;
        check_all("lights", &mut self.lights.iter().map(|light| light.joint))?;
        check_all("humanoid", &mut self.humanoid.iter().flat_map(|humanoid| humanoid.0.values().copied()))?;
        check_all("avatar", &mut self.avatar.joints())?;
        self.check_avatar()?;
        check_all("instances", &mut self.instances.iter().map(|instance| instance.joint))?;
        for instance in &self.instances {
            check("instances", instance.mesh, self.meshes.len())?;
            instance.skin.map_or(Ok(()), |skin| check("instances", skin, self.skins.len()))?;
        }
        self.default_scene.map_or(Ok(()), |scene| check("default_scene", scene, self.scenes.len()))
    }

    /// Checks all of the avatar's indices except those of joints.
    fn check_avatar(&self) -> Result<(), AssetError> {
        let expressions = &self.avatar.expressions;
        for expression in expressions {
            for bind in &expression.morphs {
                check("avatar", bind.index, self.skeleton.rest().morph_weights.len())?;
            }
            for bind in &expression.materials {
                if let PropertyTarget::Material(material, _) = bind.target {
                    check("avatar", material, self.materials.len())?;
                }
            }
        }
        let look_at = self.avatar.look_at.map(|look_at| look_at.kind);
        if let Some(LookAtKind::Expressions(indices)) = look_at {
            indices.into_iter().flatten().try_for_each(|index| check("avatar", index, expressions.len()))?;
        }
        let springs = &self.avatar.springs;
        let mut colliders = springs.joints().iter().flat_map(|spring| &spring.colliders);
        colliders.try_for_each(|&collider| check("avatar", collider as usize, springs.colliders().len()))
    }

    fn check_surfaces(&self) -> Result<(), AssetError> {
        for material in &self.materials {
            for texture in TextureSlot::ALL.into_iter().filter_map(|slot| material.texture(slot)) {
                check("materials", texture.texture, self.textures.len())?;
            }
        }
        let images = self.textures.iter().filter_map(|texture| texture.image);
        images.into_iter().try_for_each(|image| check("textures", image, self.images.len()))
    }

    fn check_geometry(&self) -> Result<(), AssetError> {
        // A mesh may be used with several skins; its influences must fit the smallest.
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
                let of_variants = geometry.variants.iter().map(|&(_, material)| material);
                for material in geometry.material.into_iter().chain(of_variants) {
                    check("meshes", material, self.materials.len())?;
                }
                let mut variants = geometry.variants.iter();
                variants.try_for_each(|&(variant, _)| check("variants", variant, self.variants.len()))?;
            }
        }
        Ok(())
    }
}

fn check(list: &'static str, index: usize, count: usize) -> Result<(), AssetError> {
    if index < count { Ok(()) } else { Err(AssetError::Index { list, index, count }) }
}
