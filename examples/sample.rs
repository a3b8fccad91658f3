//! Prints where the joints of a character are at one moment of its first clip, in metres:
//!
//! `cargo run --no-default-features --example sample -- assets/samples/creature.glb 0.5`

use anyhow::Context;
use gaitway_character::anim::{SampleCursor, model_from_joint};
use gaitway_formats::{FileSet, load};
use glam::Affine3A;

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, time_secs] = arguments.as_slice() else { anyhow::bail!("usage: MODEL SECONDS") };
    let time_secs: f32 = time_secs.parse().context("SECONDS")?;

    let mut files = FileSet::default();
    files.insert(path.as_str(), std::fs::read(path).with_context(|| path.clone())?);
    let asset = load(&files)?;
    let clip = asset.clips.first().context("the file has no clip")?;

    // Joints that the clip doesn't animate keep what is in the pose: start from the rest pose. A cursor that is kept
    // from frame to frame makes forward playback cheap.
    let mut pose = asset.skeleton.rest().clone();
    let mut cursor = SampleCursor::default();
    clip.sample(&asset.skeleton, time_secs, &mut cursor, &mut pose);

    let mut world_from_joint = Vec::new();
    model_from_joint(&asset.skeleton, &pose, Affine3A::IDENTITY, &mut world_from_joint);
    println!("“{}” at {time_secs} s of {} s", clip.name(), clip.duration_secs());
    for (joint, world_from_joint) in asset.skeleton.joints().zip(&world_from_joint) {
        let [x, y, z] = world_from_joint.translation.to_array();
        println!("{:32} {x:8.3} {y:8.3} {z:8.3}", asset.skeleton.name(joint));
    }
    Ok(())
}
