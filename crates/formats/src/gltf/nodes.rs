//! Nodes, scenes, and the meshes, cameras and lights of nodes (§3.5, §3.10).

use std::f32::consts::FRAC_PI_4;

use gaitway_character::anim::{Joint, JointIndex, Skeleton, SkeletonError, Transform};
use gaitway_character::asset::{
    Camera, CameraProjection, Light, LightKind, MAX_LIGHTS, MeshInstance, Scene, Warning, Warnings,
};
use gaitway_character::mesh::{Mesh, Skin};
use glam::{Mat4, Quat, Vec3};
use gltf::json::extensions::scene::khr_lights_punctual::{self, Type as LightType};
use gltf::json::validation::Checked;
use gltf::json::{Index, Node, Root};
use serde_json::Value;

use super::accessor::{Accessors, get};
use super::document::Document;
use super::instancing;
use crate::error::Problem;
use crate::limits::{Budget, Limit};

/// Hides nodes and their descendants.
pub const VISIBILITY: &str = "KHR_node_visibility";
/// Maximum length in characters of names that many nodes can share; longer ones are truncated.
const MAX_SHARED_NAME: usize = 256;

/// Builds one skeleton from all nodes. Its source indices are the file's node indices.
pub fn skeleton(root: &Root, meshes: &[Mesh], budget: &Budget, warnings: &mut Warnings) -> Result<Skeleton, Problem> {
    budget.spend(Limit::Nodes, root.nodes.len(), &"nodes")?;
    let mut joints: Vec<Joint> = Vec::with_capacity(root.nodes.len());
    for (index, node) in root.nodes.iter().enumerate() {
        let place = format!("nodes[{index}]");
        let morph_weights = match node.mesh {
            None => Vec::new(),
            Some(mesh) => rest_weights(root, meshes, node, mesh.value(), &place)?,
        };
        budget.spend(Limit::MorphWeights, morph_weights.len(), &place)?;
        joints.push(Joint {
            name: node.name.clone().unwrap_or_default(),
            parent: None,
            rest: rest(node, &place, warnings)?,
            morph_weights,
        });
    }
    for (index, node) in root.nodes.iter().enumerate() {
        for (at, child) in node.children.iter().flatten().map(Index::value).enumerate() {
            let place = format!("nodes[{index}].children[{at}]");
            get(&root.nodes, child, &place, "nodes")?;
            if let Some(parent) = joints[child].parent.replace(index) {
                let found = format!("node {child}, which is a child of node {parent} already");
                return Err(Problem::new(place, "a node without another parent", found));
            }
        }
    }
    Skeleton::new(joints).map_err(|problem| {
        let place = match problem {
            SkeletonError::Cycle { joint } | SkeletonError::ParentOutOfRange { joint, .. } => format!("nodes[{joint}]"),
        };
        Problem::new(place, "a tree of nodes", problem)
    })
}

fn rest_weights(root: &Root, meshes: &[Mesh], node: &Node, mesh: usize, place: &str) -> Result<Vec<f32>, Problem> {
    let targets = get(meshes, mesh, &format!("{place}.mesh"), "meshes")?.target_names.len();
    match &node.weights {
        Some(weights) if weights.len() != targets => {
            Err(Problem::new(format!("{place}.weights"), format!("{targets} weights"), weights.len()))
        }
        Some(weights) => Ok(weights.clone()),
        None => match &root.meshes[mesh].weights {
            Some(weights) if !weights.is_empty() => Ok(weights.clone()),
            _ => Ok(vec![0.0; targets]),
        },
    }
}

fn rest(node: &Node, place: &str, warnings: &mut Warnings) -> Result<Transform, Problem> {
    let transform = match node.matrix {
        Some(columns) => {
            if node.translation.is_some() || node.rotation.is_some() || node.scale.is_some() {
                let problem =
                    "it has a matrix together with translation, rotation or scale; the matrix is used".to_owned();
                warnings.push(Warning::Other { code: "matrix-and-trs", place: place.to_owned(), problem });
            }
            let matrix = Mat4::from_cols_array(&columns);
            let transform = Transform::from_matrix(&matrix);
            let recomposed = Mat4::from(transform.to_affine());
            let largest = columns.iter().fold(1.0_f32, |largest, number| largest.max(number.abs()));
            if matrix.is_finite() && !matrix.abs_diff_eq(recomposed, 1e-4 * largest) {
                warnings.push(Warning::MatrixNotDecomposable { node: place.to_owned() });
            }
            transform
        }
        None => {
            let rotation = node.rotation.map_or(Quat::IDENTITY, |rotation| Quat::from_array(rotation.0));
            // The length may be zero, or overflow.
            let length = rotation.length();
            let rotation = if length > 0.0 && length.is_finite() { rotation / length } else { Quat::IDENTITY };
            Transform {
                translation: node.translation.map_or(Vec3::ZERO, Vec3::from),
                rotation,
                scale: node.scale.map_or(Vec3::ONE, Vec3::from),
            }
        }
    };
    if transform.is_finite() {
        Ok(transform)
    } else {
        Err(Problem::new(place, "a transform of finite numbers", format!("{transform:?}")))
    }
}

/// Returns which joint draws which mesh. Without a skin, the influences of a mesh are not used.
pub fn instances(
    accessors: &Accessors,
    skeleton: &Skeleton,
    meshes: &[Mesh],
    skins: &[Skin],
    warnings: &mut Warnings,
) -> Result<Vec<MeshInstance>, Problem> {
    let vertices_of = |mesh: &Mesh| mesh.primitives.iter().map(|geometry| geometry.positions.len()).sum();
    let vertices: Vec<usize> = meshes.iter().map(vertices_of).collect();
    let budget = &accessors.budget;
    let mut instances = Vec::new();
    for (index, node) in accessors.document.root.nodes.iter().enumerate() {
        let (Some(mesh), Some(joint)) = (node.mesh, skeleton.joint_of_source(index)) else { continue };
        let place = format!("nodes[{index}]");
        let copies = instancing::copies(accessors, node, &place, warnings)?;
        let drawn = get(&vertices, mesh.value(), &place, "meshes")?.saturating_mul(copies.as_ref().map_or(1, Vec::len));
        budget.spend(Limit::DrawnVertices, drawn, &place)?;
        let calls = copies.as_ref().map_or(1, |copies| instancing::draw_calls(copies));
        let calls = calls.saturating_mul(meshes[mesh.value()].primitives.len());
        budget.spend(Limit::DrawCalls, calls, &place)?;
        let skin = node.skin.map(|skin| skin.value());
        if let Some(skin) = skin {
            let joints = get(skins, skin, &format_args!("{place}.skin"), "skins")?.joints().len();
            budget.spend(Limit::SkinMatrices, joints, &place)?;
        }
        let instance = MeshInstance::new(joint, mesh.value(), skin);
        match copies {
            None => instances.push(instance),
            Some(copies) => {
                let copy = |joint_from_mesh| MeshInstance { joint_from_mesh, ..instance };
                instances.extend(copies.into_iter().map(copy));
            }
        }
    }
    Ok(instances)
}

/// KHR_node_visibility.
pub fn hidden(root: &Root, skeleton: &Skeleton, warnings: &mut Warnings) -> Vec<JointIndex> {
    let mut hidden = Vec::new();
    for (index, node) in root.nodes.iter().enumerate() {
        let extension = node.extensions.as_ref().and_then(|extensions| extensions.others.get(VISIBILITY));
        match extension.and_then(|extension| extension.get("visible")) {
            None | Some(Value::Bool(true)) => {}
            Some(Value::Bool(false)) => hidden.extend(skeleton.joint_of_source(index)),
            Some(found) => {
                let place = format!("nodes[{index}].extensions.{VISIBILITY}.visible");
                let found: String = found.to_string().chars().take(40).collect();
                let problem = format!("expected true or false, found {found}; the node is shown");
                warnings.push(Warning::Other { code: "visibility", place, problem });
            }
        }
    }
    hidden
}

fn shared_name(name: &str) -> String {
    name.chars().take(MAX_SHARED_NAME).collect()
}

/// A missing node or scene is left out.
pub fn scenes(
    root: &Root,
    skeleton: &Skeleton,
    warnings: &mut Warnings,
) -> Result<(Vec<Scene>, Option<usize>), Problem> {
    let mut scenes = Vec::with_capacity(root.scenes.len());
    for (index, scene) in root.scenes.iter().enumerate() {
        let mut roots = Vec::with_capacity(scene.nodes.len());
        for (at, node) in scene.nodes.iter().map(Index::value).enumerate() {
            if let Err(problem) = get(&root.nodes, node, &format_args!("scenes[{index}].nodes[{at}]"), "nodes") {
                problem.leave_out("scene", "the node is left out", warnings)?;
            }
            roots.extend(skeleton.joint_of_source(node));
        }
        scenes.push(Scene { name: scene.name.clone().unwrap_or_default(), roots });
    }
    let mut default_scene = root.scene.map(|scene| scene.value());
    if let Some(scene) = default_scene
        && let Err(problem) = get(&root.scenes, scene, &"scene", "scenes")
    {
        problem.leave_out("scene", "the first scene is shown", warnings)?;
        default_scene = None;
    }
    let first = if scenes.is_empty() { None } else { Some(0) };
    Ok((scenes, default_scene.or(first)))
}

/// A camera that is missing or has no lens is left out.
pub fn cameras(document: &Document, skeleton: &Skeleton, warnings: &mut Warnings) -> Result<Vec<Camera>, Problem> {
    let root = &document.root;
    let mut cameras = Vec::new();
    for (index, node) in root.nodes.iter().enumerate() {
        let (Some(camera), Some(joint)) = (node.camera, skeleton.joint_of_source(index)) else { continue };
        if document.is_left_out(&format!("cameras[{}]", camera.value())) {
            continue;
        }
        match read_camera(root, node, camera.value(), joint, &format!("nodes[{index}].camera")) {
            Ok(camera) => cameras.push(camera),
            Err(problem) => problem.leave_out("camera", "the camera is left out", warnings)?,
        }
    }
    Ok(cameras)
}

fn read_camera(root: &Root, node: &Node, number: usize, joint: JointIndex, place: &str) -> Result<Camera, Problem> {
    let camera = get(&root.cameras, number, &place, "cameras")?;
    let projection = match (&camera.perspective, &camera.orthographic) {
        (Some(lens), _) => CameraProjection::Perspective { y_fov_radians: lens.yfov, near: lens.znear, far: lens.zfar },
        (None, Some(lens)) => CameraProjection::Orthographic { y_mag: lens.ymag, near: lens.znear, far: lens.zfar },
        (None, None) => return Err(Problem::new(place, "a perspective or orthographic camera", "neither")),
    };
    let name = match camera.name.as_deref().unwrap_or_default() {
        "" => node.name.clone().unwrap_or_default(),
        name => shared_name(name),
    };
    Ok(Camera { name, joint, number, projection })
}

/// KHR_lights_punctual. A light that is missing or of an unknown type is left out.
pub fn lights(document: &Document, skeleton: &Skeleton, warnings: &mut Warnings) -> Result<Vec<Light>, Problem> {
    let root = &document.root;
    let list: &[khr_lights_punctual::Light] = root.as_ref();
    let mut lights = Vec::new();
    for (index, node) in root.nodes.iter().enumerate() {
        let extension = node.extensions.as_ref().and_then(|extensions| extensions.khr_lights_punctual.as_ref());
        let Some(light_index) = extension.map(|extension| extension.light.value()) else { continue };
        let place = format!("nodes[{index}]");
        let light = match get(list, light_index, &format!("{place}.extensions.KHR_lights_punctual.light"), "lights") {
            Ok(light) => light,
            Err(problem) => {
                problem.leave_out("light", "the light is left out", warnings)?;
                continue;
            }
        };
        let Some(joint) = skeleton.joint_of_source(index) else { continue };
        let Some(kind) = light_kind(light) else {
            let here = format!("extensions.KHR_lights_punctual.lights[{light_index}]");
            if document.is_left_out(&here) {
                continue;
            }
            let found = document.quoted_at(&format!("{here}.type"));
            let problem = format!("light type {found} is not known; the light is left out");
            warnings.push(Warning::Other { code: "light-type", place, problem });
            continue;
        };
        lights.push(Light {
            joint,
            number: light_index,
            color: Vec3::from(light.color),
            intensity: light.intensity,
            range: light.range,
            kind,
        });
    }
    if lights.len() > MAX_LIGHTS {
        let problem = format!("{} lights; the {MAX_LIGHTS} that contribute most are drawn", lights.len());
        warnings.push(Warning::Other { code: "lights-dropped", place: "KHR_lights_punctual".to_owned(), problem });
    }
    Ok(lights)
}

fn light_kind(light: &khr_lights_punctual::Light) -> Option<LightKind> {
    let Checked::Valid(kind) = light.type_ else { return None };
    let (inner_cone_radians, outer_cone_radians) =
        light.spot.as_ref().map_or((0.0, FRAC_PI_4), |spot| (spot.inner_cone_angle, spot.outer_cone_angle));
    Some(match kind {
        LightType::Directional => LightKind::Directional,
        LightType::Point => LightKind::Point,
        LightType::Spot => LightKind::Spot { inner_cone_radians, outer_cone_radians },
    })
}
