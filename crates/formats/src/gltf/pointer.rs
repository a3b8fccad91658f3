//! KHR_animation_pointer: which property of the file a channel's JSON pointer leads to. The pointers are those of the glTF 2.0
//! Asset Object Model, whose names need none of the escapes of RFC 6901.

use gltf::json::Root;
use gltf::json::animation::Property;
use gltf::json::extensions::scene::khr_lights_punctual::{self, Type as LightType};
use gltf::json::validation::Checked;

use gaitway_character::anim::{
    CameraProperty, JointIndex, LightProperty, MaterialProperty, PropertyTarget, Skeleton, TextureSlot,
};
use gaitway_character::asset::{Asset, Camera, CameraProjection};
use gaitway_character::mesh::Material;

use super::lobes;
use super::mtoon;
use super::vrm::AnimatedNodes;

/// Aims animation channels at any property.
pub const POINTER: &str = "KHR_animation_pointer";

const MATERIAL: [(&str, MaterialProperty); 8] = [
    ("pbrMetallicRoughness/baseColorFactor", MaterialProperty::BaseColor),
    ("pbrMetallicRoughness/metallicFactor", MaterialProperty::Metallic),
    ("pbrMetallicRoughness/roughnessFactor", MaterialProperty::Roughness),
    ("emissiveFactor", MaterialProperty::Emissive),
    ("extensions/KHR_materials_emissive_strength/emissiveStrength", MaterialProperty::EmissiveStrength),
    ("alphaCutoff", MaterialProperty::AlphaCutoff),
    ("normalTexture/scale", MaterialProperty::NormalScale),
    ("occlusionTexture/strength", MaterialProperty::OcclusionStrength),
];
const TEXTURES: [(&str, TextureSlot); 5] = [
    ("pbrMetallicRoughness/baseColorTexture", TextureSlot::BaseColor),
    ("pbrMetallicRoughness/metallicRoughnessTexture", TextureSlot::MetallicRoughness),
    ("normalTexture", TextureSlot::Normal),
    ("occlusionTexture", TextureSlot::Occlusion),
    ("emissiveTexture", TextureSlot::Emissive),
];
type OfTexture = fn(TextureSlot) -> MaterialProperty;
const TEXTURE_TRANSFORM: [(&str, OfTexture); 3] = [
    ("/extensions/KHR_texture_transform/offset", MaterialProperty::UvOffset),
    ("/extensions/KHR_texture_transform/rotation", MaterialProperty::UvRotation),
    ("/extensions/KHR_texture_transform/scale", MaterialProperty::UvScale),
];
/// Prefix of the paths of lobes and MToon.
const EXTENSIONS: &str = "extensions/";
const LIGHT: [(&str, LightProperty); 5] = [
    ("color", LightProperty::Color),
    ("intensity", LightProperty::Intensity),
    ("range", LightProperty::Range),
    ("spot/innerConeAngle", LightProperty::InnerCone),
    ("spot/outerConeAngle", LightProperty::OuterCone),
];
const LIGHTS: &str = "KHR_lights_punctual/lights/";
const PERSPECTIVE: [(&str, CameraProperty); 3] = [
    ("perspective/yfov", CameraProperty::YFov),
    ("perspective/znear", CameraProperty::Near),
    ("perspective/zfar", CameraProperty::Far),
];
const ORTHOGRAPHIC: [(&str, CameraProperty); 3] = [
    ("orthographic/ymag", CameraProperty::YMag),
    ("orthographic/znear", CameraProperty::Near),
    ("orthographic/zfar", CameraProperty::Far),
];
const NODE: [(&str, Property); 4] = [
    ("translation", Property::Translation),
    ("rotation", Property::Rotation),
    ("scale", Property::Scale),
    ("weights", Property::MorphTargetWeights),
];
const VISIBLE: &str = "extensions/KHR_node_visibility/visible";

/// What a channel animates.
#[derive(Clone, Copy)]
pub enum Aim {
    /// A property of a node, which needs no extension.
    Node(usize, Property),
    /// Anything else.
    Property(PropertyTarget),
}

/// Why a pointer leads nowhere.
pub enum Unresolved {
    /// It may lead to something, but not to anything that is shown.
    Unsupported,
    /// What it leads to isn't there.
    Bad(String),
}

/// What pointers lead to.
pub struct Pointers<'a> {
    pub root: &'a Root,
    pub skeleton: &'a Skeleton,
    pub materials: &'a [Material],
    pub animated: &'a AnimatedNodes,
}

impl Pointers<'_> {
    /// Resolves a pointer. It can lead to several nodes that draw the same mesh, or to none.
    pub fn resolve(&self, pointer: &str) -> Result<Vec<Aim>, Unresolved> {
        let unsupported = Unresolved::Unsupported;
        let (list, rest) = pointer.strip_prefix('/').and_then(|rest| rest.split_once('/')).ok_or(unsupported)?;
        let rest = if list == "extensions" { rest.strip_prefix(LIGHTS) } else { Some(rest) };
        let (number, rest) = rest.and_then(|rest| rest.split_once('/')).ok_or(Unresolved::Unsupported)?;
        let number = index(number)?;
        let (count, name) = match list {
            "nodes" => (self.root.nodes.len(), list),
            "meshes" => (self.root.meshes.len(), list),
            "materials" => (self.materials.len(), list),
            "cameras" => (self.root.cameras.len(), list),
            "extensions" => (self.lights().len(), "lights"),
            _ => return Err(Unresolved::Unsupported),
        };
        if number >= count {
            return Err(Unresolved::Bad(format!("expected an index into the {count} {name}, found {number}")));
        }
        match list {
            "nodes" => self.node(number, rest),
            "meshes" => self.mesh(number, rest),
            "materials" => self.material(number, rest),
            "cameras" => self.camera(number, rest),
            _ => self.light(number, rest),
        }
    }

    fn lights(&self) -> &[khr_lights_punctual::Light] {
        self.root.as_ref()
    }

    fn node(&self, node: usize, rest: &str) -> Result<Vec<Aim>, Unresolved> {
        if let Some(property) = find(&NODE, rest) {
            return Ok(vec![Aim::Node(node, property)]);
        }
        let joint = self.skeleton.joint_of_source(node).ok_or(Unresolved::Unsupported)?;
        let target = match rest.strip_prefix("weights/") {
            Some(target) => self.weight(joint, index(target)?)?,
            None if rest == VISIBLE => PropertyTarget::Visibility(joint),
            None => return Err(Unresolved::Unsupported),
        };
        Ok(vec![Aim::Property(target)])
    }

    /// A mesh's weights are those of its nodes that have none of their own.
    fn mesh(&self, mesh: usize, rest: &str) -> Result<Vec<Aim>, Unresolved> {
        let nodes = self
            .root
            .nodes
            .iter()
            .enumerate()
            .filter(|(_, node)| node.weights.is_none() && node.mesh.is_some_and(|drawn| drawn.value() == mesh));
        match rest.split_once('/') {
            None if rest == "weights" => {
                Ok(nodes.map(|(node, _)| Aim::Node(node, Property::MorphTargetWeights)).collect())
            }
            Some(("weights", target)) => {
                let target = index(target)?;
                let joints = nodes.filter_map(|(node, _)| self.skeleton.joint_of_source(node));
                joints.map(|joint| self.weight(joint, target).map(Aim::Property)).collect()
            }
            _ => Err(Unresolved::Unsupported),
        }
    }

    fn weight(&self, joint: JointIndex, target: usize) -> Result<PropertyTarget, Unresolved> {
        let count = self.skeleton.morph_range(joint).len();
        match target < count {
            true => Ok(PropertyTarget::MorphWeight(joint, target)),
            false => Err(Unresolved::Bad(format!("expected an index into the {count} weights, found {target}"))),
        }
    }

    fn material(&self, material: usize, rest: &str) -> Result<Vec<Aim>, Unresolved> {
        let has_lobes = || self.materials[material].lobes.is_some();
        let lobe = || find(&lobes::FACTORS, rest.strip_prefix(EXTENSIONS)?).filter(|_| has_lobes());
        let has_toon = || self.materials[material].toon.is_some();
        let toon = || find(&mtoon::COLORS, rest.strip_prefix(EXTENSIONS)?).filter(|_| has_toon());
        let known = find(&MATERIAL, rest).or_else(|| lobe().map(MaterialProperty::Lobe));
        let property = match known.or_else(|| toon().map(MaterialProperty::Toon)) {
            Some(property) => property,
            None => {
                let transform = TEXTURE_TRANSFORM.iter().find_map(|(end, of)| Some((rest.strip_suffix(end)?, of)));
                let (texture, of) = transform.ok_or(Unresolved::Unsupported)?;
                let slot = find_texture(texture).ok_or(Unresolved::Unsupported)?;
                if self.materials[material].texture(slot).is_none() {
                    return Err(Unresolved::Bad("the material has no such texture".to_owned()));
                }
                of(slot)
            }
        };
        Ok(vec![Aim::Property(PropertyTarget::Material(material, property))])
    }

    fn light(&self, light: usize, rest: &str) -> Result<Vec<Aim>, Unresolved> {
        let property = find(&LIGHT, rest).ok_or(Unresolved::Unsupported)?;
        let is_cone = matches!(property, LightProperty::InnerCone | LightProperty::OuterCone);
        if is_cone && self.lights()[light].type_ != Checked::Valid(LightType::Spot) {
            return Err(Unresolved::Bad("the light is not a spot light".to_owned()));
        }
        Ok(vec![Aim::Property(PropertyTarget::Light(light, property))])
    }

    fn camera(&self, camera: usize, rest: &str) -> Result<Vec<Aim>, Unresolved> {
        let lens = &self.root.cameras[camera];
        let (kind, property, is_there) = match (find(&PERSPECTIVE, rest), find(&ORTHOGRAPHIC, rest)) {
            (Some(property), _) => ("perspective", property, lens.perspective.is_some()),
            (_, Some(property)) => ("orthographic", property, lens.orthographic.is_some()),
            (None, None) => return Err(Unresolved::Unsupported),
        };
        match is_there {
            true => Ok(vec![Aim::Property(PropertyTarget::Camera(camera, property))]),
            false => Err(Unresolved::Bad(format!("the camera is not {kind}"))),
        }
    }
}

/// Returns the JSON pointer to what a property channel animates.
pub fn pointer_to(target: PropertyTarget, asset: &Asset) -> String {
    let node = |joint| asset.skeleton.source_index(joint);
    match target {
        PropertyTarget::Material(material, property) => format!("/materials/{material}/{}", material_name(property)),
        PropertyTarget::Light(light, property) => format!("/extensions/{LIGHTS}{light}/{}", name(&LIGHT, property)),
        PropertyTarget::Camera(camera, property) => {
            let is_orthographic = |other: &Camera| {
                other.number == camera && matches!(other.projection, CameraProjection::Orthographic { .. })
            };
            let lens = if asset.cameras.iter().any(is_orthographic) { &ORTHOGRAPHIC } else { &PERSPECTIVE };
            format!("/cameras/{camera}/{}", name(lens, property))
        }
        PropertyTarget::Visibility(joint) => format!("/nodes/{}/{VISIBLE}", node(joint)),
        PropertyTarget::LookAt => format!("/extensions/{}/lookAt", vrm_extension(asset)),
        PropertyTarget::Expression(index) => {
            let Some(expression) = asset.avatar.expressions.get(index) else { return String::new() };
            let extension = vrm_extension(asset);
            let kind = if expression.is_preset { "preset" } else { "custom" };
            let name = expression.name.replace('~', "~0").replace('/', "~1");
            format!("/extensions/{extension}/expressions/{kind}/{name}")
        }
        PropertyTarget::MorphWeight(joint, target) => format!("/nodes/{}/weights/{target}", node(joint)),
    }
}

fn vrm_extension(asset: &Asset) -> &'static str {
    if asset.format == "vrma" { "VRMC_vrm_animation" } else { "VRMC_vrm" }
}

fn material_name(property: MaterialProperty) -> String {
    use MaterialProperty::{Lobe, Toon, UvOffset, UvRotation, UvScale};
    match property {
        Lobe(factor) => format!("{EXTENSIONS}{}", name(&lobes::FACTORS, factor)),
        Toon(color) => format!("{EXTENSIONS}{}", name(&mtoon::COLORS, color)),
        UvOffset(slot) | UvRotation(slot) | UvScale(slot) => {
            let transform = TEXTURE_TRANSFORM.iter().find(|(_, of)| of(slot) == property).map_or("", |(end, _)| end);
            texture_name(slot) + transform
        }
        _ => name(&MATERIAL, property).to_owned(),
    }
}

fn texture_name(slot: TextureSlot) -> String {
    let (prefix, table) = match slot {
        _ if slot >= TextureSlot::ShadeMultiply => (EXTENSIONS, &mtoon::TEXTURES[..]),
        _ if slot >= TextureSlot::Specular => (EXTENSIONS, &lobes::TEXTURES[..]),
        _ => ("", &TEXTURES[..]),
    };
    format!("{prefix}{}", name(table, slot))
}

fn find_texture(name: &str) -> Option<TextureSlot> {
    let in_extensions = || {
        let path = name.strip_prefix(EXTENSIONS)?;
        find(&lobes::TEXTURES, path).or_else(|| find(&mtoon::TEXTURES, path))
    };
    find(&TEXTURES, name).or_else(in_extensions)
}

fn find<T: Copy>(table: &[(&str, T)], name: &str) -> Option<T> {
    table.iter().find(|(known, _)| *known == name).map(|&(_, value)| value)
}

fn name<T: PartialEq>(table: &[(&'static str, T)], value: T) -> &'static str {
    table.iter().find(|(_, known)| *known == value).map_or("", |&(name, _)| name)
}

/// Parses an array index as in RFC 6901.
fn index(text: &str) -> Result<usize, Unresolved> {
    let is_plain = text.bytes().all(|byte| byte.is_ascii_digit()) && (text == "0" || !text.starts_with('0'));
    text.parse().ok().filter(|_| is_plain).ok_or(Unresolved::Unsupported)
}
