//! Real characters and all their clips, written and read back.

use std::path::Path;

use gaitway_character::asset::Asset;
use gaitway_fbx_writer::{FbxOptions, FbxRecipient, Written, fbx};

use crate::data_folder::data_folder;
use crate::read::{Difference, asset, compare, glb};

/// Allowed distance of joints per size of the model.
const TOLERANCE: f32 = 1e-4;
/// The same of vertices. The reader measures its own error at joints, and what a hand holds reaches far beyond.
const VERTEX_TOLERANCE: f32 = 2.5e-4;

/// Characters of all kinds: Mixamo's and KayKit's, avatars, names of MikuMikuDance, scaled joints, one that the mesh is on, animals,
/// rigid parts, morph targets, and files of FBX, `.x` and BVH.
const CHARACTERS: [&str; 40] = [
    "cosc422/dwarf.glb",
    "cosc422/original/Dwarf/dwarf.x",
    "cosc422/original/Dwarf/avatar_walk.bvh",
    "cosc422/ArmyPilot.glb",
    "cosc422/mannequin.glb",
    "cosc422/mannequin_run.glb",
    "cosc422/original/Mannequin/mannequin.fbx",
    "threejs/Soldier.glb",
    "threejs/Xbot.glb",
    "threejs/RobotExpressive.glb",
    "threejs/Samba_Dancing.fbx",
    "threejs/Flamingo.glb",
    "threejs/SittingBox.glb",
    "threejs/SimpleSkinning.gltf",
    "kaykit/Knight.glb",
    "khronos/CesiumMan/glTF-Binary/CesiumMan.glb",
    "khronos/CesiumMan/glTF-Draco/CesiumMan.gltf",
    "khronos/RiggedFigure/glTF-Binary/RiggedFigure.glb",
    "khronos/RiggedSimple/glTF-Binary/RiggedSimple.glb",
    "khronos/BrainStem/glTF-Binary/BrainStem.glb",
    "khronos/Monster/glTF-Binary/Monster.glb",
    "khronos/Fox/glTF-Binary/Fox.glb",
    "khronos/MorphStressTest/glTF-Binary/morph-stress-test.glb",
    "khronos/InterpolationTest/glTF-Binary/InterpolationTest.glb",
    "khronos/AnimatedMorphCube/glTF-Binary/AnimatedMorphCube.glb",
    "khronos/SimpleSkin/glTF-Embedded/SimpleSkin.gltf",
    "mesh2motion/retarget/mixamo-original-rig.glb",
    "mesh2motion/retarget/m2m-sample-rig.glb",
    "mesh2motion/human-male.glb",
    "mesh2motion/human-zombie.glb",
    "mesh2motion/fox-animations.glb",
    "mesh2motion/spider-animations.glb",
    "mesh2motion/snake-animations.glb",
    "mesh2motion/bird-animations.glb",
    "mesh2motion/cmu_91_51.glb",
    "misc/TRex.glb",
    "misc/godot_robot_player.glb",
    "misc/babylon_riggedMesh.glb",
    "playcanvas/bitmoji.glb",
    "vrm/vrm0_cryptovoxels.vrm",
];

fn write(folder: &Path, name: &str, options: FbxOptions) -> (Asset, Written) {
    let glb = glb(&folder.join(name));
    let written = fbx(&glb, &options).unwrap_or_else(|error| panic!("{name}: {error}"));
    (asset("model.glb", &glb), written)
}

fn check(folder: &Path, name: &str, recipient: FbxRecipient) -> Difference {
    let (original, written) = write(folder, name, FbxOptions { recipient, ..FbxOptions::default() });
    let read = asset("model.fbx", &written.bytes);
    let difference = compare(name, &original, &written, &read);
    println!("{name} for {recipient:?}: {difference:?}, {} bytes, {:?}", written.bytes.len(), written.warnings);
    difference
}

#[test]
fn characters_come_back_as_they_were() {
    let Some(folder) = data_folder() else { return };
    let (mut poses, mut failures) = (0, Vec::new());
    for name in CHARACTERS {
        let difference = check(&folder, name, FbxRecipient::AsIs);
        poses += difference.poses;
        if difference.joints > TOLERANCE || difference.vertices > VERTEX_TOLERANCE {
            failures.push(format!("{name}: {difference:?}"));
        }
    }
    println!("{} characters, {poses} poses", CHARACTERS.len());
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn presets_show_the_same() {
    let Some(folder) = data_folder() else { return };
    let names = ["cosc422/mannequin.glb", "threejs/Soldier.glb", "threejs/RobotExpressive.glb", "misc/TRex.glb"];
    for name in names {
        for recipient in FbxRecipient::ALL {
            let difference = check(&folder, name, recipient);
            assert!(
                difference.joints <= TOLERANCE && difference.vertices <= VERTEX_TOLERANCE,
                "{name} for {recipient:?}"
            );
        }
    }
}
