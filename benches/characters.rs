//! One character-frame: sampling a clip, local to model space, skin palette. For 1, 100 and 1,000 characters at
//! different phases, playing forward at 60 frames per second.

mod support;

use std::f32::consts::TAU;
use std::hint::black_box;

use gaitway_character::anim::{
    Clip, ClipBuilder, Interpolation, Joint, Keys, Pose, SampleCursor, Skeleton, Transform, model_from_joint,
};
use gaitway_character::mesh::{PaletteEntry, Skin, SkinningMode, write_palette};
use glam::{Affine3A, Quat, Vec3};
use support::data_folder::data_folder;
use support::{files_of, measure};

struct Character {
    time_secs: f32,
    cursor: SampleCursor,
}

struct Rig {
    skeleton: Skeleton,
    skin: Skin,
    clip: Clip,
}

fn main() {
    let rig = walker();
    println!("{:40} {:>10} {:>12} {:>10} {:>10}", "", "characters", "µs/character", "ns/joint", "(fastest)");
    for count in [1, 100, 1000] {
        print("synthetic: 67 joints, 30 keys, T R S", &rig, count, Stage::All);
    }
    print("  sampling only", &rig, 100, Stage::Sample);
    print("  local to model space only", &rig, 100, Stage::Model);
    print("  palette only", &rig, 100, Stage::Palette);
    for (path, clip) in
        [("khronos/Fox/glTF-Binary/Fox.glb", "Run"), ("threejs/Soldier.glb", "Walk"), ("threejs/Xbot.glb", "walk")]
    {
        if let Some(rig) = real(path, clip) {
            for count in [1, 100, 1000] {
                print(&format!("{path} {clip}"), &rig, count, Stage::All);
            }
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Stage {
    All,
    Sample,
    Model,
    Palette,
}

fn print(name: &str, rig: &Rig, count: usize, stage: Stage) {
    let length = rig.clip.duration_secs();
    let mut characters: Vec<Character> = (0..count)
        .map(|at| Character { time_secs: length * at as f32 / count as f32, cursor: SampleCursor::default() })
        .collect();
    let mut pose: Pose = rig.skeleton.rest().clone();
    let mut world: Vec<Affine3A> = vec![Affine3A::IDENTITY; rig.skeleton.len()];
    let mut palette: Vec<PaletteEntry> = Vec::new();
    let nanos = measure(|| {
        palette.clear();
        for character in &mut characters {
            character.time_secs += 1.0 / 60.0;
            if character.time_secs > length {
                character.time_secs -= length;
            }
            if stage == Stage::All || stage == Stage::Sample {
                pose.copy_from(rig.skeleton.rest());
                rig.clip.sample(&rig.skeleton, character.time_secs, &mut character.cursor, &mut pose);
            }
            if stage == Stage::All || stage == Stage::Model {
                model_from_joint(&rig.skeleton, black_box(&pose), Affine3A::IDENTITY, &mut world);
            }
            if stage == Stage::All || stage == Stage::Palette {
                write_palette(&rig.skin, black_box(&world), SkinningMode::Linear, &mut palette);
            }
        }
        black_box((&pose, &world, &palette));
    });
    let joints = (count * rig.skin.joints().len()) as f64;
    println!(
        "{name:40} {count:>10} {:>12.3} {:>10.1} {:>10.1}",
        nanos.median / count as f64 / 1000.0,
        nanos.median / joints,
        nanos.fastest / joints
    );
}

/// The first skin of a real file with one of its clips; none without the data folder.
fn real(path: &str, clip: &str) -> Option<Rig> {
    let files = files_of(&data_folder()?.join(path))?;
    let asset = gaitway_formats::load(&files).expect("a file known to load");
    let parts = asset.into_parts();
    let clip = parts.clips.into_iter().find(|found| found.name() == clip)?;
    Some(Rig { skin: parts.skins.into_iter().next()?, skeleton: parts.skeleton, clip })
}

/// A synthetic walk with the joints, keys and channels of a typical character: translation, rotation and scale on every
/// joint, none of them constant.
fn walker() -> Rig {
    const JOINTS: usize = 67;
    const KEYS: usize = 30;
    let joints = (0..JOINTS)
        .map(|at| Joint {
            name: format!("joint {at}"),
            // Five chains from the hips.
            parent: at.checked_sub(if at % 15 == 1 { at } else { 1 }),
            rest: Transform::from_translation(Vec3::Y * 0.1),
            morph_weights: Vec::new(),
        })
        .collect();
    let skeleton = Skeleton::new(joints).expect("the parents exist");
    let times: Vec<f32> = (0..KEYS).map(|key| key as f32 / 30.0).collect();
    let phases = || times.iter().map(|time| TAU * time);
    let mut builder = ClipBuilder::new("walk", &skeleton);
    for joint in skeleton.joints() {
        let at = joint.get() as f32;
        let translations = phases().map(|phase| Vec3::new(0.0, 0.1, 1e-6 * (phase + at).sin())).collect();
        let rotations = phases().map(|phase| Quat::from_rotation_x(0.4 * (phase + at).sin())).collect();
        let scales = phases().map(|phase| Vec3::ONE + 1e-6 * (phase + at).cos()).collect();
        for keys in [Keys::Translation(translations), Keys::Rotation(rotations), Keys::Scale(scales)] {
            builder.channel(joint, Interpolation::Linear, &times, keys).expect("the keys match the times");
        }
    }
    let clip = builder.build();
    let bind = vec![Affine3A::from_translation(Vec3::Y); JOINTS];
    let skin = Skin::new("skin".into(), skeleton.joints().collect(), bind, JOINTS).expect("the joints exist");
    Rig { skeleton, skin, clip }
}
