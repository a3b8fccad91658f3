//! The walker: a small robot with 22 joints in a T-pose facing +Z, smooth weights at every bend, three clips and one
//! morph target (closing eyes).

mod clips;
mod shape;

use gaitway_character::anim::{ChannelError, Joint, JointIndex, Skeleton, SkeletonError, Transform};
use gaitway_character::asset::{Asset, AssetError, AssetParts, MeshInstance, Scene};
use gaitway_character::mesh::{Material, Mesh, Skin, SkinError};
use glam::{Affine3A, Vec3, Vec4};

/// Indices into [`JOINTS`].
mod joint {
    pub const HIPS: usize = 1;
    pub const SPINE: usize = 2;
    pub const CHEST: usize = 3;
    pub const NECK: usize = 4;
    pub const HEAD: usize = 5;
    /// Shoulder, upper arm, lower arm, hand.
    pub const LEFT_ARM: [usize; 4] = [6, 7, 8, 9];
    pub const RIGHT_ARM: [usize; 4] = [10, 11, 12, 13];
    /// Upper leg, lower leg, foot, toes.
    pub const LEFT_LEG: [usize; 4] = [14, 15, 16, 17];
    pub const RIGHT_LEG: [usize; 4] = [18, 19, 20, 21];
    pub const COUNT: usize = 22;
}

/// Name, parent and T-pose position of each joint, in metres from the point on the ground between the feet. Left is +X.
const JOINTS: [(&str, Option<usize>, [f32; 3]); joint::COUNT] = [
    ("Root", None, [0.0, 0.0, 0.0]),
    ("Hips", Some(0), [0.0, 0.94, 0.0]),
    ("Spine", Some(1), [0.0, 1.05, -0.005]),
    ("Chest", Some(2), [0.0, 1.20, -0.01]),
    ("Neck", Some(3), [0.0, 1.45, -0.01]),
    ("Head", Some(4), [0.0, 1.53, 0.0]),
    ("LeftShoulder", Some(3), [0.05, 1.385, -0.01]),
    ("LeftUpperArm", Some(6), [0.185, 1.385, -0.01]),
    ("LeftLowerArm", Some(7), [0.445, 1.385, -0.01]),
    ("LeftHand", Some(8), [0.685, 1.385, -0.01]),
    ("RightShoulder", Some(3), [-0.05, 1.385, -0.01]),
    ("RightUpperArm", Some(10), [-0.185, 1.385, -0.01]),
    ("RightLowerArm", Some(11), [-0.445, 1.385, -0.01]),
    ("RightHand", Some(12), [-0.685, 1.385, -0.01]),
    ("LeftUpperLeg", Some(1), [0.095, 0.90, 0.0]),
    ("LeftLowerLeg", Some(14), [0.095, 0.48, 0.0]),
    ("LeftFoot", Some(15), [0.095, 0.08, 0.0]),
    ("LeftToes", Some(16), [0.095, 0.025, 0.13]),
    ("RightUpperLeg", Some(1), [-0.095, 0.90, 0.0]),
    ("RightLowerLeg", Some(18), [-0.095, 0.48, 0.0]),
    ("RightFoot", Some(19), [-0.095, 0.08, 0.0]),
    ("RightToes", Some(20), [-0.095, 0.025, 0.13]),
];

/// The nodes of the two meshes, after the joints.
const BODY_NODE: usize = joint::COUNT;
const EYES_NODE: usize = joint::COUNT + 1;

fn position(joint: usize) -> Vec3 {
    JOINTS[joint].2.into()
}

/// Built from constants, so validation cannot fail; a test checks that.
pub(super) fn asset() -> Asset {
    build().unwrap_or_default()
}

#[derive(Debug, thiserror::Error)]
enum WalkerError {
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
    #[error(transparent)]
    Skin(#[from] SkinError),
    #[error(transparent)]
    Asset(#[from] AssetError),
    #[error(transparent)]
    Channel(#[from] ChannelError),
}

fn build() -> Result<Asset, WalkerError> {
    let skeleton = skeleton()?;
    let skin = skin(&skeleton)?;
    let meshes = vec![
        Mesh { name: "Body".to_owned(), primitives: shape::body(), ..Mesh::default() },
        Mesh {
            name: "Eyes".to_owned(),
            primitives: vec![shape::eyes()],
            target_names: vec!["Blink".to_owned()],
            ..Mesh::default()
        },
    ];
    let joint_of_source = |source: usize| skeleton.joint_of_source(source).unwrap_or(JointIndex(0));
    let instances = vec![
        MeshInstance::new(joint_of_source(BODY_NODE), 0, Some(0)),
        MeshInstance::new(joint_of_source(EYES_NODE), 1, Some(0)),
    ];
    Ok(Asset::new(AssetParts {
        format: "sample",
        generator: "Gaitway".to_owned(),
        clips: clips::all(&skeleton)?,
        scenes: vec![Scene {
            name: "Walker".to_owned(),
            roots: vec![joint_of_source(0), joint_of_source(BODY_NODE), joint_of_source(EYES_NODE)],
        }],
        default_scene: Some(0),
        skins: vec![skin],
        meshes,
        instances,
        materials: materials(),
        skeleton,
        ..AssetParts::default()
    })?)
}

fn skeleton() -> Result<Skeleton, SkeletonError> {
    let mut joints: Vec<Joint> = JOINTS
        .iter()
        .enumerate()
        .map(|(index, &(name, parent, _))| Joint {
            name: name.to_owned(),
            parent,
            rest: Transform::from_translation(position(index) - parent.map_or(Vec3::ZERO, position)),
            morph_weights: Vec::new(),
        })
        .collect();
    joints.push(Joint { name: "Body".to_owned(), ..Joint::default() });
    joints.push(Joint { name: "Eyes".to_owned(), morph_weights: vec![0.0], ..Joint::default() });
    Skeleton::new(joints)
}

/// Bound in the T-pose, where every rotation is identity.
fn skin(skeleton: &Skeleton) -> Result<Skin, SkinError> {
    let joints = (0..joint::COUNT).filter_map(|source| skeleton.joint_of_source(source)).collect();
    let joint_from_bind = (0..joint::COUNT).map(|joint| Affine3A::from_translation(-position(joint))).collect();
    Skin::new("Walker".to_owned(), joints, joint_from_bind, skeleton.len())
}

/// In the order of [`shape`]'s material indices.
fn materials() -> Vec<Material> {
    let material = |name: &str, color: [f32; 3], metallic: f32, roughness: f32| Material {
        name: name.to_owned(),
        base_color: Vec3::from(color).extend(1.0),
        metallic,
        roughness,
        ..Material::default()
    };
    vec![
        material("Shell", [1.0, 1.0, 1.0], 0.0, 0.42),
        material("Visor", [0.012, 0.016, 0.024], 0.0, 0.08),
        Material {
            emissive: Vec3::new(0.25, 2.4, 3.0),
            base_color: Vec4::new(0.02, 0.2, 0.25, 1.0),
            ..material("Eyes", [0.0; 3], 0.0, 0.4)
        },
    ]
}
