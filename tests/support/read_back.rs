//! Written clips, read again.

// Each test program uses a part of it.
#![allow(dead_code)]

use gaitway_character::anim::{Clip, SampleCursor, model_from_joint};
use gaitway_character::asset::Asset;
use gaitway_formats::{LoadOptions, load_with};
use glam::{Affine3A, Vec3};

use crate::build_gltf::one;

pub const METRES: LoadOptions = LoadOptions { bvh_unit_metres: Some(1.0), bvh_z_up: Some(false), awaits_images: false };

pub fn world(asset: &Asset, clip: &Clip, time_secs: f32) -> Vec<Vec3> {
    let (mut pose, mut world) = (asset.skeleton.rest().clone(), Vec::new());
    clip.sample(&asset.skeleton, time_secs, &mut SampleCursor::default(), &mut pose);
    model_from_joint(&asset.skeleton, &pose, Affine3A::IDENTITY, &mut world);
    world.iter().map(|joint| joint.translation.into()).collect()
}

pub fn read_bvh(bytes: Vec<u8>) -> Asset {
    load_with(&one("written.bvh", bytes), &METRES).unwrap_or_else(|error| panic!("{error}"))
}

pub fn read_vrma(bytes: Vec<u8>) -> Asset {
    load_with(&one("written.vrma", bytes), &METRES).unwrap_or_else(|error| panic!("{error}"))
}
