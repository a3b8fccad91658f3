//! Retargets a motion to a character and writes the character with the new clip:
//!
//! `cargo run --no-default-features --example retarget -- assets/samples/pilot.glb assets/samples/walk.bvh out.glb`

use anyhow::Context;
use gaitway_formats::{FileSet, load, write_model};
use gaitway_retarget::{Body, Retargeting, propose};

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [model_path, motion_path, out] = arguments.as_slice() else { anyhow::bail!("usage: MODEL MOTION OUT.glb") };

    // Loaders read files in memory, by name. A .gltf would need its buffers and images in the set as well.
    let read = |path: &String| -> anyhow::Result<FileSet> {
        let mut files = FileSet::default();
        files.insert(path.as_str(), std::fs::read(path).with_context(|| path.clone())?);
        Ok(files)
    };
    let model_files = read(model_path)?;
    let (model, motion) = (load(&model_files)?, load(&read(motion_path)?)?);

    // Which joint follows which, and why.
    let proposal = propose(&model, &motion);
    for pair in &proposal.pairs {
        let names = [model.skeleton.name(pair.target), motion.skeleton.name(pair.source)];
        println!("{:24} follows {:24} {:3.0} %  {}", names[0], names[1], 100.0 * pair.confidence, pair.reason);
    }

    // Edit the map's entries to correct it; `JointMap::to_file` gives the form to save.
    let map = proposal.to_map(&model, &motion).resolve(&model, &motion)?;
    let (model_slots, motion_slots) = (proposal.model.humanoid(), proposal.motion.humanoid());
    let target = Body { asset: &model, slots: &model_slots };
    let source = Body { asset: &motion, slots: &motion_slots };
    let retargeted = Retargeting::new(target, source, 0, &map)?.bake()?;

    let glb = write_model(&model_files, model_path, &model.skeleton, &[&retargeted.clip])?;
    std::fs::write(out, glb).with_context(|| out.clone())?;
    println!("wrote {out} with the clip “{}”", retargeted.clip.name());
    Ok(())
}
