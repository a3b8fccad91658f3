//! Skins a character on the CPU with each of the three methods and prints the size of its bounding box, without props:
//!
//! `cargo run --no-default-features --example deform -- assets/samples/dwarf.glb 0.5`

use anyhow::Context;
use gaitway_character::anim::{SampleCursor, model_from_joint};
use gaitway_character::mesh::{DeformedVertices, SkinningMode, deform, write_palette};
use gaitway_formats::{FileSet, load};
use glam::{Affine3A, Vec3};

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, time_secs] = arguments.as_slice() else { anyhow::bail!("usage: MODEL SECONDS") };
    let mut files = FileSet::default();
    files.insert(path.as_str(), std::fs::read(path).with_context(|| path.clone())?);
    let asset = load(&files)?;

    let mut pose = asset.skeleton.rest().clone();
    let clip = asset.clips.first().context("the file has no clip")?;
    clip.sample(&asset.skeleton, time_secs.parse()?, &mut SampleCursor::default(), &mut pose);
    let mut world_from_joint = Vec::new();
    model_from_joint(&asset.skeleton, &pose, Affine3A::IDENTITY, &mut world_from_joint);

    for mode in [SkinningMode::Linear, SkinningMode::Rigid, SkinningMode::DualQuaternion] {
        let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for instance in &asset.instances {
            let Some(skin) = instance.skin else { continue };
            let (mut palette, mut deformed) = (Vec::new(), DeformedVertices::default());
            write_palette(&asset.skins[skin], &world_from_joint, mode, &mut palette);
            let morph_weights = &pose.morph_weights[asset.skeleton.morph_range(instance.joint)];
            for geometry in &asset.meshes[instance.mesh].primitives {
                deform(geometry, morph_weights, &palette, mode, &mut deformed);
                min = deformed.positions.iter().copied().fold(min, Vec3::min);
                max = deformed.positions.iter().copied().fold(max, Vec3::max);
            }
        }
        println!("{mode:?}: {:.3} m", max - min);
    }
    Ok(())
}
