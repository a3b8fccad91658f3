//! Damaged files, the same on every run: flipped bits, truncation, other numbers. The loader may reject or load them,
//! but what it loads must be consistent, and nothing may panic.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

use gaitway_character::anim::{JointIndex, TimeRange};
use gaitway_character::asset::Asset;
use gaitway_formats::{FileSet, LoadOptions, convert, load, missing_files, write_bvh, write_motion, write_vrma};
use gaitway_retarget::{
    ClipChanges, ClipLayer, ClipOverLayers, LayerMode, Pin, PinGoal, PinTimes, Pinning, StackedLayer, Symmetry,
    bake_stack, change_clip, recognize,
};
use glam::{Affine3A, Vec3};

use crate::build_gltf::{Build, one};
use crate::data_folder::data_folder;
use crate::file_set::file_set;
use crate::random::Random;

const CASES_PER_FILE: usize = 150;

const NUMBERS: [&str; 14] = [
    "0",
    "1",
    "2",
    "3",
    "7",
    "255",
    "65535",
    "65536",
    "4294967295",
    "18446744073709551615",
    "-1",
    "0.5",
    "1e30",
    "1e999",
];

pub fn damage(file: &[u8], random: &mut Random) -> Vec<u8> {
    let mut file = file.to_vec();
    match random.below(7) {
        0 => file.truncate(random.below(file.len())),
        1 => {
            for _ in 0..=random.below(8) {
                let at = random.below(file.len());
                file[at] ^= 1 << random.below(8);
            }
        }
        2 => {
            let (at, length) = (random.below(file.len()), random.below(16));
            let end = (at + length).min(file.len());
            file[at..end].fill([0, 0x7F, 0xFF][random.below(3)]);
        }
        3 => repeat_or_drop(&mut file, random),
        // Mostly numbers in the JSON: these are what a reader must not trust.
        _ => {
            for _ in 0..=random.below(2) {
                replace_number(&mut file, random);
            }
        }
    }
    file
}

/// Removes a piece or repeats it, so that words and braces are missing or duplicated.
fn repeat_or_drop(file: &mut Vec<u8>, random: &mut Random) {
    let at = random.below(file.len());
    let end = (at + random.below(40)).min(file.len());
    let piece = file[at..end].to_vec();
    match random.below(2) {
        0 => drop(file.drain(at..end)),
        _ => drop(file.splice(at..at, piece)),
    }
}

/// Replaces a number in the text, and corrects a GLB's lengths so that it is read at all.
fn replace_number(file: &mut Vec<u8>, random: &mut Random) {
    let is_glb = file.starts_with(b"glTF") && file.len() >= 20;
    let (start, end) = match is_glb {
        true => (20, (20 + u32::from_le_bytes([file[12], file[13], file[14], file[15]]) as usize).min(file.len())),
        false => (0, file.len()),
    };
    let is_number = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'-' | b'.');
    if end <= start {
        return;
    }
    let from = start + random.below(end - start);
    let Some(first) = (from..end).find(|&at| is_number(&file[at])) else { return };
    let length = file[first..end].iter().take_while(|byte| is_number(byte)).count();
    let number = NUMBERS[random.below(NUMBERS.len())];
    file.splice(first..first + length, number.bytes());
    if is_glb {
        let chunk = end - start - length + number.len();
        file[12..16].copy_from_slice(&(chunk as u32).to_le_bytes());
        let total = file.len() as u32;
        file[8..12].copy_from_slice(&total.to_le_bytes());
    }
}

fn check(name: &str, file: &[u8], random: &mut Random, failures: &mut Vec<String>) -> usize {
    let mut read = 0;
    for case in 0..CASES_PER_FILE {
        let files = one(name, damage(file, random));
        let result = catch_unwind(AssertUnwindSafe(|| {
            let _ = missing_files(&files);
            load(&files).map(|asset| {
                check_asset(&files, &asset);
                // That takes the longest.
                if case % 6 == 5 {
                    check_clips(&asset);
                }
            })
        }));
        match result {
            Ok(Ok(())) => read += 1,
            Ok(Err(problem)) => assert!(!problem.to_string().is_empty()),
            Err(_) => failures.push(format!("{name}, case {case}")),
        }
    }
    read
}

/// Whatever loads is consistent, and can be written, or the error says why not.
fn check_asset(files: &FileSet, asset: &Asset) {
    let skinned = |mesh: usize| {
        let of_mesh = asset.instances.iter().filter(move |instance| instance.mesh == mesh);
        of_mesh.filter_map(|instance| Some(asset.skins[instance.skin?].joints().len())).min()
    };
    for (index, mesh) in asset.meshes.iter().enumerate() {
        for geometry in &mesh.primitives {
            geometry.validate(skinned(index)).expect("consistent geometry");
        }
    }
    assert!(asset.skeleton.rest().locals().all(|local| local.is_finite()));
    let clips: Vec<_> = asset.clips.iter().collect();
    for written in [write_motion(asset, &asset.skeleton, &clips), convert(files, &LoadOptions::default())] {
        match written {
            Ok(written) => drop(load(&one("written.glb", written)).expect("what is written can be read")),
            Err(problem) => assert!(!problem.to_string().is_empty()),
        }
    }
}

/// Whatever its clips are, they can be changed, layered, pinned and written in each format, or the error says why not.
fn check_clips(asset: &Asset) {
    let skeleton = &asset.skeleton;
    let recognized = recognize(asset);
    let slots = recognized.humanoid();
    let joints: Vec<JointIndex> = skeleton.joints().collect();
    let Some(clip) = asset.clips.first() else { return };
    let trim = Some(TimeRange { start_secs: 0.1, end_secs: 0.4 });
    let (offset, turn_degrees) = ([1.0, -2.0], 30.0);
    let changes =
        ClipChanges { mirror: true, trim, reverse: true, speed: 2.0, loop_secs: Some(0.1), offset, turn_degrees };
    let changed = change_clip(asset, clip, &changes, || Symmetry::of(asset, &recognized)).clip;
    let layer = ClipLayer { mode: LayerMode::Additive, weight: 0.5, speed: 1.5, ..ClipLayer::default() };
    let source = ClipOverLayers { clip: &changed, below: &[] };
    let stacked = StackedLayer { layer: &layer, source, included: vec![true; skeleton.len()] };
    let layered = bake_stack(skeleton, clip, &[stacked]);
    let mut pinning =
        Pinning { asset, body: &recognized, pins: &BTreeMap::new(), world_from_model: Affine3A::IDENTITY, eye: None };
    let goals = [PinGoal::Point(Vec3::ONE), PinGoal::Look(Vec3::Y)];
    let times = Some(PinTimes { start_secs: 0.2, end_secs: 0.3, blend_secs: 0.1 });
    let pin = |number| Some((number, Pin { goal: *goals.iter().find(|&&goal| pinning.allows(number, goal))?, times }));
    let pins: BTreeMap<usize, Pin> = (0..skeleton.len()).filter_map(pin).take(3).collect();
    pinning.pins = &pins;
    let pinned = pinning.bake(clip, clip.duration_secs().into());
    for clip in [clip, &changed, &layered, &pinned] {
        let written = [
            ("bvh", write_bvh(asset, skeleton, &joints, clip, 30.0)),
            ("vrma", write_vrma(asset, &slots, recognized.facing.forward, clip)),
        ];
        for (extension, written) in written {
            match written {
                Ok(bytes) => {
                    let name = format!("written.{extension}");
                    load(&one(&name, bytes)).unwrap_or_else(|problem| panic!("{name} can't be read: {problem}"));
                }
                Err(problem) => assert!(!problem.to_string().is_empty()),
            }
        }
    }
}

pub fn generated() -> Vec<(&'static str, Vec<u8>)> {
    let joints = [0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0];
    let weights = [0.5, 0.5, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0];
    let moved = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0];
    vec![
        ("triangle.glb", Build::triangle().glb()),
        ("skinned.glb", Build::skinned(joints, weights).glb()),
        ("animated.glb", Build::animated("translation", &[0.0, 1.0, 2.0], "VEC3", 3, &moved).glb()),
        ("pointers.glb", crate::examples::pointers().glb()),
        ("textured.glb", crate::examples::textured_square().glb()),
        ("large-image.glb", crate::examples::large_image().glb()),
        ("walk.bvh", crate::examples::TWO_JOINTS.into()),
    ]
}

/// Small files of different kinds.
pub const REAL: [&str; 15] = [
    "khronos/SimpleSkin/glTF-Embedded/SimpleSkin.gltf",
    "khronos/SimpleMorph/glTF-Embedded/SimpleMorph.gltf",
    "khronos/RiggedSimple/glTF-Binary/RiggedSimple.glb",
    "khronos/AnimatedMorphCube/glTF-Binary/AnimatedMorphCube.glb",
    "khronos/RiggedFigure/glTF-Binary/RiggedFigure.glb",
    "threejs/SimpleSkinning.gltf",
    "asset-generator/Positive/Animation_Skin/Animation_Skin_00.gltf",
    "validator-invalid/animation/valid.gltf",
    "validator-invalid/accessor/valid.gltf",
    "validator-invalid/glb/two_images.glb",
    "cosc422/original/Dwarf/avatar_walk.bvh",
    "bvh/cosc422_Test.bvh",
    "bvh/deepmotion_rest.bvh",
    "vrm/three-vrm_test.vrma",
    "cosc422/mannequin_run.glb",
];

#[test]
fn damaged_files_never_panic() {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let mut failures = Vec::new();
    let mut read = 0;
    for (name, file) in generated() {
        read += check(name, &file, &mut random, &mut failures);
    }
    if let Some(data) = data_folder() {
        for path in REAL {
            let files = file_set(&data.join(path));
            let name = path.rsplit('/').next().expect("a name");
            read += check(name, files.get(name).expect("just added"), &mut random, &mut failures);
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
    assert!(read > 20, "only {read} damaged files were read at all: the damage hides what it should test");
}

/// One of the four files of an exercise model is damaged, the others are intact.
#[test]
fn damaged_exercises_never_panic() {
    let obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0\nv 0.3 0.3 0\nvt 0 0\nvn 0 0 1\ng a\nusemtl red\n\
               f 1/1/1 2/1/1 3/1/1 4/1/1\no b\nf -4 -3 -1\ns 1\nf 1 \\\n2 3\n";
    let skel = "0 0 0 -1\n0.5 0 0 0\n0 1 0 1\n";
    let attach = "0 0\n0.25 0.75\n1 0\n0.5 0.4\n";
    let mtl = "newmtl red\nKd 1 0.5 0\nd 0.5\nNs 10\nKs 1 1 1\nmap_Kd -s 1 1 1 skin.png\n";
    let texts = [("m.obj", obj), ("m.skel", skel), ("m.attach", attach), ("m.mtl", mtl)];
    let mut random = Random(0x0123_4567_89AB_CDEF);
    let mut read = 0;
    for case in 0..4000 {
        let mut files = FileSet::default();
        let damaged = random.below(texts.len());
        for (at, (name, text)) in texts.iter().enumerate() {
            let bytes = if at == damaged { damage(text.as_bytes(), &mut random) } else { text.as_bytes().to_vec() };
            files.insert(*name, bytes);
        }
        let _ = missing_files(&files);
        match load(&files) {
            Ok(asset) => {
                read += 1;
                let joints = asset.skins.first().map(|skin| skin.joints().len());
                for geometry in &asset.meshes[0].primitives {
                    geometry.validate(joints).unwrap_or_else(|problem| panic!("case {case}: {problem}"));
                }
                let written = convert(&files, &LoadOptions::default()).expect("what is read can be written");
                load(&one("written.glb", written)).expect("what is written can be read");
            }
            Err(problem) => assert!(!problem.to_string().is_empty()),
        }
    }
    assert!((500..3900).contains(&read), "{read} of 4000 were read");
}
