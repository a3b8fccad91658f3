//! Benchmarks that run in the page, for benches/web.

use gaitway_character::anim::{ClipQuery, SampleCursor, find_clip, model_from_joint};
use gaitway_character::asset::Asset;
use gaitway_character::mesh::{PaletteEntry, SkinningMode, write_palette};
use gaitway_formats::{FileSet, load};
use gaitway_retarget::{Body, Retargeting, propose, recognize};
use glam::Affine3A;
use wasm_bindgen::prelude::*;

use crate::files::{ImageLimits, Item, Role, open_items};

struct Character {
    phase_secs: f64,
    cursor: SampleCursor,
}

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_namespace = performance)]
    fn now() -> f64;
}

/// Loads a .glb with its images without showing it, like `GLTFLoader.parse`.
///
/// # Errors
/// If the file cannot be read.
#[wasm_bindgen]
pub async fn bench_load(bytes: Vec<u8>) -> Result<(), JsError> {
    let items = vec![Item::File("model.glb".to_owned(), bytes)];
    let model = open_items(&ImageLimits::default(), items, Role::Model, &|_, _, _| (), None)
        .await
        .map_err(|error| JsError::new(&error.to_string()))?;
    std::hint::black_box(model);
    Ok(())
}

/// Returns the µs per character and frame to sample a clip of a .glb, convert it to model space and write the skins' palettes.
/// Each character has its own phase.
///
/// # Errors
/// If the file cannot be read or has no clip of that name.
#[wasm_bindgen]
pub fn bench_characters(bytes: &[u8], clip: &str, characters: u32, frames: u32) -> Result<f64, JsError> {
    let asset = read(bytes)?;
    let clip = find_clip(asset.clips.iter(), ClipQuery::Name(clip)).ok_or_else(|| JsError::new("no such clip"))?;
    let clip = &asset.clips[clip];
    let skeleton = &asset.skeleton;
    let duration_secs = f64::from(clip.duration_secs()).max(1e-3);
    let mut crowd: Vec<Character> = (0..characters)
        .map(|index| Character {
            phase_secs: duration_secs * f64::from(index) / f64::from(characters.max(1)),
            cursor: SampleCursor::default(),
        })
        .collect();
    // As in a frame of the page, the pose is a means to the palette, and none is kept.
    let mut pose = skeleton.rest().clone();
    let mut world_from_joint: Vec<Affine3A> = Vec::with_capacity(skeleton.len());
    let mut palette: Vec<PaletteEntry> = Vec::new();
    let start_ms = now();
    for frame in 0..frames {
        for character in &mut crowd {
            let time_secs = (character.phase_secs + f64::from(frame) / 60.0) % duration_secs;
            pose.copy_from(skeleton.rest());
            clip.sample(skeleton, time_secs as f32, &mut character.cursor, &mut pose);
            model_from_joint(skeleton, &pose, Affine3A::IDENTITY, &mut world_from_joint);
            palette.clear();
            for skin in &asset.skins {
                write_palette(skin, &world_from_joint, SkinningMode::Linear, &mut palette);
            }
            std::hint::black_box(&palette);
        }
    }
    Ok(1000.0 * (now() - start_ms) / (f64::from(frames.max(1)) * f64::from(characters.max(1))))
}

/// Returns the ms to retarget a clip of one .glb to another with the proposed map, excluding the proposal.
///
/// # Errors
/// If a file cannot be read, the motion has no clip of that name, or the two have nothing in common.
#[wasm_bindgen]
pub fn bench_retarget(model: &[u8], motion: &[u8], clip: &str, rounds: u32) -> Result<f64, JsError> {
    let error = |message: &dyn std::fmt::Display| JsError::new(&message.to_string());
    let (model, motion) = (read(model)?, read(motion)?);
    let clip = find_clip(motion.clips.iter(), ClipQuery::Name(clip)).ok_or_else(|| error(&"no such clip"))?;
    let map = propose(&model, &motion).to_map(&model, &motion).resolve(&model, &motion).map_err(|e| error(&e))?;
    let slots = [recognize(&model).humanoid(), recognize(&motion).humanoid()];
    let start_ms = now();
    for _ in 0..rounds {
        let bodies = [Body { asset: &model, slots: &slots[0] }, Body { asset: &motion, slots: &slots[1] }];
        let retargeted = Retargeting::new(bodies[0], bodies[1], clip, &map).and_then(|pair| pair.bake());
        std::hint::black_box(retargeted.map_err(|e| error(&e))?);
    }
    Ok((now() - start_ms) / f64::from(rounds.max(1)))
}

fn read(bytes: &[u8]) -> Result<Asset, JsError> {
    let mut set = FileSet::default();
    set.insert("model.glb", bytes);
    load(&set).map_err(|error| JsError::new(&error.to_string()))
}
