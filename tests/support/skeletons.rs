//! Skeletons built in code.

// Each test program uses a part of it.
#![allow(dead_code)]

use gaitway_character::anim::{Joint, JointIndex, Skeleton, Transform};
use gaitway_character::asset::{Asset, AssetParts, MeshInstance};
use gaitway_character::mesh::{Geometry, Influences, Mesh, Skin};
use glam::{Affine3A, Vec3};

/// A joint of a list, with the index of its parent.
pub fn joint(name: &str, parent: Option<usize>, rest: Transform) -> Joint {
    Joint { name: name.to_owned(), parent, rest, morph_weights: Vec::new() }
}

/// A chain of joints, each `step` away from its parent.
pub fn chain<'a>(names: impl IntoIterator<Item = &'a str>, step: Vec3) -> Vec<Joint> {
    let link = |(at, name): (usize, &str)| joint(name, at.checked_sub(1), Transform::from_translation(step));
    names.into_iter().enumerate().map(link).collect()
}

/// An asset that is nothing but a skeleton.
pub fn asset(joints: Vec<Joint>) -> Asset {
    Asset::from(Skeleton::new(joints).expect("a tree"))
}

/// Gives an asset a skin of all joints, in which only `moving` have a vertex.
pub fn with_skin(asset: &Asset, moving: &[&str]) -> Asset {
    let skeleton = asset.skeleton.clone();
    let joints: Vec<JointIndex> = skeleton.joints().collect();
    let of = |name: &&str| joints.iter().position(|&joint| skeleton.name(joint) == *name).expect("a joint") as u16;
    let influences = Influences {
        stride: 4,
        joints: moving.iter().flat_map(|name| [of(name), 0, 0, 0]).collect(),
        weights: [1.0, 0.0, 0.0, 0.0].repeat(moving.len()),
    };
    let geometry = Geometry {
        file_vertices: moving.len(),
        positions: vec![Vec3::ZERO; moving.len()],
        indices: vec![0; 3],
        influences,
        ..Geometry::default()
    };
    let skin = Skin::new(String::new(), joints.clone(), vec![Affine3A::IDENTITY; joints.len()], joints.len());
    let parts = AssetParts {
        meshes: vec![Mesh { primitives: vec![geometry], ..Mesh::default() }],
        instances: vec![MeshInstance::new(joints[0], 0, Some(0))],
        skins: vec![skin.expect("a skin")],
        skeleton,
        ..AssetParts::default()
    };
    Asset::new(parts).expect("an asset")
}
