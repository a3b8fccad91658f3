//! The samples' clips, written alone.

use gaitway_character::anim::JointIndex;
use gaitway_formats::{FileSet, load_with, write_bvh, write_vrma};
use gaitway_scene::library::Model;
use gaitway_scene::samples;

use crate::read_back::{METRES, read_bvh, read_vrma, world};

fn samples() -> Vec<Model> {
    let file = |name: &str| {
        let mut files = FileSet::default();
        for (file, bytes) in samples::files(name) {
            files.insert(file, bytes);
        }
        let asset = load_with(&files, &METRES).unwrap_or_else(|error| panic!("{name}: {error}"));
        Model::new(name.to_owned(), asset, Vec::new())
    };
    vec![samples::load(samples::WALKER).expect("is generated"), file("mannequin_run")]
}

/// The sample characters, whose rests, scales and hierarchies are what programs export.
#[test]
fn samples_survive_both_formats() {
    for model in samples() {
        let name = &model.source;
        let asset = &model.asset;
        let joints: Vec<JointIndex> = asset.skeleton.joints().filter(|&joint| model.rig().is_real(joint)).collect();
        let slots = model.body().slots;
        for clip in &asset.clips {
            let bvh =
                read_bvh(write_bvh(asset, &asset.skeleton, &joints, clip, clip.frames_per_sec()).expect("is written"));
            let vrma = read_vrma(write_vrma(asset, slots, model.forward(), clip).expect("is written"));
            let bones = vrma.humanoid.as_ref().expect("declares its bones");
            for &secs in bvh.clips[0].timelines()[0].iter().step_by(7) {
                let expected = world(asset, clip, secs.min(clip.duration_secs()));
                let found = world(&bvh, &bvh.clips[0], secs);
                for (place, joint) in joints.iter().enumerate() {
                    let off = expected[joint.get()].distance(found[place]);
                    assert!(off < 1e-4, "{name}, {} at {secs}: off by {off}", asset.skeleton.name(*joint));
                }
                let found = world(&vrma, &vrma.clips[0], secs);
                for (slot, joint) in bones.0.iter().map(|(slot, joint)| (slot, found[joint.get()])) {
                    let off = expected[slots.0[slot].get()].distance(joint);
                    assert!(off < 1e-3, "{name}, {slot:?} at {secs}: off by {off}");
                }
            }
        }
    }
}
