//! Skeletons built in code.

// Each test program uses a part of it.
#![allow(dead_code)]

use gaitway_character::anim::{Joint, Skeleton, Transform};
use gaitway_character::asset::Asset;
use glam::Vec3;

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
